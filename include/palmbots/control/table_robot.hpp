// SPDX-License-Identifier: Apache-2.0
// A robot whose program is a table (control/table.hpp): its state, and, if the table needs them, the
// time that it has been in it, the partner's newest message with its age, and the table's own
// memory.
//
// INTERFACE. step(RobotInput) → RobotOutput once per control tick. The object itself is the only
// memory. The caller keeps what arrives until the robot hears it: beacons in a BeaconReceiver
// (control/mailbox.hpp), the messages of a queue in an inbox; and, across a reboot, the epoch and the
// last RobotOutput::assists. Times are in ticks.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "palmbots/control/table.hpp"

namespace palmbots {

// The rows of a table as sets: those that start in a state, those that fit a sign, a message and
// the further conditions. The first row in all of them is the one that a robot runs. So a step has
// no loop, and the sets take some hundred bytes where a table over every input would take
// thousands.
template <class Table>
class TableRowMasks {
  using State = typename Table::State;
  using Known = TableMessages<Table>;
  static constexpr std::size_t rows = sizeof(Table::rows) / sizeof(Table::rows[0]);
  static_assert(rows <= 64);
  using Mask = std::conditional_t<(rows <= 32), std::uint32_t, std::uint64_t>;

  // The conditions that the rows name. Only these are looked at.
  static constexpr IfSet named = [] {
    IfSet set;
    for (const TableRow<State>& row : Table::rows) set.bits |= row.when.bits;
    return set;
  }();
  static constexpr bool names(If one) { return named.has(one); }
  static constexpr unsigned inputs = [] {
    unsigned number = 1;
    TableConditions<bool>::each(
        [&](IfSet ones, auto) { number <<= (named.bits & ones.bits) != 0; });
    return number;
  }();

 public:
  constexpr TableRowMasks() {
    for (std::size_t i = 0; i < rows; ++i) {
      const TableRow<State>& row = Table::rows[i];
      const auto add = [&](Mask& mask, bool fits) { mask |= fits ? Mask{1} << i : 0; };
      for (int s = 0; s < Table::states; ++s) add(start_[s], row.from.has(static_cast<State>(s)));
      for (int sign = 0; sign < 3; ++sign) {
        add(sign_[sign], holds(row.p, observation_of(static_cast<Sign>(sign - 1), false)));
      }
      for (int w = 0; w < Known::count; ++w) {
        add(message_[w], row.heard.has(Known::list[static_cast<std::size_t>(w)]));
      }
      add(reads_, row.reads());
      next_[i] = row.next;
      send_[i] = row.send;
    }
    for (unsigned c = 0; c < inputs; ++c) {
      const TableConditions<bool> met = conditions(c);
      for (std::size_t i = 0; i < rows; ++i) {
        if (meets(Table::rows[i].when, met)) condition_[c] |= Mask{1} << i;
      }
    }
  }

  // The row that a robot runs; `none` if no row fits.
  static constexpr int none = -1;
  [[gnu::always_inline]] constexpr int row(State state, Sign sign, MessageKind heard,
                                           const TableConditions<bool>& met) const {
    const Mask fit = start_[static_cast<int>(state)] & sign_[static_cast<int>(sign) + 1] &
                     message_[Known::number_of(heard)] & condition_[number_of(met)];
    return fit == 0 ? none : std::countr_zero(fit);
  }
  constexpr State next(int row) const { return next_[row]; }
  constexpr MessageKind send(int row) const { return send_[row]; }
  constexpr bool reads(int row) const { return (reads_ >> row & 1) != 0; }

 private:
  static constexpr unsigned number_of(const TableConditions<bool>& met) {
    unsigned number = 0, place = 0;
    TableConditions<bool>::each([&](IfSet ones, auto member) {
      if ((named.bits & ones.bits) != 0) number |= unsigned{met.*member} << place++;
    });
    return number;
  }
  static constexpr TableConditions<bool> conditions(unsigned number) {
    TableConditions<bool> met;
    TableConditions<bool>::each([&](IfSet ones, auto member) {
      if ((named.bits & ones.bits) == 0) return;
      met.*member = (number & 1) != 0;
      number >>= 1;
    });
    return met;
  }

