// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10: a counter-based random number generator (Salmon, Moraes, Dror and Shaw, "Parallel
// random numbers: as easy as 1, 2, 3", SC 2011).
//
// A draw is a pure function of (seed, tick, stream, carry), so there is no generator state to keep.
// Any carry and any tick can be drawn in any order, on any number of threads, with the same result.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace palmbots {

// Four random words: the block that the generator maps at once, as counter and as result.
using Words = std::array<std::uint32_t, 4>;

// The generator: ten rounds on the counter under a 64-bit key.
constexpr Words philox(Words counter, std::uint64_t key) {
  auto k0 = static_cast<std::uint32_t>(key);
  auto k1 = static_cast<std::uint32_t>(key >> 32);
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ k0, static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ k1,
               static_cast<std::uint32_t>(a)};
    k0 += 0x9E3779B9;
    k1 += 0xBB67AE85;
  }
  return counter;
}

// The random words of one tick. `stream` separates purposes, `lane` separates equal uses of one
// stream (which robot, which link).
constexpr Words draw(std::uint64_t seed, std::uint32_t tick, std::uint32_t stream,
                     std::uint32_t lane = 0) {
  return philox({tick, stream, lane, 0}, seed);
}

namespace detail {

// 64-bit numbers side by side (as in base/simd_lanes.hpp). A draw uses the lower half of each.
#if defined(__AVX512F__)
inline constexpr std::size_t draws_at_once = 8;
#elif defined(__AVX2__)
inline constexpr std::size_t draws_at_once = 4;
#else
inline constexpr std::size_t draws_at_once = 2;
#endif
typedef std::uint64_t Halves __attribute__((vector_size(8 * draws_at_once)));

// The products of the lower halves with `by`.
inline Halves times(Halves x, std::uint32_t by) {
#if defined(__AVX512F__)
  return (Halves)_mm512_maskz_mul_epu32(0xFF, (__m512i)x, _mm512_set1_epi64(by));
#elif defined(__AVX2__)
  return (Halves)_mm256_mul_epu32((__m256i)x, _mm256_set1_epi64x(by));
#elif defined(__SSE2__)
  return (Halves)_mm_mul_epu32((__m128i)x, _mm_set1_epi64x(by));
#else
  return (x & 0xFFFFFFFF) * by;
#endif
}

// The counters of several draws, and later their words. The upper halves of the words are
// meaningless.
using Draws = std::array<Halves, 4>;

// The round keys of several draws.
class Keys {
 public:
  explicit Keys(Halves seed) {
    Halves k0 = seed;
    Halves k1 = seed >> 32;
    for (Round& key : rounds_) {
      key = {k0, k1};
      k0 += 0x9E3779B9;
      k1 += 0xBB67AE85;
    }
  }

  // Applies one round of philox() to several counters.
  [[gnu::always_inline]] void stir(std::size_t round, Draws& counter) const {
    const Halves a = times(counter[0], 0xD2511F53);
    const Halves b = times(counter[2], 0xCD9E8D57);
    const auto& [k0, k1] = rounds_[round];
    counter = {(b >> 32) ^ counter[1] ^ k0, b, (a >> 32) ^ counter[3] ^ k1, a};
  }

 private:
  using Round = std::array<Halves, 2>;
  std::array<Round, 10> rounds_;
};

// philox() for m groups of counters. The groups are independent, so their rounds overlap in the
// pipeline. Group i uses keys[i % parts].
template <std::size_t m, std::size_t parts>
[[gnu::always_inline]] inline std::array<Draws, m> philox(std::array<Draws, m> counters,
                                                          const std::array<Keys, parts>& keys) {
  // Unrolled, so that no word is moved from one register to another.
  [&]<std::size_t... round>(std::index_sequence<round...>) {
    const auto stir = [&](std::size_t r) {
      for (std::size_t i = 0; i < m; ++i) keys[i % parts].stir(r, counters[i]);
    };
    (stir(round), ...);
  }(std::make_index_sequence<10>());
  return counters;
}

}  // namespace detail

// The words of n ticks that are `apart` ticks from each other: draw(seed, tick + apart i, stream)
// for i < n, word by word. The draws are independent and run side by side.
template <std::size_t n>
using WordRows = std::array<std::array<std::uint32_t, n>, 4>;

template <std::size_t n>
inline WordRows<n> draw_row(std::uint64_t seed, std::uint32_t tick, std::uint32_t stream,
                            std::uint32_t apart = 1) {
  using detail::Halves;
  constexpr std::size_t width = detail::draws_at_once;
  static_assert(n % width == 0);
  WordRows<n> rows;
  const std::array<detail::Keys, 1> keys{detail::Keys(Halves{} + seed)};
  for (std::size_t first = 0; first < n; first += width) {
    std::array<std::uint64_t, width> ticks;
    for (std::size_t i = 0; i < width; ++i) {
      ticks[i] = tick + apart * static_cast<std::uint32_t>(first + i);
    }
    const auto [words] =
        detail::philox<1, 1>({{{std::bit_cast<Halves>(ticks), Halves{} + stream}}}, keys);
    for (std::size_t word = 0; word < 4; ++word) {
      for (std::size_t i = 0; i < width; ++i) {
        rows[word][first + i] = static_cast<std::uint32_t>(words[word][i]);
      }
    }
  }
  return rows;
}

// Uniform in [0, 1), exact in float too (24 bits).
template <class Real>
constexpr Real unit_uniform(std::uint32_t word) {
  return Real(word >> 8) * Real(1.0 / 16777216.0);
}

// Scale of unit_noise: the sum of two uniforms on {0 … 65535} has mean 65535 and variance 2 (65536²
// − 1) / 12.
template <class Real>
inline constexpr Real unit_noise_scale = Real(3.737624730023707e-05);

// Random number with mean 0 and variance 1, symmetric to the last bit, |x| < 2.45: the sum of two
// 16-bit uniforms. It drives an Ornstein–Uhlenbeck filter, which hides the shape of the
// distribution.
template <class Real>
constexpr Real unit_noise(std::uint32_t word) {
  const auto sum = static_cast<std::int32_t>((word & 0xFFFF) + (word >> 16));
  return Real(sum - 65535) * unit_noise_scale<Real>;
}

}  // namespace palmbots
