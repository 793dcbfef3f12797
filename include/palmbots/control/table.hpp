// SPDX-License-Identifier: Apache-2.0
// Tables: what a controller states as data, and the meaning of its conditions.
//
// A table is a Moore machine: it states what a robot commands and says in each state, and which rows
// lead from state to state. A row may start in one state, in several or in any. It names what the
// robot senses, its partner's newest word, and further conditions. A robot runs the first row that
// fits; if none fits, it stays in its state. control/table_robot.hpp makes the program of one robot
// from a table, batch/bitslice_table_team.hpp that of 64 pairs.
//
// A Table provides
//   State, states, name_of(State)   its states, numbered from 0, at most 31
//   initial                         the state after a boot
//   outputs[states]                 what a robot commands and says in each state (TableOutput)
//   rows[]                          the transitions (TableRow<State>)
//   Limit, limits, name_of(Limit)   the time limits to which its states refer, numbered from 0
//   seconds(Limit, TableTiming)     how long each one is
//   talks                           whether the words are sent to the partner
//   started_by_touch(is_leader)     optional: the state at the start if only the follower starts by
//                                   itself, and the leader when it feels that
//
// WORDS. A robot has one word in each state: its message. If the table talks, a word is sent at once
// when it changes, and repeated in every beacon period. A robot acts on its partner's newest word
// while that word is at most `lease` old (control/beacon.hpp bounds its age). When the lease has
// expired, it hears silence.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "palmbots/control/messages.hpp"
#include "palmbots/control/transition_table.hpp"

namespace palmbots {

// A set of values of an enumeration, each below 32.
template <class Enum>
struct EnumSet {
  std::uint32_t bits = 0;

