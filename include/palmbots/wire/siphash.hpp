// SPDX-License-Identifier: Apache-2.0
// SipHash-2-4: a keyed 64-bit tag for short inputs (Aumasson and Bernstein, "SipHash: a fast
// short-input PRF", INDOCRYPT 2012).
//
// It is designed for short inputs and small machines. It uses additions, rotations and exclusive
// ors of 64-bit words. There are no tables, and no branch or address depends on the key or the
// input. Bytes are read one by one, the least significant first, so the result does not depend on
// the machine's byte order.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palmbots {

// The four words of state. The initial constants spell "somepseudorandomlygeneratedbytes".
struct SipState {
  std::uint64_t v0, v1, v2, v3;

  // "SipRound" (section 2.2), n times.
  constexpr void rounds(int n) {
    for (; n > 0; --n) {
      v0 += v1;
      v2 += v3;
      v1 = std::rotl(v1, 13) ^ v0;
      v3 = std::rotl(v3, 16) ^ v2;
      v0 = std::rotl(v0, 32) + v3;
      v2 += v1;
      v1 = std::rotl(v1, 17) ^ v2;
      v3 = std::rotl(v3, 21) ^ v0;
      v2 = std::rotl(v2, 32);
    }
  }

  constexpr void absorb(std::uint64_t word) {
    v3 ^= word;
    rounds(2);
    v0 ^= word;
  }
};

// Up to eight bytes as a number, the least significant byte first.
constexpr std::uint64_t little_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t word = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) word = word << 8 | bytes[i - 1];
  return word;
}

// The tag of an input under a 128-bit key.
constexpr std::uint64_t siphash24(const std::array<std::uint8_t, 16>& key,
                                  std::span<const std::uint8_t> text) {
  const std::span<const std::uint8_t> halves = key;
  const std::uint64_t k0 = little_endian(halves.first(8));
  const std::uint64_t k1 = little_endian(halves.last(8));
  SipState state{k0 ^ 0x736f6d6570736575, k1 ^ 0x646f72616e646f6d, k0 ^ 0x6c7967656e657261,
                 k1 ^ 0x7465646279746573};
  const std::size_t size = text.size();
  for (; text.size() >= 8; text = text.subspan(8)) state.absorb(little_endian(text.first(8)));
  // The last word: the remaining bytes, zeros, and the length modulo 256 in the highest byte.
  state.absorb(little_endian(text) | std::uint64_t{size} << 56);
  state.v2 ^= 0xff;
  state.rounds(4);
  return state.v0 ^ state.v1 ^ state.v2 ^ state.v3;
}

}  // namespace palmbots
