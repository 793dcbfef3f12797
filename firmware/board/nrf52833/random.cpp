// SPDX-License-Identifier: Apache-2.0
// RNG: random bytes from noise.
#include <cstdint>

#include "../board.hpp"
#include "registers.hpp"

namespace palmbots::board {

std::uint32_t random_word() {
  RNG::CONFIG = 1;  // equally many zeros and ones
  RNG::TASKS_START = 1;
  std::uint32_t word = 0;
  for (int i = 0; i < 4; ++i) {
    while (RNG::EVENTS_VALRDY == 0) {
    }
    RNG::EVENTS_VALRDY = 0;
    word = word << 8 | (RNG::VALUE & 0xFF);
  }
  RNG::TASKS_STOP = 1;
  return word;
}

}  // namespace palmbots::board
