// SPDX-License-Identifier: Apache-2.0
// What a program for a host needs on QEMU's Cortex-M4F beside newlib's start-up: the vectors, the
// floating-point unit, and what libstdc++ would define.
#include <cstdint>
#include <cstdlib>
#include <new>

void* operator new(std::size_t size) { return std::malloc(size); }
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }

namespace std {
[[noreturn]] void __throw_length_error(const char*) { abort(); }
[[noreturn]] void __throw_bad_function_call() { abort(); }
}  // namespace std

extern "C" {
[[noreturn]] void _mainCRTStartup();

[[noreturn]] void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU
                                                            << 20;  // the unit is off at a reset
  asm volatile("dsb\n isb" ::: "memory");
  _mainCRTStartup();
}

struct Vectors {
  std::uintptr_t stack;
  void (*reset)();
};
[[gnu::section(".vectors"), gnu::used]] constinit const Vectors vectors{0x20400000, reset};
}
