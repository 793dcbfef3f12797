// SPDX-License-Identifier: Apache-2.0
// Intervals of numbers.
#pragma once

#include "palmbots/base/scalar.hpp"

namespace palmbots {

// Empty iff low > high.
template <class Real>
struct Interval {
  Real low;
  Real high;

  constexpr bool empty() const { return !(low <= high); }
};

// The numbers that lie in both intervals.
template <class Real>
constexpr Interval<Real> intersect(Interval<Real> p, Interval<Real> q) {
  return {larger(p.low, q.low), smaller(p.high, q.high)};
}

}  // namespace palmbots
