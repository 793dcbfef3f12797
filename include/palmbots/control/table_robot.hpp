// SPDX-License-Identifier: Apache-2.0
// A robot whose program is a table (control/table.hpp): its state, the time that it has been in it,
// and the partner's newest word with its age.
//
// INTERFACE. step(Input) → Output once per control tick. The object itself is the only memory. The
// caller keeps a BeaconReceiver (control/beacon.hpp) and, across a reboot, the epoch. Times are in
// ticks.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/lease_state.hpp"
#include "palmbots/control/table.hpp"

namespace palmbots {

// The rows of a table as sets: those that start in a state, those that fit a sign, a word and the
// further conditions. The first row in all of them is the one that a robot runs. So a step has no
// loop, and the sets take some hundred bytes where a table over every input would take thousands.
template <class Table>
class TableRowMasks {
  using State = typename Table::State;
  using Words = TableWords<Table>;
  static constexpr std::size_t rows = sizeof(Table::rows) / sizeof(Table::rows[0]);
  static_assert(rows <= 64);

 public:
  constexpr TableRowMasks() {
    for (std::size_t i = 0; i < rows; ++i) {
      const TableRow<State>& row = Table::rows[i];
      const std::uint64_t bit = std::uint64_t{1} << i;
      const auto add = [&](std::uint64_t& mask, bool fits) { mask |= fits ? bit : 0; };
      for (int s = 0; s < Table::states; ++s) add(start_[s], row.from.has(static_cast<State>(s)));
      for (int sign = 0; sign < 3; ++sign) {
        add(sign_[sign], holds(row.p, observation_of(static_cast<Sign>(sign - 1), false)));
      }
      for (int w = 0; w < Words::count; ++w) {
        add(word_[w], row.heard.has(Words::list[static_cast<std::size_t>(w)]));
      }
      for (unsigned c = 0; c < 16; ++c) add(condition_[c], meets<bool>(row.when, conditions(c)));
    }
  }

  // The state after a step.
  constexpr State next(State state, Sign sign, MessageKind heard,
                       const TableConditions<bool>& met) const {
    const std::uint64_t fit = start_[static_cast<int>(state)] & sign_[static_cast<int>(sign) + 1] &
                              word_[Words::number_of(heard)] & condition_[number_of(met)];
    return fit == 0 ? state : Table::rows[std::countr_zero(fit)].next;
  }

 private:
  static constexpr unsigned number_of(const TableConditions<bool>& met) {
    return unsigned{met.settled} | unsigned{met.timed_out} << 1 | unsigned{met.leads} << 2 |
           unsigned{met.may_stop} << 3;
  }
  static constexpr TableConditions<bool> conditions(unsigned number) {
    return {(number & 1) != 0, (number & 2) != 0, (number & 4) != 0, (number & 8) != 0};
  }

  std::uint64_t start_[Table::states]{};
  std::uint64_t sign_[3]{};
  std::uint64_t word_[Words::count]{};
  std::uint64_t condition_[16]{};
};

// The program of one robot.
template <class TheTable>
class TableRobot {
 public:
  using Table = TheTable;
  using State = typename Table::State;
  using Row = TableRow<State>;
  using StateOutput = TableOutput;
  using Words = TableWords<Table>;
  static_assert(is_sound<Table>());
  static constexpr int states = Table::states;
  static constexpr bool talks = Table::talks;
  static constexpr const auto& outputs = Table::outputs;
  static constexpr const auto& rows = Table::rows;

  // In ticks; each is below 65535.
  struct Times {
    std::uint16_t beacon;
    std::uint16_t lease;
    std::array<std::uint16_t, Table::limits> limits;
  };

  // What a robot knows from the start.
  struct Role {
    bool leads;             // it is the front robot in the direction of travel
    bool may_stop;          // the scene lets robots stop as a correction
    bool by_touch = false;  // the follower starts first, and the leader when it feels that
  };

