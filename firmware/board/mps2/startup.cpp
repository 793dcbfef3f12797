// SPDX-License-Identifier: Apache-2.0
// From the reset to the program, and sleep.
#include "../board.hpp"
#include "../cortex_m4.hpp"
#include "line.hpp"

namespace {

constexpr std::size_t interrupts = 32;

}  // namespace

extern "C" [[gnu::section(".vectors"), gnu::used]] constinit const auto vectors =
    palmbots::board::make_vectors<interrupts>();

namespace palmbots::board {

void start() { line::start(); }

void sleep() { wait_for_interrupt(); }

}  // namespace palmbots::board
