// The packet of every controller, byte by byte: 28 bytes, little-endian, tagged (docs/wire.md).
//
// One packet says one thing: a letter of the distributed algorithm, a beacon of the resilient one, a
// report or a command of the centralized one, or hello, "I am up". What it says is one byte. Around
// it stand who says it to whom, its own stamp (window.hpp), the newest stamp that the sender had heard
// from the receiver, and a SipHash-2-4 tag over all of this under the key of the pair. `decode` takes
// nothing but exactly what `encode` makes; whether it is new is another matter (endpoint.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/message.hpp"
#include "palmbots/policy.hpp"
#include "palmbots/siphash.hpp"
#include "palmbots/window.hpp"

namespace palmbots::wire {

// A field's place in a packet.
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

inline constexpr std::uint8_t version = 1;
inline constexpr std::size_t tagged_size = tag_field.offset;
inline constexpr std::size_t packet_size = tag_field.offset + tag_field.size;

using Key = std::array<std::uint8_t, 16>;
using Bytes = std::array<std::uint8_t, packet_size>;

enum class Role : std::uint8_t { left, right, station };
inline constexpr std::size_t role_count = 3;

enum class Kind : std::uint8_t { hello, letter, beacon, report, command };

// The last epoch that fits.
inline constexpr std::uint32_t max_epoch = 0xFFFFFF;

struct Packet {
  Kind kind;
  Role sender;
  Role receiver;
  std::uint16_t pair;
  Stamp sent;
  Stamp heard;           // the newest of the receiver's that the sender had heard since its boot
  std::uint8_t payload;  // what it says, by kind (below)

  constexpr bool operator==(const Packet&) const = default;
};

// What becomes of a packet. The first that fits counts. All before `forged` are decided by bytes of
// which nobody knows yet who wrote them: they tell what the packet claims, no more.
enum class Verdict : std::uint8_t {
  accepted,
  other_version,
  too_short,
  too_long,
  stranger,     // of another pair
  misdirected,  // to another receiver
  forged,       // the tag is wrong
  malformed,    // the tag is right, but the sender says what makes no sense
  stale,        // older than the newest, or that one again (window.hpp)
  unanswered,   // not sent in answer to the receiver's present boot (endpoint.hpp)
};
inline constexpr std::size_t verdict_count = 10;

// --- Payloads: each kind's meaning as a byte, and back. What a byte must not be, `means` tells.

constexpr std::uint8_t payload(Letter letter) { return static_cast<std::uint8_t>(letter); }

// A beacon: its letter of the alphabet (ASCII), I, R, G, D or W; in bit 5, which makes it a small one,
// whether the robot is ready to travel; and in bit 7 whether it rests.
struct Beacon {
  char letter;
  bool rests;
  bool ready;
};

constexpr std::uint8_t payload(const Beacon& beacon) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(beacon.letter) |
                                   unsigned{beacon.ready} << 5 | unsigned{beacon.rests} << 7);
}

// Bits 0–1: sign + 1; bit 2: palm; bit 3: turned.
constexpr std::uint8_t payload(const Centralized::Report& report) {
  const unsigned sign = static_cast<unsigned>(static_cast<int>(report.sign) + 1);
  const unsigned palm = static_cast<unsigned>(report.palm);
  return static_cast<std::uint8_t>(sign | palm << 2 | unsigned{report.turned} << 3);
}

// Bit 0: palm; bits 1–2: move.
constexpr std::uint8_t payload(const Command& command) {
  const unsigned palm = static_cast<unsigned>(command.palm);
  return static_cast<std::uint8_t>(palm | static_cast<unsigned>(command.move) << 1);
}

constexpr Letter letter_of(std::uint8_t payload) { return static_cast<Letter>(payload); }

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

