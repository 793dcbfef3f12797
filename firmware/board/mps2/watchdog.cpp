// SPDX-License-Identifier: Apache-2.0
// A completed tick is reported to the world, which may end QEMU if none comes.
#include "../../app/tick_record.hpp"
#include "../board.hpp"
#include "line.hpp"

namespace palmbots::board {

void start_watchdog(std::uint32_t) {}

void feed_watchdog() {
  line::write(line::Kind::done,
              {reinterpret_cast<const std::uint8_t*>(&tick_record), sizeof tick_record});
}

}  // namespace palmbots::board
