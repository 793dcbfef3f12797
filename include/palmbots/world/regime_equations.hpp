// SPDX-License-Identifier: Apache-2.0
// Where a regime (world/contact_regime.hpp) has the object while the surfaces move.
//
// The unknowns are the three of the pose and, if a robot stalls (world/force_limits.hpp) and yields,
// where its palm is. Every contact closes its gap, and a sticking one does not slip. If these are too
// few equations, the forces are few, too, and balance gives the rest; that of a robot that yields is at
// its limit. If even then something is left (a flat object between two flat surfaces that both slide,
// or a pipe, which may turn in place), both sides slide alike.
//
// Source: docs/theory/mechanics.md, Regimes, and docs/theory/contacts.md, Robots with limits.
#pragma once

#include "palmbots/base/small_linear.hpp"
#include "palmbots/world/force_limits.hpp"

namespace palmbots {

// How far two forces and the weight are from balance (the volume that they span), and how fast that
// changes while the object moves with a twist and the surfaces with the velocities of `frames`.
struct Unbalance {
  double volume;
  double rate;
};
inline Unbalance unbalanced(const PosedRegime& at, const Frames& frames, Vec velocity,
                            double spin) {
  const ContactShapes& shapes = at.problem.shapes;
  const auto turned = [](Vec v) { return Vec{-v.y, v.x}; };
  FixedList<Triple, 2> ray;
  FixedList<Triple, 2> ray_rate;
  for (const ActiveContact& c : at.contacts) {
    const PairKind kind = c.pair.kind;
    const Frame& frame = frames[c.pair.carrier];
    const double radius =
        kind == PairKind::tip_on_edge ? 0.0 : shapes.body.corners[c.pair.feature].radius;
    Vec point_rate{};
    Vec normal_rate{};
    if (kind == PairKind::corner_on_face) {
      normal_rate = turned(c.normal) * (frame.sense * frame.rate);
      point_rate = turned(c.point + c.normal * radius) * spin - normal_rate * radius;
    } else {
      point_rate = frame.velocity_at(at.pose.at + c.point) - velocity;
      normal_rate = turned(c.normal) * spin;
      if (kind == PairKind::tip_on_arc) {
        const double distance = radius + c.gap;
        const Vec passing = point_rate - turned(c.point + c.normal * distance) * spin;
        normal_rate = c.tangent * (-dot(c.tangent, passing) / distance);
      }
    }
    const Vec tangent_rate = tangent_of(frame.sense, normal_rate);
    each_edge(c.motion, c.friction, [&](double along) {
      const Vec force = c.normal + c.tangent * along;
      const Vec force_rate = normal_rate + tangent_rate * along;
      const Triple wrench = c.row(force, shapes.size);
      const Triple wrench_rate{
          force_rate.x, force_rate.y,
          (cross(point_rate, force) + cross(c.point, force_rate)) / shapes.size};
      const double scale = 1.0 / size(wrench);
      const Triple unit = wrench * scale;
      ray.push_back(unit);
      ray_rate.push_back((wrench_rate - unit * dot(unit, wrench_rate)) * scale);
    });
  }
  return {dot(cross(ray[0], ray[1]), at.weight()),
          dot(cross(ray_rate[0], ray[1]) + cross(ray[0], ray_rate[1]), at.weight())};
}

// How far the push of a robot that yields, or its partner's push against it, is above the limit.
inline double above_limit(const PosedRegime& at) {
  const std::size_t side = at.regime.yielding();
  constexpr double any = std::numeric_limits<double>::infinity();
  return BalancedForces(at, any).most_push(side, at.problem.sense(side));
}

// The equations of a regime in a pose. With `rates`, of the object's twist instead: the right-hand
// sides are the velocities that the surfaces give.
// The fourth unknown is the place of the palm that yields, or its speed, along x.
struct RegimeEquations {
  using System = EchelonForm<double, 4>;
  System system{};
  bool balance = false;  // one of them is about forces
  bool spare = false;    // some depend on others

