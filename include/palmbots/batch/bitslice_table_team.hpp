// SPDX-License-Identifier: Apache-2.0
// The controllers that are tables (control/table.hpp) for 64 pairs of robots at once, with one bit
// for each robot and bit-sliced numbers.
//
// TableTeam (sim/table_team.hpp) handles single robots and beacons; this header does the same with
// operations on words, for any table. It requires that the only faults are reboots of robots, that
// their clocks run like the carry's, and, if the table talks, that all beacons of a carry have the
// same delay or are lost (batch/bitslice_beacons.hpp).
#pragma once

#include <bit>

#include "palmbots/batch/bitslice_beacons.hpp"
#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

// 64 pairs with their radio, and their counts.
template <class Table>
class BitslicedTableTeam {
  using Robot = TableRobot<Table>;
  using Words = TableWords<Table>;
  using State = typename Table::State;
  static constexpr std::size_t bits = std::bit_width(static_cast<unsigned>(Words::count - 1));
  using Messages = BitslicedMessage<bits>;
  using Time = BitslicedCount<12>;

 public:
  static constexpr bool can_stop = true;
  static constexpr bool station = false;

  static bool supports(const TableTeam<Table>& team) {
    const auto& t = team.times();
    for (const std::uint16_t limit : t.limits) {
      if (limit > Time::most) return false;
    }
    if (!team.keeps_time() || !(team.faults().are_reboots())) return false;
    return !Table::talks ||
           (std::max(std::uint32_t{t.beacon}, t.lease + 1U) <= BitslicedCounter::most &&
            BitslicedDelay::supports(team.radio().steady_delay()));
  }

  void insert(int i, const TableTeam<Table>& team) {
    const RobotMask here = both_at(i);
    const auto& t = team.times();
    for (std::size_t k = 0; k < Table::limits; ++k) limits_[k].assign(here, t.limits[k]);
    for (const std::size_t side : {left, right}) {
      if (team.robot(side).role().leads) leads_[side] |= CarryMask{1} << i;
      if (team.robot(side).role().may_stop) may_stop_[side] |= CarryMask{1} << i;
    }
    there_ |= here;
    if constexpr (Table::talks) {
      beacon_.assign(here, t.beacon);
      stale_.assign(here, t.lease + 1U);
      beacons_.insert(i, team.radio().steady_delay());
    }
    boot(here);
    for (const std::size_t side : {left, right}) {
      RobotMask one{};
      one[side] = CarryMask{1} << i;
      robots_.insert(one, team.robot(side).state());
    }
    cases_.insert(i);
  }

  void erase(int i) {
    const RobotMask here = both_at(i);
    robots_.erase(here);
    for (RobotMask* words : {&leads_, &may_stop_, &there_}) *words &= ~here;
    if constexpr (Table::talks) beacons_.erase(i);
    commands_.erase(here);
    cases_.erase(i);
  }

  CarryMask step(std::uint64_t tick, const BitslicedObservation& sensed,
                 const BitslicedProgramState& programs, const BitslicedLoss& lost) {
    if (either(programs.booting) != 0) [[unlikely]]
      boot(programs.booting);
    const RobotMask run = there_ & ~programs.off;
    since_entered_.increment();
    Heard heard;
    if constexpr (Table::talks) heard = hear(tick, run);
    const TableConditions<RobotMask> met{sensed.palm_at_target, timed_out(), leads_, may_stop_};
    RobotMask entered{};
    robots_.step(
        run,
        [&](const typename Robot::Row& row) {
          return fits_in_table<Table, RobotMask>(row, sensed, heard, met);
        },
        [&](const typename Robot::Row& row, RobotMask whose) {
          entered |= whose & ~robots_.in(row.next);
        });
    since_entered_.assign(entered, 0);
    if constexpr (Table::talks) say(tick, run, lost);
    cases_.note(robots_);
    const BitslicedCommand before = std::exchange(commands_, robots_.commands());
    commands_.stop |=
        may_stop_ & robots_.who([](const TableOutput& output) { return output.brakes; });
    // A robot that is off keeps its palm, also one whose program has not run yet.
    commands_.shallow = (commands_.shallow & ~programs.off) | (before.shallow & programs.off);
    commands_.switch_off(programs.off);
    return commands_.differ(before);
  }

