// SPDX-License-Identifier: Apache-2.0
// Packets for the tests of the wire: one of everything that can be said.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "palmbots/base/philox.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots::wire {

inline constexpr Key test_key = {0x0f, 0x1e, 0x2d, 0x3c, 0x4b, 0x5a, 0x69, 0x78,
                                 0x87, 0x96, 0xa5, 0xb4, 0xc3, 0xd2, 0xe1, 0xf0};
inline constexpr std::uint16_t test_pair = 0xC0DE;

// Written out, not asked of `well_formed`: every kind, who may say it to whom, every payload.
inline std::vector<Packet> all_sayings() {
  const Role l = Role::left, r = Role::right, s = Role::station;
  std::vector<Packet> packets;
  const auto say = [&](PacketKind kind, Role from, Role to, std::vector<int> payloads) {
    for (const int payload : payloads) {
      packets.push_back({kind,
                         from,
                         to,
                         test_pair,
                         {0x010203, 0xfedcba98},
                         {0x0a0b0c, 0x12345678},
                         static_cast<std::uint8_t>(payload)});
    }
  };
  for (const Role from : {l, r, s}) {
    for (const Role to : {l, r, s}) {
      if (from != to) say(PacketKind::hello, from, to, {0});
    }
  }
  for (const auto& [from, to] : {std::pair{l, r}, std::pair{r, l}}) {
    say(PacketKind::message, from, to, {1, 2, 3});
    say(PacketKind::beacon, from, to, {'I',  'R',  'G',  'D',  'W',  'i',  'r',  'g',  'd',  'w',
                                       0xC9, 0xD2, 0xC7, 0xC4, 0xD7, 0xE9, 0xF2, 0xE7, 0xE4, 0xF7});
    say(PacketKind::sign, from, to, {0, 1, 2, 4, 6});
  }
  for (const Role robot : {l, r}) {
    say(PacketKind::report, robot, s, {0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14});
    say(PacketKind::command, s, robot, {0, 1, 2, 3, 4, 5});
  }
  return packets;
}

// Random numbers for tests: the words of Philox one after the other.
class RandomWords {
 public:
  explicit RandomWords(std::uint64_t seed) : seed_(seed) {}

  std::uint32_t word() {
    if (used_ == 4) {
      words_ = draw(seed_, tick_++, 0U);
      used_ = 0;
    }
    return words_[used_++];
  }

  std::uint32_t below(std::uint32_t n) { return word() % n; }

 private:
  std::uint64_t seed_;
  std::uint32_t tick_ = 0;
  Words words_{};
  std::size_t used_ = 4;
};

}  // namespace palmbots::wire
