// Which readings of the tactile sensors are false, for several carries side by side: the same draws as a
// single carry's (tactile.hpp), a bit a lane.
#pragma once

#include "palmbots/dice.hpp"
#include "palmbots/lanes.hpp"
#include "palmbots/side.hpp"

namespace palmbots {

// For some ticks in a row.
template <std::size_t ticks>
struct FalseReadings {
  using Row = std::array<std::uint32_t, ticks>;
  PerSide<Row> wrong;  // in which lanes
  PerSide<Row>
      once;  // in which it is the next sign that is read, of −, 0, +, −, …; else the one after
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

}  // namespace detail

// The readings of the ticks from `first` on.
template <int n, std::size_t ticks>
void draw_readings(const Dice<n>& dice, std::uint64_t first, FalseReadings<ticks>& found) {
  using D = Dice<n>;
  using V = Lanes<double, static_cast<int>(D::width)>;
  constexpr std::size_t in_turn = D::in_turn;
  static_assert(ticks % in_turn == 0);
  typename D::template Draws<in_turn> draws(dice, Stream::tactile, first, 1);
  std::uint32_t left_leads = 0;
  for (std::size_t l = 0; l < n; ++l) left_leads |= (dice.left_leads[l] != 0 ? 1U : 0U) << l;
  for (std::size_t k = 0; k < ticks; k += in_turn) {
    draws.next();
    for (std::size_t i = 0; i < in_turn; ++i) {
      const auto where = [&](std::size_t which, auto&& is_true) {
        std::uint32_t bits = 0;
        for (std::size_t p = D::parts; p-- > 0;) {
          V most;
          std::memcpy(&most.raw, dice.false_words.data() + p * D::width, sizeof most.raw);
          bits = bits << D::width | is_true(draws.word(i, p, which), most).bits();
        }
        return bits;
      };
      const auto put = [&](PerSide<typename FalseReadings<ticks>::Row>& rows, std::uint32_t leader,
                           std::uint32_t follower) {
        const std::uint32_t swapped = (leader ^ follower) & ~left_leads;
        rows[left][k + i] = leader ^ swapped;
        rows[right][k + i] = follower ^ swapped;
      };
      const auto is_wrong = [](detail::Halves word, V most) {
        return detail::lower_numbers(word) < most;
      };
      const auto is_odd = [](detail::Halves word, V) {
        return detail::lower_numbers(word & 1) == V(1);
      };
      put(found.wrong, where(0, is_wrong), where(2, is_wrong));
      put(found.once, where(1, is_odd), where(3, is_odd));
    }
  }
}

}  // namespace palmbots
