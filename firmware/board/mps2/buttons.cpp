// SPDX-License-Identifier: Apache-2.0
// Buttons as the world states them.
#include "../board.hpp"
#include "line.hpp"

namespace palmbots::board {

std::uint8_t read_buttons() { return line::newest_tick().buttons; }

}  // namespace palmbots::board
