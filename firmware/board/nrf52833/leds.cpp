// SPDX-License-Identifier: Apache-2.0
// 5 × 5 LEDs. A row shines while its pin is high, a column of it while the column's pin is low.
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"
#include "registers.hpp"

namespace palmbots::board {

namespace {

constexpr unsigned size = 5;

// The pins of the columns in a port that a row of the picture leaves dark.
template <bool is_first_port>
constexpr std::uint32_t dark_pins(unsigned lit) {
  std::uint32_t found = 0;
  for (unsigned column = 0; column < size; ++column) {
    const std::uint8_t pin = pins::led_columns[column];
    if ((pin < 32) == is_first_port && (lit >> column & 1) == 0) found |= 1U << pin % 32;
  }
  return found;
}
constexpr std::uint32_t all_pins_0 = dark_pins<true>(0), all_pins_1 = dark_pins<false>(0);

std::uint32_t picture_shown;
unsigned row;

}  // namespace

void show(std::uint32_t picture) { picture_shown = picture; }

void next_row() {
  pins::clear(pins::led_rows[row]);
  row = (row + 1) % size;
  const unsigned lit = picture_shown >> (size * row) & 31;
  const std::uint32_t dark_0 = dark_pins<true>(lit), dark_1 = dark_pins<false>(lit);
  P0::OUTSET = dark_0;
  P0::OUTCLR = all_pins_0 & ~dark_0;
  P1::OUTSET = dark_1;
  P1::OUTCLR = all_pins_1 & ~dark_1;
  pins::set(pins::led_rows[row]);
}

}  // namespace palmbots::board
