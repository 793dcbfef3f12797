// SPDX-License-Identifier: Apache-2.0
// A whole carry in `float` on a Cortex-M4F, world and all, for QEMU's machine mps2-an386. It prints the
// trace hash on UART0, one line for each seed, and ends QEMU through semihosting.
#include <cstddef>
#include <cstdint>
#include <new>

#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/team_registry.hpp"
#include "support/paper_spec.hpp"

namespace {

using namespace palmbots;

constexpr std::uint32_t seeds = 3;

volatile std::uint32_t& uart(std::uint32_t offset) {
  return *reinterpret_cast<volatile std::uint32_t*>(0x40004000 + offset);
}

void print(char character) {
  while ((uart(4) & 1) != 0) {  // the transmit buffer is full
  }
  uart(0) = static_cast<std::uint8_t>(character);
}

void print_hash(std::uint64_t hash) {
  for (int place = 60; place >= 0; place -= 4) print("0123456789abcdef"[hash >> place & 15]);
  print('\n');
}

ResilientTeam team_of(const Spec& spec, std::uint64_t seed) {
  const PerSide<double> drift{spec.robots[left].clock_drift, spec.robots[right].clock_drift};
  return {resilient_timing_of(spec).times, drift, channel_of(spec), seed, leader_of(spec),
          Faults::of(spec, seed)};
}

[[noreturn]] void finish() {
  while ((uart(4) & 1) != 0) {  // the last character has not left
  }
  // SYS_EXIT with ADP_Stopped_ApplicationExit.
  register std::uint32_t operation asm("r0") = 0x18;
  register std::uint32_t reason asm("r1") = 0x20026;
  asm volatile("bkpt 0xAB" ::"r"(operation), "r"(reason) : "memory");
  while (true) {
  }
}

// Memory is given out and never taken back: there is enough for all carries.
alignas(8) std::byte heap[1 << 21];
std::size_t used;

}  // namespace

void* operator new(std::size_t size) {
  void* place = heap + used;
  used += (size + 7) & ~std::size_t{7};
  if (used > sizeof heap) finish();
  return place;
}
void operator delete(void*) noexcept {}
void operator delete(void*, std::size_t) noexcept {}

namespace std {
[[noreturn]] void __throw_length_error(const char*) { finish(); }
[[noreturn]] void __throw_bad_function_call() { finish(); }
}  // namespace std

extern "C" {
extern std::uint32_t stack_top[], data_from[], data_begin[], data_end[], bss_begin[], bss_end[];

[[noreturn]] void reset() {
  // The floating-point unit is off after a reset.
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU << 20;
  asm volatile("dsb\n isb" ::: "memory");
  const std::uint32_t* from = data_from;
  for (std::uint32_t* to = data_begin; to < data_end; ++to) *to = *from++;
  for (std::uint32_t* to = bss_begin; to < bss_end; ++to) *to = 0;
  uart(16) = 16;  // fastest
  uart(8) = 1;    // transmits
  const Spec spec = paper_spec();
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    Carry<float, ResilientTeam, TraceRecorder> carry(spec, seed, team_of(spec, seed),
                                                     TraceRecorder(false));
    carry.run();
    print_hash(carry.recorder().hash());
  }
  finish();
}

struct Vectors {
  std::uint32_t* stack;
  void (*handlers[15])();
};
[[gnu::section(".vectors"), gnu::used]] constinit const Vectors vectors{
    stack_top,
    {reset, finish, finish, finish, finish, finish, finish, finish, finish, finish, finish, finish,
     finish, finish, finish}};
}
