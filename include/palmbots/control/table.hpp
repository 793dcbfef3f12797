// SPDX-License-Identifier: Apache-2.0
// Tables: what a controller states as data, and the meaning of its conditions.
//
// A table states what a robot commands in each state, and which rows lead from state to state. A row
// may start in one state, in several or in any. It names what the robot senses, what it hears from
// its partner, and further conditions. A robot runs the first row that fits; if none fits, it stays
// in its state. control/table_robot.hpp makes the program of one robot from a table,
// batch/bitslice_table_team.hpp that of 64 pairs, and control/machine_table.hpp is a table that is
// known at run time only.
//
// A Table provides
//   State, states, name_of(State)   its states, numbered from 0, at most 31
//   initial                         the state after a boot
//   outputs[states]                 what a robot commands and says in each state (TableOutput)
//   rows[]                          the transitions (TableRow<State>)
//   Limit, limits, name_of(Limit)   the time limits to which its states refer, numbered from 0
//   seconds(Limit, TableTiming)     how long each one is
//   mail                            how a robot hears its partner (Mail)
//   started_by_touch(is_leader)     optional: the state at the start if the follower starts by itself
//                                   and the leader starts when its contact slides
//   Memory<B, Count>                optional: what a robot remembers besides its state and times, and
//                                   what follows from that (control/resilient_memory.hpp)
//   idle                            … the state of a robot that neither corrects nor assists
//   assisting, initial_assisting    optional: the states that a robot stores, and its state after a
//                                   boot if it was in one of them
//   quiet, quiet_limit              optional, with beacons: the states in which a robot does the same
//                                   whether or not it hears its partner, and the number of the time
//                                   limit for which it may be silent then. Such a table spares beacons
//
// MAIL. With *beacons* a robot has one message in each state. It is sent at once when it changes, and
// repeated in every beacon period. A robot acts on its partner's newest message while that message
// is at most `lease` old (control/mailbox.hpp bounds its age). When the lease has expired, it hears
// silence. A table that names its `quiet` states needs fewer beacons (TableBeacons). With a *queue* a
// row may send a message, once. The message waits at the partner until a row of the partner reads it.
// A robot hears the oldest message that it has not read. A row that names what it hears reads that
// message.
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

// How a robot hears its partner.
enum class Mail : std::uint8_t { none, queue, beacons };

// The messages to which a row reacts; `MessageKind::none` is silence, or that no message waits. A
// row with `any_message` fits whatever the robot hears, also nothing, and reads no message.
using MessageSet = EnumSet<MessageKind>;
inline constexpr MessageSet any_message = MessageSet::all();

// Further conditions of a row. All that are named must hold.
enum class If : std::uint8_t {
  turned,     // the palm has reached the angle last commanded
  timed_out,  // the robot has been in its state for the state's time limit
  leads,      // it is the front robot in the direction of travel
  follows,
  may_stop,  // the scene lets a robot stop as a correction
  // Of tables with a memory of their own (control/resilient_memory.hpp):
  settled,   // the palm has turned and the wheels have braked
  released,  // the partner knew, when it sent its newest message, that this robot no longer asks
  // Of the table that lifts (control/lifting.hpp):
  touches,     // something presses the palm
  is_empty,    // nothing does
  reached,     // the arm has its height; or, in a state that carries, the robot its distance
  gave_up,     // it has tried as often as it may
  abreast,     // its arm is no step ahead of its partner's
  ahead,       // it is
  level_only,  // the pair corrects contacts at level pivots only
};
using IfSet = EnumSet<If>;
inline constexpr int if_count = 14;

constexpr const char* name_of(If condition) {
  constexpr const char* names[] = {"turned",  "timed_out", "leads",   "follows",   "may_stop",
                                   "settled", "released",  "touches", "is_empty",  "reached",
                                   "gave_up", "abreast",   "ahead",   "level_only"};
  return names[static_cast<int>(condition)];
}

// What a robot commands and says as long as it is in a state.
struct TableOutput {
  char name;  // the case: 'a' to 'd' as in Table 2; ' ' for none
  Command command;
  MessageKind message = MessageKind::none;  // with beacons
  std::int8_t limit = -1;                   // the number of the state's time limit; -1: it has none
  bool waits = false;                       // it waits for a message
  bool brakes = false;  // it stands instead, if the scene lets a robot stop as a correction
};

constexpr TableOutput braking(TableOutput output) {
  output.brakes = true;
  return output;
}
constexpr TableOutput waiting(TableOutput output) {
  output.waits = true;
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
  MessageSet heard;
  IfSet when;
  State next;
  MessageKind send = MessageKind::none;  // with a queue

  // True if the row reads the message that it hears.
  constexpr bool reads() const { return !(heard == any_message); }
};

// What the length of a time limit may depend on [s].
struct TableTiming {
  double turn;   // the longest time in which a palm turns
  double delay;  // the longest time from the step that says a message to the step that hears it
  double reach;  // the longest time in which a correction moves a contact from a palm's end to zero
  double crossing;  // the longest time in which a robot that starts crosses the zero zone
};