  using Input = RobotInput;

  struct Output {
    Command command;
    MessageKind message;  // the robot's current word, at all times
    bool send;            // a beacon is due now
    static constexpr bool ready = false;
  };

  constexpr TableRobot(const Times& times, Role role)
      : times_(times),
        role_(role),
        state_(first(role)),
        age_(static_cast<std::uint16_t>(times.lease + 1)),
        since_sent_(times.beacon) {}

  // The robot after a boot.
  constexpr TableRobot booted() const { return TableRobot(times_, {role_.leads, role_.may_stop}); }

  Output step(const Input& in) {
    pass(in.elapsed);
    if (in.message != MessageKind::none) {
      word_ = in.message;
      age_ = in.age < stale() ? in.age : stale();
    }
    const State before = state_;
    const MessageKind said = now().message;
    state_ = row_masks.next(state_, in.sign, heard(), met(in.palm_at_target));
    if (state_ != before) since_entered_ = 0;
    const bool send = talks && (now().message != said || since_sent_ >= times_.beacon);
    if (send) since_sent_ = 0;
    Command command = now().command;
    command.stop = command.stop || (now().brakes && role_.may_stop);
    return {command, now().message, send};
  }

  // For simulations that skip steps without effect. Returns how many steps of one tick could follow
  // in which only time passes, as long as the robot's observation stays the same and no beacon
  // arrives.
  std::uint16_t quiet(Sign sign, bool palm_at_target) const {
    TableRobot next = *this;
    const Output out = next.step({sign, palm_at_target, 1, MessageKind::none, false, false, 0});
    if (next.state_ != state_ || out.send) return 0;
    int more = 0xFFFE;
    const auto until = [&](std::uint16_t since, std::uint16_t most) {
      if (since < most && most - since - 1 < more) more = most - since - 1;
    };
    if (talks) {
      until(next.since_sent_, times_.beacon);
      until(next.age_, stale());
    }
    until(next.since_entered_, limit());
    return static_cast<std::uint16_t>(1 + more);
  }

  // Executes that many of these steps at once.
  constexpr void idle(Sign, std::uint16_t steps) { pass(steps); }

  constexpr State state() const { return state_; }
  constexpr const StateOutput& now() const { return outputs[static_cast<int>(state_)]; }
  // A robot that stops as a correction does not wait to be joined.
  static constexpr bool stopped() { return false; }
  constexpr Role role() const { return role_; }
  // True if there is no fresh word: the partner is silent, or does not hear this robot.
  constexpr bool silence() const { return age_ >= stale(); }

 private:
  static constexpr TableRowMasks<Table> row_masks{};

  static constexpr State first(const Role& role) {
    if constexpr (requires { Table::started_by_touch(true); }) {
      if (role.by_touch) return Table::started_by_touch(role.leads);
    }
    return Table::initial;
  }
  constexpr std::uint16_t stale() const { return static_cast<std::uint16_t>(times_.lease + 1); }
  // The time limit of the present state [ticks].
  constexpr std::uint16_t limit() const {
    return now().limit < 0 ? 0 : times_.limits[static_cast<std::size_t>(now().limit)];
  }
  constexpr MessageKind heard() const { return silence() ? MessageKind::none : word_; }
  constexpr TableConditions<bool> met(bool palm_at_target) const {
    return {palm_at_target, since_entered_ >= limit(), role_.leads, role_.may_stop};
  }
  constexpr void pass(std::uint16_t elapsed) {
    advance(age_, elapsed, stale());
    advance(since_entered_, elapsed, limit());
    advance(since_sent_, elapsed, times_.beacon);
  }

  Times times_;
  Role role_;
  State state_;
  MessageKind word_ = MessageKind::none;  // the partner's newest
  std::uint16_t age_;                     // of it
  std::uint16_t since_entered_ = 0;       // since the state was entered
  std::uint16_t since_sent_;              // since the last beacon
};

}  // namespace palmbots
