// SPDX-License-Identifier: Apache-2.0
// The packet, byte by byte: 32 bytes, little-endian, authenticated (docs/reference/wire.md).
//
// A packet carries one item: hello, which announces a boot; the state or the phase that a robot sends
// its partner; its status for the station; a wish of the operator; or a report or a command of
// the centralized algorithm (wire/payload.hpp). The other fields are sender and receiver, the
// packet's own stamp, the newest stamp that the sender had received from
// the receiver, and a SipHash-2-4 tag over all of this under the key of the pair. `decode` accepts
// exactly the byte sequences that `encode` produces; wire/endpoint.hpp decides whether a packet is
// new.
//
// STAMPS. Each sender numbers its packets. A packet's stamp is (epoch, sequence), compared in this
// order. The epoch counts the sender's boots and survives them. A sender stores the last epoch in
// permanent memory, and writes the next one there *before* its first packet, so no stamp is ever used
// twice under a key. The sequence starts at 1 in every epoch. After 2³² − 1 packets (497 days at 100
// per second) the next number would be 0, which is not valid. The sender then stays silent until it
// enters the next epoch, as at a boot. After 2²⁴ − 1 epochs, or when the counter is lost, the pair
// needs a new key.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/wire/payload.hpp"
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
inline constexpr Field payload_field{"payload", 19, payload_size};
inline constexpr Field tag_field{"tag", 24, 8};
inline constexpr Field layout[] = {
    version_field,  kind_field,        roles_field,          pair_field,    epoch_field,
    sequence_field, heard_epoch_field, heard_sequence_field, payload_field, tag_field};

// Version of the packet format; the tag covers the first `tagged_size` bytes.
inline constexpr std::uint8_t version = 3;
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

// A packet's stamp. Epoch 0 stands for "never".
struct SequenceNumber {
  std::uint32_t epoch = 0;
  std::uint32_t sequence = 0;

  constexpr auto operator<=>(const SequenceNumber&) const = default;
};

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
  Payload payload;

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
  stale,           // older than the newest, or a repetition of it (wire/endpoint.hpp)
  no_session,      // not sent in answer to the receiver's present boot (wire/endpoint.hpp)
};
inline constexpr std::size_t verdict_count = 10;

constexpr const char* name_of(Verdict verdict) {
  constexpr const char* names[] = {"accepted",   "wrong_version",  "too_short", "too_long",
                                   "wrong_pair", "wrong_receiver", "bad_tag",   "malformed",
                                   "stale",      "no_session"};
  return names[static_cast<int>(verdict)];
}

// True if this sender may send a packet of this kind to this receiver. Robots talk to each other or
// with the station.
constexpr bool on_speaking_terms(PacketKind kind, Role sender, Role receiver) {
  if (sender > Role::station || receiver > Role::station || sender == receiver) return false;
  switch (kind) {
    case PacketKind::hello: return true;
    case PacketKind::state:
    case PacketKind::phase: return sender != Role::station && receiver != Role::station;
    case PacketKind::status:
    case PacketKind::report: return receiver == Role::station;
    case PacketKind::operate:
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

// Writes the tag of the other fields under a key.
constexpr void retag(Bytes& bytes, const Key& key) {
  const std::span<const std::uint8_t> written = bytes;
  put(bytes, tag_field, siphash24(key, written.first(tagged_size)));
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
  for (std::size_t i = 0; i < payload_size; ++i) {
    bytes[payload_field.offset + i] = packet.payload[i];
  }
  retag(bytes, key);
  return true;
}

// True if two tags are equal, in a time that does not depend on where they differ. The halves are
// joined before the one comparison, also on machines with 32-bit words.
constexpr bool same_tag(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t difference = a ^ b;
  return static_cast<std::uint32_t>(difference | difference >> 32) == 0;
}

// True if the tag is right, so that the packet says who sent it and when, whether or not it is new.
constexpr bool is_authentic(Verdict verdict) {
  return verdict == Verdict::accepted || verdict == Verdict::stale ||
         verdict == Verdict::no_session;
}

// The result of decoding.
struct Decoded {
  Verdict verdict;
  Packet packet;  // all zero unless authentic
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
  Payload payload{};
  for (std::size_t i = 0; i < payload_size; ++i) {
    payload[i] = bytes[payload_field.offset + i];
  }
  const Packet packet{
      get<PacketKind>(bytes, kind_field),
      static_cast<Role>(roles & 15),
      static_cast<Role>(roles >> 4),
      get<std::uint16_t>(bytes, pair_field),
      {get<std::uint32_t>(bytes, epoch_field), get<std::uint32_t>(bytes, sequence_field)},
      {get<std::uint32_t>(bytes, heard_epoch_field),
       get<std::uint32_t>(bytes, heard_sequence_field)},
      payload};
  if (packet.pair != pair) return {Verdict::wrong_pair, {}};
  if (packet.receiver != receiver) return {Verdict::wrong_receiver, {}};
  const std::uint64_t tag = siphash24(key, bytes.first(tagged_size));
  if (!same_tag(tag, get<std::uint64_t>(bytes, tag_field))) return {Verdict::bad_tag, {}};
  if (!well_formed(packet)) return {Verdict::malformed, {}};
  return {Verdict::accepted, packet};
}

}  // namespace palmbots::wire
