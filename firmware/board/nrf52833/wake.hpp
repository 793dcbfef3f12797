// SPDX-License-Identifier: Apache-2.0
// Which interrupts end the sleep.
//
// Interrupts stay masked (PRIMASK), so no handler ever runs. A pending one still ends WFI, also if it
// came just before. So no wake-up can be lost between the last look at the events and the sleep.
#pragma once

#include <cstdint>

#include "../register.hpp"

namespace palmbots::board {

// The numbers of the interrupts: the position of the peripheral on the bus.
enum class Interrupt : std::uint8_t { power = 0, radio = 1, uart = 2, twi = 3, timer0 = 8 };

inline constexpr Registers<0xE000E100, 4> NVIC_ISER{};
inline constexpr Registers<0xE000E280, 4> NVIC_ICPR{};

inline void wakes(Interrupt interrupt) { NVIC_ISER[0] = 1U << static_cast<unsigned>(interrupt); }
// To be called when the events of a peripheral have been cleared.
inline void has_been_served(Interrupt interrupt) {
  NVIC_ICPR[0] = 1U << static_cast<unsigned>(interrupt);
}

}  // namespace palmbots::board