// Whether a payload means something.
constexpr bool means(Kind kind, std::uint8_t payload) {
  switch (kind) {
    case Kind::hello: return payload == 0;
    case Kind::letter: return payload >= 1 && payload <= 3;
    case Kind::beacon: {
      const char letter = beacon_of(payload).letter;
      return letter == 'I' || letter == 'R' || letter == 'G' || letter == 'D' || letter == 'W';
    }
    case Kind::report: return payload < 16 && (payload & 3) != 3;
    case Kind::command: return payload < 6;
  }
  return false;
}

// Whether one says such a thing to the other: robots talk to each other or with the station.
constexpr bool on_speaking_terms(Kind kind, Role sender, Role receiver) {
  if (sender > Role::station || receiver > Role::station || sender == receiver) return false;
  switch (kind) {
    case Kind::hello: return true;
    case Kind::letter:
    case Kind::beacon: return sender != Role::station && receiver != Role::station;
    case Kind::report: return receiver == Role::station;
    case Kind::command: return sender == Role::station;
  }
  return false;
}

// Whether something can bear this stamp: neither part of it is 0, which stands for never.
constexpr bool dated(const Stamp& stamp) {
  return stamp.epoch >= 1 && stamp.epoch <= max_epoch && stamp.sequence >= 1;
}

constexpr bool well_formed(const Packet& packet) {
  return on_speaking_terms(packet.kind, packet.sender, packet.receiver) &&
         means(packet.kind, packet.payload) && dated(packet.sent) &&
         (dated(packet.heard) || packet.heard == Stamp{});
}

// --- The packet.

constexpr void put(Bytes& bytes, Field field, std::uint64_t value) {
  for (std::size_t i = 0; i < field.size; ++i) {
    bytes[field.offset + i] = static_cast<std::uint8_t>(value >> 8 * i);
  }
}

// A field of a text that is known to be long enough.
template <class Number>
constexpr Number get(std::span<const std::uint8_t> bytes, Field field) {
  return static_cast<Number>(little_endian(bytes.subspan(field.offset, field.size)));
}

// Writes the packet; false, and nothing written, if it is not well formed.
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

// Whether two tags are equal, in a time that does not tell where they differ: the halves are joined
// before the one comparison, also where words have 32 bits.
constexpr bool same_tag(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t difference = a ^ b;
  return static_cast<std::uint32_t>(difference | difference >> 32) == 0;
}

struct Decoded {
  Verdict verdict;
  Packet packet;  // all zero unless accepted, or unanswered (endpoint.hpp)
};

// What a receiver of a pair makes of some bytes. The version comes first, so that another one may
// have another length.
constexpr Decoded decode(std::span<const std::uint8_t> bytes, const Key& key, std::uint16_t pair,
                         Role receiver) {
  if (bytes.empty()) return {Verdict::too_short, {}};
  if (bytes[version_field.offset] != version) return {Verdict::other_version, {}};
  if (bytes.size() < packet_size) return {Verdict::too_short, {}};
  if (bytes.size() > packet_size) return {Verdict::too_long, {}};
  const auto roles = get<std::uint8_t>(bytes, roles_field);
  const Packet packet{
      get<Kind>(bytes, kind_field),
      static_cast<Role>(roles & 15),
      static_cast<Role>(roles >> 4),
      get<std::uint16_t>(bytes, pair_field),
      {get<std::uint32_t>(bytes, epoch_field), get<std::uint32_t>(bytes, sequence_field)},
      {get<std::uint32_t>(bytes, heard_epoch_field),
       get<std::uint32_t>(bytes, heard_sequence_field)},
      get<std::uint8_t>(bytes, payload_field)};
  if (packet.pair != pair) return {Verdict::stranger, {}};
  if (packet.receiver != receiver) return {Verdict::misdirected, {}};
  const std::uint64_t tag = siphash24(key, bytes.first(tagged_size));
  if (!same_tag(tag, get<std::uint64_t>(bytes, tag_field))) return {Verdict::forged, {}};
  if (!well_formed(packet)) return {Verdict::malformed, {}};
  return {Verdict::accepted, packet};
}

}  // namespace palmbots::wire
