// SPDX-License-Identifier: Apache-2.0
// The packet: what is encoded decodes, and nothing else does.
#include "palmbots/wire/packet.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/check.hpp"
#include "support/wire_packets.hpp"

using namespace palmbots::wire;
using palmbots::Centralized;
using palmbots::Command;
using palmbots::MessageKind;
using palmbots::Move;
using palmbots::Palm;
using palmbots::Sign;

namespace {

Bytes encoded(const Packet& packet) {
  Bytes bytes{};
  CHECK(encode(packet, test_key, bytes));
  return bytes;
}

Verdict verdict_of(std::span<const std::uint8_t> bytes, Role receiver) {
  return decode(bytes, test_key, test_pair, receiver).verdict;
}

// The fields follow each other without a gap, and the packet is no longer than 32 bytes.
void test_layout_has_no_gaps() {
  std::size_t end = 0;
  for (const Field& field : layout) {
    CHECK(field.offset == end);
    end += field.size;
  }
  CHECK(end == packet_size);
  CHECK(packet_size == 32);
}

void test_every_packet_survives_encoding() {
  const auto packets = all_sayings();
  CHECK(packets.size() > 1000);
  for (const Packet& packet : packets) {
    const Decoded decoded = decode(encoded(packet), test_key, test_pair, packet.receiver);
    CHECK(decoded.verdict == Verdict::accepted);
    CHECK(decoded.packet == packet);
  }
}

// All kinds and roles, also those that no enumeration names, with every value of every payload byte:
// `encode` takes exactly what can be said, and with a right tag `decode` calls all others malformed.
void test_all_other_payloads_are_malformed() {
  const Packet good = all_sayings()[0];
  const Payload bases[] = {
      {}, {1, 0x14, 0, 0, 2}, {5, 0x27, 0, 0, 1}, {4, 1, 2, 3, 0}, {12, 0x44, 0, 0, 4}};
  std::size_t legal = 0;
  std::size_t malformed = 0;
  for (unsigned kind = 0; kind < 8; ++kind) {
    for (unsigned roles = 0; roles < 256; ++roles) {
      // Senders and receivers that do not exist are all alike.
      if ((roles & 15) > 4 || roles >> 4 > 4) continue;
      for (const Payload& base : bases) {
        for (std::size_t place = 0; place < payload_size; ++place) {
          for (unsigned byte = 0; byte < 256; ++byte) {
            Packet packet = good;
            packet.kind = static_cast<PacketKind>(kind);
            packet.sender = static_cast<Role>(roles & 15);
            packet.receiver = static_cast<Role>(roles >> 4);
            packet.payload = base;
            packet.payload[place] = static_cast<std::uint8_t>(byte);
            const bool said = can_be_said(kind, roles & 15, roles >> 4, packet.payload);
            CHECK(well_formed(packet) == said);
            legal += said;
            if (said || byte % 17 != 0) continue;
            Bytes bytes = encoded(good);
            const Bytes before = bytes;
            CHECK(!encode(packet, test_key, bytes) && bytes == before);
            put(bytes, kind_field, kind);
            put(bytes, roles_field, roles);
            std::copy(packet.payload.begin(), packet.payload.end(),
                      bytes.begin() + payload_field.offset);
            put(bytes, tag_field,
                palmbots::siphash24(test_key, std::span(bytes).first(tagged_size)));
            CHECK(verdict_of(bytes, packet.receiver) == Verdict::malformed);
            ++malformed;
          }
        }
      }
    }
  }
  CHECK(legal > 10000 && malformed > 10000);
}

void test_numbers_out_of_range() {
  const Packet good = all_sayings()[0];
  const auto refused = [&](auto change) {
    Packet packet = good;
    change(packet);
    Bytes bytes{};
    return !encode(packet, test_key, bytes);
  };
  CHECK(!refused([](Packet& p) { p.sent = {1, 1}; }));
  CHECK(!refused([](Packet& p) { p.sent = {0xFFFFFF, 0xFFFFFFFF}; }));
  CHECK(!refused([](Packet& p) { p.heard = {0, 0}; }));
  CHECK(!refused([](Packet& p) { p.heard = {1, 1}; }));
  CHECK(!refused([](Packet& p) { p.heard = {0xFFFFFF, 0xFFFFFFFF}; }));
  CHECK(refused([](Packet& p) { p.sent = {0, 0}; }));
  CHECK(refused([](Packet& p) { p.sent = {0, 1}; }));
  CHECK(refused([](Packet& p) { p.sent = {1, 0}; }));
  CHECK(refused([](Packet& p) { p.sent = {0x1000000, 1}; }));
  CHECK(refused([](Packet& p) { p.heard = {0, 1}; }));
  CHECK(refused([](Packet& p) { p.heard = {1, 0}; }));
  CHECK(refused([](Packet& p) { p.heard = {0x1000000, 1}; }));
  // Come with a right tag, what fits into the fields is malformed.
  for (const Field& field :
       {epoch_field, sequence_field, heard_epoch_field, heard_sequence_field}) {
    Bytes bytes = encoded(good);
    put(bytes, field, 0);
    put(bytes, tag_field, palmbots::siphash24(test_key, std::span(bytes).first(tagged_size)));
    CHECK(verdict_of(bytes, good.receiver) == Verdict::malformed);
  }
}

constexpr Sign signs[] = {Sign::negative, Sign::zero, Sign::positive};
constexpr bool no_or_yes[] = {false, true};

void test_states_and_back() {
  for (unsigned language = 0; language < 5; ++language) {
    for (int message = 0; message < palmbots::all_message_kinds; ++message) {
      for (unsigned mode = 0; mode < robot_modes; ++mode) {
        for (unsigned flags = 0; flags < 8; ++flags) {
          const State state{static_cast<Language>(language),
                            static_cast<MessageKind>(message),
                            static_cast<RobotMode>(mode),
                            (flags & 1) != 0,
                            (flags & 2) != 0,
                            (flags & 4) != 0};
          const Payload payload = payload_of(state);
          CHECK(state_of(payload) == state && passes_stop(payload) == state.stop);
          const bool is_phase = state.language == Language::phases;
          const bool has = has_message(state.language, state.message);
          CHECK(means(PacketKind::state, payload) == (has && !is_phase));
          CHECK(means(PacketKind::phase, payload) == (has && is_phase));
        }
      }
    }
  }
}

void test_statuses_and_back() {
  RandomWords dice(5);
  for (int i = 0; i < 100000; ++i) {
    const Status status{static_cast<RobotMode>(dice.below(robot_modes)),
                        static_cast<FaultCode>(dice.below(fault_codes)),
                        signs[dice.below(3)],
                        static_cast<Palm>(dice.below(2)),
                        dice.below(2) != 0,
                        case_names[dice.below(sizeof case_names)],
                        static_cast<StatusItem>(dice.below(status_items)),
                        static_cast<std::uint16_t>(dice.word()),
                        dice.below(2) != 0,
                        dice.below(2) != 0,
                        dice.below(2) != 0};
    const Payload payload = payload_of(status);
    CHECK(status_of(payload) == status && means(PacketKind::status, payload));
    CHECK(passes_stop(payload) == status.stop);
  }
}

void test_other_payloads_and_back() {
  for (const bool stop : no_or_yes) {
    for (const std::uint32_t settings : {0U, 1U, 0x04030201U, 0xFFFFFFFFU}) {
      const Hello hello{settings, stop};
      CHECK(hello_of(payload_of(hello)) == hello);
      CHECK(means(PacketKind::hello, payload_of(hello)));
    }
    for (unsigned operation = 0; operation < operations; ++operation) {
      const Operate wish{static_cast<Operation>(operation), stop};
      CHECK(operate_of(payload_of(wish)) == wish);
      CHECK(means(PacketKind::operate, payload_of(wish)));
    }
    for (const Palm palm : {Palm::steep, Palm::shallow}) {
      for (const Sign sign : signs) {
        for (const bool palm_at_target : no_or_yes) {
          const Centralized::Report report{sign, palm, palm_at_target};
          const Payload payload = payload_of(report, stop);
          CHECK(report_of(payload) == report && passes_stop(payload) == stop);
          CHECK(means(PacketKind::report, payload));
        }
      }
      for (const Move move : {Move::hold, Move::away, Move::closer}) {
        const Payload payload = payload_of(Command{palm, move}, stop);
        CHECK((command_of(payload) == Command{palm, move} && passes_stop(payload) == stop));
        CHECK(means(PacketKind::command, payload));
      }
    }
  }
}

void test_every_truncation_and_extension() {
  for (const Packet& packet : all_sayings()) {
    const Bytes bytes = encoded(packet);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      // A copy of its own, so that a sanitizer sees a read past its end.
      const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
      CHECK(verdict_of(cut, packet.receiver) == Verdict::too_short);
    }
    for (std::size_t more = 1; more <= 40; ++more) {
      std::vector<std::uint8_t> longer(bytes.begin(), bytes.end());
      longer.resize(bytes.size() + more);
      CHECK(verdict_of(longer, packet.receiver) == Verdict::too_long);
    }
  }
}

