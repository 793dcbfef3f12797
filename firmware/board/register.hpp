// SPDX-License-Identifier: Apache-2.0
// A register of a peripheral at a fixed address.
//
// Each access is a single one, in the order of the program. The barriers keep the compiler from moving
// a store out of a loop or past another access: GCC 12 may otherwise emit one volatile store twice.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palmbots::board {

inline void barrier() { asm volatile("" ::: "memory"); }

inline void store(std::uint32_t address, std::uint32_t value) {
  barrier();
  *reinterpret_cast<volatile std::uint32_t*>(address) = value;
  barrier();
}

inline std::uint32_t load(std::uint32_t address) {
  barrier();
  const std::uint32_t value = *reinterpret_cast<volatile std::uint32_t*>(address);
  barrier();
  return value;
}

template <std::uint32_t address>
struct Register {
  const Register& operator=(std::uint32_t value) const {
    store(address, value);
    return *this;
  }
  operator std::uint32_t() const { return load(address); }
  static constexpr std::uint32_t at = address;
};

// Several registers of a kind, `step` bytes apart.
template <std::uint32_t first, std::uint32_t step>
struct Registers {
  struct One {
    std::uint32_t address;
    const One& operator=(std::uint32_t value) const {
      store(address, value);
      return *this;
    }
    operator std::uint32_t() const { return load(address); }
  };
  constexpr One operator[](std::uint32_t number) const { return {first + step * number}; }
};

// The address of a buffer, as a peripheral takes it.
inline std::uint32_t address_of(const volatile void* buffer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(buffer));
}

}  // namespace palmbots::board
