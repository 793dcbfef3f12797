// SPDX-License-Identifier: Apache-2.0
// Converts messages of the controllers to packets (wire/packet.hpp) and back.
//
// A message of the resilient algorithm is encoded as one letter: I idle (TiltDown), R request
// (TiltUp), G grant (Ack), D in case (d) (Closing), W palm up but not granted (Raised). Its stamp
// is boot epoch and control tick. The tick is the packet's sequence number: it only rises, and an
// echo of it gives an age without a record of when it was sent (control/beacon.hpp).
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
constexpr Packet sealed(const PacketHeader& e, PacketKind kind, std::uint8_t payload) {
  return {kind, e.sender, e.receiver, e.pair, e.sent, e.heard, payload};
}

constexpr Packet packet_of(MessageKind message, const PacketHeader& e) {
  return sealed(e, PacketKind::message, payload(message));
}

constexpr Packet packet_of(const Centralized::Report& report, const PacketHeader& e) {
  return sealed(e, PacketKind::report, payload(report));
}

constexpr Packet packet_of(const Command& command, const PacketHeader& e) {
  return sealed(e, PacketKind::command, payload(command));
}

// The letters of beacons, in the order of MessageKind.
inline constexpr char alphabet[] = {' ', 'R', 'I', 'G', 'D', 'W'};

constexpr std::uint8_t payload(const palmbots::Beacon& beacon) {
  return payload(
      Beacon{alphabet[static_cast<std::size_t>(beacon.message)], beacon.stopped, beacon.ready});
}

// A beacon carries its own stamps, which replace those of the header.
constexpr Packet packet_of(const palmbots::Beacon& beacon, const PacketHeader& e) {
  Packet packet = sealed(e, PacketKind::beacon, payload(beacon));
  packet.sent = {beacon.sent.epoch, beacon.sent.tick};
  packet.heard = {beacon.heard.epoch, beacon.heard.tick};
  return packet;
}

// The beacon in an accepted packet of kind `beacon`.
constexpr palmbots::Beacon beacon_in(const Packet& packet) {
  const Beacon said = beacon_of(packet.payload);
  MessageKind message = MessageKind::none;
  for (std::uint8_t i = 1; i < sizeof alphabet; ++i) {
    if (alphabet[i] == said.letter) message = static_cast<MessageKind>(i);
  }
  return {message,
          said.stopped,
          said.ready,
          {packet.sent.epoch, packet.sent.sequence},
          {packet.heard.epoch, packet.heard.sequence}};
}

// Passes the beacon of a received packet to a robot's receiver. Returns true if it counts.
//
// A beacon with the verdict `no_session` counts too. It is the newest and has unknown age
// (`BeaconReceiver::age`), so the partner is treated as silent until it answers. If it were
// ignored, the beacon before it would still count as the newest, although this robot's packets
// acknowledge the new one and the partner therefore regards the old one as forgotten. For the same
// reason robots that run the resilient algorithm send each other only beacons.
constexpr bool hear(BeaconReceiver& receiver, const Decoded& received) {
  const bool counts =
      received.verdict == Verdict::accepted || received.verdict == Verdict::no_session;
  return counts && received.packet.kind == PacketKind::beacon &&
         receiver.accept(beacon_in(received.packet));
}

}  // namespace palmbots::wire
