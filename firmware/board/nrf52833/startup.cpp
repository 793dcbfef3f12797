// SPDX-License-Identifier: Apache-2.0
// From the reset to the program, the clocks, the debug port, and sleep.
#include <cstdint>

#include "../board.hpp"
#include "../cortex_m4.hpp"
#include "pins.hpp"
#include "registers.hpp"
#include "wake.hpp"

namespace {

constexpr std::size_t interrupts = 48;

}  // namespace

extern "C" [[gnu::section(".vectors"), gnu::used]] constinit const auto vectors =
    palmbots::board::make_vectors<interrupts>();

namespace palmbots::board {

namespace {

constexpr std::uint32_t open = 0x5A;
constexpr Register<0xE000ED0C> AIRCR{};
constexpr std::uint32_t restart = 0x05FA0004;

// Settings of the chip, in flash memory. They hold until the whole chip is erased.
template <class Setting>
void keep(const Setting& setting, std::uint32_t value) {
  NVMC::CONFIG = 1;
  setting = value;
  while (NVMC::READY == 0) {
  }
  NVMC::CONFIG = 0;
}

// Chips with access protection in hardware lock the debug port at a reset unless both the settings in
// flash and the program say otherwise. A locked board could be flashed only after a full erase.
void keep_debug_port_open() {
  if (UICR::APPROTECT != open) keep(UICR::APPROTECT, open);
  APPROTECT::DISABLE = open;
}

// A pin of the switches belongs to the antenna for near-field communication unless a setting says
// otherwise, which takes effect at the next reset.
void free_antenna_pins() {
  const std::uint32_t pins = UICR::NFCPINS;
  if ((pins & 1) == 0) return;
  keep(UICR::NFCPINS, pins & ~1U);
  AIRCR = restart;
  while (true) {
  }
}

}  // namespace

void start() {
  keep_debug_port_open();
  free_antenna_pins();
  // The radio needs the crystal.
  CLOCK::EVENTS_HFCLKSTARTED = 0;
  CLOCK::TASKS_HFCLKSTART = 1;
  while (CLOCK::EVENTS_HFCLKSTARTED == 0) {
  }
  for (const std::uint8_t pin : pins::led_rows) pins::configure(pin, pins::output);
  for (const std::uint8_t pin : pins::led_columns) pins::configure(pin, pins::output);
  pins::configure(pins::button_a, pins::input_pull_up);
  pins::configure(pins::button_b, pins::input_pull_up);
}

void sleep() { wait_for_interrupt(); }

}  // namespace palmbots::board
