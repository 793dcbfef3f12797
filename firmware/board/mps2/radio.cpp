// SPDX-License-Identifier: Apache-2.0
// Packets pass through the line; the world has the radio.
#include <cstdint>

#include "../board.hpp"
#include "line.hpp"

namespace palmbots::board {

namespace {

constexpr std::size_t room = 16;
RadioPacket buffers[room];
std::size_t first, waiting;
std::uint32_t lost;

}  // namespace

namespace line {

void take_packet(std::span<const std::uint8_t> bytes) {
  if (waiting == room || bytes.size() > RadioPacket::most_bytes) {
    ++lost;
    return;
  }
  RadioPacket& packet = buffers[(first + waiting++) % room];
  packet.size = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) packet.bytes[i] = bytes[i];
}

}  // namespace line

void start_radio(std::uint8_t, std::int8_t) {}

bool take_packet(RadioPacket& packet) {
  if (waiting == 0) return false;
  packet = buffers[first];
  first = (first + 1) % room;
  --waiting;
  return true;
}

bool send(const RadioPacket& packet) {
  line::write(line::Kind::packet, {packet.bytes.data(), packet.size});
  return true;
}

bool is_sending() { return false; }
void serve_radio() { line::serve(); }
std::uint32_t lost_packets() { return lost; }
std::uint32_t damaged_packets() { return 0; }

}  // namespace palmbots::board
