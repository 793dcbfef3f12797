// SPDX-License-Identifier: Apache-2.0
// There is none, so it never answers.
#include "../board.hpp"

namespace palmbots::board {

void start_motor_board() {}
void write_motor_board(std::int16_t, std::int16_t) {}
bool motor_board_answers() { return false; }

}  // namespace palmbots::board
