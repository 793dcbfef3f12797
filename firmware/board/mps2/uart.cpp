// SPDX-License-Identifier: Apache-2.0
// This board is never the station's radio.
#include "../board.hpp"

namespace palmbots::board {

void start_uart() {}
std::size_t read_uart(std::uint8_t*, std::size_t) { return 0; }
std::size_t uart_room() { return 0; }
void write_uart(const std::uint8_t*, std::size_t) {}
void serve_uart() {}

}  // namespace palmbots::board
