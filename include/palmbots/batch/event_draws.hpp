// SPDX-License-Identifier: Apache-2.0
// What happens by chance to several carries side by side in a block of ticks, a bit a lane: false
// readings and lost messages. The same draws as a single carry's (robot/tactile_sensor.hpp,
// sim/radio_channel.hpp).
#pragma once

#include "palmbots/base/side.hpp"
#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/batch/lane_random_inputs.hpp"
#include "palmbots/sim/random_streams.hpp"

namespace palmbots {

// Bit l of a row tells of lane l in a tick.
template <std::size_t ticks>
using ChanceRows = PerSide<std::array<std::uint32_t, ticks>>;

// Of what the sensors say.
template <std::size_t ticks>
struct FalseReadings {
  ChanceRows<ticks> wrong;
  ChanceRows<ticks> once;  // it is the next sign that is read, of −, 0, +, −, …; else the one after
};

namespace detail {

// The lower halves as numbers.
inline auto lower_numbers(Halves words) {
  using V = Lanes<double, static_cast<int>(draws_at_once)>;
  // The bits of 2⁵² and of a smaller whole number make their sum.
  constexpr double two_52 = 4503599627370496.0;
  const Halves sum = (words & 0xFFFFFFFF) | std::bit_cast<std::uint64_t>(two_52);
  return V::of((decltype(V::raw))sum) - V(two_52);
}

// Whether a word of a draw is below a number, and whether it is odd.
template <int n, class RandomBlock>
std::uint32_t lanes_below(const std::array<double, n>& limits, const RandomBlock& drawn,
                          std::size_t tick, std::size_t which) {
  std::uint32_t bits = 0;
  for (std::size_t p = LaneRandomInputs<n>::parts; p-- > 0;) {
    auto limit = lower_numbers(Halves{});
    std::memcpy(&limit.raw, limits.data() + p * draws_at_once, sizeof limit.raw);
    bits = bits << draws_at_once | (lower_numbers(drawn.word(tick, p, which)) < limit).bits();
  }
  return bits;
}
template <int n, class RandomBlock>
std::uint32_t lanes_odd(const RandomBlock& drawn, std::size_t tick, std::size_t which) {
  std::uint32_t bits = 0;
  for (std::size_t p = LaneRandomInputs<n>::parts; p-- > 0;) {
    const auto last_bit = lower_numbers(drawn.word(tick, p, which) & 1);
    bits = bits << draws_at_once | (last_bit > lower_numbers(Halves{})).bits();
  }
  return bits;
}

// From what is drawn for the robots that lead and for the others.
template <int n, std::size_t ticks>
void put_chances(const LaneRandomInputs<n>& inputs, std::uint32_t leader, std::uint32_t follower,
                 std::size_t k, ChanceRows<ticks>& rows) {
  const std::uint32_t swapped = (leader ^ follower) & ~inputs.lanes_in_which_left_leads();
  rows[left][k] = leader ^ swapped;
  rows[right][k] = follower ^ swapped;
}

}  // namespace detail

// The readings of the ticks from `first` on.
template <int n, std::size_t ticks>
void draw_readings(const LaneRandomInputs<n>& inputs, std::uint64_t first,
                   FalseReadings<ticks>& found) {
  constexpr std::size_t in_turn = LaneRandomInputs<n>::in_turn;
  static_assert(ticks % in_turn == 0);
  typename LaneRandomInputs<n>::template LaneDraws<in_turn> draws(inputs, Stream::tactile, 0, first,
                                                                  1);
  for (std::size_t k = 0; k < ticks; k += in_turn) {
    const auto drawn = draws.next();
    for (std::size_t i = 0; i < in_turn; ++i) {
      const auto wrong = [&](std::size_t which) {
        return detail::lanes_below<n>(inputs.false_words, drawn, i, which);
      };
      const auto once = [&](std::size_t which) { return detail::lanes_odd<n>(drawn, i, which); };
      detail::put_chances(inputs, wrong(0), wrong(2), k + i, found.wrong);
      detail::put_chances(inputs, once(1), once(3), k + i, found.once);
    }
  }
}

// Whether messages that are sent in the ticks from `first` on are lost: on the links of the robot
// that leads and of the other one, which draw in two lanes of the radio's from `lane` on.
template <int n, std::size_t ticks>
void draw_losses(const LaneRandomInputs<n>& inputs, std::uint32_t lane, std::uint64_t first,
                 ChanceRows<ticks>& found) {
  constexpr std::size_t in_turn = LaneRandomInputs<n>::in_turn;
  using LaneDraws = typename LaneRandomInputs<n>::template LaneDraws<in_turn>;
  static_assert(ticks % in_turn == 0);
  LaneDraws leaders(inputs, Stream::radio, lane, first, 1);
  LaneDraws followers(inputs, Stream::radio, lane + 1, first, 1);
  for (std::size_t k = 0; k < ticks; k += in_turn) {
    const auto leader = leaders.next();
    const auto follower = followers.next();
    for (std::size_t i = 0; i < in_turn; ++i) {
      const auto lost = [&](const auto& drawn) {
        return detail::lanes_below<n>(inputs.loss_words, drawn, i, 0);
      };
      detail::put_chances(inputs, lost(leader), lost(follower), k + i, found);
    }
  }
}

}  // namespace palmbots
