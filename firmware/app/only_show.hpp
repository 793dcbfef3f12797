// SPDX-License-Identifier: Apache-2.0
// A board that cannot run shows why, and does nothing else.
#pragma once

#include "../board/board.hpp"
#include "picture.hpp"

namespace palmbots::app {

[[noreturn]] inline void only_show(BoardFault fault) {
  board::start_ticks(10000);
  board::show(picture_of(wire::RobotMode::fault, wire::FaultCode::none, fault, false, Sign::zero));
  while (true) {
    board::sleep();
    if (board::take_slot()) board::next_row();
  }
}

}  // namespace palmbots::app
