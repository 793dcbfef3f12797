// SPDX-License-Identifier: Apache-2.0
// Corruption of packets on the way (wire/packet.hpp).
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/base/philox.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots {

// The receiver's verdict on a packet in which up to eight consecutive bytes are random. The first
// of them is certainly wrong. Place, length and noise are taken from three words.
constexpr wire::Verdict damaged(const wire::Packet& packet, const Words& words) {
  constexpr wire::Key key{};  // any key: a damaged packet fails under each
  wire::Bytes bytes{};
  if (!wire::encode(packet, key, bytes)) return wire::Verdict::malformed;
  const std::uint64_t noise = std::uint64_t{words[3]} << 32 | words[2] | 1;
  const std::size_t first = words[1] % wire::packet_size;
  const std::size_t size = 1 + (words[1] >> 16) % 8;
  for (std::size_t i = 0; i < size && first + i < wire::packet_size; ++i) {
    bytes[first + i] ^= static_cast<std::uint8_t>(noise >> 8 * i);
  }
  return wire::decode(bytes, key, packet.pair, packet.receiver).verdict;
}

}  // namespace palmbots
