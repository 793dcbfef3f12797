// SPDX-License-Identifier: Apache-2.0
// Which random numbers of a carry are drawn for which purpose (base/philox.hpp).
#pragma once

#include <cstdint>

namespace palmbots {

// What a draw is for. The number is part of every published trace: append, never renumber.
struct Stream {
  enum Number : std::uint32_t {
    noise = 0,
    tactile = 1,
    bump = 2,
    radio = 3,
    collision = 4,
    fault = 5,
    corruption = 6,
  };
};

// What is random in every tick is drawn, and metrics are added up, for so many ticks at once.
inline constexpr std::uint32_t block_ticks = 64;

}  // namespace palmbots
