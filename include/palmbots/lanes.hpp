// Several numbers side by side, treated as one: what a formula does, it does in every lane.
//
// A formula written for a number V serves one carry (V = double or float) or several in lockstep
// (V = Lanes<double, 4>, …) with the same bits: each lane sees the same IEEE operations in the same
// order. What would be a branch is written
//
//     if (any(mask)) x = select(mask, other, x);
//
// which for a single number is that branch, and for lanes skips work that none of them needs.
// The arithmetic is the compiler's: vector extensions of GCC and Clang.
#pragma once

#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "palmbots/scalar.hpp"

namespace palmbots {

// One truth value a lane: all bits of the lane are set, or none.
template <class Real, int n>
struct LaneMask {
  using Int = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  typedef Int Raw __attribute__((vector_size(n * sizeof(Real))));
  Raw raw;

  friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.raw & b.raw}; }
  friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.raw | b.raw}; }
  friend LaneMask operator^(LaneMask a, LaneMask b) { return {a.raw ^ b.raw}; }
  LaneMask operator!() const { return {~raw}; }

  // Bit l tells of lane l.
  std::uint32_t bits() const {
#if defined(__AVX__)
    if constexpr (n == 4 && sizeof(Real) == 8) {
      return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_castsi256_pd((__m256i)raw)));
    }
    if constexpr (n == 8 && sizeof(Real) == 4) {
      return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps((__m256i)raw)));
    }
#elif defined(__SSE2__)
    if constexpr (n == 2 && sizeof(Real) == 8) {
      return static_cast<std::uint32_t>(_mm_movemask_pd(_mm_castsi128_pd((__m128i)raw)));
    }
    if constexpr (n == 4 && sizeof(Real) == 4) {
      return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps((__m128i)raw)));
    }
#endif
    Int lanes[n];
    std::memcpy(lanes, &raw, sizeof raw);
    std::uint32_t found = 0;
    for (int l = 0; l < n; ++l) found |= (lanes[l] != 0 ? 1U : 0U) << l;
    return found;
  }
};

template <class Real_, int n>
struct Lanes {
  using Real = Real_;
  using Mask = LaneMask<Real, n>;
  static constexpr int count = n;
  typedef Real Raw __attribute__((vector_size(n * sizeof(Real))));
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
  friend Mask operator<(Lanes a, Lanes b) { return {a.raw < b.raw}; }
  friend Mask operator>(Lanes a, Lanes b) { return {a.raw > b.raw}; }
  friend Mask operator<=(Lanes a, Lanes b) { return {a.raw <= b.raw}; }
  friend Mask operator>=(Lanes a, Lanes b) { return {a.raw >= b.raw}; }
  friend Mask operator==(Lanes a, Lanes b) { return {a.raw == b.raw}; }
  friend Mask operator!=(Lanes a, Lanes b) { return {a.raw != b.raw}; }
};

template <class Real, int n>
struct ScalarOf<Lanes<Real, n>> {
  using type = Real;
};

template <class Real, int n>
Lanes<Real, n> select(LaneMask<Real, n> mask, Lanes<Real, n> yes, Lanes<Real, n> no) {
  return Lanes<Real, n>::of(mask.raw ? yes.raw : no.raw);
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
#if defined(__AVX__)
  if constexpr (n == 4 && sizeof(Real) == 8)
    return Lanes<Real, n>::of((typename Lanes<Real, n>::Raw)_mm256_sqrt_pd((__m256d)x.raw));
  if constexpr (n == 8 && sizeof(Real) == 4)
    return Lanes<Real, n>::of((typename Lanes<Real, n>::Raw)_mm256_sqrt_ps((__m256)x.raw));
#endif
  for (int l = 0; l < n; ++l) x.raw[l] = std::sqrt(x.raw[l]);
  return x;
}

template <class Real, int n>
SinCos<Lanes<Real, n>> sin_cos(Lanes<Real, n> x) {
  using V = Lanes<Real, n>;
  const V quarter(pi<Real> / Real(4));
  if (all((x <= quarter) & (x >= -quarter))) return {detail::sin_kernel(x), detail::cos_kernel(x)};
  SinCos<V> found{};
  for (int l = 0; l < n; ++l) {
    const SinCos<Real> at = sin_cos(Real(x.raw[l]));
    found.sin.raw[l] = at.sin;
    found.cos.raw[l] = at.cos;
  }
  return found;
}

// A struct of numbers with a type parameter, S<V> or S<Real>, is as many numbers in a row: so one
// lane of S<V> can be taken out and put back without naming them.
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

}  // namespace palmbots
