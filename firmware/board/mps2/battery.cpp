// SPDX-License-Identifier: Apache-2.0
// The supply is never low.
#include "../board.hpp"

namespace palmbots::board {

void start_battery(std::uint16_t) {}
std::uint16_t battery_mv() { return 3300; }
bool take_brown_out() { return false; }

}  // namespace palmbots::board