  RegimeEquations(const PosedRegime& at, bool rates) {
    const Regime& regime = at.regime;
    const std::size_t yielding = regime.yielding();
    const bool yields = yielding <= right;
    if (!yields) add({}, 0.0, 1.0);
    const auto close = [&](const FeatureContact& c, Vec direction, double off) {
      add(at.row(c, direction), rates ? at.given(c, direction) : off,
          c.pair.carrier == yielding ? -direction.x : 0.0);
    };
    for (const ActiveContact& c : at.contacts) close(c, c.normal, c.gap);
    for (const ActiveContact& c : at.contacts)
      if (c.motion == Motion::stick) close(c, c.tangent, c.slipped());
    if (system.full()) return;
    constexpr double none = 1e-8;
    const double size = at.problem.shapes.size;
    // Adds that a quantity is 0; rate(frames, velocity, spin) is how fast it changes while the
    // surfaces move with the frames' velocities and the object with these. False: it does not depend
    // on where the object is.
    const auto add_level = [&](double value, auto rate) {
      Frames still = at.frames;
      for (Frame& frame : still) {
        frame.velocity = {};
        frame.rate = 0.0;
      }
      const Triple row{rate(still, Vec{size, 0.0}, 0.0), rate(still, Vec{0.0, size}, 0.0),
                       rate(still, Vec{}, 1.0)};
      double palm = 0.0;
      if (yields) {
        still[yielding].velocity.x = size;
        palm = rate(still, Vec{}, 0.0);
      }
      if (!(System::largest({row.x, row.y, row.z, palm}) > none)) return false;
      balance = true;
      add(row, (rates ? -rate(at.frames, Vec{}, 0.0) : value) * size, palm);
      return true;
    };
    if (regime.unknown_forces() == 2) {
      const auto unbalance = [&](const Frames& moving, Vec velocity, double spin) {
        return unbalanced(at, moving, velocity, spin);
      };
      const double off = unbalance(at.frames, {}, 0.0).volume;
      const bool is_added =
          add_level(off, [&](auto... motion) { return unbalance(motion...).rate; });
      if (!yields && (is_added || magnitude(off) > none)) return;
    }
    if (yields) {
      if (!regime.has_unique_forces()) return;
      // Central differences: in the mirror they round alike.
      add_level(above_limit(at), [&](const Frames& moving, Vec velocity, double spin) {
        const double fastest =
            larger(pace_of(moving, size), length(velocity) + magnitude(spin) * size);
        if (!(fastest > 0.0)) return 0.0;
        const double h = 1e-6 * (size / fastest);
        const auto above = [&](double t) {
          const Pose there = Pose::of(at.pose.at + velocity * t, at.pose.angle + spin * t);
          return above_limit({{at.problem, moved(moving, t), there}, regime});
        };
        return (above(h) - above(-h)) / (h + h);
      });
      return;
    }
    // Both sides alike: the run of the first contact of one carrier as that of the other one.
    const std::size_t second = regime.other_carrier();
    if (second == at.contacts.size()) return;
    const ActiveContact& a = at.contacts[0];
    const ActiveContact& b = at.contacts[second];
    add(at.row(a, a.tangent) - at.row(b, b.tangent),
        rates ? at.given(a, a.tangent) - at.given(b, b.tangent) : (a.run - b.run) - regime.alike);
  }

 private:
  void add(Triple row, double value, double palm = 0.0) {
    if (!system.add({row.x, row.y, row.z, palm}, value)) spare = true;
  }
};

// True if all gaps are closed and all sticking contacts are where they were: there may be more
// equations than unknowns.
inline bool holds(const PosedRegime& at) {
  // Wider for slip: the place at which a contact sticks was noted before its gap was closed.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double size = at.problem.shapes.size;
  const double far = magnitude(at.pose.at.x) + magnitude(at.pose.at.y);  // coordinates round there
  const double most = 16.0 * epsilon * (4.0 * size + far);
  const double most_slip = 2e5 * epsilon * size;
  return std::ranges::all_of(at.contacts, [&](const ActiveContact& c) {
    return magnitude(c.gap) <= most &&
           (c.motion != Motion::stick || magnitude(c.slipped()) <= most_slip);
  });
}

// Moves the pose, and a palm that yields, to where the regime holds the object. False if that is not
// near.
inline bool settle(PosedRegime& at) {
  constexpr double noise = 1e-7;  // of the size: shorter steps may be errors of rounding
  const double size = at.problem.shapes.size;
  double before = size;
  int grown = 0;  // steps that were longer than the one before: there is no such place
  for (int i = 0; i < 40 && grown < 2; ++i) {
    const RegimeEquations made(at, false);
    if (!made.system.full()) return false;
    const auto step = made.system.solution();
    const double most = RegimeEquations::System::largest(step);
    if (!(most < size)) return false;
    if (!(most < before) && most > noise * size) ++grown;
    before = most;
    for (const std::size_t side : {left, right})
      if (at.regime.drives[side] == Drive::yields) at.frames[side].origin.x -= step[3];
    at.put(at.after({step[0], step[1], step[2]}, -1.0));
    // Convergence is quadratic: after so small a step, the remaining error is far below rounding.
    if (most < 1e-10 * size) return holds(at);
  }
  return false;
}

}  // namespace palmbots
