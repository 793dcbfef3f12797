// SPDX-License-Identifier: Apache-2.0
// Robots whose force along the floor is limited: which forces the contacts of a regime may have.
//
// H is the force of a robot on the object along the floor, towards +x [weights]. A robot drives at
// its commanded speed while |H| ≤ F. Otherwise it stalls: its speed is between 0 and the command. The
// forces that balance the weight are the convex combinations of a few: by Carathéodory's theorem,
// those on three rays of the contacts. So a regime is possible iff one of these combinations is within
// both limits, and a robot stalls only if the push of the pair can reach a limit.
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
  BalancedForces(const ContactProblem& problem, const Regime& regime,
                 const ActiveContacts& contacts, double slack)
      : limit_(problem.limit) {
    const Rays rays = rays_of(problem, regime, contacts);
    const Triple weight = problem.weight(regime.pushed);
    std::array<std::size_t, 2 * max_supports> carrier{};
    std::size_t ray = 0;
    for (std::size_t i = 0; i < regime.count; ++i) {
      const std::size_t n = regime.active[i].motion == Motion::stick ? 2 : 1;
      for (std::size_t k = 0; k < n; ++k) carrier[ray++] = problem.carrier(regime.active[i].pair);
    }
    for_each_combination(rays, weight, [&](const RayShares& shares) {
      if (count_ == capacity || shares.least() < -slack) return;
      RobotForces force{};
      for (std::size_t k = 0; k < shares.count; ++k) {
        const std::size_t at = shares.ray[k];
        if (carrier[at] < 2) force[carrier[at]] += shares.share[k] * rays.ray[at].x;
      }
      at_[count_++] = force;
    });
  }

  // By how much the least forces exceed the limits; ≤ 0: robots can exert them [weights].
  double least_excess() const {
    if (count_ == 0) return 0.0;  // no forces balance at all: another condition
    double least = excess(at_[0]);
    for (std::size_t i = 1; i < count_; ++i) least = smaller(least, excess(at_[i]));
    if (least <= 0.0) return least;
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t j = 0; j < i; ++j) least = smaller(least, least_between(at_[i], at_[j]));
    if (least > 0.0 && contain_none()) return -smaller(limit_[left], limit_[right]);
    return least;
  }

  // By how much the push of a robot towards its `sense` along x, or the partner's push against it, can
  // exceed a limit.
  double most_push(std::size_t side, double sense) const {
    double most = count_ == 0 ? 0.0 : -1.0;
    for (std::size_t i = 0; i < count_; ++i) {
      most = larger(most, larger(sense * at_[i][side] - limit_[side],
                                 -sense * at_[i][other(side)] - limit_[other(side)]));
    }
    return most;
  }

 private:
  static constexpr std::size_t capacity = 128;

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
    for (std::size_t i = 0; i < count_; ++i) {
      bool is_extreme = true;
      for (std::size_t j = 0; j < count_ && is_extreme; ++j) {
        const Vec p{at_[i][left], at_[i][right]};
        const Vec q{at_[j][left], at_[j][right]};
        is_extreme = cross(p, q) > 0.0 || (cross(p, q) == 0.0 && dot(p, q) > 0.0);
      }
      if (is_extreme) return false;
    }
    return true;
  }

  PerSide<double> limit_;
  std::array<RobotForces, capacity> at_;  // up to `count_`
  std::size_t count_ = 0;
};

}  // namespace palmbots
