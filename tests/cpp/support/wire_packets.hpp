// SPDX-License-Identifier: Apache-2.0
// Packets for the tests of the wire: what can be said, and a selection of it.
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

// Whether a packet with these numbers can be sent: the tables of docs/reference/wire.md, written out
// instead of asking the header under test.
inline bool can_be_said(unsigned kind, unsigned sender, unsigned receiver, const Payload& b) {
  if (sender > 2 || receiver > 2 || sender == receiver || kind > 6) return false;
  const bool from_station = sender == 2, to_station = receiver == 2;
  const bool is_short = b[1] == 0 && b[2] == 0 && b[3] == 0 && b[4] <= 1;
  switch (kind) {
    case 0: return b[4] <= 1;
    case 1:
    case 6: {
      const int language = b[1] / 16, message = b[0];
      if ((kind == 6) != (language == 4)) return false;
      const bool is_message = (language == 0 && message == 0) ||
                              (language == 1 && message >= 1 && message <= 3) ||
                              (language == 2 && message >= 1 && message <= 5) ||
                              (language == 3 && message >= 6 && message <= 10) ||
                              (language == 4 && message >= 11 && message <= 24);
      return !from_station && !to_station && is_message && b[1] % 16 <= 8 && b[2] == 0 &&
             b[3] == 0 && b[4] <= 7;
    }
    case 2:
      return to_station && b[0] % 16 <= 8 && b[0] / 16 <= 15 && b[1] % 4 <= 2 && b[1] / 16 <= 12 &&
             b[4] / 8 <= 14;
    case 3: return from_station && is_short && b[0] <= 5;
    case 4: return to_station && is_short && b[0] <= 15 && b[0] % 4 <= 2;
    case 5: return from_station && is_short && b[0] <= 5;
    default: return false;
  }
}

// Packets of every kind and direction. In each payload one byte takes every value that it can have
// there.
inline std::vector<Packet> all_sayings() {
  std::vector<Packet> packets;
  const Payload bases[] = {{1, 2, 3, 4, 0}, {1, 0x14, 0, 0, 2}, {4, 1, 2, 3, 0},    {3, 0, 0, 0, 0},
                           {1, 0, 0, 0, 0}, {1, 0, 0, 0, 0},    {12, 0x44, 0, 0, 4}};
  for (unsigned kind = 0; kind < 7; ++kind) {
    for (unsigned from = 0; from < 3; ++from) {
      for (unsigned to = 0; to < 3; ++to) {
        for (std::size_t place = 0; place < payload_size; ++place) {
          for (unsigned byte = 0; byte < 256;
               byte += kind == 0 || place == 2 || place == 3 ? 51 : 1) {
            Payload payload = bases[kind];
            payload[place] = static_cast<std::uint8_t>(byte);
            if (!can_be_said(kind, from, to, payload)) continue;
            packets.push_back({static_cast<PacketKind>(kind),
                               static_cast<Role>(from),
                               static_cast<Role>(to),
                               test_pair,
                               {0x010203, 0xfedcba98},
                               {0x0a0b0c, 0x12345678},
                               payload});
          }
        }
      }
    }
  }
  return packets;
}

// A state and its payload, as one robot sends it to the other.
inline constexpr Payload request =
    payload_of(State{Language::beacons, MessageKind::tilt_up, RobotMode::carrying});
inline constexpr Payload idle =
    payload_of(State{Language::beacons, MessageKind::tilt_down, RobotMode::carrying});
inline constexpr Payload up = payload_of(Hello{});

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
