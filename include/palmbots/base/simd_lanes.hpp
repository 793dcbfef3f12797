// SPDX-License-Identifier: Apache-2.0
// SIMD lanes: several numbers side by side that behave as one number in formulas.
//
// A formula written for a number type V serves one carry (V = double or float) or several in
// lanes (V = Lanes<double, 4>, …) with the same bits, because each lane executes the same IEEE
// operations in the same order. A branch is written as
//
//     if (any(mask)) x = select(mask, other, x);
//
// For a single number this is the branch itself. For lanes it skips work that no lane needs. The
// arithmetic uses the vector extensions of GCC and Clang.
#pragma once

#include <cstring>

#include "palmbots/base/scalar.hpp"
#include "palmbots/base/simd_registers.hpp"

namespace palmbots {

// A truth value for each lane.
template <class Real, int n>
struct LaneMask {
  using In = Register<Real, n>;
  using Raw = typename In::Truths;
  Raw raw;

  friend LaneMask operator&(LaneMask a, LaneMask b) { return {Raw(a.raw & b.raw)}; }
  friend LaneMask operator|(LaneMask a, LaneMask b) { return {Raw(a.raw | b.raw)}; }
  friend LaneMask operator^(LaneMask a, LaneMask b) { return {Raw(a.raw ^ b.raw)}; }
  LaneMask operator!() const { return {Raw(~raw)}; }

  void put(int lane, bool truth) { In::put(raw, lane, truth); }

  // Conversion from and to bits: bit l belongs to lane l.
  static LaneMask of(std::uint32_t bits) { return {In::of(bits)}; }
  std::uint32_t bits() const { return In::bits(raw); }
};

// n numbers of type Real, one for each lane.
template <class Real_, int n>
struct Lanes {
  using Real = Real_;
  using In = Register<Real, n>;
  using Mask = LaneMask<Real, n>;
  static constexpr int count = n;
  using Raw = typename In::Numbers;
  Raw raw;

  Lanes() = default;
  static Lanes of(Raw lanes) {
    Lanes found;
    found.raw = lanes;
    return found;
  }
  explicit Lanes(Real everywhere) : raw(everywhere - Raw{}) {}  // − 0 keeps the sign of a zero
  template <class Other>
    requires(std::is_arithmetic_v<Other> && !std::is_same_v<Other, Real>)
  explicit Lanes(Other everywhere) : Lanes(Real(everywhere)) {}

  Lanes operator-() const { return of(-raw); }
  friend Lanes operator+(Lanes a, Lanes b) { return of(a.raw + b.raw); }
  friend Lanes operator-(Lanes a, Lanes b) { return of(a.raw - b.raw); }
  friend Lanes operator*(Lanes a, Lanes b) { return of(a.raw * b.raw); }
  friend Lanes operator/(Lanes a, Lanes b) { return of(a.raw / b.raw); }
  friend Mask operator<(Lanes a, Lanes b) { return {In::less(a.raw, b.raw)}; }
  friend Mask operator>(Lanes a, Lanes b) { return {In::less(b.raw, a.raw)}; }
  friend Mask operator<=(Lanes a, Lanes b) { return {In::no_more(a.raw, b.raw)}; }
  friend Mask operator>=(Lanes a, Lanes b) { return {In::no_more(b.raw, a.raw)}; }
  friend Mask operator==(Lanes a, Lanes b) { return {In::equal(a.raw, b.raw)}; }
  friend Mask operator!=(Lanes a, Lanes b) { return {In::differ(a.raw, b.raw)}; }
};

template <class Real, int n>
struct ScalarOf<Lanes<Real, n>> {
  using type = Real;
};

template <class Real, int n>
Lanes<Real, n> select(LaneMask<Real, n> mask, Lanes<Real, n> yes, Lanes<Real, n> no) {
  return Lanes<Real, n>::of(Register<Real, n>::blend(mask.raw, yes.raw, no.raw));
}

template <class Real, int n>
Lanes<Real, n> larger(Lanes<Real, n> x, Lanes<Real, n> y) {
  return Lanes<Real, n>::of(Register<Real, n>::larger(x.raw, y.raw));
}

template <class Real, int n>
Lanes<Real, n> smaller(Lanes<Real, n> x, Lanes<Real, n> y) {
  return Lanes<Real, n>::of(Register<Real, n>::smaller(x.raw, y.raw));
}

template <class Real, int n>
Lanes<Real, n> magnitude(Lanes<Real, n> x) {
  return Lanes<Real, n>::of(Register<Real, n>::magnitude(x.raw));
}

template <class Real, int n>
bool any(LaneMask<Real, n> mask) {
  return mask.bits() != 0;
}

template <class Real, int n>
bool all(LaneMask<Real, n> mask) {
  return mask.bits() == (1U << n) - 1;
}

template <class Real, int n>
Lanes<Real, n> square_root(Lanes<Real, n> x) {
  return Lanes<Real, n>::of(Register<Real, n>::root(x.raw));
}

template <class Real, int n>
[[gnu::always_inline]] inline SinCos<Lanes<Real, n>> sin_cos(Lanes<Real, n> x) {
  using V = Lanes<Real, n>;
  if (all(within(x, V(pi<Real> / Real(4))))) return {detail::sin_kernel(x), detail::cos_kernel(x)};
  SinCos<V> found{};
  for (int l = 0; l < n; ++l) {
    const SinCos<Real> at = sin_cos(Real(x.raw[l]));
    found.sin.raw[l] = at.sin;
    found.cos.raw[l] = at.cos;
  }
  return found;
}

// take_lane and put_lane copy one lane out of a struct of lanes and back. A struct of numbers with
// a type parameter, S<V> or S<Real>, is laid out as a row of numbers, so its fields need not be
// named.
template <template <class> class S, class Real, int n>
S<Real> take_lane(const S<Lanes<Real, n>>& from, int lane) {
  constexpr std::size_t numbers = sizeof(S<Real>) / sizeof(Real);
  static_assert(sizeof from == numbers * sizeof(Lanes<Real, n>));
  static_assert(std::is_trivially_copyable_v<S<Real>>);
  Real row[numbers];
  const auto* lanes = reinterpret_cast<const unsigned char*>(&from);
  for (std::size_t i = 0; i < numbers; ++i) {
    std::memcpy(&row[i], lanes + (i * n + static_cast<std::size_t>(lane)) * sizeof(Real),
                sizeof(Real));
  }
  S<Real> found;
  std::memcpy(&found, row, sizeof found);
  return found;
}

template <template <class> class S, class Real, int n>
void put_lane(S<Lanes<Real, n>>& to, int lane, const S<Real>& value) {
  constexpr std::size_t numbers = sizeof(S<Real>) / sizeof(Real);
  static_assert(sizeof to == numbers * sizeof(Lanes<Real, n>));
  Real row[numbers];
  std::memcpy(row, &value, sizeof value);
  auto* lanes = reinterpret_cast<unsigned char*>(&to);
  for (std::size_t i = 0; i < numbers; ++i) {
    std::memcpy(lanes + (i * n + static_cast<std::size_t>(lane)) * sizeof(Real), &row[i],
                sizeof(Real));
  }
}

// The number of lanes that fill a register.
template <class Real>
inline constexpr int lanes_of = register_bytes / static_cast<int>(sizeof(Real));

}  // namespace palmbots
