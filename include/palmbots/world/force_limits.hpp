// SPDX-License-Identifier: Apache-2.0
// Robots whose force along the floor is limited: which forces the contacts of a regime may have.
//
// A robot drives at its commanded speed while |H| ≤ F; otherwise it stalls. All forces that balance the
// weight are convex combinations of those on three rays of the contacts. So a regime is possible iff
// one of these combinations is within both limits, and a robot stalls only if the push of the pair can
// reach a limit.
//
// Source: docs/theory/contacts.md, Robots with limits.
#pragma once

#include "palmbots/world/contact_regime.hpp"

namespace palmbots {

// The forces of both robots on the object, towards +x [weights].
using RobotForces = PerSide<double>;

// The forces of the contacts of a regime: all are convex combinations of these.
class BalancedForces {
 public:
  BalancedForces(const PosedRegime& at, double slack) : limit_(at.problem.limit) {
    const Rays rays = at.rays();
    FixedList<std::size_t, Rays::capacity> carriers;  // of the rays
    for (const ActiveContact& c : at.contacts)
      each_edge(c.motion, c.friction, [&](double) { carriers.push_back(c.pair.carrier); });
    for_each_combination(rays, at.weight(), [&](const RayShares& shares) {
      if (forces_.full() || shares.least() < -slack) return;
      RobotForces force{};
      for (std::size_t k = 0; k < shares.count; ++k) {
        const std::size_t ray = shares.ray[k];
        if (carriers[ray] <= right) force[carriers[ray]] += shares.share[k] * rays[ray].x;
      }
      forces_.push_back(force);
    });
  }

  // By how much the least forces exceed the limits; ≤ 0: robots can exert them [weights].
  double least_excess() const {
    if (forces_.empty()) return 0.0;  // no forces balance at all: another condition
    double least = excess(forces_[0]);
    for (const RobotForces& force : forces_) least = smaller(least, excess(force));
    if (least <= 0.0) return least;
    for (const RobotForces& a : forces_)
      for (const RobotForces* b = forces_.begin(); b != &a; ++b)
        least = smaller(least, least_between(a, *b));
    if (least > 0.0 && contain_none()) return -smaller(limit_[left], limit_[right]);
    return least;
  }

  // By how much the push of a robot towards its `sense` along x, or the partner's push against it, can
  // exceed a limit.
  double most_push(std::size_t side, double sense) const {
    double most = forces_.empty() ? 0.0 : -1.0;
    for (const RobotForces& force : forces_) {
      most = larger(most, larger(sense * force[side] - limit_[side],
                                 -sense * force[other(side)] - limit_[other(side)]));
    }
    return most;
  }

 private:
  double excess(const RobotForces& h) const {
    return larger(magnitude(h[left]) - limit_[left], magnitude(h[right]) - limit_[right]);
  }

  // The least excess of the combinations of two: the largest of four linear functions, whose least
  // value is at an end or where two of them are equal.
  double least_between(const RobotForces& a, const RobotForces& b) const {
    double least = smaller(excess(a), excess(b));
    const auto line = [&](std::size_t k) {
      const std::size_t side = k / 2;
      const double sign = k % 2 == 0 ? 1.0 : -1.0;
      return std::array<double, 2>{sign * a[side] - limit_[side], sign * (b[side] - a[side])};
    };
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t l = 0; l < k; ++l) {
        const auto p = line(k);
        const auto q = line(l);
        const double share = (q[0] - p[0]) / (p[1] - q[1]);
        if (!(share > 0.0 && share < 1.0)) continue;
        const auto mix = [&](std::size_t side) { return a[side] + share * (b[side] - a[side]); };
        least = smaller(least, excess({mix(left), mix(right)}));
      }
    }
    return least;
  }

  // Whether no force at all is a combination. If it is not, all are on one side of a line through 0.
  bool contain_none() const {
    return std::ranges::none_of(forces_, [&](const RobotForces& a) {
      return std::ranges::all_of(forces_, [&](const RobotForces& b) {
        const Vec p{a[left], a[right]};
        const Vec q{b[left], b[right]};
        return cross(p, q) > 0.0 || (cross(p, q) == 0.0 && dot(p, q) > 0.0);
      });
    });
  }

  PerSide<double> limit_;
  FixedList<RobotForces, 128> forces_;
};

}  // namespace palmbots
