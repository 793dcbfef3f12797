// SPDX-License-Identifier: Apache-2.0
// From the reset of a Cortex-M4 to the program, and sleep. For the `startup.cpp` of a board, and for no
// other file, because it defines functions.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {
// From the linker script.
extern std::uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
void run_program();

// A fault of the processor ends here, and the watchdog resets.
[[noreturn]] inline void unexpected() {
  while (true) {
  }
}

[[noreturn]] inline void reset() {
  asm volatile("cpsid i" ::: "memory");
  const std::uint32_t* from = data_from;
  for (std::uint32_t* to = data_begin; to < data_end; ++to) *to = *from++;
  for (std::uint32_t* to = bss_begin; to < bss_end; ++to) *to = 0;
  run_program();
  unexpected();
}
}

namespace palmbots::board {

template <std::size_t interrupts>
struct VectorTable {
  std::uint32_t* stack;
  void (*handlers[15 + interrupts])();
};

// Interrupts stay masked, so none is ever taken.
template <std::size_t interrupts>
constexpr VectorTable<interrupts> make_vectors() {
  VectorTable<interrupts> table{stack_top, {}};
  for (auto& handler : table.handlers) handler = unexpected;
  table.handlers[0] = reset;
  return table;
}

// A pending interrupt ends it although it is masked.
inline void wait_for_interrupt() { asm volatile("wfi" ::: "memory"); }

}  // namespace palmbots::board
