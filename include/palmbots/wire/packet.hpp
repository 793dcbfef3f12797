// SPDX-License-Identifier: Apache-2.0
// The packet of every controller, byte by byte: 28 bytes, little-endian, authenticated
// (docs/reference/wire.md).
//
// One packet carries one item: a message of the distributed algorithm, a beacon of the resilient
// one, a sign of a controller that shares signs, a report or a command of the centralized one, or
// hello, which announces a boot. This payload is one byte. The other fields are sender and
// receiver, the packet's own stamp (wire/replay_window.hpp), the newest stamp that the sender had
// received from the receiver, and a SipHash-2-4 tag over all of this under the key of the pair.
// `decode` accepts exactly the byte sequences that `encode` produces; wire/endpoint.hpp decides
// whether a packet is new.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/control/centralized.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/wire/replay_window.hpp"
#include "palmbots/wire/siphash.hpp"

namespace palmbots::wire {

// The position of a field in a packet.
struct Field {
  const char* name;
  std::size_t offset;  // [bytes]
  std::size_t size;    // [bytes]
};

inline constexpr Field version_field{"version", 0, 1};
inline constexpr Field kind_field{"kind", 1, 1};
inline constexpr Field roles_field{"roles", 2, 1};  // sender, and 16 × receiver
inline constexpr Field pair_field{"pair", 3, 2};
inline constexpr Field epoch_field{"epoch", 5, 3};
inline constexpr Field sequence_field{"sequence", 8, 4};
inline constexpr Field heard_epoch_field{"heard epoch", 12, 3};
inline constexpr Field heard_sequence_field{"heard sequence", 15, 4};
inline constexpr Field payload_field{"payload", 19, 1};
inline constexpr Field tag_field{"tag", 20, 8};
inline constexpr Field layout[] = {
    version_field,  kind_field,        roles_field,          pair_field,    epoch_field,
    sequence_field, heard_epoch_field, heard_sequence_field, payload_field, tag_field};

// Version of the packet format; the tag covers the first `tagged_size` bytes.
inline constexpr std::uint8_t version = 1;
inline constexpr std::size_t tagged_size = tag_field.offset;
inline constexpr std::size_t packet_size = tag_field.offset + tag_field.size;

// The 128-bit key of a pair, and the bytes of a packet.
using Key = std::array<std::uint8_t, 16>;
using Bytes = std::array<std::uint8_t, packet_size>;

// Who sends or receives a packet.
enum class Role : std::uint8_t { left, right, station };
inline constexpr std::size_t role_count = 3;

constexpr const char* name_of(Role role) {
  constexpr const char* names[] = {"left", "right", "station"};
  return names[static_cast<int>(role)];
}

// What a packet carries.
enum class PacketKind : std::uint8_t { hello, message, beacon, report, command, sign };

constexpr const char* name_of(PacketKind kind) {
  constexpr const char* names[] = {"hello", "message", "beacon", "report", "command", "sign"};
  return names[static_cast<int>(kind)];
}

// The largest epoch that fits into its field.
inline constexpr std::uint32_t max_epoch = 0xFFFFFF;

// A decoded packet.
struct Packet {
  PacketKind kind;
  Role sender;
  Role receiver;
  std::uint16_t pair;
  SequenceNumber sent;
  SequenceNumber heard;  // newest stamp from the receiver since the sender's boot
  std::uint8_t payload;  // meaning depends on the kind (below)

