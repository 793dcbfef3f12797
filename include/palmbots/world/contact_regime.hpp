// SPDX-License-Identifier: Apache-2.0
// A regime: which contacts persist, and whether each of them sticks or slides. It determines where
// the object is while the surfaces move.
//
// There are three unknowns, the pose. Every contact closes its gap, a sticking one does not slip.
// If these are fewer than three independent equations, the forces are few, too, and balance gives
// the rest: with two contacts that both slide, the object takes the pose in which the two forces and
// the weight are in balance. If even then something is left (a flat object between two flat
// surfaces that both slide, or a pipe, which may turn in place), both sides slide alike.
//
// A robot that stalls (world/force_limits.hpp) and yields is a fourth unknown: where its palm is.
#pragma once

#include "palmbots/base/small_linear.hpp"
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
  constexpr bool has(FeaturePair pair) const {
    for (std::size_t i = 0; i < count; ++i)
      if (active[i].pair == pair) return true;
    return false;
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
  // How far such a contact is from the end of what may be used of its palm. A little before it
  // counts as there, because the palm may end there, too.
  double left_of_reach(std::size_t side, const FeatureContact& c) const {
    const double from = shapes.stops[side] ? -c.place : magnitude(c.place);
    return shapes.reach[side] - from - 4e-10 * shapes.size;
  }
  // The weight that the contacts carry, with the push of an acceleration or without it.
  Triple<double> weight(bool pushed) const { return {slope + (pushed ? push : 0.0), 1.0, 0.0}; }
  // The velocity that the surface of a pair gives to the contact in a direction.
  double given(const Frames& frames, const Pose& pose, FeaturePair pair, const FeatureContact& c,
               Vec direction) const {
    return dot(direction, frames[carrier(pair)].velocity_at(pose.at + c.point));
  }
  Triple<double> row(const FeatureContact& c, Vec direction) const {
    return {direction.x, direction.y, cross(c.point, direction) / shapes.size};
  }
  // The forces of a contact that moves in this way, as rays of unit size (mechanics/wrench_cone.hpp).
  void add_rays(Rays<double>& rays, const FeatureContact& c, double friction, Motion motion) const {
    for (const Motion edge : {Motion::up, Motion::down}) {
      if (motion != edge && motion != Motion::stick) continue;
      const double along = edge == Motion::up ? -friction : friction;
      const Triple<double> wrench = row(c, c.normal + c.tangent * along);
      rays.ray[rays.count++] = wrench * (1.0 / palmbots::size(wrench));
    }
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

inline Rays<double> rays_of(const ContactProblem& problem, const Regime& regime,
                            const ActiveContacts& contacts) {
  Rays<double> rays{};
  for (std::size_t i = 0; i < regime.count; ++i) {
    problem.add_rays(rays, contacts[i], problem.surface(regime.active[i].pair).friction,
                     regime.active[i].motion);
  }
  return rays;
}

namespace detail {

// How far two forces and the weight are from balance: the volume that they span.
inline double unbalanced(const ContactProblem& problem, const Regime& regime,
                         const ActiveContacts& contacts) {
  const Rays<double> rays = rays_of(problem, regime, contacts);
  return dot(cross(rays.ray[0], rays.ray[1]), problem.weight(regime.pushed));
}

// The equations of a regime at a pose. With `rates`, of the object's twist instead: the right-hand
// sides are the velocities that the surfaces give.
// The fourth unknown is the place of the palm that yields, or its speed, along x.
struct RegimeEquations {
  EchelonForm<double, 4> system{};
  bool balance = false;  // the last one is that of balance
  bool spare = false;    // some depend on others

  void add(Triple<double> row, double value, double palm = 0.0) {
    if (!system.add({row.x, row.y, row.z, palm}, value)) spare = true;
  }
};

inline RegimeEquations equations(const ContactProblem& problem, const Regime& regime,
                                 const Frames& frames, const Pose& pose,
                                 const ActiveContacts& contacts, bool rates) {
  RegimeEquations equations{};
  const auto given = [&](std::size_t i, Vec direction) {
    return problem.given(frames, pose, regime.active[i].pair, contacts[i], direction);
  };
  // A palm that yields moves a contact on it by this per metre.
  const auto by_palm = [&](std::size_t i, Vec direction) {
    const std::size_t carrier = problem.carrier(regime.active[i].pair);
    return carrier < 2 && regime.drives[carrier] == Drive::yields ? -direction.x : 0.0;
  };
  if (!regime.yields()) equations.add({0.0, 0.0, 0.0}, 0.0, 1.0);
  for (std::size_t i = 0; i < regime.count; ++i) {
    const FeatureContact& c = contacts[i];
    equations.add(problem.row(c, c.normal), rates ? given(i, c.normal) : c.gap,
                  by_palm(i, c.normal));
  }
  std::size_t rays = regime.count;
  for (std::size_t i = 0; i < regime.count; ++i) {
    if (regime.active[i].motion != Motion::stick) continue;
    const FeatureContact& c = contacts[i];
    ++rays;
    equations.add(problem.row(c, c.tangent),
                  rates ? given(i, c.tangent) : c.run - regime.active[i].held,
                  by_palm(i, c.tangent));
  }
  if (equations.system.full() || regime.yields()) return equations;
  if (rays == 2) {
    // Central differences: in the mirror they round alike.
    const double h = 1e-6;
    const auto rate = [&](auto at) { return (at(h) - at(-h)) / (h + h); };
    const auto by = [&](Vec shift, double turn) {
      return rate([&](double k) {
        const Pose there = Pose::of(pose.at + shift * k, pose.angle + turn * k);
        return unbalanced(problem, regime, contacts_of(problem, regime, frames, there));
      });
    };
    const double size = problem.shapes.size;
    const Triple<double> row{by({size, 0.0}, 0.0), by({0.0, size}, 0.0), by({0.0, 0.0}, 1.0)};
    constexpr double none = 1e-8;  // above the rounding of the differences
    equations.balance = decltype(equations.system)::largest({row.x, row.y, row.z, 0.0}) > none;
    const double off = unbalanced(problem, regime, contacts);
    if (!equations.balance) {
      if (magnitude(off) > none) return equations;  // nowhere in balance
    } else if (!rates) {
      equations.add(row, off * size);
      return equations;
    } else {
      const double pace = size / pace_of(frames, size);
      const double drift = rate([&](double k) {
        const Frames then = moved(frames, k * pace);
        return unbalanced(problem, regime, contacts_of(problem, regime, then, pose));
      });
      equations.add(row, -(drift / pace) * size);
      return equations;
    }
  }
  // Both sides alike: the run of the first contact of one carrier as that of the other one.
  const std::size_t second = other_carrier(problem, regime);
  if (second == regime.count) return equations;
  const FeatureContact& a = contacts[0];
  const FeatureContact& b = contacts[second];
  equations.add(
      problem.row(a, a.tangent) - problem.row(b, b.tangent),
      rates ? given(0, a.tangent) - given(second, b.tangent) : (a.run - b.run) - regime.alike);
  return equations;
}

}  // namespace detail

// True if all gaps are closed and all sticking contacts are where they were: there may be more
// equations than unknowns.
inline bool holds(const ContactProblem& problem, const Regime& regime,
                  const ActiveContacts& contacts) {
  // Wider for slip: the place at which a contact sticks was noted before its gap was closed.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double most = 64.0 * epsilon * problem.shapes.size;
  const double most_slip = 2e5 * epsilon * problem.shapes.size;
  for (std::size_t i = 0; i < regime.count; ++i) {
    const double slipped = contacts[i].run - regime.active[i].held;
    if (magnitude(contacts[i].gap) > most) return false;
    if (regime.active[i].motion == Motion::stick && magnitude(slipped) > most_slip) return false;
  }
  return true;
}

// Moves the pose, and a palm that yields, to where the regime holds the object. False if that is not
// near.
inline bool settle(const ContactProblem& problem, const Regime& regime, Frames& frames, Pose& pose,
                   ActiveContacts& contacts) {
  for (int i = 0; i < 40; ++i) {
    contacts = contacts_of(problem, regime, frames, pose);
    const auto made = detail::equations(problem, regime, frames, pose, contacts, false);
    if (!made.system.full()) return false;
    const auto step = made.system.solution();
    const double most = decltype(made.system)::largest(step);
    if (!(most < problem.shapes.size)) return false;
    for (const std::size_t side : {left, right})
      if (regime.drives[side] == Drive::yields) frames[side].origin.x -= step[3];
    pose = Pose::of(pose.at - Vec{step[0], step[1]}, pose.angle - step[2] / problem.shapes.size);
    // Convergence is quadratic: after so small a step, the remaining error is far below rounding.
    if (most < 1e-10 * problem.shapes.size) {
      contacts = contacts_of(problem, regime, frames, pose);
      return holds(problem, regime, contacts);
    }
  }
  return false;
}

}  // namespace palmbots
