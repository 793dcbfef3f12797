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

// How far two forces and the weight are from balance (the volume that they span), and how fast that
// changes while the object moves with a twist and the surfaces with their velocities.
struct Unbalance {
  double volume;
  double rate;
};
inline Unbalance unbalanced(const ContactProblem& problem, const Regime& regime,
                            const ActiveContacts& contacts, const Frames& frames, const Pose& pose,
                            Vec velocity, double spin) {
  const double size = problem.shapes.size;
  const auto turned = [](Vec v) { return Vec{-v.y, v.x}; };
  std::array<Triple, 2> ray{};
  std::array<Triple, 2> ray_rate{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < regime.count; ++i) {
    const FeatureContact& c = contacts[i];
    const FeaturePair pair = regime.active[i].pair;
    const Frame& frame = frames[problem.carrier(pair)];
    const double radius =
        pair.kind == PairKind::tip_on_edge ? 0.0 : problem.shapes.body.corners[pair.feature].radius;
    Vec point_rate{};
    Vec normal_rate{};
    if (pair.kind == PairKind::corner_on_face) {
      normal_rate = turned(c.normal) * (frame.sense * frame.rate);
      point_rate = turned(c.point + c.normal * radius) * spin - normal_rate * radius;
    } else {
      point_rate = frame.velocity_at(pose.at + c.point) - velocity;
      normal_rate = turned(c.normal) * spin;
      if (pair.kind == PairKind::tip_on_arc) {
        const double distance = radius + c.gap;
        const Vec passing = point_rate - turned(c.point + c.normal * distance) * spin;
        normal_rate = c.tangent * (-dot(c.tangent, passing) / distance);
      }
    }
    const Vec tangent_rate = tangent_of(frame.sense, normal_rate);
    each_edge(regime.active[i].motion, problem.surface(pair).friction, [&](double along) {
      const Vec force = c.normal + c.tangent * along;
      const Vec force_rate = normal_rate + tangent_rate * along;
      const Triple wrench = problem.row(c, force);
      const Triple wrench_rate{force_rate.x, force_rate.y,
                               (cross(point_rate, force) + cross(c.point, force_rate)) / size};
      const double scale = 1.0 / palmbots::size(wrench);
      ray[count] = wrench * scale;
      ray_rate[count] = (wrench_rate - ray[count] * dot(ray[count], wrench_rate)) * scale;
      ++count;
    });
  }
  const Triple weight = problem.weight(regime.pushed);
  return {dot(cross(ray[0], ray[1]), weight),
          dot(cross(ray_rate[0], ray[1]) + cross(ray[0], ray_rate[1]), weight)};
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

  void add(Triple row, double value, double palm = 0.0) {
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
  constexpr double none = 1e-8;
  const double size = problem.shapes.size;
  // Adds that a quantity is 0; rate(frames, velocity, spin) is how fast it changes while the surfaces
  // move with the frames' velocities and the object with these. False: it does not depend on where
  // the object is.
  const auto add_level = [&](double value, auto rate) {
    Frames still = frames;
    for (Frame& frame : still) {
      frame.velocity = {};
      frame.rate = 0.0;
    }
    const Triple row{rate(still, Vec{size, 0.0}, 0.0), rate(still, Vec{0.0, size}, 0.0),
                     rate(still, Vec{}, 1.0)};
    double palm = 0.0;
    if (regime.yields()) {
      still[regime.drives[left] == Drive::yields ? left : right].velocity.x = size;
      palm = rate(still, Vec{}, 0.0);
    }
    if (!(decltype(equations.system)::largest({row.x, row.y, row.z, palm}) > none)) return false;
    equations.balance = true;
    equations.add(row, (rates ? -rate(frames, Vec{}, 0.0) : value) * size, palm);
    return true;
  };
  if (rays == 2) {
    const auto unbalance = [&](const Frames& moving, Vec velocity, double spin) {
      return unbalanced(problem, regime, contacts, moving, pose, velocity, spin);
    };
    const double off = unbalance(frames, {}, 0.0).volume;
    const bool is_added = add_level(off, [&](auto... motion) { return unbalance(motion...).rate; });
    if (!regime.yields() && (is_added || magnitude(off) > none)) return equations;
  }
  if (regime.yields()) {
    // Central differences: in the mirror they round alike.
    const auto rate = [&](const Frames& moving, Vec velocity, double spin) {
      const double fastest =
          larger(pace_of(moving, size), length(velocity) + magnitude(spin) * size);
      if (!(fastest > 0.0)) return 0.0;
      const double h = 1e-6 * (size / fastest);
      const auto at = [&](double t) {
        const Pose there = Pose::of(pose.at + velocity * t, pose.angle + spin * t);
        return above_limit(problem, regime, contacts_of(problem, regime, moved(moving, t), there));
      };
      return (at(h) - at(-h)) / (h + h);
    };
    if (regime.has_unique_forces()) add_level(above_limit(problem, regime, contacts), rate);
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
inline bool holds(const ContactProblem& problem, const Regime& regime, const Pose& pose,
                  const ActiveContacts& contacts) {
  // Wider for slip: the place at which a contact sticks was noted before its gap was closed.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double far = magnitude(pose.at.x) + magnitude(pose.at.y);  // coordinates round there
  const double most = 16.0 * epsilon * (4.0 * problem.shapes.size + far);
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
  constexpr double noise = 1e-7;  // of the size: shorter steps may be errors of rounding
  double before = problem.shapes.size;
  int grown = 0;  // steps that were longer than the one before: there is no such place
  for (int i = 0; i < 40 && grown < 2; ++i) {
    contacts = contacts_of(problem, regime, frames, pose);
    const auto made = detail::equations(problem, regime, frames, pose, contacts, false);
    if (!made.system.full()) return false;
    const auto step = made.system.solution();
    const double most = decltype(made.system)::largest(step);
    if (!(most < problem.shapes.size)) return false;
    if (!(most < before) && most > noise * problem.shapes.size) ++grown;
    before = most;
    for (const std::size_t side : {left, right})
      if (regime.drives[side] == Drive::yields) frames[side].origin.x -= step[3];
    pose = Pose::of(pose.at - Vec{step[0], step[1]}, pose.angle - step[2] / problem.shapes.size);
    // Convergence is quadratic: after so small a step, the remaining error is far below rounding.
    if (most < 1e-10 * problem.shapes.size) {
      contacts = contacts_of(problem, regime, frames, pose);
      return holds(problem, regime, pose, contacts);
    }
  }
  return false;
}

}  // namespace palmbots