  constexpr bool operator==(const Packet&) const = default;
};

// The outcome of decoding a packet: the first that fits. All verdicts before `bad_tag` depend on
// bytes that are not yet authenticated, so they describe only what the packet claims.
enum class Verdict : std::uint8_t {
  accepted,
  wrong_version,
  too_short,
  too_long,
  wrong_pair,      // meant for another pair
  wrong_receiver,  // meant for another receiver
  bad_tag,         // the tag is wrong
  malformed,       // the tag is right, but the content is invalid
  stale,           // older than the newest, or a repetition of it (wire/replay_window.hpp)
  no_session,      // not sent in answer to the receiver's present boot (wire/endpoint.hpp)
};
inline constexpr std::size_t verdict_count = 10;

constexpr const char* name_of(Verdict verdict) {
  constexpr const char* names[] = {"accepted",   "wrong_version",  "too_short", "too_long",
                                   "wrong_pair", "wrong_receiver", "bad_tag",   "malformed",
                                   "stale",      "no_session"};
  return names[static_cast<int>(verdict)];
}

// --- Payloads: each kind's content as a byte, and back. `means` rejects invalid bytes.

constexpr std::uint8_t payload(MessageKind message) { return static_cast<std::uint8_t>(message); }

// A beacon. The letter is I, R, G, D or W in ASCII. Bit 5, the lower-case bit of ASCII, is set if
// the robot is ready to travel. Bit 7 is set if it rests.
struct Beacon {
  char letter;
  bool stopped;
  bool ready;
};

constexpr std::uint8_t payload(const Beacon& beacon) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(beacon.letter) |
                                   unsigned{beacon.ready} << 5 | unsigned{beacon.stopped} << 7);
}

// Bits 0–1: sign + 1; bit 2: palm; bit 3: turned.
constexpr std::uint8_t payload(const Centralized::Report& report) {
  const unsigned sign = static_cast<unsigned>(static_cast<int>(report.sign) + 1);
  const unsigned palm = static_cast<unsigned>(report.palm);
  return static_cast<std::uint8_t>(sign | palm << 2 | unsigned{report.palm_at_target} << 3);
}

// Bit 0: palm; bits 1–2: move.
constexpr std::uint8_t payload(const Command& command) {
  const unsigned palm = static_cast<unsigned>(command.palm);
  return static_cast<std::uint8_t>(palm | static_cast<unsigned>(command.move) << 1);
}

// Bits 0–1: the sender's sign + 1; bit 2: its palm is shallow. At sign 0 the palm is not sent.
struct SignWord {
  Sign sign;
  bool shallow;
};

constexpr std::uint8_t payload(const SignWord& word) {
  const unsigned sign = static_cast<unsigned>(static_cast<int>(word.sign) + 1);
  return static_cast<std::uint8_t>(sign | unsigned{word.shallow} << 2);
}

constexpr MessageKind message_of(std::uint8_t payload) { return static_cast<MessageKind>(payload); }

constexpr Beacon beacon_of(std::uint8_t payload) {
  return {static_cast<char>(payload & 0x5f), (payload >> 7) != 0, (payload >> 5 & 1) != 0};
}

constexpr Centralized::Report report_of(std::uint8_t payload) {
  return {static_cast<Sign>((payload & 3) - 1), static_cast<Palm>(payload >> 2 & 1),
          (payload >> 3 & 1) != 0};
}

constexpr Command command_of(std::uint8_t payload) {
  return {static_cast<Palm>(payload & 1), static_cast<Move>(payload >> 1)};
}

constexpr SignWord sign_of(std::uint8_t payload) {
  return {static_cast<Sign>((payload & 3) - 1), (payload >> 2 & 1) != 0};
}

// True if the payload is valid for this kind.
constexpr bool means(PacketKind kind, std::uint8_t payload) {
  switch (kind) {
    case PacketKind::hello: return payload == 0;
    case PacketKind::message: return payload >= 1 && payload <= 3;
    case PacketKind::beacon: {
      const char letter = beacon_of(payload).letter;
      return letter == 'I' || letter == 'R' || letter == 'G' || letter == 'D' || letter == 'W';
    }
    case PacketKind::report: return payload < 16 && (payload & 3) != 3;
    case PacketKind::command: return payload < 6;
    case PacketKind::sign: return payload < 7 && payload != 3 && payload != 5;
  }
  return false;
}

// True if this sender may send a packet of this kind to this receiver. Robots talk to each other or
// with the station.
constexpr bool on_speaking_terms(PacketKind kind, Role sender, Role receiver) {
  if (sender > Role::station || receiver > Role::station || sender == receiver) return false;
  switch (kind) {
    case PacketKind::hello: return true;
    case PacketKind::message:
    case PacketKind::beacon:
    case PacketKind::sign: return sender != Role::station && receiver != Role::station;
    case PacketKind::report: return receiver == Role::station;
    case PacketKind::command: return sender == Role::station;
  }
  return false;
}

