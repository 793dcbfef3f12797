// SPDX-License-Identifier: Apache-2.0
// The two buttons; a held one connects its pin to ground.
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"

namespace palmbots::board {

std::uint8_t read_buttons() {
  return static_cast<std::uint8_t>((pins::is_high(pins::button_a) ? 0 : 1) |
                                   (pins::is_high(pins::button_b) ? 0 : 2));
}

}  // namespace palmbots::board
