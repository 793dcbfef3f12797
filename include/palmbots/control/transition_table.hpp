// SPDX-License-Identifier: Apache-2.0
// Transition tables: evaluates the rows of a controller's table for one robot, or for the robots of
// 64 pairs.
//
// Rule 1: the meaning of a condition is written once, for a truth value B. B is bool for one robot,
// or a word with one bit for each robot (batch/bitslice.hpp). Rule 2: a robot runs the first row of
// its state that fits. If none fits, it stays in its state. `spread` computes this for every input
// of one robot, so that a step is one look-up. `step_all` evaluates it for many robots at once,
// without a branch.
#pragma once

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

// The message that one robot received, or none.
struct OneMessage {
  MessageKind kind;
  constexpr bool is(MessageKind that) const { return kind == that; }
};

// A table for one robot, expanded over every input. The table provides `states` and `rows`, and
// these types: Key, an input as a number below Key::count, with `fits(row, key)`; and Entry, the
// result of a step, with stay(state, key) if no row fits and run(row, key) if this one does.
template <class Table>
struct SpreadTable {
  typename Table::Entry entries[Table::states * Table::Key::count];

  constexpr const typename Table::Entry& at(typename Table::State state,
                                            const typename Table::Key& key) const {
    return entries[static_cast<int>(state) * Table::Key::count + key.number()];
  }
};

// Expands a table over every state and input.
template <class Table>
constexpr SpreadTable<Table> spread() {
  SpreadTable<Table> all{};
  for (int s = 0; s < Table::states; ++s) {
    for (int k = 0; k < Table::Key::count; ++k) {
      const auto state = static_cast<typename Table::State>(s);
      const auto key = Table::Key::of(k);
      typename Table::Entry& entry = all.entries[s * Table::Key::count + k];
      entry = Table::stay(state, key);
      for (const auto& row : Table::rows) {
        if (row.state == state && Table::fits(row, key)) {
          entry = Table::run(row, key);
          break;
        }
      }
    }
  }
  return all;
}

// A step of `these` robots. in[s] are the robots in state s. fits(row) returns the robots to which
// a row applies, and went(row, whose) is called with the robots that ran it. The loop is unrolled,
// so that no table remains at run time.
template <class Table, class B, class Fits, class Went>
[[gnu::always_inline]] constexpr void step_all(B (&in)[Table::states], const B& these, Fits&& fits,
                                               Went&& went) {
  using Row = std::remove_cvref_t<decltype(Table::rows[0])>;
  constexpr bool from_one_state = requires(const Row& row) { row.state; };
  B stay[Table::states];
  B come[Table::states];
  for (int s = 0; s < Table::states; ++s) {
    stay[s] = in[s];
    come[s] = B{};
  }
  B idle = these;  // robots that no row has moved yet; used where rows start in several states
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    const auto run = [&](const Row& row) {
      B go = fits(row);
      if constexpr (from_one_state) {
        const auto from = static_cast<std::size_t>(row.state);
        go &= stay[from] & these;
        stay[from] &= opposite(go);
      } else {
        go &= idle;
        if (is_empty(go)) return;  // as with most rows in most ticks
        if (row.from != decltype(row.from)::all()) {
          // The fewer states are looked at: those in which the row starts, or the others.
          int starts = 0;
          for (int s = 0; s < Table::states; ++s) {
            starts += row.from.has(static_cast<typename Table::State>(s)) ? 1 : 0;
          }
          const bool few = 2 * starts <= Table::states;
          B there{};
          for (int s = 0; s < Table::states; ++s) {
            if (row.from.has(static_cast<typename Table::State>(s)) == few) there |= in[s];
          }
          go &= few ? there : opposite(there);
        }
        idle &= opposite(go);
      }
      come[static_cast<std::size_t>(row.next)] |= go;
      went(row, go);
    };
    (run(Table::rows[i]), ...);
  }(std::make_index_sequence<sizeof(Table::rows) / sizeof(Table::rows[0])>());
  for (int s = 0; s < Table::states; ++s) {
    if constexpr (!from_one_state) stay[s] &= idle | opposite(these);
    in[s] = stay[s] | come[s];
  }
}

}  // namespace palmbots
