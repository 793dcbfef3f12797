// SPDX-License-Identifier: Apache-2.0
// The errors of one robot's wheels, tick by tick, as a carry with this seed has them: for robots that
// are simulated outside a carry. Pushes come from the surroundings, and are not among them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/base/side.hpp"
#include "palmbots/robot/actuators.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/recorded_traces.hpp"
#include "palmbots/sim/spec.hpp"
#include "palmbots/sim/speed_errors.hpp"

namespace palmbots {

class WheelErrors {
 public:
  WheelErrors(const Spec& spec, std::size_t side, std::uint64_t seed)
      : spec_(spec),
        side_(side),
        seed_(seed),
        wheels_(robots_of<double>(spec, seed).wheels[side]) {}

  // The error of wheels that drive, in the next tick, along the direction of travel [m/s].
  double step() {
    const double white = SpeedErrors::white(spec_, seed_, tick_)[side_];
    const double recorded = SpeedErrors::recorded(spec_, seed_, tick_, replays_)[side_];
    wheels_.bias = SpeedErrors::modelled(spec_.robots[side_]).bias + (white + recorded);
    const double error = wheels_.step(0, SpeedErrors::noise(spec_, seed_, tick_)[side_]);
    ++tick_;
    return error;
  }

  // The speed in that tick of wheels that brakes hold [m/s].
  double held() const { return wheels_.held(); }

  // Actual speed per commanded speed [1].
  double gain() const { return wheels_.gain; }

 private:
  Spec spec_;
  std::size_t side_;
  std::uint64_t seed_;
  std::uint32_t tick_ = 0;
  Wheels<double> wheels_;
  PerSide<ErrorReplay> replays_{};
};

}  // namespace palmbots
