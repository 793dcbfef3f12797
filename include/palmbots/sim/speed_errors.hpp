// SPDX-License-Identifier: Apache-2.0
// Errors of the robots' speeds: random numbers of the Ornstein–Uhlenbeck noise, the gain, drawn once
// for a carry, and the white part of the noise, drawn once for a tick. A recording takes the place of
// all.
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
#include "palmbots/sim/recorded_traces.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

struct SpeedErrors {
  // Whether the biases of the wheels differ from tick to tick.
  static bool vary(const Spec& spec) { return has_white(spec) || replay(spec); }

  // The errors of a robot that are drawn from a model: none if it has a recording.
  static RobotSpec modelled(RobotSpec robot) {
    if (robot.recorded == nullptr) return robot;
    robot.gain = 1;
    robot.gain_sd = robot.noise = robot.standing_noise = robot.white_noise = robot.bias = 0;
    return robot;
  }

  // The gain of a robot in a carry. The deviation from the mean is a sum of eight uniforms, nearly
  // normal and less than 4.9 standard deviations: within the limits of the keys the gain is above 0.
  static double gain(const Spec& spec, std::uint64_t seed, std::size_t side) {
    const RobotSpec& robot = spec.robots[side];
    if (robot.recorded != nullptr) {
      if (robot.gain_by_segment) return 1;
      return ErrorReplay::first(*robot.recorded, seed, rank(spec, side)).gain;
    }
    if (robot.gain_sd == 0) return robot.gain;
    double deviation = 0;
    for (const std::uint32_t word : draw(seed, 0, Stream::gain, rank(spec, side))) {
      deviation += 0.5 * unit_noise<double>(word);
    }
    return robot.gain + robot.gain_sd * deviation;
  }

  // The random numbers of the Ornstein–Uhlenbeck noise in a tick: mean 0, variance 1.
  static PerSide<double> noise(const Spec& spec, std::uint64_t seed, std::uint32_t tick) {
    return of_tick(spec, seed, tick, Stream::noise);
  }

  // The white part of both robots' speeds in a tick, along the direction of travel [m/s].
  static PerSide<double> white(const Spec& spec, std::uint64_t seed, std::uint32_t tick) {
    PerSide<double> speeds{};
    if (!has_white(spec)) return speeds;
    speeds = of_tick(spec, seed, tick, Stream::white_noise);
    for (const std::size_t side : {left, right}) {
      speeds[side] *= modelled(spec.robots[side]).white_noise / std::sqrt(spec.period);
    }
    return speeds;
  }

  // What the recordings add to the speeds in a tick, along the direction of travel [m/s]. The gain of
  // a segment counts at the nominal speed.
  static PerSide<double> recorded(const Spec& spec, std::uint64_t seed, std::uint32_t tick,
                                  PerSide<ErrorReplay>& replays) {
    PerSide<double> speeds{};
    if (!replay(spec)) return speeds;
    for (const std::size_t side : {left, right}) {
      const RobotSpec& robot = spec.robots[side];
      if (robot.recorded == nullptr) continue;
      const ErrorTrace& trace = *robot.recorded;
      const double gain = replays[side].go_to(trace, seed, rank(spec, side), tick).gain;
      speeds[side] = replays[side].speed(trace, tick);
      if (robot.gain_by_segment) speeds[side] += (gain - 1) * robot.speed;
    }
    return speeds;
  }

 private:
  // A draw of four words serves two robots for two ticks.
  static PerSide<double> of_tick(const Spec& spec, std::uint64_t seed, std::uint32_t tick,
                                 Stream::Number stream) {
    const Words words = draw(seed, tick - tick % 2, stream);
    const std::size_t first = 2 * (tick % 2);
    return {unit_noise<double>(words[first + rank(spec, left)]),
            unit_noise<double>(words[first + rank(spec, right)])};
  }
  static bool has_white(const Spec& spec) {
    return modelled(spec.robots[left]).white_noise > 0 ||
           modelled(spec.robots[right]).white_noise > 0;
  }
  static bool replay(const Spec& spec) {
    return spec.robots[left].recorded != nullptr || spec.robots[right].recorded != nullptr;
  }
  static std::uint32_t rank(const Spec& spec, std::size_t side) {
    return side == leader_of(spec) ? 0 : 1;
  }
};

}  // namespace palmbots