// Which count a flipped bit goes to: the first check that sees it.
Verdict expected_of_flip(std::size_t byte, std::size_t bit) {
  if (byte == 0) return Verdict::wrong_version;
  if (byte == 3 || byte == 4) return Verdict::wrong_pair;
  if (byte == 2 && bit >= 4) return Verdict::wrong_receiver;
  return Verdict::bad_tag;
}

void test_every_flip_of_one_bit_and_of_two() {
  unsigned n = 0;
  for (const Packet& packet : all_sayings()) {
    if (n++ % 20 != 0) continue;
    Bytes bytes = encoded(packet);
    for (std::size_t i = 0; i < 8 * packet_size; ++i) {
      bytes[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
      const Decoded decoded = decode(bytes, test_key, test_pair, packet.receiver);
      CHECK(decoded.verdict == expected_of_flip(i / 8, i % 8));
      CHECK(decoded.packet == Packet{});
      for (std::size_t k = 0; k < i; ++k) {
        bytes[k / 8] ^= static_cast<std::uint8_t>(1 << k % 8);
        CHECK(verdict_of(bytes, packet.receiver) != Verdict::accepted);
        bytes[k / 8] ^= static_cast<std::uint8_t>(1 << k % 8);
      }
      bytes[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
    }
  }
}

void test_packets_for_another_receiver_pair_or_key_are_rejected() {
  for (const Packet& packet : all_sayings()) {
    const Bytes bytes = encoded(packet);
    for (const Role receiver : {Role::left, Role::right, Role::station}) {
      const Verdict expected =
          receiver == packet.receiver ? Verdict::accepted : Verdict::wrong_receiver;
      CHECK(verdict_of(bytes, receiver) == expected);
    }
    CHECK(decode(bytes, test_key, test_pair + 1, packet.receiver).verdict == Verdict::wrong_pair);
    Key other = test_key;
    other[15] ^= 0x80;
    CHECK(decode(bytes, other, test_pair, packet.receiver).verdict == Verdict::bad_tag);
  }
}

// The default payloads are all zero: no settings, no message, no stop.
void test_payloads_that_are_not_set() {
  CHECK(payload_of(Hello{}) == Payload{});
  CHECK(payload_of(State{}) == Payload{});
}

// Two tags differ if any of their bits differ.
void test_comparison_of_tags_covers_all_bits() {
  for (int i = 0; i < 64; ++i) {
    const std::uint64_t tag = 0x0123456789abcdef;
    CHECK(same_tag(tag, tag));
    CHECK(!same_tag(tag, tag ^ std::uint64_t{1} << i));
    CHECK(!same_tag(tag, tag ^ std::uint64_t{1} << i ^ std::uint64_t{1} << (i + 32) % 64));
  }
}

}  // namespace

int main() {
  test_layout_has_no_gaps();
  test_every_packet_survives_encoding();
  test_all_other_payloads_are_malformed();
  test_numbers_out_of_range();
  test_states_and_back();
  test_statuses_and_back();
  test_other_payloads_and_back();
  test_payloads_that_are_not_set();
  test_every_truncation_and_extension();
  test_every_flip_of_one_bit_and_of_two();
  test_packets_for_another_receiver_pair_or_key_are_rejected();
  test_comparison_of_tags_covers_all_bits();
}
