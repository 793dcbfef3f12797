// Philox4x32-10: a counter-based random number generator (Salmon, Moraes, Dror and Shaw,
// "Parallel random numbers: as easy as 1, 2, 3", SC 2011).
//
// A draw is a pure function of (seed, tick, stream, carry): no state to carry along, so any carry
// and any tick can be drawn in any order, on any number of threads, with the same result.
#pragma once

#include <array>
#include <cstdint>

namespace palmbots {

using Words = std::array<std::uint32_t, 4>;

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

// What a draw is for. The number is part of every published trace: append, never renumber.
enum class Stream : std::uint32_t {
  noise = 0,
  tactile = 1,
  bump = 2,
  radio = 3,
  collision = 4,
  fault = 5,
};

// The random words of one tick. `lane` separates equal uses of one stream (which robot, which link).
constexpr Words draw(std::uint64_t seed, std::uint32_t tick, Stream stream,
                     std::uint32_t lane = 0) {
  return philox({tick, static_cast<std::uint32_t>(stream), lane, 0}, seed);
}

// Uniform in [0, 1), exact in float too (24 bits).
template <class Real>
constexpr Real unit_uniform(std::uint32_t word) {
  return Real(word >> 8) * Real(1.0 / 16777216.0);
}

// Mean 0, variance 1, symmetric to the last bit, |x| < 2.45: the sum of two 16-bit uniforms. The
// Ornstein–Uhlenbeck filter it drives hides the shape.
template <class Real>
constexpr Real unit_noise(std::uint32_t word) {
  const auto sum = static_cast<std::int32_t>((word & 0xFFFF) + (word >> 16));
  // Two uniforms on {0 … 65535} have mean 65535 and variance 2 (65536² − 1) / 12.
  return Real(sum - 65535) * Real(3.737624730023707e-05);
}

}  // namespace palmbots
