// SPDX-License-Identifier: Apache-2.0
// Pulses as a frame.
#include "../board.hpp"
#include "line.hpp"

namespace palmbots::board {

void start_servos() {}

void write_servos(const Pulses& pulses) {
  std::uint8_t content[6];
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    content[2 * i] = static_cast<std::uint8_t>(pulses[i] & 255);
    content[2 * i + 1] = static_cast<std::uint8_t>(pulses[i] >> 8);
  }
  line::write(line::Kind::pulses, content);
}

}  // namespace palmbots::board
