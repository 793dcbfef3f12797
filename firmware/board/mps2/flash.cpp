// SPDX-License-Identifier: Apache-2.0
// QEMU's board has no permanent memory: two pages that last until QEMU ends.
#include "../board.hpp"

extern "C" std::uint32_t storage_begin[];  // from the linker script; blank at power-up

namespace palmbots::board {

const std::uint32_t* page(std::size_t number) { return storage_begin + number * words_per_page; }

void write_word(std::size_t number, std::size_t word, std::uint32_t value) {
  storage_begin[number * words_per_page + word] &= value;
}

void erase_page(std::size_t number) {
  for (std::size_t i = 0; i < words_per_page; ++i) {
    storage_begin[number * words_per_page + i] = 0xFFFFFFFF;
  }
}

}  // namespace palmbots::board
