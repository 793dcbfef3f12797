// SPDX-License-Identifier: Apache-2.0
// TWIM0: a motor board at the I²C address 0x10. From register 0 on it takes, for each wheel, the
// direction (0 forward, 1 backward) and the speed (0 to 255).
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"
#include "registers.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t address = 0x10, length = 5;

std::uint8_t command[length];
bool is_under_way, answers = true;
unsigned patience;  // calls for which a transfer may last

void look() {
  if (!is_under_way) return;
  const bool failed = TWIM0::EVENTS_ERROR != 0;
  if (failed) {
    TWIM0::EVENTS_ERROR = 0;
    TWIM0::ERRORSRC = 0b111;  // writing ones clears it
    answers = false;
    TWIM0::TASKS_STOP = 1;
  }
  if (TWIM0::EVENTS_STOPPED != 0) {
    TWIM0::EVENTS_STOPPED = 0;
    is_under_way = false;
    if (!failed && TWIM0::TXD_AMOUNT == length) answers = true;
  } else if (patience == 0) {  // the bus is stuck
    answers = false;
    TWIM0::ENABLE = 0;
    TWIM0::ENABLE = 6;
    is_under_way = false;
  } else {
    --patience;
  }
}

}  // namespace

void start_motor_board() {
  pins::configure(pins::scl, pins::open_drain);
  pins::configure(pins::sda, pins::open_drain);
  TWIM0::PSEL_SCL = pins::scl;
  TWIM0::PSEL_SDA = pins::sda;
  TWIM0::FREQUENCY = 0x01980000;  // 100 kbit/s
  TWIM0::ADDRESS = address;
  TWIM0::SHORTS = 1U << 9;  // LASTTX stops
  TWIM0::ENABLE = 6;
}

void write_motor_board(std::int16_t left, std::int16_t right) {
  look();
  if (is_under_way) return;
  const auto magnitude = [](std::int16_t speed) {
    return static_cast<std::uint8_t>(speed < 0 ? -speed : speed);
  };
  command[0] = 0;
  command[1] = left < 0 ? 1 : 0;
  command[2] = magnitude(left);
  command[3] = right < 0 ? 1 : 0;
  command[4] = magnitude(right);
  TWIM0::TXD_PTR = address_of(command);
  TWIM0::TXD_MAXCNT = length;
  TWIM0::EVENTS_STOPPED = 0;
  TWIM0::TASKS_STARTTX = 1;
  is_under_way = true;
  patience = 2;
}

bool motor_board_answers() {
  look();
  return answers;
}

}  // namespace palmbots::board
