// SPDX-License-Identifier: Apache-2.0
// Random events of several carries side by side in a block of ticks, with one bit for each lane:
// false readings and lost messages. The draws are the same as a single carry's
// (robot/tactile_sensor.hpp, sim/radio_channel.hpp).
#pragma once

#include "palmbots/base/side.hpp"
#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/batch/lane_random_inputs.hpp"
#include "palmbots/sim/random_streams.hpp"

namespace palmbots {

// One row of bits for each tick. Bit l of a row belongs to lane l.
template <std::size_t ticks>
using ChanceRows = PerSide<std::array<std::uint32_t, ticks>>;

// False readings of the sensors.
template <std::size_t ticks>
struct FalseReadings {
  ChanceRows<ticks> wrong;
  ChanceRows<ticks> once;  // the false sign is the next one of −, 0, +, −, …; else the one after it
};

namespace detail {

// The lower halves as floating-point numbers.
inline auto lower_numbers(Halves words) {
  using V = Lanes<double, static_cast<int>(draws_at_once)>;
  // The bit pattern of 2⁵², combined with the bits of a smaller whole number, is that of their sum.
  constexpr double two_52 = 4503599627370496.0;
  const Halves sum = (words & 0xFFFFFFFF) | std::bit_cast<std::uint64_t>(two_52);
  return V::of((decltype(V::raw))sum) - V(two_52);
}

// The lanes in which a word of a draw is below a number, or is odd.
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

// Stores what is drawn for the leading robots and for the others.
template <int n, std::size_t ticks>
void put_chances(const LaneRandomInputs<n>& inputs, std::uint32_t leader, std::uint32_t follower,
                 std::size_t k, ChanceRows<ticks>& rows) {
  const std::uint32_t swapped = (leader ^ follower) & ~inputs.lanes_in_which_left_leads();
  rows[left][k] = leader ^ swapped;
  rows[right][k] = follower ^ swapped;
}

}  // namespace detail

// Draws the false readings of the ticks from `first` on.
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

// Draws the losses of messages that are sent in the ticks from `first` on. The links of the leading
// robot and of the other one use two lanes of the radio's stream, from `lane` on.
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
