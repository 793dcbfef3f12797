// SPDX-License-Identifier: Apache-2.0
// PWM0: a pulse for the palm, one for each wheel and one for the arm, every 20 ms.
//
// The peripheral reads the widths from memory when a period begins. So the program writes into one of
// two buffers and then hands it over.
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"
#include "registers.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t period_us = 20000;
constexpr std::uint16_t high_first = 0x8000;  // the output is high until the width is over

std::uint16_t widths[2][4];
unsigned free_buffer;
Pulses newest;

void hand_over() {
  PWM0::SEQ0_PTR = address_of(widths[free_buffer]);
  PWM0::TASKS_SEQSTART[0] = 1;
  free_buffer = 1 - free_buffer;
}

}  // namespace

void start_servos() {
  std::uint32_t number = 0;
  for (const std::uint8_t pin :
       {pins::palm_servo, pins::left_wheel, pins::right_wheel, pins::arm_servo}) {
    pins::clear(pin);
    pins::configure(pin, pins::output);
    PWM0::PSEL_OUT[number++] = pin;
  }
  PWM0::ENABLE = 1;
  PWM0::MODE = 0;       // counts up
  PWM0::PRESCALER = 4;  // 16 MHz / 2⁴
  PWM0::COUNTERTOP = period_us;
  PWM0::DECODER = 2;  // one width for each output
  PWM0::LOOP = 0;
  PWM0::SEQ0_REFRESH = 0;
  PWM0::SEQ0_ENDDELAY = 0;
  PWM0::SEQ0_CNT = 4;
  newest = {};
  for (std::uint16_t& width : widths[free_buffer]) width = high_first;
  hand_over();
}

void write_servos(const Pulses& pulses) {
  if (pulses == newest) return;
  newest = pulses;
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    widths[free_buffer][i] = static_cast<std::uint16_t>(high_first | pulses[i]);
  }
  hand_over();
}

}  // namespace palmbots::board
