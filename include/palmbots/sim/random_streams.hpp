// SPDX-License-Identifier: Apache-2.0
// Streams of random numbers: which stream of a carry's draws serves which purpose
// (base/philox.hpp).
#pragma once

#include <cstdint>

namespace palmbots {

// The purpose of a draw. The number is part of every published trace: append, never renumber.
struct Stream {
  enum Number : std::uint32_t {
    noise = 0,
    tactile = 1,
    bump = 2,
    radio = 3,
    collision = 4,
    fault = 5,
    corruption = 6,
    replay = 7,
    gain = 8,
    white_noise = 9,
    arm_height = 10,
    error_trace = 11,
    radio_trace = 12,
    ambiguity = 13,
  };
};

// Number of ticks for which random numbers are drawn, and metrics are summed, at once.
inline constexpr std::uint32_t block_ticks = 64;

}  // namespace palmbots
