// SPDX-License-Identifier: Apache-2.0
// From the reset to the program, and sleep. Interrupts stay masked; a pending one ends WFI.
#include <cstdint>

#include "../board.hpp"
#include "line.hpp"

extern "C" {
extern std::uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
void run_program();
[[noreturn]] void reset();
[[noreturn]] void unexpected();
}

namespace {

using Handler = void (*)();
struct VectorTable {
  std::uint32_t* stack;
  Handler handlers[15 + 32];
};

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

void start() { line::start(); }

void sleep() { asm volatile("wfi" ::: "memory"); }

}  // namespace palmbots::board
