// SPDX-License-Identifier: Apache-2.0
// Linear feedback of the contact coordinates: references that show what information is worth.
//
// The commanded opening speed is (p_L + p_R) / T_c less the expected error of the opening speed,
// within what the robots can be commanded. The palms bring the difference p_L − p_R to zero. (Where
// the contacts have other targets, p is measured from these.) With
// `exact`, both contact coordinates are read from the world, and the error of the opening speed is
// its value in the last tick. Otherwise a Kalman filter estimates them from the signs of both palms
// (optimum/sign_filter.hpp). Nothing is delayed.
#pragma once

#include <cstdint>

#include "palmbots/optimum/reference_team.hpp"
#include "palmbots/optimum/sign_filter.hpp"

namespace palmbots {

// What distinguishes the references with linear feedback.
struct LinearFeedback {
  bool exact = false;
  bool may_stop = false;
  double time_s = 0.4;        // T_c: the sum of the contacts is to vanish in this time [s]
  PerSide<double> targets{};  // where the contacts are to be: p [m]
};

class LinearTeam : public ReferenceTeam {
 public:
  LinearTeam(const LinearFeedback& feedback, const Spec& spec)
      : ReferenceTeam(spec, feedback.may_stop),
        feedback_(feedback),
        filter_(spec),
        period_(spec.period) {
    const RobotSpec& ahead = spec.robots[leader()];
    const RobotSpec& behind = spec.robots[follower()];
    memory_ = memory_of<double>(spec.period, ahead.noise > 0 ? ahead.noise_tau : behind.noise_tau);
    bias_ = ahead.bias - behind.bias;
    error_ = bias_;
  }

  // Takes in, before step(), what a robot knows of the palms and the commanded speeds, and what only
  // the exact reference reads.
  template <class World, class AnyRobots>
  void look(const World& world, const AnyRobots& robots) {
    const auto& now = world.configuration();
    for (const std::size_t side : {left, right}) {
      speeds_[side] = double(robots.wheels[side].speed);
      angles_[side] = double(now.palms[side].angle);
      turns_[side] = double(robots.wrists[side].gain);
    }
    const bool has_moved = has_started_;
    has_started_ = true;
    if (!feedback_.exact) {
      if (has_moved) filter_.predict(opening(speeds_), now.palms);
      return;
    }
    for (const std::size_t side : {left, right}) contacts_[side] = double(now.contacts[side]);
    if (!has_moved) return;
    const double actual = double(robots.travel_sense) *
                          (double(robots.speeds[leader()]) - double(robots.speeds[follower()]));
    error_ = memory_ * (actual - opening(speeds_) - bias_) + bias_;
  }

  template <class Log>
  PerSide<Command> step(std::uint32_t, const PerSide<RobotObservation>& sensed, Log&&) {
    if (!feedback_.exact) {
      for (const std::size_t side : {leader(), follower()}) {
        filter_.update(side, sensed[side].sign);
      }
      for (const std::size_t side : {left, right}) contacts_[side] = filter_.contact(side);
      error_ = filter_.error();
    }
    PerSide<double> off = contacts_;
    for (const std::size_t side : {left, right}) off[side] -= feedback_.targets[side];
    const double wanted = (off[left] + off[right]) / feedback_.time_s - error_;
    PerSide<Command> commands =
        cheapest(speeds_, [&](double opening) { return magnitude(opening - wanted); });
    const double rate = magnitude(opening(speeds_) + error_);
    // An estimated difference near zero changes its sign often. Palms that follow it hang about
    // halfway, where the object decides which contact slides; so they complete their turns.
    if (feedback_.exact || (sensed[left].palm_at_target && sensed[right].palm_at_target)) {
      steer_palms(angles_, off, rate, turns_, period_, palms_);
    }
    for (const std::size_t side : {left, right}) commands[side].palm = palms_[side];
    return commands;
  }

 private:
  LinearFeedback feedback_;
  SignFilter filter_;
  bool has_started_ = false;
  double memory_ = 0;  // e^(−T/τ)
  double bias_ = 0;    // of the opening speed [m/s]
  double error_ = 0;   // opening speed less the commanded one, as expected in the next tick [m/s]
  PerSide<double> speeds_{};  // commanded, reached by the wheels [m/s]
  PerSide<double> angles_{};  // of the palms [rad]
  double period_;
  PerSide<double> turns_{};     // largest turns of the palms in a tick [rad]
  PerSide<double> contacts_{};  // [m]
  PerSide<Palm> palms_{Palm::steep, Palm::steep};
};

static_assert(Team<LinearTeam>);

}  // namespace palmbots
