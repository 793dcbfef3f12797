// SPDX-License-Identifier: Apache-2.0
// Everything that touches the object in one state, and the contact modes that may occur there: on two
// palms, or between palms that were driven along a floor, among walls and stands.
#pragma once

#include <string>
#include <vector>

#include "palmbots/mechanics/twist_feasibility.hpp"
#include "palmbots/sim/spec.hpp"
#include "palmbots/sim/state_contacts.hpp"

namespace palmbots::page {

// How palms move on a floor from where they begin, beside the object: both drive inward by `driven`,
// then both rise by `raised` [m].
struct FloorState {
  PerSide<double> theta;  // [rad]
  PerSide<double> driven;
  double raised;
  double friction;  // of the floor
  bool has_right;   // whether there is a right palm
};

class TouchedState {
 public:
  TouchedState() = default;

  // At palm angles [rad] and contact coordinates [m]; the right one of a pipe follows from the others.
  static TouchedState on_palms(const Spec& spec, const PerSide<double>& theta,
                               const PerSide<double>& p);
  static TouchedState on_floor(const Spec& spec, const FloorState& state);

  // What is wrong with the state; empty: nothing.
  const std::string& problem() const { return problem_; }
  // Why the palms stopped before they were where they were to be; empty: they did not.
  const std::string& end() const { return end_; }
  // Why they were not moved at all: what they would pass through.
  const std::string& refusal() const { return refusal_; }
  // Names of what touches, one a line.
  std::string kinds() const;

  // Appends: whether the contacts hold the object if all stick, and their number; of each contact its
  // carrier, place, point from the COM, normal into the object, friction; then x of the pivots before
  // the palms drive and, of palms on a floor and of a pipe, the places.
  void append(std::vector<double>& out) const;

  // Appends each contact mode that may occur while the palms move like this: the motion of each
  // contact, its normal and its friction force (from, to), and as what it is loaded where the margin
  // ends; then the margin [rad].
  void append_modes(const PerSide<RigidMotion>& palms, std::vector<double>& out) const;

 private:
  explicit TouchedState(const Spec& spec) : slope_(spec.slope) {}

  void add(const Touched& one);

  double slope_ = 0;
  std::string problem_;
  std::string end_;
  std::string refusal_;
  std::vector<Touched> touched_;
  Supports supports_;
  PerSide<Vec> pivots_{};  // from the COM
  std::vector<double> places_;
};

}  // namespace palmbots::page
