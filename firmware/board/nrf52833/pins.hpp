// SPDX-License-Identifier: Apache-2.0
// The pins of the BBC micro:bit v2. P0.n has the number n, P1.n the number 32 + n.
#pragma once

#include <array>
#include <cstdint>

#include "registers.hpp"

namespace palmbots::board::pins {

// Edge connector: P0, P1, P2.
inline constexpr std::uint8_t palm_servo = 2;
inline constexpr std::uint8_t left_wheel = 3;
inline constexpr std::uint8_t right_wheel = 4;
// Edge connector: P9.
inline constexpr std::uint8_t arm_servo = 9;
// Edge connector: P13, P14, P15 are rows, P8, P12, P16 columns of the switches.
inline constexpr std::array<std::uint8_t, 3> switch_rows{17, 1, 13};
inline constexpr std::array<std::uint8_t, 3> switch_columns{10, 12, 34};
// Edge connector: P19, P20.
inline constexpr std::uint8_t scl = 26;
inline constexpr std::uint8_t sda = 32;
// On the board.
inline constexpr std::uint8_t button_a = 14;
inline constexpr std::uint8_t button_b = 23;
inline constexpr std::array<std::uint8_t, 5> led_rows{21, 22, 15, 24, 19};
inline constexpr std::array<std::uint8_t, 5> led_columns{28, 11, 31, 37, 30};
inline constexpr std::uint8_t uart_txd = 6;
inline constexpr std::uint8_t uart_rxd = 40;

inline constexpr std::uint32_t input_pull_up = 0b1100;
inline constexpr std::uint32_t output = 0b11;                  // input buffer disconnected
inline constexpr std::uint32_t open_drain = 6U << 8 | 0b1101;  // S0D1 with pull-up, as I²C asks

inline void configure(std::uint8_t pin, std::uint32_t how) {
  if (pin < 32) {
    P0::PIN_CNF[pin] = how;
  } else {
    P1::PIN_CNF[pin - 32U] = how;
  }
}
inline void set(std::uint8_t pin) {
  if (pin < 32) {
    P0::OUTSET = 1U << pin;
  } else {
    P1::OUTSET = 1U << (pin - 32);
  }
}
inline void clear(std::uint8_t pin) {
  if (pin < 32) {
    P0::OUTCLR = 1U << pin;
  } else {
    P1::OUTCLR = 1U << (pin - 32);
  }
}
inline bool is_high(std::uint8_t pin) {
  return pin < 32 ? (P0::IN >> pin & 1) != 0 : (P1::IN >> (pin - 32) & 1) != 0;
}

}  // namespace palmbots::board::pins