  Mask start_[Table::states]{};
  Mask sign_[3]{};
  Mask message_[Known::count]{};
  Mask condition_[inputs]{};
  Mask reads_ = 0;
  State next_[rows]{};
  MessageKind send_[rows]{};
};

// What a robot knows from the start.
struct TableRole {
  bool leads = false;     // it is the front robot in the direction of travel
  bool may_stop = false;  // the scene lets robots stop as a correction
  bool by_touch = false;  // the follower starts first, and the leader when it feels that
};

// What a robot with time limits or beacons remembers besides its state.
template <class Table>
struct TableClock {
  using Beacons = TableBeacons<Table>;

  TableTimes<Table> times;
  TableRole role;
  bool in_place = false;                    // neither robot travels, so `may_stop` does not hold
  MessageKind message = MessageKind::none;  // the partner's newest
  std::uint16_t age;                        // of it
  std::uint16_t since_entered = 0;          // since the state was entered
  std::uint16_t since_sent;                 // since the last beacon
  TableMemory<Table, bool, std::uint16_t> own{};

  constexpr TableClock(const TableTimes<Table>& its_times, const TableRole& its_role)
      : times(its_times), role(its_role), age(stale()), since_sent(most_since_sent()) {
    own.boot(true, own_limits());
  }

  constexpr std::uint16_t stale() const { return static_cast<std::uint16_t>(times.lease + 1); }
  constexpr std::uint16_t most_since_sent() const {
    return Beacons::spares ? std::uint16_t{0xFFFE} : times.beacon;
  }
  constexpr bool silence() const { return age >= stale(); }
  constexpr MessageKind heard() const { return silence() ? MessageKind::none : message; }
  constexpr auto own_limits() const {
    return TableMemory<Table, bool, std::uint16_t>::limits(times);
  }

  constexpr void pass(std::uint16_t elapsed, std::uint16_t limit) {
    advance(age, elapsed, stale());
    advance(since_entered, elapsed, limit);
    advance(since_sent, elapsed, most_since_sent());
    own.pass(elapsed, own_limits());
  }
  constexpr void hear(const RobotInput& in) {
    if (in.message == MessageKind::none) return;
    message = in.message;
    age = in.age < stale() ? in.age : stale();
    own.hear(true, in.stopped, in.ready);
  }
};

// The program of one robot.
template <class TheTable>
class TableRobot {
 public:
  using Table = TheTable;
  using State = typename Table::State;
  using Row = TableRow<State>;
  using StateOutput = TableOutput;
  using Times = TableTimes<Table>;  // each is below 65535
  using Role = TableRole;
  using Beacons = TableBeacons<Table>;
  static_assert(is_sound<Table>());
  static constexpr Mail mail = Table::mail;
  static constexpr int states = Table::states;
  static constexpr const auto& outputs = Table::outputs;
  static constexpr const auto& rows = Table::rows;
  // Without, it is its state alone.
  static constexpr bool has_clock = Table::limits > 0 || mail == Mail::beacons;

  constexpr TableRobot()
    requires(!has_clock)
      : state_(Table::initial) {}

  // `assisted`: what the robot had stored of RobotOutput::assists.
  constexpr TableRobot(const Times& times, const Role& role, bool assisted = false)
    requires has_clock
      : state_(first(role, assisted)), clock_(times, role) {}

  // The robot after a boot, with what it had stored of RobotOutput::assists.
  constexpr TableRobot booted(bool assisted) const {
    if constexpr (has_clock) {
      const Role& role = clock_.role;
      TableRobot made(clock_.times, {role.leads, role.may_stop}, assisted);
      if constexpr (requires { Table::rebooted; }) {
        if (!assisted) made.enter(Table::rebooted);
      }
      return made;
    } else {
      return {};
    }
  }
  constexpr TableRobot booted() const { return booted(assists()); }