  constexpr EnumSet() = default;
  constexpr EnumSet(Enum one) : bits(1U << static_cast<unsigned>(one)) {}
  constexpr EnumSet(std::initializer_list<Enum> some) {
    for (const Enum one : some) bits |= EnumSet(one).bits;
  }
  static constexpr EnumSet all() {
    EnumSet set;
    set.bits = ~0U;
    return set;
  }
  constexpr bool has(Enum one) const { return (bits & EnumSet(one).bits) != 0; }
  constexpr EnumSet operator-(EnumSet those) const {
    EnumSet rest;
    rest.bits = bits & ~those.bits;
    return rest;
  }
  constexpr bool operator==(const EnumSet&) const = default;
};

// The words to which a row reacts; `MessageKind::none` is silence.
using WordSet = EnumSet<MessageKind>;
inline constexpr WordSet any_word = WordSet::all();

// Further conditions of a row. All that are named must hold.
enum class If : std::uint8_t {
  settled,    // the palm has reached the angle last commanded
  timed_out,  // the robot has been in its state for the state's time limit
  leads,      // it is the front robot in the direction of travel
  follows,
  may_stop,  // the scene lets a robot stop as a correction
};
using IfSet = EnumSet<If>;
inline constexpr int if_count = 5;

constexpr const char* name_of(If condition) {
  constexpr const char* names[] = {"settled", "timed_out", "leads", "follows", "may_stop"};
  return names[static_cast<int>(condition)];
}

// What a robot commands and says as long as it is in a state.
struct TableOutput {
  char name;  // the case: 'a' to 'd' as in Table 2; ' ' for none
  Command command;
  MessageKind message;
  int limit = -1;       // the number of the state's time limit; -1: it has none
  bool waits = false;   // it waits for a message
  bool brakes = false;  // it stops, too, if the scene lets a robot stop as a correction
};

constexpr TableOutput braking(TableOutput output) {
  output.brakes = true;
  return output;
}

// The states in which the palm is commanded to this angle.
template <class State, std::size_t n>
constexpr EnumSet<State> states_with(Palm palm, const TableOutput (&outputs)[n]) {
  EnumSet<State> found;
  for (std::size_t i = 0; i < n; ++i) {
    if (outputs[i].command.palm == palm) found.bits |= 1U << i;
  }
  return found;
}

// A transition.
template <class State>
struct TableRow {
  EnumSet<State> from;
  ContactCondition p;
  WordSet heard;
  IfSet when;
  State next;
};

// What the length of a time limit may depend on [s].
struct TableTiming {
  double turn;   // the longest time in which a palm turns
  double delay;  // the longest time from the step that says a word to the step that hears it
  double reach;  // the longest time in which a correction moves a contact from a palm's end to zero
  double crossing;  // the longest time in which a robot that starts crosses the zero zone
};

// The values of the conditions `If` of a row.
template <class B>
struct TableConditions {
  B settled;
  B timed_out;
  B leads;
  B may_stop;
};

// True for the robots that meet all of these conditions.
template <class B>
[[gnu::always_inline]] constexpr B meets(IfSet wanted, const TableConditions<B>& met) {
  B all = everywhere<B>();
  if (wanted.has(If::settled)) all &= met.settled;
  if (wanted.has(If::timed_out)) all &= met.timed_out;
  if (wanted.has(If::leads)) all &= met.leads;
  if (wanted.has(If::follows)) all &= opposite(met.leads);
  if (wanted.has(If::may_stop)) all &= met.may_stop;
  return all;
}

// The words that a robot can hear: silence, and what the table's states say.
template <class Table>
struct TableWords {
  static constexpr bool includes(int kind) {
    if (kind == 0) return true;
    for (const TableOutput& output : Table::outputs) {
      if (Table::talks && static_cast<int>(output.message) == kind) return true;
    }
    return false;
  }
  static constexpr int count = [] {
    int n = 0;
    for (int kind = 0; kind < message_kinds; ++kind) n += includes(kind) ? 1 : 0;
    return n;
  }();
  static constexpr std::array<MessageKind, count> list = [] {
    std::array<MessageKind, count> words{};
    std::size_t n = 0;
    for (int kind = 0; kind < message_kinds; ++kind) {
      if (includes(kind)) words[n++] = static_cast<MessageKind>(kind);
    }
    return words;
  }();
  // The place of a word in the list.
  static constexpr int number_of(MessageKind word) {
    for (int i = 0; i < count; ++i) {
      if (list[static_cast<std::size_t>(i)] == word) return i;
    }
    return 0;
  }
};

// True for the robots that hear a word of the set. heard.is(kind) is true where the newest word is
// fresh and of that kind; `none` stands for silence.
template <class Table, class B, class Message>
[[gnu::always_inline]] constexpr B hears(WordSet wanted, const Message& heard) {
  if (wanted == any_word) return everywhere<B>();
  B found{};
  for (const MessageKind word : TableWords<Table>::list) {
    if (wanted.has(word)) found |= heard.is(word);
  }
  return found;
}

// True for the robots to which a row applies.
template <class Table, class B, class Message>
[[gnu::always_inline]] constexpr B fits_in_table(const TableRow<typename Table::State>& row,
                                                 const Observation<B>& seen, const Message& heard,
                                                 const TableConditions<B>& met) {
  const B contact = holds(row.p, seen);
  const B word = hears<Table, B>(row.heard, heard);
  const B condition = meets(row.when, met);
  return contact & word & condition;
}

// True if a table is one of those described above.
template <class Table>
constexpr bool is_sound() {
  if (Table::states > 31) return false;
  for (const TableOutput& output : Table::outputs) {
    if (output.limit >= static_cast<int>(Table::limits)) return false;
    if (Table::talks && output.message == MessageKind::none) return false;
  }
  for (const auto& row : Table::rows) {
    for (int s = 0; s < Table::states; ++s) {
      const bool starts = row.from.has(static_cast<typename Table::State>(s));
      // A state without a limit never times out, so no row may wait for that.
      if (starts && row.when.has(If::timed_out) && Table::outputs[s].limit < 0) return false;
    }
  }
  return true;
}

}  // namespace palmbots
