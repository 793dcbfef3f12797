// SPDX-License-Identifier: Apache-2.0
// From the reset to the program, the clocks, the debug port, and sleep.
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"
#include "registers.hpp"
#include "wake.hpp"

extern "C" {
// From the linker script.
extern std::uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
void run_program();
[[noreturn]] void reset();
[[noreturn]] void unexpected();
}

namespace {

using Handler = void (*)();

struct VectorTable {
  std::uint32_t* stack;
  Handler handlers[15 + 48];
};

// No interrupt is ever taken. A fault of the processor ends in `unexpected`, and the watchdog resets.
constexpr VectorTable make_vectors() {
  VectorTable table{stack_top, {}};
  for (Handler& handler : table.handlers) handler = unexpected;
  table.handlers[0] = reset;
  return table;
}

}  // namespace

extern "C" {
[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = make_vectors();

[[noreturn]] void unexpected() {
  while (true) {
  }
}

[[noreturn]] void reset() {
  asm volatile("cpsid i" ::: "memory");
  const std::uint32_t* from = data_from;
  for (std::uint32_t* to = data_begin; to < data_end; ++to) *to = *from++;
  for (std::uint32_t* to = bss_begin; to < bss_end; ++to) *to = 0;
  run_program();
  unexpected();
}
}

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

void sleep() { asm volatile("wfi" ::: "memory"); }

}  // namespace palmbots::board
