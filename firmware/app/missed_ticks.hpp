// SPDX-License-Identifier: Apache-2.0
// How many ticks came too late: all, and those among the last 50 to 100.
#pragma once

#include <cstdint>

namespace palmbots::app {

class MissedTicks {
 public:
  // A tick that comes `elapsed` ticks after the last one.
  void count(std::uint16_t elapsed) {
    const auto late = static_cast<std::uint16_t>(elapsed - 1);
    total_ += late;
    now_ = static_cast<std::uint16_t>(now_ + late);
    if ((ticks_ += elapsed) < block) return;
    ticks_ = 0;
    before_ = now_;
    now_ = 0;
  }
  std::uint16_t recent() const { return static_cast<std::uint16_t>(before_ + now_); }
  std::uint32_t total() const { return total_; }

 private:
  static constexpr std::uint32_t block = 50;

  std::uint32_t total_ = 0;
  std::uint32_t ticks_ = 0;
  std::uint16_t before_ = 0;  // in the last block
  std::uint16_t now_ = 0;     // in this one
};

}  // namespace palmbots::app
