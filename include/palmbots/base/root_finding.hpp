// SPDX-License-Identifier: Apache-2.0
// Root finding: the instant of an event inside a step.
//
// Both searches keep a bracket [good, bad] of fractions of the step and return its good end. The
// state there still obeys the regime that the event ends.
#pragma once

#include <limits>

#include "palmbots/base/scalar.hpp"

namespace palmbots {

// The last instant at which `holds(t)` is still true. It must be true at `good` and false at `bad`.
// Bisects until the two ends are neighbouring floating-point numbers.
template <class Real, class Predicate>
Real bisect_last_true(Real good, Real bad, Predicate holds) {
  for (int i = 0; i < 200; ++i) {
    const Real middle = Real(0.5) * (good + bad);
    if (!(middle > good && middle < bad)) break;
    (holds(middle) ? good : bad) = middle;
  }
  return good;
}

// Tolerance of the instant found for an event, as a fraction of the step. A contact moves less than
// a millimetre in a step.
template <class Real>
inline constexpr Real instant_tolerance = Real(sizeof(Real) == 8 ? 4e-10 : 5e-4);

// The root of f between `good` (f = f_good ≥ 0) and `bad` (f = f_bad < 0), in the lanes that
// `wanted` selects.
//
// The first estimate is a secant, the later ones are inverse quadratic interpolations through the
// last three points. Each estimate is moved a little towards the good end, so that it mostly
// becomes that end. The search ends when the slope since the previous evaluation shows that the
// estimate is within the tolerance. It is superlinear on the smooth functions it is used for; a
// bracket that three evaluations have not halved is bisected.
//
// V is one number or several lanes. A lane stops when its own root is found, and f gets a number
// from `good` to `bad` in every lane.
template <class V, class Function>
V bracketed_root(MaskOf<V> wanted, V good, V f_good, V bad, V f_bad, Function f,
                 V tolerance = V(instant_tolerance<typename ScalarOf<V>::type>)) {
  using Mask = MaskOf<V>;
  V last = bad;  // the end that was replaced last
  V f_last = f_bad;
  V before = bad;  // the previous evaluation
  V f_before = f_bad;
  V halved = bad - good;
  V looks(0);  // evaluations since the bracket was halved
  Mask on = wanted & (bad - good > tolerance) & (f_good > V(0));
  const auto inside = [&](V t) { return (t > good) & (t < bad); };
  const auto secant = [&] { return good + (bad - good) * (f_good / (f_good - f_bad)); };
  const auto look = [&](V t) {
    t = t - V(0.5) * tolerance;
    const Mask bisected = on & ((looks == V(3)) | !inside(t));
    if (any(bisected)) t = select(bisected, V(0.5) * (good + bad), t);
    const V value = f(select(on, t, good));
    const Mask above = value >= V(0);
    const Mask near = value * magnitude(t - before) <= tolerance * magnitude(value - f_before);
    before = t;
    f_before = value;
    last = select(on, select(above, good, bad), last);
    f_last = select(on, select(above, f_good, f_bad), f_last);
    good = select(on & above, t, good);
    f_good = select(on & above, value, f_good);
    bad = select(on & !above, t, bad);
    f_bad = select(on & !above, value, f_bad);
    const Mask is_halved = bad - good <= V(0.5) * halved;
    halved = select(is_halved, bad - good, halved);
    looks = select(is_halved, V(0), looks + V(1));
    on = on & (bad - good > tolerance) & !(above & near);
  };
  if (any(on)) look(secant());
  for (int i = 1; i < 200 && any(on); ++i) {
    const V d = f_good - f_bad;
    const V e = f_good - f_last;
    V t = good - f_good * (f_last * e * (bad - good) - f_bad * d * (last - good)) /
                     (d * e * (f_bad - f_last));
    if (!all(inside(t) | !on)) t = select(inside(t), t, secant());
    look(t);
  }
  return good;
}

}  // namespace palmbots
