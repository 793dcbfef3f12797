// SPDX-License-Identifier: Apache-2.0
// What the controllers say, as packets of the wire (wire/packet.hpp), and back.
//
// A message of the resilient algorithm goes as a letter of the alphabet: I idle (TiltDown), R
// request (TiltUp), G grant (Ack), D in case (d) (Closing), W palm up but not granted (Raised). Its
// stamp is boot epoch and control tick, and the tick is the packet's sequence number: it only
// rises, and an echo of it tells an age without any memory of when it was sent
// (control/beacon.hpp).
#pragma once

#include <cstdint>

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/centralized.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots::wire {

// From whom to whom, and when, all but what is said.
struct PacketHeader {
  Role sender;
  Role receiver;
  std::uint16_t pair;
  SequenceNumber sent;
  SequenceNumber heard;
};

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

// A beacon has stamps of its own, which take the place of the envelope's.
constexpr Packet packet_of(const palmbots::Beacon& beacon, const PacketHeader& e) {
  Packet packet = sealed(e, PacketKind::beacon, payload(beacon));
  packet.sent = {beacon.sent.epoch, beacon.sent.tick};
  packet.heard = {beacon.heard.epoch, beacon.heard.tick};
  return packet;
}

// The beacon in a packet of that kind that was accepted.
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

// Puts the beacon of a packet that an end received into a robot's receiver; returns whether it is
// news. An unanswered beacon is: it is the newest, and of no age (`BeaconReceiver::age`), so the
// partner is silent until it answers. Left out, the beacon before it would count as the newest
// although the partner, told by the echo of this one, thinks it forgotten. For the same reason
// robots that run the resilient algorithm say nothing but beacons to each other.
constexpr bool hear(BeaconReceiver& receiver, const Decoded& received) {
  const bool counts =
      received.verdict == Verdict::accepted || received.verdict == Verdict::no_session;
  return counts && received.packet.kind == PacketKind::beacon &&
         receiver.accept(beacon_in(received.packet));
}

}  // namespace palmbots::wire
