// SPDX-License-Identifier: Apache-2.0
// What is wrong with a board. The first four rest the wheels; the wire calls them `driver`.
#pragma once

#include <cstdint>

namespace palmbots::app {

enum class BoardFault : std::uint8_t {
  none,
  switches,  // the switches of the palm contradict each other: one is stuck
  palm,      // the palm reaches neither end: it is jammed or not plugged in
  motor,     // the motor board does not answer
  supply,    // the supply voltage broke down
  storage,   // nothing can be stored
  settings,  // the image has no settings, or damaged ones
  stranger,  // only packets of another pair, or with another key, arrive
  late,      // too many ticks come too late
};

constexpr bool rests_wheels(BoardFault fault) {
  return fault >= BoardFault::switches && fault <= BoardFault::supply;
}

}  // namespace palmbots::app