  RobotOutput step(const RobotInput& in) {
    Arrival arrival = Arrival::none;
    if constexpr (has_clock) {
      clock_.pass(in.elapsed, limit());
      if constexpr (Beacons::spares) {
        if (in.message != MessageKind::none) {
          arrival = clock_.silence() ? Arrival::after_silence : Arrival::in_time;
        }
      }
      clock_.hear(in);
    }
    const State before = state_;
    const int row = row_masks.row(state_, in.sign, heard(in), met(in));
    if (row != row_masks.none) state_ = row_masks.next(row);
    RobotOutput out{now().command};
    if constexpr (mail == Mail::queue) {
      if (row == row_masks.none) return out;
      out.message = row_masks.send(row);
      out.send = out.message != MessageKind::none;
      out.read = in.message != MessageKind::none && row_masks.reads(row);
    }
    if constexpr (has_clock) finish(in, before, arrival, out);
    return out;
  }

  // For simulations that skip steps without effect. Returns how many steps of one tick could follow
  // in which only time passes, as long as the robot's observation stays the same, no beacon arrives,
  // and the oldest unread message of a queue is this one.
  std::uint16_t quiet(Sign sign, bool palm_at_target,
                      MessageKind unread = MessageKind::none) const {
    TableRobot next = *this;
    const RobotOutput out = next.step({sign, palm_at_target, 1, unread});
    if (next.state_ != state_ || out.send) return 0;
    if constexpr (mail == Mail::queue) {
      if (out.read) return 0;
    }
    int more = 0xFFFE;
    const auto until = [&](std::uint16_t since, std::uint16_t most) {
      if (since < most && most - since - 1 < more) more = most - since - 1;
    };
    if constexpr (has_clock) {
      const TableClock<Table>& clock = next.clock_;
      if constexpr (mail == Mail::beacons) {
        until(clock.since_sent, next.interval());
        until(clock.age, clock.stale());
        if constexpr (Beacons::spares) until(clock.age, Beacons::old(clock.times));
      }
      until(clock.since_entered, next.limit());
      clock.own.until(palm_at_target, clock.own_limits(), until);
    }
    return static_cast<std::uint16_t>(1 + more);
  }

  // Executes that many of these steps at once.
  constexpr void idle(Sign sign, std::uint16_t steps) {
    if constexpr (has_clock) {
      clock_.pass(steps, limit());
      clock_.own.stay(true, *this, is_centred(sign), !silence());
    }
  }

  constexpr State state() const { return state_; }
  constexpr const TableOutput& now() const { return outputs[static_cast<int>(state_)]; }
  constexpr char name() const { return now().name; }
  constexpr bool waits() const { return now().waits; }
  constexpr MessageKind awaits() const { return awaited[static_cast<std::size_t>(state_)]; }
  // True if it does not travel until its partner joins. A robot that stops as a correction does not
  // wait to be joined.
  constexpr bool stopped() const {
    if constexpr (has_clock) {
      return clock_.own.stopped;
    } else {
      return false;
    }
  }
  // True if it has to know after a boot that its palm was up for the partner.
  constexpr bool assists() const {
    if constexpr (requires { Table::assisting; }) return Table::assisting.has(state_);
    return false;
  }
  constexpr Role role() const { return clock_.role; }
  // True if there is no fresh message: the partner is silent, or does not hear this robot.
  constexpr bool silence() const { return clock_.silence(); }
  // What it remembers besides its state, for a model checker.
  constexpr const TableClock<Table>& clock() const { return clock_; }
  constexpr TableClock<Table>& clock() { return clock_; }
  constexpr void enter(State state) { state_ = state; }
  // Whether it corrects where it stands, as does its partner. Robots with messages hear what their
  // partner needs; the others would stop for a motion that never comes.
  constexpr bool is_in_place() const
    requires(has_clock && mail == Mail::none)
  {
    return clock_.in_place;
  }
  constexpr void set_in_place(bool in_place)
    requires(has_clock && mail == Mail::none)
  {
    clock_.in_place = in_place;
  }

