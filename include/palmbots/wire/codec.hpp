// SPDX-License-Identifier: Apache-2.0
// Converts messages of the controllers to packets (wire/packet.hpp) and back.
//
// A message of the resilient algorithm is encoded as one letter: I idle (TiltDown), R request
// (TiltUp), G grant (Ack), D in case (d) (Closing), W palm up but not granted (Raised). Its stamp
// is boot epoch and control tick. The tick is the packet's sequence number: it only rises, and an
// echo of it gives an age without a record of when it was sent (control/beacon.hpp).
//
// The words of a controller that shares signs are stamped in the same way. They are packets of a
// kind of their own.
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

// The word of a table that shares signs (MessageKind::zero to minus_shallow), and back.
constexpr SignWord sign_word(MessageKind word) {
  const bool is_plus = word == MessageKind::plus || word == MessageKind::plus_shallow;
  const bool is_shallow = word == MessageKind::plus_shallow || word == MessageKind::minus_shallow;
  const Sign sign = is_plus ? Sign::positive : Sign::negative;
  return {word == MessageKind::zero ? Sign::zero : sign, is_shallow};
}

constexpr MessageKind word_of(const SignWord& said) {
  if (said.sign == Sign::zero) return MessageKind::zero;
  if (said.sign == Sign::positive)
    return said.shallow ? MessageKind::plus_shallow : MessageKind::plus;
  return said.shallow ? MessageKind::minus_shallow : MessageKind::minus;
}

// The kind of packet in which a beacon with this message is sent.
constexpr PacketKind kind_of(MessageKind message) {
  return is_sign(message) ? PacketKind::sign : PacketKind::beacon;
}

// A beacon carries its own stamps, which replace those of the header.
constexpr Packet packet_of(const palmbots::Beacon& beacon, const PacketHeader& e) {
  const PacketKind kind = kind_of(beacon.message);
  Packet packet = sealed(
      e, kind, kind == PacketKind::sign ? payload(sign_word(beacon.message)) : payload(beacon));
  packet.sent = {beacon.sent.epoch, beacon.sent.tick};
  packet.heard = {beacon.heard.epoch, beacon.heard.tick};
  return packet;
}

// The beacon in an accepted packet of kind `beacon` or `sign`.
constexpr palmbots::Beacon beacon_in(const Packet& packet) {
  const BeaconStamp sent{packet.sent.epoch, packet.sent.sequence};
  const BeaconStamp heard{packet.heard.epoch, packet.heard.sequence};
  if (packet.kind == PacketKind::sign)
    return {word_of(sign_of(packet.payload)), false, false, sent, heard};
  const Beacon said = beacon_of(packet.payload);
  MessageKind message = MessageKind::none;
  for (std::uint8_t i = 1; i < sizeof alphabet; ++i) {
    if (alphabet[i] == said.letter) message = static_cast<MessageKind>(i);
  }
  return {message, said.stopped, said.ready, sent, heard};
}

// Passes the beacon of a received packet to a robot's receiver. Returns true if it counts. `kind` is
// `beacon` for robots that run the resilient algorithm, `sign` for those that share signs.
//
// A beacon with the verdict `no_session` counts too. It is the newest and has unknown age
// (`BeaconReceiver::age`), so the partner is treated as silent until it answers. If it were
// ignored, the beacon before it would still count as the newest, although this robot's packets
// acknowledge the new one and the partner therefore regards the old one as forgotten. For the same
// reason robots that run the resilient algorithm send each other only beacons, and robots that share
// signs only signs.
constexpr bool hear(BeaconReceiver& receiver, const Decoded& received,
                    PacketKind kind = PacketKind::beacon) {
  const bool counts =
      received.verdict == Verdict::accepted || received.verdict == Verdict::no_session;
  return counts && received.packet.kind == kind && receiver.accept(beacon_in(received.packet));
}

}  // namespace palmbots::wire