  const BitslicedCommand& commands() const { return commands_; }

  void write_results(int i, std::uint32_t ticks, Metrics& metrics, LinkTotals& link_totals) const {
    cases_.write_results(i, ticks, metrics);
    if constexpr (Table::talks) {
      beacons_.write_results(i, link_totals);
    } else {
      link_totals.sent = link_totals.lost = 0;
    }
  }

 private:
  // The newest words while they are fresh, by their place in the list of words.
  struct Heard {
    std::array<RobotMask, Words::count> word{};

    [[gnu::always_inline]] RobotMask is(MessageKind kind) const {
      return word[static_cast<std::size_t>(Words::number_of(kind))];
    }
  };

  // A word as the number that is bit-sliced.
  static constexpr MessageKind code(MessageKind word) {
    return static_cast<MessageKind>(Words::number_of(word));
  }

  void boot(RobotMask whose) {
    robots_.insert(whose, Table::initial);
    since_entered_.assign(whose, 0);
    if constexpr (Table::talks) {
      says_.erase(whose);
      says_.insert(whose, code(Table::outputs[static_cast<std::size_t>(Table::initial)].message));
      age_.assign(whose, BitslicedCounter::most);
      since_sent_.assign(whose, BitslicedCounter::most);
      beacons_.boot(whose);
    }
  }

  // The robots that have been in their state for its time limit.
  [[gnu::always_inline]] RobotMask timed_out() const {
    RobotMask found{};
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      const auto add = [&](std::size_t limit) {
        const RobotMask limited = robots_.who(
            [&](const TableOutput& output) { return output.limit == static_cast<int>(limit); });
        if (either(limited) != 0) found |= limited & since_entered_.at_least(limits_[limit]);
      };
      (add(k), ...);
    }(std::make_index_sequence<Table::limits>());
    return found;
  }

  [[gnu::always_inline]] Heard hear(std::uint64_t tick, RobotMask run) {
    age_.increment();
    since_sent_.increment();
    beacons_.hear(tick, run, newest_, age_, stale_);
    const RobotMask silence = age_.at_least(stale_);
    Heard heard;
    heard.word[0] = silence;
    for (std::size_t k = 1; k < Words::count; ++k) {
      heard.word[k] = newest_.is(static_cast<MessageKind>(k)) & ~silence;
    }
    return heard;
  }

  [[gnu::always_inline]] void say(std::uint64_t tick, RobotMask run, const BitslicedLoss& lost) {
    const Messages said = std::exchange(says_, words());
    const RobotMask send = (says_.differ(said) | since_sent_.at_least(beacon_)) & run;
    since_sent_.assign(send, 0);
    beacons_.post(tick, send, lost.from_robot, says_);
  }

  // The words that the robots say in their states.
  [[gnu::always_inline]] Messages words() const {
    Messages found;
    for (std::size_t k = 1; k < Words::count; ++k) {
      found.insert(
          robots_.who([&](const TableOutput& output) { return output.message == Words::list[k]; }),
          static_cast<MessageKind>(k));
    }
    return found;
  }

  BitslicedTable<Robot> robots_;
  RobotMask there_{};
  RobotMask leads_{};
  RobotMask may_stop_{};
  Time since_entered_;
  std::array<Time, Table::limits> limits_;

  Messages newest_;  // the partner's newest word
  Messages says_;    // its own word
  BitslicedCounter age_;
  BitslicedCounter since_sent_;
  BitslicedCounter beacon_;  // the beacon period
  BitslicedCounter stale_;   // the smallest age at which a word is too old
  BitslicedBeacons<bits> beacons_;

  BitslicedCommand commands_;
  BitslicedCaseMetrics cases_;
};

template <class Table>
struct BitslicedTeam<TableTeam<Table>> : BitslicedTableTeam<Table> {
  static constexpr bool exist = true;
};

}  // namespace palmbots
