// SPDX-License-Identifier: Apache-2.0
// Corruption on the way. The simulated radio passes messages on without encoding them; only one that is
// damaged becomes a packet (wire/packet.hpp).
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/base/philox.hpp"
#include "palmbots/control/centralized.hpp"
#include "palmbots/control/mailbox.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots::wire {

// Everything in a packet except its kind and payload: sender, receiver and stamps.
struct PacketHeader {
  Role sender;
  Role receiver;
  std::uint16_t pair;
  SequenceNumber sent;
  SequenceNumber heard;
};

// A packet with this header, kind and payload.
constexpr Packet packet_with(const PacketHeader& e, PacketKind kind, const Payload& payload) {
  return {kind, e.sender, e.receiver, e.pair, e.sent, e.heard, payload};
}

// A message of Table 2, as a robot sends it during a carry.
constexpr Packet packet_of(MessageKind message, const PacketHeader& e) {
  return packet_with(e, PacketKind::state,
                     payload_of(State{Language::messages, message, RobotMode::carrying}));
}

constexpr Packet packet_of(const Centralized::Report& report, const PacketHeader& e) {
  return packet_with(e, PacketKind::report, payload_of(report));
}

constexpr Packet packet_of(const Command& command, const PacketHeader& e) {
  return packet_with(e, PacketKind::command, payload_of(command));
}

// A beacon, as a robot sends it during a carry. It has its own stamps, which replace those of the
// header.
constexpr Packet packet_of(const Beacon& beacon, const PacketHeader& e) {
  const Language language = language_of(beacon.message);
  Packet packet = packet_with(e, kind_of(language),
                              payload_of(State{language, beacon.message, RobotMode::carrying,
                                               beacon.ready, beacon.stopped}));
  packet.sent = {beacon.sent.epoch, beacon.sent.tick};
  packet.heard = {beacon.heard.epoch, beacon.heard.tick};
  return packet;
}

}  // namespace palmbots::wire

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
