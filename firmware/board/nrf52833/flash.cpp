// SPDX-License-Identifier: Apache-2.0
// NVMC: the last two pages of the flash memory. A word takes 43 µs to write, a page 88 ms to erase; the
// processor stands still meanwhile.
#include <cstdint>

#include "../board.hpp"
#include "registers.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t first_page = 0x7E000, page_bytes = 0x1000;

void finish() {
  while (NVMC::READY == 0) {
  }
  NVMC::CONFIG = 0;
}

}  // namespace

const std::uint32_t* page(std::size_t number) {
  return reinterpret_cast<const std::uint32_t*>(first_page + number * page_bytes);
}

void write_word(std::size_t number, std::size_t word, std::uint32_t value) {
  NVMC::CONFIG = 1;
  barrier();
  *const_cast<volatile std::uint32_t*>(page(number) + word) = value;
  barrier();
  finish();
}

void erase_page(std::size_t number) {
  NVMC::CONFIG = 2;
  NVMC::ERASEPAGE = address_of(page(number));
  finish();
}

}  // namespace palmbots::board
