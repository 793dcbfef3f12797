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

// The root of f between `good` (f = f_good ≥ 0) and `bad` (f = f_bad < 0): a secant, then inverse
// quadratic interpolation through the last three points. Each estimate is moved a little away from the
// nearer end, so that the bracket closes from both sides. Superlinear on the smooth functions it is used
// for; a bracket that three looks have not halved is bisected.
template <class Real, class Function>
Real root(Real good, Real f_good, Real bad, Real f_bad, Function f) {
  constexpr Real tolerance = Real(4096) * std::numeric_limits<Real>::epsilon();
  Real last = bad;  // the end that was replaced last
  Real f_last = f_bad;
  Real halved = bad - good;
  int looks = 0;  // since then
  for (int i = 0; i < 200 && bad - good > tolerance && f_good > Real(0); ++i) {
    const Real d = f_good - f_bad;
    const Real e = f_good - f_last;
    Real t = good - f_good * (f_last * e * (bad - good) - f_bad * d * (last - good)) /
                        (d * e * (f_bad - f_last));
    if (!(t > good && t < bad)) t = good + (bad - good) * (f_good / d);
    t += Real(t - good < bad - t ? 0.25 : -0.25) * tolerance;
    if (looks == 3 || !(t > good && t < bad)) t = Real(0.5) * (good + bad);
    const Real value = f(t);
    if (value >= Real(0)) {
      last = good;
      f_last = f_good;
      good = t;
      f_good = value;
    } else {
      last = bad;
      f_last = f_bad;
      bad = t;
      f_bad = value;
    }
    ++looks;
    if (bad - good <= Real(0.5) * halved) {
      halved = bad - good;
      looks = 0;
    }
  }
  return good;
}

}  // namespace palmbots
