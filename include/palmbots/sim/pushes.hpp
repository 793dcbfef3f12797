// SPDX-License-Identifier: Apache-2.0
// Pushes: something outside moves a robot, so that its speed differs for some time from what its
// wheels command.
//
// A push adds to the calibration error of the robot's wheels while it lasts. It begins and ends with
// a tick. Source: none in the paper; a disturbance that a person or an obstacle causes.
#pragma once

#include <cstdint>

#include "palmbots/base/side.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// The pushes of one carry.
class Pushes {
 public:
  static bool any(const Spec& spec) { return spec.push_count > 0; }

  // The first tick from `tick` on at which a push begins or ends; ~0 if there is none.
  static std::uint32_t next_change(const Spec& spec, std::uint32_t tick) {
    std::uint32_t next = ~0U;
    for (std::size_t i = 0; i < spec.push_count; ++i) {
      for (const std::uint32_t at : {from(spec, i), to(spec, i)}) {
        if (at >= tick && at < next) next = at;
      }
    }
    return next;
  }

  // The speed that the pushes of a tick add to a robot's, outward [m/s].
  static double speed(const Spec& spec, std::uint32_t tick, std::size_t side) {
    double sum = 0;
    for (std::size_t i = 0; i < spec.push_count; ++i) {
      const bool lasts = tick >= from(spec, i) && tick < to(spec, i);
      if (spec.pushes[i].side == side && lasts) sum += spec.pushes[i].speed;
    }
    return sum;
  }

 private:
  static std::uint32_t ticks(const Spec& spec, double seconds) {
    return static_cast<std::uint32_t>(seconds / spec.period + 0.5);
  }
  static std::uint32_t from(const Spec& spec, std::size_t i) {
    return ticks(spec, spec.pushes[i].at);
  }
  static std::uint32_t to(const Spec& spec, std::size_t i) {
    return from(spec, i) + ticks(spec, spec.pushes[i].lasts);
  }
};

}  // namespace palmbots