// The times of a table's robot [ticks].
template <class Table>
struct TableTimes {
  std::uint16_t beacon;
  std::uint16_t lease;
  std::array<std::uint16_t, Table::limits> limits;
};

// When a robot repeats its message: one time for each table, and one that depends on the state if the
// table spares beacons. In a quiet state the robot then leaves its partner to its own sign for as long
// as the limit says. In the others it sends every second beacon, half a beacon early if a message
// arrives, because the beacon then echoes a newer one. It sends all of them if its partner's message
// is old, because that shows that beacons are lost. A robot that hears nothing does not: its partner
// may just have been quiet, and needs a round trip to answer. And a robot that had heard nothing
// answers at once, because its partner may be waiting to be heard, too. All this only leaves out
// beacons, so what holds where any of them may be lost holds here (docs/theory/verification.md).
template <class Table>
struct TableBeacons {
  static constexpr bool spares = requires { Table::quiet; };

  // The age from which a message counts as old.
  static constexpr std::uint16_t old(const TableTimes<Table>& times) {
    return static_cast<std::uint16_t>((7 * times.lease + 9) / 10);
  }
  static constexpr std::uint16_t quiet(const TableTimes<Table>& times) {
    if constexpr (spares) {
      const std::uint16_t limit = times.limits[static_cast<std::size_t>(Table::quiet_limit)];
      if (limit > times.beacon) return limit;
    }
    return times.beacon;
  }
  static constexpr std::uint16_t sparing(const TableTimes<Table>& times) {
    constexpr int most = 0xFFFE;
    const int every = (spares ? 2 : 1) * times.beacon;
    return static_cast<std::uint16_t>(every < most ? every : most);
  }
  // The same if a message arrives.
  static constexpr std::uint16_t early(const TableTimes<Table>& times) {
    const int early = times.beacon + (times.beacon + 1) / 2;
    return early < sparing(times) ? static_cast<std::uint16_t>(early) : sparing(times);
  }
  static constexpr std::uint16_t longest(const TableTimes<Table>& times) {
    return quiet(times) > sparing(times) ? quiet(times) : sparing(times);
  }
};

// The values of the conditions `If` of a row.
template <class B>
struct TableConditions {
  B turned{};
  B timed_out{};
  B leads{};
  B may_stop{};
  B settled{};
  B released{};
  B touches{};
  B reached{};
  B gave_up{};
  B abreast{};
  B level_only{};

  // Calls visit(conditions, member) for each value, with the conditions that depend on it.
  template <class Visit>
  static constexpr void each(Visit&& visit) {
    using C = TableConditions;
    constexpr IfSet leading{If::leads, If::follows};
    constexpr IfSet touching{If::touches, If::is_empty};
    constexpr IfSet keeping{If::abreast, If::ahead};
    visit(IfSet(If::turned), &C::turned);
    visit(IfSet(If::timed_out), &C::timed_out);
    visit(leading, &C::leads);
    visit(IfSet(If::may_stop), &C::may_stop);
    visit(IfSet(If::settled), &C::settled);
    visit(IfSet(If::released), &C::released);
    visit(touching, &C::touches);
    visit(IfSet(If::reached), &C::reached);
    visit(IfSet(If::gave_up), &C::gave_up);
    visit(keeping, &C::abreast);
    visit(IfSet(If::level_only), &C::level_only);
  }
};

// True for the robots that meet all of these conditions.
template <class B>
[[gnu::always_inline]] constexpr B meets(IfSet wanted, const TableConditions<B>& met) {
  B all = everywhere<B>();
  if (wanted.has(If::turned)) all &= met.turned;
  if (wanted.has(If::timed_out)) all &= met.timed_out;
  if (wanted.has(If::leads)) all &= met.leads;
  if (wanted.has(If::follows)) all &= opposite(met.leads);
  if (wanted.has(If::may_stop)) all &= met.may_stop;
  if (wanted.has(If::settled)) all &= met.settled;
  if (wanted.has(If::released)) all &= met.released;
  if (wanted.has(If::touches)) all &= met.touches;
  if (wanted.has(If::is_empty)) all &= opposite(met.touches);
  if (wanted.has(If::reached)) all &= met.reached;
  if (wanted.has(If::gave_up)) all &= met.gave_up;
  if (wanted.has(If::abreast)) all &= met.abreast;
  if (wanted.has(If::ahead)) all &= opposite(met.abreast);
  if (wanted.has(If::level_only)) all &= met.level_only;
  return all;
}

// The memory of a table that needs none of its own.
template <class B, class Count>
struct NoMemory {
  struct Effect {
    B ready{};
    B is_news{};
  };
  static constexpr B stopped{};

