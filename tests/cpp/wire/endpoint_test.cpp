// SPDX-License-Identifier: Apache-2.0
// Two ends of a wire that loses, repeats and reorders, with boots and with a stranger who plays
// back whatever was ever sent; and many forged, replayed and corrupted packets.
//
// endpoint_test [PACKETS]   PACKETS: of each of these three kinds; 200000 if not given
#include "palmbots/wire/endpoint.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "support/check.hpp"
#include "support/wire_packets.hpp"

using namespace palmbots::wire;

namespace {

constexpr Identity left_end{test_key, test_pair, Role::left};
constexpr Identity right_end{test_key, test_pair, Role::right};
constexpr Identity station_end{test_key, test_pair, Role::station};

Bytes sent(Endpoint& from, Role to, PacketKind kind, const Payload& payload) {
  Bytes bytes{};
  CHECK(from.send(to, kind, payload, bytes));
  return bytes;
}

// Two ends just booted, made acquainted by one hello each way and one back.
struct Acquainted {
  Endpoint left{left_end, 4};
  Endpoint right{right_end, 9};

  Acquainted() {
    CHECK(right.receive(sent(left, Role::right, PacketKind::hello, up)).verdict ==
          Verdict::no_session);
    CHECK(left.receive(sent(right, Role::left, PacketKind::hello, up)).verdict ==
          Verdict::accepted);
    CHECK((left.heard(Role::right) == SequenceNumber{9, 1} &&
           right.heard(Role::left) == SequenceNumber{4, 1}));
  }
};

void test_packets_are_accepted_after_one_round_trip() {
  Acquainted ends;
  const Decoded got = ends.right.receive(sent(ends.left, Role::right, PacketKind::state, request));
  CHECK(got.verdict == Verdict::accepted);
  CHECK((got.packet ==
         Packet{PacketKind::state, Role::left, Role::right, test_pair, {4, 2}, {9, 1}, request}));
  CHECK(ends.right.count(Verdict::accepted) == 1 && ends.right.count(Verdict::no_session) == 1);
}

// Both boot at once and their first packets cross: the answers are accepted on both sides.
void test_crossing_hellos() {
  Endpoint left(left_end, 1);
  Endpoint right(right_end, 1);
  const Bytes from_left = sent(left, Role::right, PacketKind::hello, up);
  const Bytes from_right = sent(right, Role::left, PacketKind::hello, up);
  CHECK(left.receive(from_right).verdict == Verdict::no_session);
  CHECK(right.receive(from_left).verdict == Verdict::no_session);
  CHECK(left.receive(sent(right, Role::left, PacketKind::state, request)).verdict ==
        Verdict::accepted);
  CHECK(right.receive(sent(left, Role::right, PacketKind::state, request)).verdict ==
        Verdict::accepted);
}

// The receiver reboots and forgets its window: what it took before the boot is not taken again.
void test_what_was_sent_before_a_boot_stays_out() {
  Acquainted ends;
  std::vector<Bytes> tape;
  for (int i = 0; i < 50; ++i) {
    tape.push_back(sent(ends.left, Role::right, PacketKind::state, request));
    CHECK(ends.right.receive(tape.back()).verdict == Verdict::accepted);
  }
  ends.right = Endpoint(right_end, 10);
  for (int pass = 0; pass < 2; ++pass) {
    for (const Bytes& bytes : tape) {
      CHECK(ends.right.receive(bytes).verdict ==
            (pass == 0 ? Verdict::no_session : Verdict::stale));
    }
  }
  // The partner hears of the boot, and they go on.
  CHECK(ends.left.receive(sent(ends.right, Role::left, PacketKind::state, idle)).verdict ==
        Verdict::accepted);
  CHECK(ends.right.receive(sent(ends.left, Role::right, PacketKind::state, request)).verdict ==
        Verdict::accepted);
}

// One's own packet thrown back is for somebody else; the station keeps the two robots apart.
void test_reflection_and_station() {
  Acquainted ends;
  CHECK(ends.left.receive(sent(ends.left, Role::right, PacketKind::state, idle)).verdict ==
        Verdict::wrong_receiver);
  Endpoint station(station_end, 3);
  const Bytes early = sent(ends.left, Role::station, PacketKind::hello, up);
  for (int i = 0; i < 5; ++i) sent(ends.right, Role::station, PacketKind::hello, up);
  CHECK(station.receive(sent(ends.right, Role::station, PacketKind::hello, up)).verdict ==
        Verdict::no_session);
  CHECK(station.receive(early).verdict == Verdict::no_session);  // an older number, another sender
  CHECK(ends.left.receive(sent(station, Role::left, PacketKind::command, up)).verdict ==
        Verdict::accepted);
  CHECK(station.receive(sent(ends.left, Role::station, PacketKind::report, Payload{1})).verdict ==
        Verdict::accepted);
}

// What goes to the station leaves no gap in the numbers to the partner, so these can be control
// ticks.
void test_each_receiver_has_a_sequence_of_its_own() {
  const auto number = [](const Bytes& bytes) { return get<std::uint32_t>(bytes, sequence_field); };
  Endpoint left(left_end, 4);
  for (std::uint32_t tick = 10; tick < 20; ++tick) {
    left.skip_to(Role::right, tick);
    CHECK(number(sent(left, Role::right, PacketKind::state, request)) == tick);
    CHECK(number(sent(left, Role::station, PacketKind::hello, up)) == tick - 9);
  }
}

// A station that starts on another laptop, with a lower count of boots, learns from the robots which
// epoch they know. Neither damage nor repetition raises that number, nor does what is for others.
void test_an_end_that_is_behind_learns_its_epoch() {
  Endpoint robot(left_end, 2);
  Endpoint before(station_end, 7);
  robot.receive(sent(before, Role::left, PacketKind::hello, up));
  Endpoint station(station_end, 1);
  CHECK(station.session(Role::left).claimed_epoch() == 0);
  CHECK(robot.receive(sent(station, Role::left, PacketKind::operate, Payload{0})).verdict ==
        Verdict::stale);
  Bytes bytes = sent(robot, Role::station, PacketKind::hello, up);
  Bytes damaged = bytes;
  damaged[heard_epoch_field.offset] ^= 0x40;
  CHECK(station.receive(damaged).verdict == Verdict::bad_tag);
  CHECK(station.session(Role::left).claimed_epoch() == 0);
  CHECK(station.receive(bytes).verdict == Verdict::no_session);
  CHECK(station.session(Role::left).claimed_epoch() == 7);
  CHECK(station.session(Role::right).claimed_epoch() == 0);
  station = Endpoint(station_end, 8);
  CHECK(robot.receive(sent(station, Role::left, PacketKind::hello, up)).verdict ==
        Verdict::no_session);
  CHECK(station.receive(sent(robot, Role::station, PacketKind::hello, up)).verdict ==
        Verdict::accepted);
  CHECK(station.session(Role::left).claimed_epoch() == 8);
}

// A state and a phase of one tick have the same number, and either may overtake the other.
void test_phases_have_a_session_of_their_own() {
  Acquainted ends;
  const Payload phase = payload_of(State{Language::phases, palmbots::MessageKind::docking});
  const auto verdict = [&](const Bytes& bytes) { return ends.right.receive(bytes).verdict; };
  ends.left.skip_to(Role::right, 50);
  ends.left.skip_to(Role::right, 50, PacketKind::phase);
  const Bytes state = sent(ends.left, Role::right, PacketKind::state, request);
  const Bytes first = sent(ends.left, Role::right, PacketKind::phase, phase);
  const Bytes second = sent(ends.left, Role::right, PacketKind::phase, phase);
  CHECK(get<std::uint32_t>(state, sequence_field) == 50);
  CHECK(get<std::uint32_t>(first, sequence_field) == 50);
  CHECK(verdict(second) == Verdict::no_session);  // no phase of the right end has been heard
  CHECK(verdict(first) == Verdict::stale && verdict(state) == Verdict::accepted);
  CHECK(ends.left.receive(sent(ends.right, Role::left, PacketKind::phase, phase)).verdict ==
        Verdict::accepted);
  CHECK(verdict(sent(ends.left, Role::right, PacketKind::phase, phase)) == Verdict::accepted);
}

void test_invalid_packets_are_not_sent() {
  Endpoint left(left_end, 1);
  Bytes bytes{};
  CHECK(!left.send(Role::left, PacketKind::hello, up, bytes));
  CHECK(!left.send(Role::station, PacketKind::state, idle, bytes));
  CHECK(!left.send(Role::right, PacketKind::state, Payload{0x66}, bytes));
  CHECK(bytes == Bytes{});
  // Nothing of this has used up a number.
  CHECK(left.send(Role::right, PacketKind::state, idle, bytes));
  CHECK(decode(bytes, test_key, test_pair, Role::right).packet.sent.sequence == 1);
}

// Nor to anybody unheard of. At compile time, where reading past the windows would be an error.
constexpr bool sent_to_nobody() {
  Endpoint left(left_end, 1);
  Bytes bytes{};
  return left.send(static_cast<Role>(3), PacketKind::hello, up, bytes);
}
static_assert(!sent_to_nobody());

// An endpoint that has used all numbers of an epoch stops sending, and continues in the next epoch.
void test_endpoint_without_numbers_stops_until_the_next_epoch() {
  Acquainted ends;
  ends.left = Endpoint(left_end, 4, 0xFFFFFFFF);
  CHECK(ends.right.receive(sent(ends.left, Role::right, PacketKind::hello, up)).verdict ==
        Verdict::no_session);
  Bytes bytes{};
  CHECK(!ends.left.send(Role::right, PacketKind::hello, up, bytes) && bytes == Bytes{});
  ends.left = Endpoint(left_end, 5);
  CHECK(ends.right.receive(sent(ends.left, Role::right, PacketKind::hello, up)).verdict ==
        Verdict::no_session);
  CHECK((ends.right.heard(Role::left) == SequenceNumber{5, 1}));
}

// An endpoint that has not counted its boot neither sends nor accepts packets that acknowledge
// nothing.
void test_endpoint_in_epoch_zero_neither_sends_nor_accepts() {
  Endpoint left(left_end, 0);
  Endpoint right(right_end, 1);
  Bytes bytes{};
  CHECK(!left.send(Role::right, PacketKind::hello, up, bytes));
  CHECK(left.receive(sent(right, Role::left, PacketKind::state, request)).verdict ==
        Verdict::no_session);
}

// An end whose counter has gone back is not what its partner talks to, and is not heard by it.
void test_a_counter_that_went_back() {
  Acquainted ends;
  ends.left = Endpoint(left_end, 3);
  CHECK(ends.left.receive(sent(ends.right, Role::left, PacketKind::state, request)).verdict ==
        Verdict::no_session);
  CHECK(ends.right.receive(sent(ends.left, Role::right, PacketKind::state, request)).verdict ==
        Verdict::stale);
}

// The worst channel: every packet ever sent may arrive at any time and repeatedly, while the
// endpoints boot. Accepted packets were sent by the partner after this endpoint's boot, and are
// accepted once each and in order.
void test_random_order_of_delivery_with_boots() {
  struct Sent {
    Bytes bytes;
    int at;
  };
  RandomWords dice(1);
  for (int run = 0; run < 20; ++run) {
    std::uint32_t epoch[2] = {1, 1};
    Endpoint ends[2] = {Endpoint(left_end, 1), Endpoint(right_end, 1)};
    std::vector<Sent> tapes[2];     // by sender
    int booted[2] = {0, 0};         // when
    int accepted_last[2] = {0, 0};  // when the newest that was accepted had been sent, by receiver
    std::uint32_t accepted = 0;
    for (int now = 1; now < 3000; ++now) {
      const std::uint32_t end = dice.below(2);
      const Role other = end == 0 ? Role::right : Role::left;
      std::vector<Sent>& tape = tapes[1 - end];
      switch (dice.below(8)) {
        case 0:
          if (dice.below(20) != 0) break;
          ends[end] = Endpoint(end == 0 ? left_end : right_end, ++epoch[end]);
          booted[end] = now;
          break;
        case 1:
        case 2:
        case 3:
          tapes[end].push_back({sent(ends[end], other, PacketKind::state, request), now});
          break;
        default: {
          if (tape.empty()) break;
          const auto size = static_cast<std::uint32_t>(tape.size());
          const std::uint32_t back = dice.below(2) == 0 ? dice.below(size) : dice.below(3) % size;
          const Sent& packet = tape[size - 1 - back];
          if (ends[end].receive(packet.bytes).verdict != Verdict::accepted) break;
          CHECK(packet.at > booted[end]);
          CHECK(packet.at > accepted_last[end]);
          accepted_last[end] = packet.at;
          ++accepted;
        }
      }
    }
    CHECK(accepted > 100);  // they did talk
    for (const Endpoint& end : ends) CHECK(end.count(Verdict::accepted) <= accepted);
  }
}

std::uint32_t turned_away(const Endpoint& end) {
  std::uint32_t sum = 0;
  for (std::size_t i = 1; i < verdict_count; ++i) sum += end.count(static_cast<Verdict>(i));
  return sum;
}

// Who does not know the key gets one of 2⁶⁴ tags right: in a million tries with chance 5 · 10⁻¹⁴.
void test_many_forged_packets_are_rejected(std::uint32_t packets) {
  Acquainted ends;
  RandomWords dice(2);
  for (std::uint32_t i = 0; i < packets; ++i) {
    Bytes bytes = sent(ends.left, Role::right, PacketKind::state, request);
    put(bytes, tag_field, std::uint64_t{dice.word()} << 32 | dice.word());
    CHECK(ends.right.receive(bytes).verdict == Verdict::bad_tag);
  }
  CHECK(ends.right.count(Verdict::bad_tag) == packets);
  CHECK(ends.right.count(Verdict::accepted) == 0);
}

// Every packet of a long talk again, in random order: none is new. No chance is involved.
void test_many_replayed_packets_are_rejected(std::uint32_t packets) {
  Acquainted ends;
  std::vector<Bytes> tape;
  std::vector<Packet> said;
  for (int i = 0; i < 1000; ++i) {
    tape.push_back(sent(ends.left, Role::right, PacketKind::state, request));
    const Decoded decoded = ends.right.receive(tape.back());
    CHECK(decoded.verdict == Verdict::accepted);
    CHECK(decoded.packet.sent == ends.left.newest(Role::right));
    said.push_back(decoded.packet);
  }
  RandomWords dice(3);
  for (std::uint32_t i = 0; i < packets; ++i) {
    const std::uint32_t which = dice.below(1000);
    const Decoded decoded = ends.right.receive(tape[which]);
    CHECK(decoded.verdict == Verdict::stale && decoded.packet == said[which]);
  }
  CHECK(ends.right.count(Verdict::stale) == packets);
  CHECK(ends.right.count(Verdict::accepted) == 1000);
}

// A packet never seen before, with a burst of noise somewhere in it, sometimes cut or too long.
void test_many_corrupted_packets_are_rejected(std::uint32_t packets) {
  Acquainted ends;
  RandomWords dice(4);
  for (std::uint32_t i = 0; i < packets; ++i) {
    const Bytes good = sent(ends.left, Role::right, PacketKind::state, request);
    std::array<std::uint8_t, packet_size + 4> bytes{};
    std::copy(good.begin(), good.end(), bytes.begin());
    const std::uint32_t first = dice.below(packet_size);
    const std::uint32_t last = first + dice.below(packet_size - first);
    bytes[first] ^= static_cast<std::uint8_t>(1 + dice.below(255));
    for (std::uint32_t k = first + 1; k <= last; ++k) {
      bytes[k] ^= static_cast<std::uint8_t>(dice.word());
    }
    const std::size_t size = dice.below(8) == 0 ? dice.below(bytes.size() + 1) : packet_size;
    CHECK(ends.right.receive(std::span(bytes).first(size)).verdict != Verdict::accepted);
  }
  CHECK(ends.right.count(Verdict::accepted) == 0);
  CHECK(turned_away(ends.right) == packets + 1);  // and the hello
  for (const Verdict verdict : {Verdict::wrong_version, Verdict::too_short, Verdict::too_long,
                                Verdict::wrong_pair, Verdict::wrong_receiver, Verdict::bad_tag}) {
    CHECK(ends.right.count(verdict) > packets / 1000);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto packets =
      static_cast<std::uint32_t>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 200000);
  test_packets_are_accepted_after_one_round_trip();
  test_crossing_hellos();
  test_what_was_sent_before_a_boot_stays_out();
  test_reflection_and_station();
  test_each_receiver_has_a_sequence_of_its_own();
  test_an_end_that_is_behind_learns_its_epoch();
  test_phases_have_a_session_of_their_own();
  test_invalid_packets_are_not_sent();
  test_endpoint_without_numbers_stops_until_the_next_epoch();
  test_endpoint_in_epoch_zero_neither_sends_nor_accepts();
  test_a_counter_that_went_back();
  test_random_order_of_delivery_with_boots();
  test_many_forged_packets_are_rejected(packets);
  test_many_replayed_packets_are_rejected(packets);
  test_many_corrupted_packets_are_rejected(packets);
}
