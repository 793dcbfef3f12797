// SPDX-License-Identifier: Apache-2.0
// What frames on a serial line are, written a second time from docs/reference/wire.md: whole pieces
// between zeros instead of byte by byte, and the CRC as a division of polynomials.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palmbots::wire::frame_laws {

using Bytes = std::vector<std::uint8_t>;

// The remainder of the message, preceded by ones and followed by 16 zero bits, as polynomials.
inline std::uint32_t remainder_of(const Bytes& message) {
  std::vector<bool> bits;
  for (const std::uint8_t byte : message) {
    for (int bit = 7; bit >= 0; --bit) bits.push_back((byte >> bit & 1) != 0);
  }
  for (int bit = 0; bit < 16; ++bit) bits.push_back(false);
  // The initial value FFFF inverts the first 16 bits.
  for (std::size_t i = 0; i < 16; ++i) bits[i] = !bits[i];
  for (std::size_t i = 0; i + 16 < bits.size(); ++i) {
    if (!bits[i]) continue;
    for (const std::size_t power : {0U, 4U, 11U, 16U}) bits[i + power] = !bits[i + power];
  }
  std::uint32_t remainder = 0;
  for (std::size_t i = bits.size() - 16; i < bits.size(); ++i) {
    remainder = remainder << 1 | (bits[i] ? 1U : 0U);
  }
  return remainder;
}

// The stuffed bytes between two zeros, back to plain: groups that begin with their length.
inline std::optional<Bytes> unstuffed(const Bytes& piece) {
  Bytes plain;
  for (std::size_t at = 0; at < piece.size();) {
    const std::size_t length = piece[at];
    if (at + length > piece.size()) return std::nullopt;
    const auto group = piece.begin() + static_cast<std::ptrdiff_t>(at);
    plain.insert(plain.end(), group + 1, group + static_cast<std::ptrdiff_t>(length));
    at += length;
    if (at < piece.size()) plain.push_back(0);
  }
  return plain;
}

struct Found {
  std::vector<Bytes> frames;  // kind and content
  std::size_t damaged = 0;
};

// All frames in a stream.
inline Found frames_in(std::span<const std::uint8_t> stream) {
  Found found;
  Bytes piece;
  for (const std::uint8_t byte : stream) {
    if (byte != 0) {
      piece.push_back(byte);
      continue;
    }
    if (!piece.empty()) {
      auto plain = piece.size() <= 68 ? unstuffed(piece) : std::nullopt;
      bool good = false;
      if (plain && plain->size() >= 3) {
        const std::size_t size = plain->size();
        const unsigned crc = (*plain)[size - 2] + 256U * (*plain)[size - 1];
        plain->resize(size - 2);
        good = remainder_of(*plain) == crc;
      }
      if (good) {
        found.frames.push_back(*plain);
      } else {
        ++found.damaged;
      }
    }
    piece.clear();
  }
  return found;
}

}  // namespace palmbots::wire::frame_laws