  static constexpr int limits(const auto&) { return 0; }
  static constexpr void boot(const auto&...) {}
  static constexpr void pass(const auto&...) {}
  static constexpr void hear(const auto&...) {}
  static constexpr void meet(const auto&...) {}
  static constexpr Effect finish(const auto&...) { return {}; }
  static constexpr void stay(const auto&...) {}
  static constexpr void until(const auto&...) {}
};

namespace detail {

template <class Table, class B, class Count>
struct MemoryOf {
  using type = NoMemory<B, Count>;
};
template <class Table, class B, class Count>
  requires requires { typename Table::template Memory<B, Count>; }
struct MemoryOf<Table, B, Count> {
  using type = typename Table::template Memory<B, Count>;
};

}  // namespace detail

// What one robot of a table, or many, remember besides states and times (B and Count as in
// control/transition_table.hpp).
template <class Table, class B, class Count>
using TableMemory = typename detail::MemoryOf<Table, B, Count>::type;

// The messages that a robot can hear: silence, and what the table's states or rows say.
template <class Table>
struct TableMessages {
  static constexpr bool includes(int kind) {
    if (kind == 0) return true;
    for (const TableOutput& output : Table::outputs) {
      if (Table::mail == Mail::beacons && static_cast<int>(output.message) == kind) return true;
    }
    for (const auto& row : Table::rows) {
      if (Table::mail == Mail::queue && static_cast<int>(row.send) == kind) return true;
    }
    return false;
  }
  static constexpr int count = [] {
    int n = 0;
    for (int kind = 0; kind < all_message_kinds; ++kind) n += includes(kind) ? 1 : 0;
    return n;
  }();
  static constexpr std::array<MessageKind, count> list = [] {
    std::array<MessageKind, count> messages{};
    std::size_t n = 0;
    for (int kind = 0; kind < all_message_kinds; ++kind) {
      if (includes(kind)) messages[n++] = static_cast<MessageKind>(kind);
    }
    return messages;
  }();
  // The place of each message in the list.
  static constexpr std::array<std::uint8_t, all_message_kinds> places = [] {
    std::array<std::uint8_t, all_message_kinds> found{};
    for (std::size_t i = 0; i < list.size(); ++i) {
      found[static_cast<std::size_t>(list[i])] = static_cast<std::uint8_t>(i);
    }
    return found;
  }();
  static constexpr int number_of(MessageKind message) {
    return count == 1 ? 0 : places[static_cast<std::size_t>(message)];
  }
};

// True for the robots that hear a message of the set. heard.is(kind) is true where the newest
// message is fresh and of that kind; `none` stands for silence.
template <class Table, class B, class Message>
[[gnu::always_inline]] constexpr B hears(MessageSet wanted, const Message& heard) {
  if (wanted == any_message) return everywhere<B>();
  // A robot hears one of the messages. The fewer are looked at: those of the set, or the others.
  int wanted_messages = 0;
  for (const MessageKind message : TableMessages<Table>::list)
    wanted_messages += wanted.has(message) ? 1 : 0;
  const bool few = 2 * wanted_messages <= TableMessages<Table>::count;
  B found{};
  for (const MessageKind message : TableMessages<Table>::list) {
    if (wanted.has(message) == few) found |= heard.is(message);
  }
  return few ? found : opposite<B>(found);
}

// True for the robots to which a row applies.
template <class Table, class B, class Message>
[[gnu::always_inline]] constexpr B fits_in_table(const TableRow<typename Table::State>& row,
                                                 const Observation<B>& seen, const Message& heard,
                                                 const TableConditions<B>& met) {
  const B contact = holds(row.p, seen);
  const B message = hears<Table, B>(row.heard, heard);
  const B condition = meets(row.when, met);
  return contact & message & condition;
}

// The message for which a robot waits in a state: that of the first row that starts there. None if it
// does not wait.
template <class Table>
constexpr MessageKind awaited_in(typename Table::State state) {
  if (!Table::outputs[static_cast<int>(state)].waits) return MessageKind::none;
  for (const auto& row : Table::rows) {
    if (!row.from.has(state)) continue;
    for (const MessageKind message : TableMessages<Table>::list) {
      if (row.heard == MessageSet(message)) return message;
    }
  }
  return MessageKind::none;
}

// True if a table is one of those described above.
template <class Table>
constexpr bool is_sound() {
  if (Table::states > 31) return false;
  for (const TableOutput& output : Table::outputs) {
    if (output.limit >= static_cast<int>(Table::limits)) return false;
    // With beacons each state has a message, and otherwise none has.
    if ((Table::mail == Mail::beacons) != (output.message != MessageKind::none)) return false;
  }
  for (const auto& row : Table::rows) {
    if (Table::mail != Mail::queue && row.send != MessageKind::none) return false;
    for (int s = 0; s < Table::states; ++s) {
      const bool starts = row.from.has(static_cast<typename Table::State>(s));
      // A state without a limit never times out, so no row may wait for that.
      if (starts && row.when.has(If::timed_out) && Table::outputs[s].limit < 0) return false;
    }
  }
  return true;
}

}  // namespace palmbots