// True if the stamp is valid. Neither part may be 0, which stands for "never".
constexpr bool dated(const SequenceNumber& stamp) {
  return stamp.epoch >= 1 && stamp.epoch <= max_epoch && stamp.sequence >= 1;
}

// True if the packet may be sent: roles, stamps and payload are valid.
constexpr bool well_formed(const Packet& packet) {
  return on_speaking_terms(packet.kind, packet.sender, packet.receiver) &&
         means(packet.kind, packet.payload) && dated(packet.sent) &&
         (dated(packet.heard) || packet.heard == SequenceNumber{});
}

// --- The packet.

// Writes a number into a field, the least significant byte first.
constexpr void put(Bytes& bytes, Field field, std::uint64_t value) {
  for (std::size_t i = 0; i < field.size; ++i) {
    bytes[field.offset + i] = static_cast<std::uint8_t>(value >> 8 * i);
  }
}

// Reads a field. The bytes must be long enough.
template <class Number>
constexpr Number get(std::span<const std::uint8_t> bytes, Field field) {
  return static_cast<Number>(little_endian(bytes.subspan(field.offset, field.size)));
}

// Writes the packet. Returns false and writes nothing if it is not well formed.
constexpr bool encode(const Packet& packet, const Key& key, Bytes& bytes) {
  if (!well_formed(packet)) return false;
  const auto sender = static_cast<unsigned>(packet.sender);
  const auto receiver = static_cast<unsigned>(packet.receiver);
  put(bytes, version_field, version);
  put(bytes, kind_field, static_cast<std::uint8_t>(packet.kind));
  put(bytes, roles_field, sender | receiver << 4);
  put(bytes, pair_field, packet.pair);
  put(bytes, epoch_field, packet.sent.epoch);
  put(bytes, sequence_field, packet.sent.sequence);
  put(bytes, heard_epoch_field, packet.heard.epoch);
  put(bytes, heard_sequence_field, packet.heard.sequence);
  put(bytes, payload_field, packet.payload);
  const std::span<const std::uint8_t> written = bytes;
  put(bytes, tag_field, siphash24(key, written.first(tagged_size)));
  return true;
}

// True if two tags are equal, in a time that does not depend on where they differ. The halves are
// joined before the one comparison, also on machines with 32-bit words.
constexpr bool same_tag(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t difference = a ^ b;
  return static_cast<std::uint32_t>(difference | difference >> 32) == 0;
}

// The result of decoding.
struct Decoded {
  Verdict verdict;
  Packet packet;  // all zero unless accepted or no_session (wire/endpoint.hpp)
};

// Decodes a packet for a receiver of a pair. The version is checked first, because another version
// may have another length.
constexpr Decoded decode(std::span<const std::uint8_t> bytes, const Key& key, std::uint16_t pair,
                         Role receiver) {
  if (bytes.empty()) return {Verdict::too_short, {}};
  if (bytes[version_field.offset] != version) return {Verdict::wrong_version, {}};
  if (bytes.size() < packet_size) return {Verdict::too_short, {}};
  if (bytes.size() > packet_size) return {Verdict::too_long, {}};
  const auto roles = get<std::uint8_t>(bytes, roles_field);
  const Packet packet{
      get<PacketKind>(bytes, kind_field),
      static_cast<Role>(roles & 15),
      static_cast<Role>(roles >> 4),
      get<std::uint16_t>(bytes, pair_field),
      {get<std::uint32_t>(bytes, epoch_field), get<std::uint32_t>(bytes, sequence_field)},
      {get<std::uint32_t>(bytes, heard_epoch_field),
       get<std::uint32_t>(bytes, heard_sequence_field)},
      get<std::uint8_t>(bytes, payload_field)};
  if (packet.pair != pair) return {Verdict::wrong_pair, {}};
  if (packet.receiver != receiver) return {Verdict::wrong_receiver, {}};
  const std::uint64_t tag = siphash24(key, bytes.first(tagged_size));
  if (!same_tag(tag, get<std::uint64_t>(bytes, tag_field))) return {Verdict::bad_tag, {}};
  if (!well_formed(packet)) return {Verdict::malformed, {}};
  return {Verdict::accepted, packet};
}

}  // namespace palmbots::wire
