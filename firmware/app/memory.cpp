// SPDX-License-Identifier: Apache-2.0
// The functions that a compiler expects of every program, also of one without a standard library.
#include <cstddef>
#include <cstdint>

extern "C" {

void* memcpy(void* to, const void* from, std::size_t size) {
  auto* t = static_cast<std::uint8_t*>(to);
  const auto* f = static_cast<const std::uint8_t*>(from);
  for (std::size_t i = 0; i < size; ++i) {
    t[i] = f[i];
    asm volatile("" ::: "memory");  // or the compiler finds a memcpy in this loop
  }
  return to;
}

void* memmove(void* to, const void* from, std::size_t size) {
  auto* t = static_cast<std::uint8_t*>(to);
  const auto* f = static_cast<const std::uint8_t*>(from);
  if (t < f) return memcpy(to, from, size);
  for (std::size_t i = size; i > 0; --i) {
    t[i - 1] = f[i - 1];
    asm volatile("" ::: "memory");
  }
  return to;
}

void* memset(void* to, int value, std::size_t size) {
  auto* t = static_cast<std::uint8_t*>(to);
  for (std::size_t i = 0; i < size; ++i) {
    t[i] = static_cast<std::uint8_t>(value);
    asm volatile("" ::: "memory");
  }
  return to;
}

int memcmp(const void* a, const void* b, std::size_t size) {
  const auto* x = static_cast<const std::uint8_t*>(a);
  const auto* y = static_cast<const std::uint8_t*>(b);
  for (std::size_t i = 0; i < size; ++i) {
    if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
  }
  return 0;
}

// As GCC and clang call them on ARM.
void __aeabi_memcpy(void* to, const void* from, std::size_t size) { memcpy(to, from, size); }
void __aeabi_memcpy4(void* to, const void* from, std::size_t size) { memcpy(to, from, size); }
void __aeabi_memcpy8(void* to, const void* from, std::size_t size) { memcpy(to, from, size); }
void __aeabi_memmove4(void* to, const void* from, std::size_t size) { memmove(to, from, size); }
void __aeabi_memset(void* to, std::size_t size, int value) { memset(to, value, size); }
void __aeabi_memclr(void* to, std::size_t size) { memset(to, 0, size); }
void __aeabi_memclr4(void* to, std::size_t size) { memset(to, 0, size); }
void __aeabi_memclr8(void* to, std::size_t size) { memset(to, 0, size); }

}  // extern "C"
