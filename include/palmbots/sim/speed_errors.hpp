// SPDX-License-Identifier: Apache-2.0
// Errors of the robots' speeds that are drawn apart from the Ornstein–Uhlenbeck noise: the gain, once
// for a carry, and the white part of the noise, once for a tick.
//
// The white part of a tick is constant during the tick, and independent of those of other ticks: after
// the time t it has displaced the robot by q √t, as a standard deviation. The leading robot draws the
// same numbers on either side, so that the mirrored carry has the mirrored errors.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

struct SpeedErrors {
  static bool has_white(const Spec& spec) {
    return spec.robots[left].white_noise > 0 || spec.robots[right].white_noise > 0;
  }

  // The gain of a robot in a carry. The deviation from the mean is a sum of eight uniforms, nearly
  // normal and less than 4.9 standard deviations: within the limits of the keys the gain is above 0.
  static double gain(const Spec& spec, std::uint64_t seed, std::size_t side) {
    const RobotSpec& robot = spec.robots[side];
    if (robot.gain_sd == 0) return robot.gain;
    double deviation = 0;
    for (const std::uint32_t word : draw(seed, 0, Stream::gain, rank(spec, side))) {
      deviation += 0.5 * unit_noise<double>(word);
    }
    return robot.gain + robot.gain_sd * deviation;
  }

  // The white part of both robots' speeds in a tick, along the direction of travel [m/s]. A draw of
  // four words serves two robots for two ticks.
  static PerSide<double> white(const Spec& spec, std::uint64_t seed, std::uint32_t tick) {
    PerSide<double> speeds{};
    if (!has_white(spec)) return speeds;
    const Words words = draw(seed, tick - tick % 2, Stream::white_noise);
    for (const std::size_t side : {left, right}) {
      const double spread = spec.robots[side].white_noise / std::sqrt(spec.period);
      speeds[side] = spread * unit_noise<double>(words[2 * (tick % 2) + rank(spec, side)]);
    }
    return speeds;
  }

 private:
  static std::uint32_t rank(const Spec& spec, std::size_t side) {
    return side == leader_of(spec) ? 0 : 1;
  }
};

}  // namespace palmbots
