// What the controllers say, as packets of the wire (wire.hpp), and back; and what damage on the way
// makes of one.
//
// A letter of the resilient algorithm goes as a letter of the alphabet: I idle (TiltDown), R request
// (TiltUp), G grant (Ack), D in case (d) (Closing), W palm up but not granted (Raised). Its stamp is
// boot epoch and control tick, and the tick is the packet's sequence number: it only rises, and an
// echo of it tells an age without any memory of when it was sent (beacon.hpp).
#pragma once

#include <cstdint>

#include "palmbots/beacon.hpp"
#include "palmbots/message.hpp"
#include "palmbots/philox.hpp"
#include "palmbots/policy.hpp"
#include "palmbots/wire.hpp"

namespace palmbots::wire {

// From whom to whom, and when, all but what is said.
struct Envelope {
  Role sender;
  Role receiver;
  std::uint16_t pair;
  Stamp sent;
  Stamp heard;
};

constexpr Packet sealed(const Envelope& e, Kind kind, std::uint8_t payload) {
  return {kind, e.sender, e.receiver, e.pair, e.sent, e.heard, payload};
}

constexpr Packet packet_of(Letter letter, const Envelope& e) {
  return sealed(e, Kind::letter, payload(letter));
}

constexpr Packet packet_of(const Centralized::Report& report, const Envelope& e) {
  return sealed(e, Kind::report, payload(report));
}

constexpr Packet packet_of(const Command& command, const Envelope& e) {
  return sealed(e, Kind::command, payload(command));
}

// The letters of beacons, in the order of Letter.
inline constexpr char alphabet[] = {' ', 'R', 'I', 'G', 'D', 'W'};

constexpr std::uint8_t payload(const palmbots::Beacon& beacon) {
  return payload(
      Beacon{alphabet[static_cast<std::size_t>(beacon.letter)], beacon.rests, beacon.ready});
}

// A beacon has stamps of its own, which take the place of the envelope's.
constexpr Packet packet_of(const palmbots::Beacon& beacon, const Envelope& e) {
  Packet packet = sealed(e, Kind::beacon, payload(beacon));
  packet.sent = {beacon.sent.epoch, beacon.sent.tick};
  packet.heard = {beacon.heard.epoch, beacon.heard.tick};
  return packet;
}

// The beacon in a packet of that kind that was accepted.
constexpr palmbots::Beacon beacon_in(const Packet& packet) {
  const Beacon said = beacon_of(packet.payload);
  Letter letter = Letter::none;
  for (std::uint8_t i = 1; i < sizeof alphabet; ++i) {
    if (alphabet[i] == said.letter) letter = static_cast<Letter>(i);
  }
  return {letter,
          said.rests,
          said.ready,
          {packet.sent.epoch, packet.sent.sequence},
          {packet.heard.epoch, packet.heard.sequence}};
}

// Puts the beacon of a packet that an end received into a robot's ear; returns whether it is news.
// An unanswered beacon is: it is the newest, and of no age (`Ear::age`), so the partner is silent
// until it answers. Left out, the beacon before it would count as the newest although the partner,
// told by the echo of this one, thinks it forgotten. For the same reason robots that run the
// resilient algorithm say nothing but beacons to each other.
constexpr bool hear(Ear& ear, const Decoded& received) {
  const bool counts =
      received.verdict == Verdict::accepted || received.verdict == Verdict::unanswered;
  return counts && received.packet.kind == Kind::beacon && ear.take(beacon_in(received.packet));
}

// What the receiver says of a packet of which up to eight bytes in a row are random, the first of
// them certainly wrong: place, length and noise from three words.
constexpr Verdict damaged(const Packet& packet, const Words& words) {
  constexpr Key key{};  // any: what is wrong stays wrong
  Bytes bytes{};
  if (!encode(packet, key, bytes)) return Verdict::malformed;
  const std::uint64_t noise = std::uint64_t{words[3]} << 32 | words[2] | 1;
  const std::size_t first = words[1] % packet_size;
  const std::size_t size = 1 + (words[1] >> 16) % 8;
  for (std::size_t i = 0; i < size && first + i < packet_size; ++i) {
    bytes[first + i] ^= static_cast<std::uint8_t>(noise >> 8 * i);
  }
  return decode(bytes, key, packet.pair, packet.receiver).verdict;
}

}  // namespace palmbots::wire
