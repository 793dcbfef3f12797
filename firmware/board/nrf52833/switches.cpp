// SPDX-License-Identifier: Apache-2.0
// Nine switches as a 3 × 3 matrix. A switch connects its row and its column; a diode in series keeps
// currents from taking a way round through other closed switches.
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"

namespace palmbots::board {

namespace {

// The pull-up of 13 kΩ charges a metre of cable (100 pF) in 4 µs; this waits for about 5 µs.
void let_settle() {
  for (int i = 0; i < 80; ++i) asm volatile("");
}

}  // namespace

void start_switches() {
  for (const std::uint8_t row : pins::switch_rows) {
    pins::set(row);
    pins::configure(row, pins::output);
  }
  for (const std::uint8_t column : pins::switch_columns) {
    pins::configure(column, pins::input_pull_up);
  }
}

std::uint16_t read_switches() {
  unsigned closed = 0;
  unsigned bit = 0;
  for (const std::uint8_t row : pins::switch_rows) {
    pins::clear(row);
    let_settle();
    for (const std::uint8_t column : pins::switch_columns) {
      closed |= (pins::is_high(column) ? 0U : 1U) << bit++;
    }
    pins::set(row);
  }
  return static_cast<std::uint16_t>(closed);
}

}  // namespace palmbots::board
