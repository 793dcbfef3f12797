// SPDX-License-Identifier: Apache-2.0
// A regime: which contacts persist, and whether each of them sticks or slides. It determines where
// the object is while the surfaces move (world/regime_equations.hpp).
#pragma once

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

// How a robot moves. One that stalls stands, or yields: the contacts determine its speed.
enum class Drive : std::uint8_t { as_commanded, yields, stands };

struct Regime {
  std::array<ActivePair, max_supports> active;  // up to `count`
  std::size_t count = 0;
  PerSide<Drive> drives{};
  double alike = 0.0;  // difference of the runs of both sides, where nothing else decides [m]
  bool pushed = true;  // whether forces balance with the push, or only without it

  constexpr bool none() const { return count == 0; }
  constexpr bool yields() const {
    return drives[left] == Drive::yields || drives[right] == Drive::yields;
  }
  constexpr bool stalls() const { return drives != PerSide<Drive>{}; }
  // Whether balance alone determines the forces: at most three of them are unknown.
  constexpr bool has_unique_forces() const {
    std::size_t rays = count;
    for (std::size_t i = 0; i < count; ++i) rays += active[i].motion == Motion::stick ? 1 : 0;
    return rays <= 3;
  }
  constexpr bool has(FeaturePair pair) const {
    for (std::size_t i = 0; i < count; ++i)
      if (active[i].pair == pair) return true;
    return false;
  }
  // Drops the contacts that leave.
  constexpr void let_go() {
    const std::size_t before = count;
    count = 0;
    for (std::size_t i = 0; i < before; ++i)
      if (active[i].motion != Motion::leave) active[count++] = active[i];
  }
  // Whether the same pairs move alike.
  constexpr bool is_like(const Regime& other) const {
    if (count != other.count || pushed != other.pushed) return false;
    for (std::size_t i = 0; i < count; ++i)
      if (active[i].pair != other.active[i].pair || active[i].motion != other.active[i].motion)
        return false;
    return true;
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
  const Surface& surface(FeaturePair pair) const { return shapes.surfaces.at[pair.surface]; }
  std::size_t carrier(FeaturePair pair) const {
    return static_cast<std::size_t>(surface(pair).carrier);
  }
  FeatureContact contact(const Frames& frames, const Pose& pose, FeaturePair pair,
                         Vec reference = {}) const {
    return contact_of(shapes.body, surface(pair), frames[carrier(pair)], pose, pair, reference);
  }
  // The palm on which this is the contact corner of the object; 2 if it is another pair.
  std::size_t own_side(FeaturePair pair) const {
    return pair == shapes.own[left] ? left : (pair == shapes.own[right] ? right : 2);
  }
  // The first contact of a regime on each palm; nullptr: the palm is not touched.
  PerSide<const ActivePair*> first_on_palms(const Regime& regime) const {
    PerSide<const ActivePair*> first{};
    for (std::size_t i = regime.count; i-- > 0;)
      if (const std::size_t side = carrier(regime.active[i].pair); side <= right)
        first[side] = &regime.active[i];
    return first;
  }
  bool is_on_both(const Regime& regime) const {
    const PerSide<const ActivePair*> first = first_on_palms(regime);
    return first[left] != nullptr && first[right] != nullptr;
  }
  // How far such a contact is from the end of what may be used of its palm. A little before it
  // counts as there, because the palm may end there, too.
  double left_of_reach(std::size_t side, const FeatureContact& c) const {
    const double from = shapes.stops[side] ? -c.place : magnitude(c.place);
    return shapes.reach[side] - from - 4e-10 * shapes.size;
  }
  // The weight that the contacts carry, with the push of an acceleration or without it.
  Triple weight(bool pushed) const { return {slope + (pushed ? push : 0.0), 1.0, 0.0}; }
  // The velocity that the surface of a pair gives to the contact in a direction.
  double given(const Frames& frames, const Pose& pose, FeaturePair pair, const FeatureContact& c,
               Vec direction) const {
    return dot(direction, frames[carrier(pair)].velocity_at(pose.at + c.point));
  }
  Triple row(const FeatureContact& c, Vec direction) const {
    return {direction.x, direction.y, cross(c.point, direction) / shapes.size};
  }
  // The forces of a contact that moves in this way, as rays of unit size (mechanics/wrench_cone.hpp).
  void add_rays(Rays& rays, const FeatureContact& c, double friction, Motion motion) const {
    each_edge(motion, friction, [&](double along) {
      const Triple wrench = row(c, c.normal + c.tangent * along);
      rays.ray[rays.count++] = wrench * (1.0 / palmbots::size(wrench));
    });
  }
};

// The first contact on another carrier than the first one of all.
inline std::size_t other_carrier(const ContactProblem& problem, const Regime& regime) {
  std::size_t second = 0;
  while (second < regime.count &&
         problem.carrier(regime.active[second].pair) == problem.carrier(regime.active[0].pair))
    ++second;
  return second;
}

using ActiveContacts = std::array<FeatureContact, max_supports>;

inline ActiveContacts contacts_of(const ContactProblem& problem, const Regime& regime,
                                  const Frames& frames, const Pose& pose) {
  ActiveContacts found;
  for (std::size_t i = 0; i < regime.count; ++i) {
    found[i] = problem.contact(frames, pose, regime.active[i].pair, regime.active[i].reference);
  }
  return found;
}

inline Rays rays_of(const ContactProblem& problem, const Regime& regime,
                    const ActiveContacts& contacts) {
  Rays rays{};
  for (std::size_t i = 0; i < regime.count; ++i) {
    problem.add_rays(rays, contacts[i], problem.surface(regime.active[i].pair).friction,
                     regime.active[i].motion);
  }
  return rays;
}

}  // namespace palmbots