  // True for a robot whose output is one of those for which the predicate holds, or in this state: as
  // of many robots in batch/bitslice_table.hpp.
  template <class Predicate>
  [[gnu::always_inline]] constexpr bool who(Predicate predicate) const {
    return predicate(now());
  }

 private:
  static constexpr TableRowMasks<Table> row_masks{};
  static constexpr auto awaited = [] {
    std::array<MessageKind, Table::states> messages{};
    for (std::size_t s = 0; s < messages.size(); ++s) {
      messages[s] = awaited_in<Table>(static_cast<State>(s));
    }
    return messages;
  }();

  static constexpr bool brakes = [] {
    for (const TableOutput& output : outputs) {
      if (output.brakes) return true;
    }
    return false;
  }();

  static constexpr State first(const Role& role, bool assisted) {
    if constexpr (requires { Table::started_by_touch(true); }) {
      if (role.by_touch) return Table::started_by_touch(role.leads);
    }
    if constexpr (requires { Table::assisting; }) {
      if (assisted) return Table::initial_assisting;
    }
    return Table::initial;
  }
  // The time limit of the present state [ticks].
  constexpr std::uint16_t limit() const
    requires has_clock
  {
    return now().limit < 0 ? 0 : clock_.times.limits[static_cast<std::size_t>(now().limit)];
  }
  // What has arrived from the partner since the last step.
  enum class Arrival : std::uint8_t { none, in_time, after_silence };

  // The time after which it repeats its message [ticks].
  constexpr std::uint16_t interval(Arrival arrival = Arrival::none) const
    requires has_clock
  {
    const Times& times = clock_.times;
    if constexpr (Beacons::spares) {
      if (arrival == Arrival::after_silence) return times.beacon;
      if (Table::quiet.has(state_)) return Beacons::quiet(times);
      if (silence() || clock_.age < Beacons::old(times)) {
        return arrival == Arrival::none ? Beacons::sparing(times) : Beacons::early(times);
      }
    }
    return times.beacon;
  }
  constexpr MessageKind heard(const RobotInput& in) const {
    if constexpr (mail == Mail::queue) {
      return in.message;
    } else {
      return clock_.heard();
    }
  }
  constexpr bool is_centred(Sign sign) const {
    if constexpr (requires { Table::idle; }) return state_ == Table::idle && sign == Sign::zero;
    return false;
  }
  constexpr TableConditions<bool> met(const RobotInput& in) {
    TableConditions<bool> met{.turned = in.palm_at_target};
    if constexpr (has_clock) {
      met.timed_out = clock_.since_entered >= limit();
      met.leads = clock_.role.leads;
      met.may_stop = clock_.role.may_stop;
      if constexpr (mail == Mail::none) met.may_stop = met.may_stop && !clock_.in_place;
      clock_.own.meet(met, true, *this, clock_.age, !silence(), clock_.own_limits());
    }
    return met;
  }
  constexpr void finish(const RobotInput& in, State before, Arrival arrival, RobotOutput& out) {
    if (state_ != before) clock_.since_entered = 0;
    if constexpr (brakes) {
      if (now().brakes && clock_.role.may_stop) {
        out.command.move = Move::hold;
        out.command.stop = true;
      }
    }
    if constexpr (mail == Mail::beacons) {
      const auto done = clock_.own.finish(true, *this, is_centred(in.sign), clock_.age, !silence(),
                                          clock_.own_limits());
      out.message = now().message;
      out.send = out.message != outputs[static_cast<int>(before)].message || done.is_news ||
                 clock_.since_sent >= interval(arrival);
      if (out.send) clock_.since_sent = 0;
      out.ready = done.ready;
      out.assists = assists();
      if (stopped()) out.command.stop = true;
    }
  }

  struct NoClock {};

  State state_;
  [[no_unique_address]] std::conditional_t<has_clock, TableClock<Table>, NoClock> clock_;
};

}  // namespace palmbots
