// SPDX-License-Identifier: Apache-2.0
// Bumps of the floor: when they occur, and by how much they shift the contacts.
//
// A scripted bump occurs once, at a time or at a place. Random bumps occur for each robot with a
// probability proportional to the distance that the pair travels in a tick.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// The bumps of one carry.
class Bumps {
 public:
  Bumps() = default;
  explicit Bumps(const Spec& spec) { plan(spec); }

  static bool any(const Spec& spec) { return spec.bump_count > 0 || spec.bump_rate > 0; }

  // Draws the random numbers for the random bumps of the block of ticks from `first` on. To be
  // called before the first tick of each block.
  void draw_block(const Spec& spec, std::uint64_t seed, std::uint32_t first) {
    if (!(spec.bump_rate > 0)) return;
    const auto words = draw_row<block_ticks>(seed, first, Stream::bump);
    for (std::size_t i = 0; i < block_ticks; ++i) {
      luck_[i] = unit_uniform<double>(words[0][i] < words[2][i] ? words[0][i] : words[2][i]);
    }
  }

  // True if there is a bump in this tick. `midpoint` [m] and `together`, the sum of both robots'
  // speeds over the tick before [m/s], are along +x.
  bool due(const Spec& spec, std::uint32_t tick, double midpoint, double together) const {
    return double(tick) * spec.period >= next_time_ || midpoint * spec.direction >= next_place_ ||
           (spec.bump_rate > 0 && luck_[tick % block_ticks] < chance(spec, together));
  }

  // The shift of the contacts in this tick [m], and the number of bumps that caused it.
  struct ContactShift {
    PerSide<double> by{};
    std::uint32_t bumps = 0;
  };
  ContactShift take(const Spec& spec, std::uint64_t seed, std::uint32_t tick, double midpoint,
                    double together) {
    ContactShift shift;
    for (std::size_t i = 0; i < spec.bump_count; ++i) {
      const BumpSpec& bump = spec.bumps[i];
      const double reached =
          bump.by_time != 0 ? double(tick) * spec.period : midpoint * spec.direction;
      if (is_over(i) || reached < bump.at) continue;
      over_ |= std::uint64_t{1} << i;
      shift.by[bump.side] += bump.shift;
      ++shift.bumps;
    }
    plan(spec);
    if (!(spec.bump_rate > 0)) return shift;
    const Words words = draw(seed, tick, Stream::bump);
    const std::size_t leader = spec.direction > 0 ? right : left;
    for (const std::size_t side : {left, right}) {
      const std::size_t lane = side == leader ? 0 : 2;
      if (unit_uniform<double>(words[lane]) >= chance(spec, together)) continue;
      const double place = 2 * unit_uniform<double>(words[lane + 1]) - 1;
      shift.by[side] += place * spec.bump_max;
      ++shift.bumps;
    }
    return shift;
  }

 private:
  // The probability of a random bump for one robot in one tick.
  static double chance(const Spec& spec, double together) {
    return spec.bump_rate * (std::abs(together) * 0.5 * spec.period);
  }

  bool is_over(std::size_t i) const { return (over_ >> i & 1) != 0; }

  // Determines time and place of the next scripted bumps.
  void plan(const Spec& spec) {
    next_time_ = next_place_ = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spec.bump_count; ++i) {
      if (is_over(i)) continue;
      double& next = spec.bumps[i].by_time != 0 ? next_time_ : next_place_;
      next = spec.bumps[i].at < next ? spec.bumps[i].at : next;
    }
  }

  std::uint64_t over_ = 0;  // scripted bumps that have occurred, one bit each
  double next_time_ = std::numeric_limits<double>::infinity();  // [s]
  double next_place_ =
      std::numeric_limits<double>::infinity();  // along the direction of travel [m]
  std::array<double, block_ticks> luck_{};      // smaller draw of the two robots in each tick
};

}  // namespace palmbots
