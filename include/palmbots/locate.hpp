// Finding the instant of an event inside a step.
//
// Both searches keep a bracket [good, bad] of fractions of the step and return its good end, so that
// the state there still obeys the regime that the event ends.
#pragma once

#include <limits>

namespace palmbots {

// The last instant at which `holds(t)` is still true; it is at `good` and is not at `bad`. Bisection
// down to neighbouring numbers.
template <class Real, class Predicate>
Real last_holding(Real good, Real bad, Predicate holds) {
  for (int i = 0; i < 200; ++i) {
    const Real middle = Real(0.5) * (good + bad);
    if (!(middle > good && middle < bad)) break;
    (holds(middle) ? good : bad) = middle;
  }
  return good;
}

// The root of f between `good` (f ≥ 0) and `bad` (f = f_bad < 0), by the Illinois variant of regula
// falsi: superlinear on the smooth functions it is used for, and never leaves the bracket.
template <class Real, class Function>
Real root(Real good, Real bad, Real f_bad, Function f) {
  Real f_good = f(good);
  if (!(f_good > Real(0))) return good;
  constexpr Real tolerance = Real(4096) * std::numeric_limits<Real>::epsilon();
  int kept = 0;  // > 0: the bad end was kept last time, < 0: the good end
  for (int i = 0; i < 100 && bad - good > tolerance; ++i) {
    Real t = good + (bad - good) * (f_good / (f_good - f_bad));
    if (!(t > good && t < bad)) t = Real(0.5) * (good + bad);
    const Real value = f(t);
    if (value >= Real(0)) {
      good = t;
      f_good = value;
      if (value == Real(0)) break;
      if (kept > 0) f_bad *= Real(0.5);
      kept = 1;
    } else {
      bad = t;
      f_bad = value;
      if (kept < 0) f_good *= Real(0.5);
      kept = -1;
    }
  }
  return good;
}

}  // namespace palmbots
