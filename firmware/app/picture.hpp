// SPDX-License-Identifier: Apache-2.0
// What the 25 LEDs show. The upper three rows are a symbol of the mode. The fourth row is the fault
// code as a binary number in its four right LEDs; its left LED shines if the fault is one of the board
// (BoardFault) and not one of the wire. The bottom row shows where the object lies: left −, middle 0,
// right +.
#pragma once

#include <cstdint>

#include "board_fault.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/wire/robot_mode.hpp"

namespace palmbots::app {

namespace detail {

// 15 characters, row by row.
constexpr std::uint32_t symbol(const char* rows) {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < 15; ++i) bits |= (rows[i] == '#' ? 1U : 0U) << i;
  return bits;
}

constexpr std::uint32_t symbols[wire::robot_modes] = {
    symbol("..............."),  // off
    symbol(".......#......."),  // disarmed
    symbol(".###..#.#..###."),  // armed
    symbol(".###..###..###."),  // ready
    symbol("..#...###.#.#.#"),  // carrying
    symbol(".#.#..#.#..#.#."),  // holding
    symbol("....##..#..##.."),  // done
    symbol("###############"),  // stopped
    symbol(".#.#...#...#.#."),  // fault
};

}  // namespace detail

constexpr std::uint32_t fault_row(unsigned code, bool is_of_board) {
  std::uint32_t bits = is_of_board ? 1U : 0U;
  for (unsigned i = 0; i < 4; ++i) bits |= (code >> (3 - i) & 1U) << (1 + i);
  return bits << 15;
}

constexpr std::uint32_t picture_of(wire::RobotMode mode, wire::FaultCode code, BoardFault fault,
                                   bool has_contact, Sign sign) {
  const bool is_of_board = fault != BoardFault::none;
  const unsigned number = is_of_board ? static_cast<unsigned>(fault) : static_cast<unsigned>(code);
  const std::uint32_t place = has_contact ? 1U << (2 + 2 * static_cast<int>(sign)) : 0U;
  return detail::symbols[static_cast<unsigned>(mode)] | fault_row(number, is_of_board) |
         place << 20;
}

}  // namespace palmbots::app
