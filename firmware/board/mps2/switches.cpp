// SPDX-License-Identifier: Apache-2.0
// Switches as the world states them.
#include "../board.hpp"
#include "line.hpp"

namespace palmbots::board {

void start_switches() {}
std::uint16_t read_switches() { return line::newest_tick().switches; }

}  // namespace palmbots::board
