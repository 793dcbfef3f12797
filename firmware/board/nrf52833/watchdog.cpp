// SPDX-License-Identifier: Apache-2.0
// WDT: once started it cannot be stopped. It counts 32768 steps a second, also in sleep.
#include <cstdint>

#include "../board.hpp"
#include "registers.hpp"

namespace palmbots::board {

void start_watchdog(std::uint32_t limit_us) {
  // Rounded down, so that the reset comes no later than the limit.
  const auto steps = static_cast<std::uint32_t>(std::uint64_t{limit_us} * 32768 / 1000000);
  WDT::CONFIG = 1;
  WDT::CRV = steps - 1;
  WDT::RREN = 1;
  WDT::TASKS_START = 1;
}

void feed_watchdog() { WDT::RR[0] = 0x6E524635; }

}  // namespace palmbots::board
