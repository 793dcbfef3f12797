// SPDX-License-Identifier: Apache-2.0
// Where a regime (world/contact_regime.hpp) has the object while the surfaces move.
//
// There are three unknowns, the pose. Every contact closes its gap, a sticking one does not slip.
// If these are fewer than three independent equations, the forces are few, too, and balance gives
// the rest: with two contacts that both slide, the object takes the pose in which the two forces and
// the weight are in balance. If even then something is left (a flat object between two flat
// surfaces that both slide, or a pipe, which may turn in place), both sides slide alike.
//
// A robot that stalls (world/force_limits.hpp) and yields is a fourth unknown: where its palm is.
// Either one more contact sticks, or the forces are unique, and that of the robot is at its limit.
#pragma once

#include "palmbots/base/small_linear.hpp"
#include "palmbots/world/force_limits.hpp"

namespace palmbots {

namespace detail {

// How far two forces and the weight are from balance: the volume that they span.
inline double unbalanced(const ContactProblem& problem, const Regime& regime,
                         const ActiveContacts& contacts) {
  const Rays<double> rays = rays_of(problem, regime, contacts);
  return dot(cross(rays.ray[0], rays.ray[1]), problem.weight(regime.pushed));
}

// How far the push of a robot that yields, or its partner's push against it, is above the limit.
inline double above_limit(const ContactProblem& problem, const Regime& regime,
                          const ActiveContacts& contacts) {
  const std::size_t side = regime.drives[left] == Drive::yields ? left : right;
  constexpr double any = std::numeric_limits<double>::infinity();
  return BalancedForces(problem, regime, contacts, any)
      .most_push(side, problem.commanded[side] < 0.0 ? -1.0 : 1.0);
}

// The equations of a regime at a pose. With `rates`, of the object's twist instead: the right-hand
// sides are the velocities that the surfaces give.
// The fourth unknown is the place of the palm that yields, or its speed, along x.
struct RegimeEquations {
  EchelonForm<double, 4> system{};
  bool balance = false;  // one of them is about forces
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
  if (equations.system.full()) return equations;
  constexpr double none = 1e-8;  // above the rounding of the differences
  // Adds that a function of the contacts is 0. False: it does not depend on where the object is.
  const auto add_level = [&](auto level, double value) {
    // Central differences: in the mirror they round alike.
    const double h = 1e-6;
    const auto rate = [&](auto at) { return (at(h) - at(-h)) / (h + h); };
    const double size = problem.shapes.size;
    const auto by = [&](Vec shift, double turn) {
      return rate([&](double k) {
        const Pose there = Pose::of(pose.at + shift * k, pose.angle + turn * k);
        return level(problem, regime, contacts_of(problem, regime, frames, there));
      });
    };
    const auto by_palm_that_yields = [&] {
      return rate([&](double k) {
        Frames there = frames;
        for (const std::size_t side : {left, right})
          if (regime.drives[side] == Drive::yields) there[side].origin.x += size * k;
        return level(problem, regime, contacts_of(problem, regime, there, pose));
      });
    };
    const Triple<double> row{by({size, 0.0}, 0.0), by({0.0, size}, 0.0), by({0.0, 0.0}, 1.0)};
    const double palm = regime.yields() ? by_palm_that_yields() : 0.0;
    if (!(decltype(equations.system)::largest({row.x, row.y, row.z, palm}) > none)) return false;
    equations.balance = true;
    if (rates) {
      const double fastest = pace_of(frames, size);
      value = 0.0;
      if (fastest > 0.0) {
        const double pace = size / fastest;
        const double drift = rate([&](double k) {
          const Frames then = moved(frames, k * pace);
          return level(problem, regime, contacts_of(problem, regime, then, pose));
        });
        value = -(drift / pace);
      }
    }
    equations.add(row, value * size, palm);
    return true;
  };
  if (rays == 2) {
    const double off = unbalanced(problem, regime, contacts);
    const bool is_added = add_level(unbalanced, off);
    if (!regime.yields() && (is_added || magnitude(off) > none)) return equations;
  }
  if (regime.yields()) {
    if (regime.has_unique_forces()) add_level(above_limit, above_limit(problem, regime, contacts));
    return equations;
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
