// SPDX-License-Identifier: Apache-2.0
// Converts what controllers say to packets (wire/packet.hpp) and back.
//
// The stamp of a beacon is boot epoch and control tick. The tick is the packet's sequence number: it
// only rises, and an echo of it gives an age without a record of when it was sent
// (control/beacon.hpp). The messages of a controller that shares signs are stamped in the same way.
#pragma once

#include <cstdint>

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/centralized.hpp"
#include "palmbots/control/messages.hpp"
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

// The language of a beacon with this message.
constexpr Language language_of(MessageKind message) {
  return is_sign(message) ? Language::signs : Language::beacons;
}

// A beacon, as a robot sends it during a carry. It has its own stamps, which replace those of the
// header.
constexpr Packet packet_of(const Beacon& beacon, const PacketHeader& e) {
  Packet packet = packet_with(e, PacketKind::state,
                              payload_of(State{language_of(beacon.message), beacon.message,
                                               RobotMode::carrying, beacon.ready, beacon.stopped}));
  packet.sent = {beacon.sent.epoch, beacon.sent.tick};
  packet.heard = {beacon.heard.epoch, beacon.heard.tick};
  return packet;
}

// The beacon in an accepted packet of kind `state`.
constexpr Beacon beacon_in(const Packet& packet) {
  const State state = state_of(packet.payload);
  return {state.message,
          state.at_rest,
          state.ready,
          {packet.sent.epoch, packet.sent.sequence},
          {packet.heard.epoch, packet.heard.sequence}};
}

// Passes the beacon of a received packet to a robot's receiver. Returns true if it counts.
// `language` is that of the robot's controller.
//
// A beacon with the verdict `no_session` counts too. It is the newest and has unknown age
// (`BeaconReceiver::age`), so the partner is treated as silent until it answers. If it were
// ignored, the beacon before it would still count as the newest, although this robot's packets
// acknowledge the new one and the partner therefore regards the old one as forgotten. For the same
// reason robots that run the resilient algorithm send each other only beacons during a carry, and
// robots that share signs only signs.
template <class Receiver>
constexpr bool hear(Receiver& receiver, const Decoded& received,
                    Language language = Language::beacons) {
  const bool counts =
      received.verdict == Verdict::accepted || received.verdict == Verdict::no_session;
  return counts && received.packet.kind == PacketKind::state &&
         state_of(received.packet.payload).language == language &&
         receiver.accept(beacon_in(received.packet));
}

}  // namespace palmbots::wire
