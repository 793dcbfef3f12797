// SPDX-License-Identifier: Apache-2.0
// The newest tick, for a debugger or an emulator that reads the memory of the board.
#pragma once

#include <cstdint>

namespace palmbots::app {

struct TickRecord {
  std::uint32_t ticks;     // since the boot
  std::uint32_t rejected;  // packets that were copies, overtaken, or without a session
  std::uint32_t late;      // packets older than the lease
  std::uint32_t missed;    // ticks that came too late
  std::uint8_t palm;       // 0 steep, 1 shallow
  std::uint8_t move;       // 0 hold, 1 away, 2 closer
  std::uint8_t stop;       // the robot does not travel
  std::uint8_t wheels;     // they may turn
  std::uint8_t name;       // the case
  std::uint8_t waits;
  std::uint8_t awaits;   // the message that it waits for
  std::uint8_t message;  // what the first packet of the tick says
  std::uint8_t mode;
  std::uint8_t code;     // fault code of the wire
  std::uint8_t fault;    // BoardFault
  std::uint8_t assists;  // stored
  std::uint8_t packets;  // to be sent in this tick
  // In a job on the floor:
  std::uint8_t phase;            // state of the table that lifts
  std::uint8_t arm;              // 0 follows the floor, 1 reaches, 2 holds, 3 rises, 4 sinks
  std::uint8_t holds;            // stored
  std::uint8_t rejected_phases;  // modulo 256, as above
  std::uint8_t late_phases;
};

}  // namespace palmbots::app

// Outside of all functions, under a name that a debugger finds.
extern "C" palmbots::app::TickRecord tick_record;
