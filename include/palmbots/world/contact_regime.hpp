// SPDX-License-Identifier: Apache-2.0
// A regime: which contacts persist, and whether each of them sticks or slides. It determines where
// the object is while the surfaces move (world/regime_equations.hpp).
#pragma once

#include <algorithm>

#include "palmbots/mechanics/twist_feasibility.hpp"
#include "palmbots/world/travel.hpp"

namespace palmbots {

// A contact that persists.
struct ActivePair {
  FeaturePair pair;
  Motion motion;  // stick, up or down
  double held;    // its run while it sticks [m]
  Vec reference;  // of a tip on an arc (feature_contact.hpp)
};

using ActivePairs = FixedList<ActivePair, max_supports>;

// How a robot moves. One that stalls stands, or yields: the contacts determine its speed.
enum class Drive : std::uint8_t { as_commanded, yields, stands };

struct Regime {
  ActivePairs active;
  PerSide<Drive> drives{};
  double alike = 0.0;  // difference of the runs of both sides, where nothing else decides [m]
  bool pushed = true;  // whether forces balance with the push, or only without it

  constexpr bool none() const { return active.empty(); }
  // The robot that yields; 3, which is no carrier: neither does.
  constexpr std::size_t yielding() const {
    return drives[left] == Drive::yields ? left : (drives[right] == Drive::yields ? right : 3);
  }
  constexpr bool stalls() const { return drives != PerSide<Drive>{}; }
  // How many forces are unknown: on the edges of the friction cones.
  constexpr std::size_t unknown_forces() const {
    std::size_t count = active.size();
    for (const ActivePair& a : active) count += a.motion == Motion::stick ? 1 : 0;
    return count;
  }
  // Whether balance alone determines the forces.
  constexpr bool has_unique_forces() const { return unknown_forces() <= 3; }
  constexpr bool has(FeaturePair pair) const {
    return std::ranges::find(active, pair, &ActivePair::pair) != active.end();
  }
  // The first contact on each palm; nullptr: the palm is not touched.
  PerSide<const ActivePair*> first_on_palms() const {
    PerSide<const ActivePair*> first{};
    for (const ActivePair& a : active)
      if (const std::size_t side = a.pair.carrier; side <= right && first[side] == nullptr)
        first[side] = &a;
    return first;
  }
  bool is_on_both() const {
    const PerSide<const ActivePair*> first = first_on_palms();
    return first[left] != nullptr && first[right] != nullptr;
  }
  // The number of the first contact on another carrier than the first one of all.
  std::size_t other_carrier() const {
    std::size_t i = 0;
    while (i < active.size() && active[i].pair.carrier == active[0].pair.carrier) ++i;
    return i;
  }
  // Drops the contacts that leave.
  constexpr void let_go() {
    const auto leaves = [](const ActivePair& a) { return a.motion == Motion::leave; };
    active.keep(std::size_t(std::remove_if(active.begin(), active.end(), leaves) - active.begin()));
  }
  // Whether the same pairs move alike.
  constexpr bool is_like(const Regime& other) const {
    const auto is_same = [](const ActivePair& a, const ActivePair& b) {
      return a.pair == b.pair && a.motion == b.motion;
    };
    return pushed == other.pushed && std::ranges::equal(active, other.active, is_same);
  }
};

// The object and what it can touch.
struct ContactShapes {
  RoundedBody body;
  Surfaces surfaces;
  PerSide<FeaturePair> own;  // each contact corner of the object on the face of its palm
  PerSide<double> reach;     // how far from the middle of the face that contact may be [m]
  PerSide<bool> stops;       // outward, only a heel limits that
  double size;               // of the object: the distance of its contact corners, or a radius [m]
  double lopsided;           // > 0 or < 0: which way left and right differ; 0: mirror images
};

// What does not change in a step.
struct ContactProblem {
  const ContactShapes& shapes;
  double slope;         // sideways specific force
  double push;          // more of it, from acceleration
  bool on_both = true;  // whether the step ends when the object leaves one palm
  PerSide<double> limit =
      no_limits<double>;        // of the force of each robot along the floor [weights]
  PerSide<double> commanded{};  // the way of each robot along x in the step [m]

  bool is_limited() const { return limit != no_limits<double>; }
  // The direction in which a robot drives along x.
  double sense(std::size_t side) const { return commanded[side] < 0.0 ? -1.0 : 1.0; }
  const Surface& surface(FeaturePair pair) const { return shapes.surfaces[pair.surface]; }
  // How far such a contact is from the end of what may be used of its palm. A little before it
  // counts as there, because the palm may end there, too.
  double left_of_reach(const FeatureContact& c) const {
    const double from = shapes.stops[c.pair.carrier] ? -c.place : magnitude(c.place);
    return shapes.reach[c.pair.carrier] - from - 4e-10 * shapes.size;
  }
  // The weight that the contacts carry, with the push of an acceleration or without it.
  Triple weight(bool pushed) const { return {slope + (pushed ? push : 0.0), 1.0, 0.0}; }
};

// The object among the surfaces at an instant.
struct Instant {
  const ContactProblem& problem;
  Frames frames;
  Pose pose;

  FeatureContact contact(FeaturePair pair, Vec reference = {}) const {
    return contact_of(problem.shapes.body, problem.surface(pair), frames[pair.carrier], pose, pair,
                      reference);
  }
  Triple row(const FeatureContact& c, Vec direction) const {
    return c.row(direction, problem.shapes.size);
  }
  // The pose after a motion with a twist (x, y, turn × size) for so long.
  Pose after(Triple twist, double t = 1.0) const {
    return Pose::of(pose.at + Vec{twist.x, twist.y} * t,
                    pose.angle + twist.z * t / problem.shapes.size);
  }
  // The velocity that the surface of a contact gives to it in a direction.
  double given(const FeatureContact& c, Vec direction) const {
    return dot(direction, frames[c.pair.carrier].velocity_at(pose.at + c.point));
  }
};

// A contact that persists, in a pose.
struct ActiveContact : FeatureContact {
  Motion motion;
  double held;

  // How far it has slipped since it began to stick [m].
  double slipped() const { return run - held; }
};

// A regime with its contacts as they are at an instant.
struct PosedRegime : Instant {
  const Regime& regime;
  FixedList<ActiveContact, max_supports> contacts;

  PosedRegime(const Instant& at, const Regime& with) : Instant(at), regime(with) { put(pose); }
  // Puts the object in a pose.
  void put(const Pose& there) {
    pose = there;
    contacts.clear();
    for (const ActivePair& a : regime.active)
      contacts.push_back({contact(a.pair, a.reference), a.motion, a.held});
  }

  Triple weight() const { return problem.weight(regime.pushed); }
  // The forces of the contacts.
  Rays rays() const {
    Rays rays;
    for (const ActiveContact& c : contacts) add_rays(rays, c, c.motion, problem.shapes.size);
    return rays;
  }
};

}  // namespace palmbots
