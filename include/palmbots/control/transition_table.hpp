// SPDX-License-Identifier: Apache-2.0
// Transition tables: evaluates the rows of a controller's table for one robot, or for the robots of
// 64 pairs.
//
// Rule 1: the meaning of a condition is written once, for a truth value B. B is bool for one robot,
// or a word with one bit for each robot (batch/bitslice.hpp). A count of ticks is a number, or
// bit-sliced. Rule 2: a robot runs the first row of its state that fits. If none fits, it stays in
// its state. `step_all` evaluates it for many robots at once, almost without a branch;
// control/table_robot.hpp for one.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "palmbots/control/messages.hpp"

namespace palmbots {

// True for all robots, and the negation.
template <class B>
constexpr B everywhere() {
  return ~B{};
}
template <>
constexpr bool everywhere<bool>() {
  return true;
}
template <class B>
[[gnu::always_inline]] constexpr B opposite(const B& b) {
  static_assert(!std::is_same_v<B, int>, "name the truth value: opposite<bool>(a & b)");
  if constexpr (std::is_same_v<B, bool>) {
    return !b;
  } else {
    return ~b;
  }
}

// True if it holds for no robot. A word has two parts, one for each side.
template <class B>
[[gnu::always_inline]] constexpr bool is_empty(const B& b) {
  if constexpr (std::is_same_v<B, bool>) {
    return !b;
  } else {
    return (b[0] | b[1]) == 0;
  }
}

// A count of ticks for one robot. It saturates at `most`, because longer times make no difference.
// For many robots batch/bitslice.hpp has the same functions.
constexpr void advance(std::uint16_t& since, std::uint16_t elapsed, std::uint16_t most) {
  since = elapsed < most - since ? static_cast<std::uint16_t>(since + elapsed) : most;
}
// Sets the count of the robots in `whose` to zero, or to its greatest value.
constexpr void reset_where(std::uint16_t& since, bool whose) {
  if (whose) since = 0;
}
constexpr void exhaust_where(std::uint16_t& since, bool whose, std::uint16_t most) {
  if (whose) since = most;
}
constexpr bool at_least(std::uint16_t since, std::uint16_t least) { return since >= least; }

// What the robots sense, as truth values.
template <class B>
struct Observation {
  B positive{};  // sign of the contact coordinate p
  B negative{};
  B palm_at_target{};  // the palm has reached the angle last commanded
};

// The observation of one robot.
constexpr Observation<bool> observation_of(Sign sign, bool palm_at_target) {
  return {sign == Sign::positive, sign == Sign::negative, palm_at_target};
}

// What a row requires of the contact coordinate p.
enum class ContactCondition : std::uint8_t {
  any,
  positive,
  not_positive,
  negative,
  not_negative,
  zero,
};

constexpr const char* name_of(ContactCondition condition) {
  constexpr const char* names[] = {"any",      "positive",     "not_positive",
                                   "negative", "not_negative", "zero"};
  return names[static_cast<int>(condition)];
}

// True for the robots whose contact coordinate meets the condition.
template <class B>
[[gnu::always_inline]] constexpr B holds(ContactCondition condition, const Observation<B>& seen) {
  switch (condition) {
    case ContactCondition::positive: return seen.positive;
    case ContactCondition::not_positive: return opposite(seen.positive);
    case ContactCondition::negative: return seen.negative;
    case ContactCondition::not_negative: return opposite(seen.negative);
    case ContactCondition::zero: return opposite<B>(seen.positive | seen.negative);
    case ContactCondition::any: break;
  }
  return everywhere<B>();
}

// The robots in one of these states. in[s] are those in state s; each robot is in one.
template <class Table, class States, class B>
[[gnu::always_inline]] constexpr B robots_in(States states, const B (&in)[Table::states]) {
  using State = typename Table::State;
  return [&]<std::size_t... s>(std::index_sequence<s...>) {
    // The fewer states are looked at: these, or the others.
    const int count = ((states.has(static_cast<State>(s)) ? 1 : 0) + ...);
    const bool few = 2 * count <= Table::states;
    B found{};
    ((states.has(static_cast<State>(s)) == few ? void(found |= in[s]) : void()), ...);
    return few ? found : opposite(found);
  }(std::make_index_sequence<Table::states>());
}

// A step of `these` robots. in[s] are the robots in state s. fits(row) returns the robots to which
// a row applies, and went(row, whose) is called with the robots that ran it. The loop is unrolled,
// so that no table remains at run time.
template <class Table, class B, class Fits, class Went>
[[gnu::always_inline]] constexpr void step_all(B (&in)[Table::states], const B& these, Fits&& fits,
                                               Went&& went) {
  constexpr bool each_from_one_state = [] {
    for (const auto& row : Table::rows) {
      if (std::popcount(row.from.bits) != 1) return false;
    }
    return true;
  }();
  B come[Table::states];
  for (B& state : come) state = B{};
  B idle = these;  // robots that no row has moved yet
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    const auto run = [&](const auto& row) {
      B go = fits(row) & idle;
      if constexpr (!each_from_one_state) {
        if (is_empty(go)) return;  // as with most rows in most ticks
      }
      go &= robots_in<Table>(row.from, in);
      idle &= opposite(go);
      come[static_cast<std::size_t>(row.next)] |= go;
      went(row, go);
    };
    (run(Table::rows[i]), ...);
  }(std::make_index_sequence<sizeof(Table::rows) / sizeof(Table::rows[0])>());
  for (int s = 0; s < Table::states; ++s) in[s] = (in[s] & (idle | opposite(these))) | come[s];
}

}  // namespace palmbots
