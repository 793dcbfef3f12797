// SPDX-License-Identifier: Apache-2.0
// What benchmarks/bench_wire.py counts the instructions of: each function is called CALLS times.
#include <cstdint>
#include <cstdlib>

#include "palmbots/wire/endpoint.hpp"

using namespace palmbots::wire;

// For all to see, so that no compiler takes them for constants.
Key key{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
std::uint16_t pair = 0xC0DE;
const Payload request =
    payload_of(State{Language::beacons, palmbots::MessageKind::tilt_up, RobotMode::carrying});
Packet packet{PacketKind::state, Role::left, Role::right, pair, {5, 1000}, {7, 900}, request};
Bytes written;
Bytes given;
Verdict verdict;

namespace {

constexpr int calls = 100;
Endpoint sender({key, pair, Role::left}, 5);
Endpoint receiver({key, pair, Role::right}, 7);

void judge() { verdict = decode(given, key, pair, Role::right).verdict; }

}  // namespace

extern "C" {
[[gnu::noinline]] void count_encode() { encode(packet, key, written); }
[[gnu::noinline]] void count_decode_accepted() { judge(); }
[[gnu::noinline]] void count_decode_bad_tag_in_first_byte() { judge(); }
[[gnu::noinline]] void count_decode_bad_tag_in_last_byte() { judge(); }
[[gnu::noinline]] void count_decode_wrong_pair() { judge(); }
[[gnu::noinline]] void count_send() {
  sender.send(Role::right, PacketKind::state, request, written);
}
[[gnu::noinline]] void count_receive() { verdict = receiver.receive(written).verdict; }
}

int main() {
  const auto expect = [](Verdict expected) {
    if (verdict != expected) std::abort();
  };
  for (int i = 0; i < calls; ++i) {
    count_encode();
    given = written;
    count_decode_accepted();
    expect(Verdict::accepted);
    given[tag_field.offset] ^= 1;
    count_decode_bad_tag_in_first_byte();
    expect(Verdict::bad_tag);
    given = written;
    given[packet_size - 1] ^= 1;
    count_decode_bad_tag_in_last_byte();
    expect(Verdict::bad_tag);
    given = written;
    given[pair_field.offset] ^= 1;
    count_decode_wrong_pair();
    expect(Verdict::wrong_pair);
  }
  // The two ends meet, so that the receiver accepts what is sent.
  receiver.send(Role::left, PacketKind::hello, payload_of(Hello{}), written);
  sender.receive(written);
  for (int i = 0; i < calls; ++i) {
    count_send();
    count_receive();
    expect(Verdict::accepted);
  }
}
