// SPDX-License-Identifier: Apache-2.0
// The few functions of a real number that the core needs, built from + − × ÷ √ only.
//
// The sine of <cmath> differs from one system to the next in the last bit, and one bit is enough to
// change which contact slides. IEEE 754 fixes + − × ÷ √, so these functions give the same bits
// everywhere (build with -ffp-contract=off). Their accuracy is about 1 ulp for |x| ≤ 2π.
//
// Real is double or float throughout the core.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace palmbots {

template <class Real>
inline constexpr Real pi = Real(3.14159265358979323846264338327950288);

// Converts degrees to radians by multiplication.
template <class Real>
inline constexpr Real radians_per_degree = pi<Real> / Real(180);

// The scalar type of V: V itself, or that of each lane (base/simd_lanes.hpp).
template <class V>
struct ScalarOf {
  using type = V;
};

// The scalar versions of the mask operations that base/simd_lanes.hpp defines for lanes.
template <class V>
using MaskOf = decltype(V{} < V{});

constexpr bool any(bool mask) { return mask; }
constexpr bool all(bool mask) { return mask; }

template <class V>
constexpr V select(bool mask, V yes, V no) {
  return mask ? yes : no;
}

inline double square_root(double x) { return std::sqrt(x); }
inline float square_root(float x) { return std::sqrt(x); }

// Sine and cosine of one angle.
template <class Real>
struct SinCos {
  Real sin;
  Real cos;
};

namespace detail {

// c[0] + c[1] y + … by Estrin's scheme. Its chain of dependent operations is a third as long as
// Horner's.
template <class V, class Real, std::size_t n>
constexpr V polynomial(V y, const std::array<Real, n>& c) {
  static_assert(n == 4 || n == 5 || n == 8);
  const V y2 = y * y;
  const V low = (V(c[0]) + V(c[1]) * y) + (V(c[2]) + V(c[3]) * y) * y2;
  if constexpr (n == 4) return low;
  if constexpr (n == 5) return low + V(c[4]) * (y2 * y2);
  const V high = (V(c[4]) + V(c[5]) * y) + (V(c[6]) + V(c[7]) * y) * y2;
  return low + high * (y2 * y2);
}

// The Taylor coefficients −1/first!, +1/(first + 2)!, −1/(first + 4)!, …
template <class Real, std::size_t n>
constexpr std::array<Real, n> taylor(int first) {
  std::array<Real, n> c{};
  double factorial = 1;
  for (int k = 2; k <= first; ++k) factorial *= k;
  for (std::size_t i = 0; i < n; ++i) {
    c[i] = Real(i % 2 == 0 ? -1 : 1) / Real(factorial);
    factorial *= (first + 1) * (first + 2);
    first += 2;
  }
  return c;
}

// Taylor series of sine and cosine for |x| ≤ π/4. The first omitted term is below 1e-18 in double
// and below 2e-9 in float.
template <class V>
constexpr V sin_kernel(V x) {
  using Real = typename ScalarOf<V>::type;
  constexpr auto c = taylor<Real, sizeof(Real) == 8 ? 8 : 4>(3);
  const V y = x * x;
  return x + (x * y) * polynomial(y, c);
}

template <class V>
constexpr V cos_kernel(V x) {
  using Real = typename ScalarOf<V>::type;
  constexpr auto c = taylor<Real, sizeof(Real) == 8 ? 8 : 5>(2);
  const V y = x * x;
  return V(1) + y * polynomial(y, c);
}

}  // namespace detail

// Sine and cosine of x [rad], |x| ≤ 2π. They are odd and even to the last bit, so that a mirrored
// problem has a mirrored solution.
template <class Real>
constexpr SinCos<Real> sin_cos(Real x) {
  if (x <= pi<Real> / Real(4) && x >= -(pi<Real> / Real(4))) {
    return {detail::sin_kernel(x), detail::cos_kernel(x)};
  }
  // π/2 as a sum of two parts. The first has trailing zero bits, so that k times it is exact.
  constexpr Real half_pi_high =
      sizeof(Real) == 8 ? Real(1.57079632673412561417e+00) : Real(1.5703125);
  constexpr Real half_pi_low =
      sizeof(Real) == 8 ? Real(6.07710050650619224932e-11) : Real(4.83826794896619231e-4);
  const Real magnitude = x < Real(0) ? -x : x;
  const auto k = static_cast<std::int32_t>(magnitude * (Real(2) / pi<Real>)+Real(0.5));
  const Real r = (magnitude - Real(k) * half_pi_high) - Real(k) * half_pi_low;
  const Real s = detail::sin_kernel(r);
  const Real c = detail::cos_kernel(r);
  Real sine = s;
  Real cosine = c;
  switch (k & 3) {
    case 1:
      sine = c;
      cosine = -s;
      break;
    case 2:
      sine = -s;
      cosine = -c;
      break;
    case 3:
      sine = -c;
      cosine = s;
      break;
    default: break;
  }
  return {x < Real(0) ? -sine : sine, cosine};
}

// The angle with this sine and cosine [rad], in (−π, π]. Odd in the sine to the last bit. Newton's
// method from a coarse polynomial: each step triples the number of digits.
template <class Real>
constexpr Real angle_of(Real sine, Real cosine) {
  const Real up = sine < Real(0) ? -sine : sine;
  const Real along = cosine < Real(0) ? -cosine : cosine;
  const bool steep = up > along;
  const Real t = steep ? along / up : up / along;
  Real angle = t * (Real(1.0584) - Real(0.273) * t);
  for (int i = 0; i < 4; ++i) {
    const SinCos<Real> at = sin_cos(angle);
    const Real s = steep ? along : up;
    const Real c = steep ? up : along;
    angle = angle + (s * at.cos - c * at.sin) / (s * at.sin + c * at.cos);
  }
  if (steep) angle = Real(0.5) * pi<Real> - angle;
  if (cosine < Real(0)) angle = pi<Real> - angle;
  return sine < Real(0) ? -angle : angle;
}

// Tangent of x [rad], |x| < π/2.
template <class Real>
constexpr Real tangent(Real x) {
  const SinCos<Real> at = sin_cos(x);
  return at.sin / at.cos;
}

// e^−x for x ≥ 0. Halves the argument until the series converges fast, then squares the result as
// often.
template <class Real>
constexpr Real exp_minus(Real x) {
  if (x > Real(80)) return Real(0);
  int halvings = 0;
  while (x > Real(0.125)) {
    x = x * Real(0.5);
    ++halvings;
  }
  Real term = Real(1);
  Real sum = Real(1);
  for (int n = 1; n <= 12; ++n) {
    term = term * -x / Real(n);
    sum = sum + term;
  }
  for (; halvings > 0; --halvings) sum = sum * sum;
  return sum;
}

// The larger and the smaller of two numbers; y where they are equal.
template <class Real>
  requires std::is_arithmetic_v<Real>
constexpr Real larger(Real x, Real y) {
  return x > y ? x : y;
}
template <class Real>
  requires std::is_arithmetic_v<Real>
constexpr Real smaller(Real x, Real y) {
  return x < y ? x : y;
}

// The absolute value |x|.
constexpr double magnitude(double x) { return __builtin_fabs(x); }
constexpr float magnitude(float x) { return __builtin_fabsf(x); }

// True where |x| ≤ most.
template <class V>
constexpr MaskOf<V> within(V x, V most) {
  return magnitude(x) <= most;
}

// x limited to [low, high].
template <class V>
constexpr V clamp(V x, V low, V high) {
  return smaller(high, larger(low, x));
}

}  // namespace palmbots
