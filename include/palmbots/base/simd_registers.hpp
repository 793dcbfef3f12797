// SPDX-License-Identifier: Apache-2.0
// SIMD registers: the operations that base/simd_lanes.hpp needs and that the vector extensions of
// GCC and Clang lack or compile to slow code, above all truth values and roots.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace palmbots {

// Size of the largest register of numbers on the target that is compiled for [bytes].
#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

// Registers whose truth values have the width of a lane: all bits of a lane are set, or none.
template <class Real, int n>
struct Register {
  using Int = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  typedef Real Numbers __attribute__((vector_size(n * sizeof(Real))));
  typedef Int Truths __attribute__((vector_size(n * sizeof(Real))));

  static Truths less(Numbers a, Numbers b) { return a < b; }
  static Truths no_more(Numbers a, Numbers b) { return a <= b; }
  static Truths equal(Numbers a, Numbers b) { return a == b; }
  static Truths differ(Numbers a, Numbers b) { return a != b; }
#if defined(__SSE2__)
  // GCC would take truth values of two doubles apart where several are combined: SSE2 has no
  // instruction for the form to which it simplifies them.
  static constexpr bool is_pair = n == 2 && sizeof(Real) == 8;
  static Truths less(Numbers a, Numbers b)
    requires is_pair
  {
    return (Truths)_mm_cmplt_pd(a, b);
  }
  static Truths no_more(Numbers a, Numbers b)
    requires is_pair
  {
    return (Truths)_mm_cmple_pd(a, b);
  }
  static Truths equal(Numbers a, Numbers b)
    requires is_pair
  {
    return (Truths)_mm_cmpeq_pd(a, b);
  }
  static Truths differ(Numbers a, Numbers b)
    requires is_pair
  {
    return (Truths)_mm_cmpneq_pd(a, b);
  }
#endif
  static Numbers blend(Truths truths, Numbers yes, Numbers no) { return truths ? yes : no; }
  static Numbers larger(Numbers a, Numbers b) { return a > b ? a : b; }
  static Numbers smaller(Numbers a, Numbers b) { return a < b ? a : b; }
  static Numbers magnitude(Numbers x) { return (Numbers)((Truths)x & ~(Truths)(-Numbers{})); }

  static void put(Truths& truths, int lane, bool truth) { truths[lane] = truth ? -1 : 0; }

  // Conversion from and to bits: bit l belongs to lane l.
  static Truths of(std::uint32_t bits) {
    return [&]<Int... l>(std::integer_sequence<Int, l...>) {
      const Truths own = {(Int{1} << l)...};
      return (Truths)(((Truths{} + static_cast<Int>(bits)) & own) == own);
    }(std::make_integer_sequence<Int, n>());
  }
  static std::uint32_t bits(Truths truths) {
#if defined(__AVX__)
    if constexpr (n == 4 && sizeof(Real) == 8) {
      return static_cast<std::uint32_t>(_mm256_movemask_pd((__m256d)truths));
    }
    if constexpr (n == 8 && sizeof(Real) == 4) {
      return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)truths));
    }
#elif defined(__SSE2__)
    if constexpr (n == 2 && sizeof(Real) == 8) {
      return static_cast<std::uint32_t>(_mm_movemask_pd((__m128d)truths));
    }
    if constexpr (n == 4 && sizeof(Real) == 4) {
      return static_cast<std::uint32_t>(_mm_movemask_ps((__m128)truths));
    }
#endif
    Int lanes[n];
    std::memcpy(lanes, &truths, sizeof truths);
    std::uint32_t found = 0;
    for (int l = 0; l < n; ++l) found |= (lanes[l] != 0 ? 1U : 0U) << l;
    return found;
  }

  static Numbers root(Numbers x) {
#if defined(__AVX__)
    if constexpr (n == 4 && sizeof(Real) == 8) return (Numbers)_mm256_sqrt_pd((__m256d)x);
    if constexpr (n == 8 && sizeof(Real) == 4) return (Numbers)_mm256_sqrt_ps((__m256)x);
#endif
    for (int l = 0; l < n; ++l) x[l] = std::sqrt(x[l]);
    return x;
  }
};

// Registers of 64 bytes have truth values of their own, with one bit for each lane. The roots are
// written with a mask because GCC 12 warns about uninitialized values in the unmasked version. With
// all mask bits set, GCC emits the unmasked instruction.
#if defined(__AVX512F__) && defined(__AVX512DQ__)
template <class Real, int n>
  requires(n * sizeof(Real) == 64)
struct Register<Real, n> {
  static constexpr bool is_double = sizeof(Real) == 8;
  typedef Real Numbers __attribute__((vector_size(64)));
  using Truths = std::conditional_t<is_double, __mmask8, __mmask16>;

  static Truths less(Numbers a, Numbers b) { return compare<_CMP_LT_OQ>(a, b); }
  static Truths no_more(Numbers a, Numbers b) { return compare<_CMP_LE_OQ>(a, b); }
  static Truths equal(Numbers a, Numbers b) { return compare<_CMP_EQ_OQ>(a, b); }
  static Truths differ(Numbers a, Numbers b) { return compare<_CMP_NEQ_UQ>(a, b); }
  static Numbers blend(Truths truths, Numbers yes, Numbers no) {
    if constexpr (is_double)
      return _mm512_mask_blend_pd(truths, no, yes);
    else
      return _mm512_mask_blend_ps(truths, no, yes);
  }
  static Numbers larger(Numbers a, Numbers b) {
    if constexpr (is_double)
      return _mm512_maskz_max_pd(every, a, b);
    else
      return _mm512_maskz_max_ps(every, a, b);
  }
  static Numbers smaller(Numbers a, Numbers b) {
    if constexpr (is_double)
      return _mm512_maskz_min_pd(every, a, b);
    else
      return _mm512_maskz_min_ps(every, a, b);
  }
  static Numbers magnitude(Numbers x) {
    if constexpr (is_double)
      return _mm512_abs_pd(x);
    else
      return _mm512_abs_ps(x);
  }
  static Numbers root(Numbers x) {
    if constexpr (is_double)
      return _mm512_maskz_sqrt_pd(every, x);
    else
      return _mm512_maskz_sqrt_ps(every, x);
  }

  static void put(Truths& truths, int lane, bool truth) {
    truths = static_cast<Truths>((truths & ~(1U << lane)) | (truth ? 1U : 0U) << lane);
  }
  static Truths of(std::uint32_t bits) { return static_cast<Truths>(bits); }
  static std::uint32_t bits(Truths truths) { return truths; }

 private:
  static constexpr Truths every = static_cast<Truths>(~0U);

  template <int relation>
  static Truths compare(Numbers a, Numbers b) {
    if constexpr (is_double)
      return _mm512_cmp_pd_mask(a, b, relation);
    else
      return _mm512_cmp_ps_mask(a, b, relation);
  }
};
#endif

}  // namespace palmbots
