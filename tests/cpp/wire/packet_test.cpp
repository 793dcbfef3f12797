// SPDX-License-Identifier: Apache-2.0
// The packet: what is encoded decodes, and nothing else does.
#include "palmbots/wire/packet.hpp"

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
  CHECK(packet_size <= 32);
}

void test_every_packet_survives_encoding() {
  const auto packets = all_sayings();
  CHECK(packets.size() == 6 + 2 * (3 + 20 + 5) + 2 * (12 + 6));
  for (const Packet& packet : packets) {
    const Decoded decoded = decode(encoded(packet), test_key, test_pair, packet.receiver);
    CHECK(decoded.verdict == Verdict::accepted);
    CHECK(decoded.packet == packet);
  }
}

// All combinations of kind, roles and payload, also those that no enumeration names: `encode` takes
// exactly those listed, and with a right tag `decode` calls all others malformed.
void test_all_other_payloads_are_malformed() {
  const auto packets = all_sayings();
  std::size_t legal = 0;
  for (unsigned kind = 0; kind < 8; ++kind) {
    for (unsigned roles = 0; roles < 256; ++roles) {
      for (unsigned payload = 0; payload < 256; ++payload) {
        Packet packet = packets[0];
        packet.kind = static_cast<PacketKind>(kind);
        packet.sender = static_cast<Role>(roles & 15);
        packet.receiver = static_cast<Role>(roles >> 4);
        packet.payload = static_cast<std::uint8_t>(payload);
        Bytes bytes = encoded(packets[0]);
        const Bytes before = bytes;
        const bool said = encode(packet, test_key, bytes);
        CHECK(said || bytes == before);
        legal += said;
        if (said) continue;
        put(bytes, kind_field, kind);
        put(bytes, roles_field, roles);
        put(bytes, payload_field, payload);
        put(bytes, tag_field, palmbots::siphash24(test_key, std::span(bytes).first(tagged_size)));
        CHECK(verdict_of(bytes, packet.receiver) == Verdict::malformed);
      }
    }
  }
  CHECK(legal == packets.size());
  for (const Packet& packet : packets) CHECK(well_formed(packet));
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

void test_payloads_and_back() {
  for (const MessageKind message :
       {MessageKind::tilt_up, MessageKind::tilt_down, MessageKind::ack}) {
    CHECK(means(PacketKind::message, payload(message)));
    CHECK(message_of(payload(message)) == message);
  }
  for (const char letter : {'I', 'R', 'G', 'D', 'W'}) {
    for (const bool stopped : {false, true}) {
      for (const bool ready : {false, true}) {
        const auto byte = payload(Beacon{letter, stopped, ready});
        CHECK(means(PacketKind::beacon, byte));
        const auto [said, at_rest, at_ready] = beacon_of(byte);
        CHECK(said == letter && at_rest == stopped && at_ready == ready);
      }
    }
  }
  for (const Sign sign : {Sign::negative, Sign::zero, Sign::positive}) {
    for (const bool shallow : {false, true}) {
      const auto byte = payload(SignWord{sign, shallow});
      CHECK(means(PacketKind::sign, byte) == (sign != Sign::zero || !shallow));
      CHECK(sign_of(byte).sign == sign && sign_of(byte).shallow == shallow);
    }
  }
  for (const Palm palm : {Palm::steep, Palm::shallow}) {
    for (const Sign sign : {Sign::negative, Sign::zero, Sign::positive}) {
      for (const bool palm_at_target : {false, true}) {
        const auto byte = payload(Centralized::Report{sign, palm, palm_at_target});
        CHECK(means(PacketKind::report, byte));
        const auto report = report_of(byte);
        CHECK(report.sign == sign && report.palm == palm &&
              report.palm_at_target == palm_at_target);
      }
    }
    for (const Move move : {Move::hold, Move::away, Move::closer}) {
      const auto byte = payload(Command{palm, move});
      CHECK(means(PacketKind::command, byte));
      CHECK((command_of(byte) == Command{palm, move}));
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
  for (const Packet& packet : all_sayings()) {
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
  test_payloads_and_back();
  test_every_truncation_and_extension();
  test_every_flip_of_one_bit_and_of_two();
  test_packets_for_another_receiver_pair_or_key_are_rejected();
  test_comparison_of_tags_covers_all_bits();
}
