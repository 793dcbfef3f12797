// SPDX-License-Identifier: Apache-2.0
// There is no source of randomness, and nothing to collide with: the count of SysTick will do.
#include "../board.hpp"
#include "../register.hpp"

namespace palmbots::board {

std::uint32_t random_word() { return Register<0xE000E018>{} * 2654435761U + 1; }

}  // namespace palmbots::board
