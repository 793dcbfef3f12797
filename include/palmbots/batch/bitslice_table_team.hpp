// SPDX-License-Identifier: Apache-2.0
// The controllers that are tables (control/table.hpp) for 64 pairs of robots at once, with one bit
// for each robot and bit-sliced numbers.
//
// TableTeam (sim/table_team.hpp) handles single robots and messages; this header does the same with
// operations on words, for any table. It requires that the only faults are reboots of robots that
// count time, that their clocks run like the carry's, and that all messages of a carry have the same
// delay or are lost.
#pragma once

#include <bit>
#include <type_traits>

#include "palmbots/batch/bitslice_beacons.hpp"
#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/batch/bitslice_queue.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

// 64 pairs with their radio, and their counts.
template <class Table>
class BitslicedTableTeam {
  using Robot = TableRobot<Table>;
  using Known = TableMessages<Table>;
  using State = typename Table::State;
  using Memory = TableMemory<Table, RobotMask, BitslicedCounter>;
  static constexpr bool is_queue = Table::mail == Mail::queue;
  static constexpr bool is_beacons = Table::mail == Mail::beacons;
  static constexpr bool has_memory = requires(Memory memory) { memory.partner_stopped; };
  static constexpr std::size_t message_bits =
      std::bit_width(static_cast<unsigned>(Known::count - 1));
  // A beacon of a table with a memory also says whether its sender rests, and whether it is ready.
  static constexpr std::size_t rests_bit = message_bits;
  static constexpr std::size_t ready_bit = message_bits + 1;
  static constexpr std::size_t content_bits = message_bits + (has_memory ? 2 : 0);
  using Messages = BitslicedMessage<message_bits>;
  using Content = BitslicedMessage<content_bits>;
  using Time = BitslicedCount<12>;
  using Beacons = TableBeacons<Table>;

  static constexpr bool stops(const TableOutput& output) {
    return output.command.stop || output.brakes;
  }

 public:
  static constexpr bool can_stop =
      has_memory || std::ranges::any_of(Table::outputs, [](const auto& o) { return stops(o); });
  static constexpr bool station = false;

  static bool supports(const TableTeam<Table>& team) {
    if constexpr (Robot::has_clock) {
      const auto& t = team.robot(left).clock().times;
      for (const std::uint16_t limit : t.limits) {
        if (limit > Time::most) return false;
      }
      if (!team.keeps_time() || !team.faults().are_reboots()) return false;
      if constexpr (has_memory) {
        for (const std::uint16_t limit : Memory::limits(t)) {
          if (limit > BitslicedCounter::most) return false;
        }
      }
      if (is_beacons &&
          (t.lease + 1U > BitslicedCounter::most || Beacons::longest(t) > Time::most)) {
        return false;
      }
    } else if (team.faults().any()) {
      return false;
    }
    return Table::mail == Mail::none || BitslicedDelay::supports(team.radio().steady_delay());
  }

  void insert(int i, const TableTeam<Table>& team) {
    const RobotMask here = both_at(i);
    there_ |= here;
    if constexpr (Robot::has_clock) {
      const auto& t = team.robot(left).clock().times;
      for (std::size_t k = 0; k < Table::limits; ++k) limits_[k].assign(here, t.limits[k]);
      beacon_.assign(here, t.beacon);
      if constexpr (Beacons::spares) {
        quiet_.assign(here, Beacons::quiet(t));
        sparing_.assign(here, Beacons::sparing(t));
        early_.assign(here, Beacons::early(t));
        old_.assign(here, Beacons::old(t));
      }
      stale_.assign(here, t.lease + 1U);
      if constexpr (has_memory) {
        const auto own = Memory::limits(t);
        for (std::size_t k = 0; k < own.size(); ++k) own_limits_[k].assign(here, own[k]);
      }
      for (const std::size_t side : {left, right}) {
        if (team.robot(side).role().leads) leads_[side] |= CarryMask{1} << i;
        if (team.robot(side).role().may_stop) may_stop_[side] |= CarryMask{1} << i;
      }
    }
    if constexpr (Table::mail != Mail::none) mail_.insert(i, team.radio().steady_delay());
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
    if constexpr (Table::mail != Mail::none) mail_.erase(i);
    commands_.erase(here);
    cases_.erase(i);
  }

  CarryMask step(std::uint64_t tick, const BitslicedObservation& sensed,
                 const BitslicedProgramState& programs, const BitslicedLoss& lost) {
    if (either(programs.booting) != 0) [[unlikely]]
      boot(programs.booting);
    const RobotMask run = there_ & ~programs.off;
    if constexpr (Robot::has_clock) since_entered_.increment();
    own_.pass(1, own_limits_);
    const Heard heard = hear(tick, run);
    TableConditions<RobotMask> met{.turned = sensed.palm_at_target,
                                   .timed_out = timed_out(),
                                   .leads = leads_,
                                   .may_stop = may_stop_};
    own_.meet(met, run, robots_, age_, ~heard.message[0], own_limits_);
    RobotMask entered{};
    RobotMask reads{};
    Messages sends;
    robots_.step(
        run,
        [&](const typename Robot::Row& row) {
          return fits_in_table<Table, RobotMask>(row, sensed, heard, met);
        },
        [&](const typename Robot::Row& row, RobotMask whose) {
          if constexpr (Robot::has_clock) entered |= whose & ~robots_.in(row.next);
          if constexpr (is_queue) {
            sends.insert(whose, code(row.send));
            if (row.reads()) reads |= whose;
          }
        });
    if constexpr (Robot::has_clock) since_entered_.assign(entered, 0);
    if constexpr (is_queue) {
      mail_.read(reads);
      mail_.post(tick, lost.from_robot, sends);
    } else if constexpr (is_beacons) {
      say(tick, run, sensed, ~heard.message[0], lost);
    }
    cases_.note(robots_);
    const BitslicedCommand before = std::exchange(commands_, robots_.commands());
    if constexpr (Robot::has_clock) {
      commands_.switch_off(may_stop_ &
                           robots_.who([](const TableOutput& output) { return output.brakes; }));
      commands_.stop |= own_.stopped & there_;
      // A robot that is off keeps its palm, also one whose program has not run yet.
      commands_.shallow = (commands_.shallow & ~programs.off) | (before.shallow & programs.off);
      commands_.switch_off(programs.off);
    }
    return commands_.differ(before);
  }

  const BitslicedCommand& commands() const { return commands_; }

  void write_results(int i, std::uint32_t ticks, Metrics& metrics, LinkTotals& link_totals) const {
    cases_.write_results(i, ticks, metrics);
    if constexpr (Table::mail != Mail::none) {
      mail_.write_results(i, link_totals);
    } else {
      link_totals.sent = link_totals.lost = 0;
    }
  }

 private:
  // What the robots hear, by its place in the list of known messages.
  struct Heard {
    std::array<RobotMask, Known::count> message{};

    [[gnu::always_inline]] RobotMask is(MessageKind kind) const {
      return message[static_cast<std::size_t>(Known::number_of(kind))];
    }
  };

  // A message as the number that is bit-sliced.
  static constexpr MessageKind code(MessageKind message) {
    return static_cast<MessageKind>(Known::number_of(message));
  }

  void boot(RobotMask whose) {
    RobotMask assisted{};
    if constexpr (requires { Table::assisting; }) {
      assisted = whose & robots_.where([](State state) { return Table::assisting.has(state); });
      robots_.insert(assisted, Table::initial_assisting);
    }
    robots_.insert(whose & ~assisted, Table::initial);
    since_entered_.assign(whose, 0);
    own_.boot(whose, own_limits_);
    if constexpr (is_beacons) {
      says_.erase(whose);
      says_.insert(whose, messages());
      age_.assign(whose, BitslicedCounter::most);
      since_sent_.assign(whose, Time::most);
      mail_.boot(whose);
    }
  }

  // The robots that have been in their state for its time limit.
  [[gnu::always_inline]] RobotMask timed_out() const {
    RobotMask found{};
    for (std::size_t k = 0; k < Table::limits; ++k) {
      const RobotMask limited = robots_.who(
          [&](const TableOutput& output) { return output.limit == static_cast<int>(k); });
      if (either(limited) != 0) found |= limited & since_entered_.at_least(limits_[k]);
    }
    return found;
  }

  [[gnu::always_inline]] Heard hear(std::uint64_t tick, RobotMask run) {
    Heard heard;
    if constexpr (is_queue) {
      const Messages& unread = mail_.hear(tick);
      for (std::size_t k = 0; k < Known::count; ++k) {
        heard.message[k] = unread.is(static_cast<MessageKind>(k));
      }
    } else if constexpr (is_beacons) {
      age_.increment();
      since_sent_.increment();
      if constexpr (Beacons::spares) answers_ = age_.at_least(stale_);
      const RobotMask news = arrived_ = mail_.hear(tick, run, newest_, age_);
      answers_ &= news;
      if constexpr (has_memory) own_.hear(news, newest_.bit[rests_bit], newest_.bit[ready_bit]);
      const RobotMask silence = heard.message[0] = age_.at_least(stale_);
      mail_.count_late(news & silence);
      for (std::size_t k = 1; k < Known::count; ++k) {
        heard.message[k] =
            newest_.template first<message_bits>().is(static_cast<MessageKind>(k)) & ~silence;
      }
    }
    return heard;
  }

  [[gnu::always_inline]] void say(std::uint64_t tick, RobotMask run,
                                  const BitslicedObservation& sensed, RobotMask fresh,
                                  const BitslicedLoss& lost) {
    const Messages said = std::exchange(says_, messages());
    RobotMask centred{};
    if constexpr (has_memory)
      centred = robots_.in(Table::idle) & ~(sensed.positive | sensed.negative);
    const auto own = own_.finish(run, robots_, centred, age_, fresh, own_limits_);
    const RobotMask send = (says_.differ(said) | own.is_news | repeats(fresh)) & run;
    since_sent_.assign(send, 0);
    Content content;
    content.insert(~RobotMask{}, says_);
    if constexpr (has_memory) {
      content.bit[rests_bit] = own_.stopped;
      content.bit[ready_bit] = own.ready;
    }
    mail_.post(tick, send, lost.from_robot, content);
  }

  // The robots that repeat their message (TableBeacons).
  [[gnu::always_inline]] RobotMask repeats([[maybe_unused]] RobotMask fresh) const {
    const RobotMask beacon = since_sent_.at_least(beacon_);
    if constexpr (Beacons::spares) {
      const RobotMask quiet = robots_.where([](State state) { return Table::quiet.has(state); });
      const RobotMask loses = fresh & age_.at_least(old_);
      const RobotMask busy = since_sent_.at_least(sparing_) |
                             (since_sent_.at_least(early_) & arrived_) | (beacon & loses);
      return (since_sent_.at_least(quiet_) & quiet) | (busy & ~quiet) | (beacon & answers_);
    } else {
      return beacon;
    }
  }

  // The messages that the robots say in their states.
  [[gnu::always_inline]] Messages messages() const {
    Messages found;
    for (std::size_t k = 1; k < Known::count; ++k) {
      found.insert(
          robots_.who([&](const TableOutput& output) { return output.message == Known::list[k]; }),
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
  Memory own_;
  std::conditional_t<has_memory, std::array<BitslicedCounter, 3>, int> own_limits_{};

  Content newest_;  // the partner's newest beacon
  Messages says_;   // its own message
  BitslicedCounter age_;
  RobotMask arrived_{};  // they have heard something
  RobotMask answers_{};  // and had heard nothing before
  Time since_sent_;
  Time beacon_;  // the beacon period
  Time quiet_;   // as in TableBeacons
  Time sparing_;
  Time early_;
  BitslicedCounter old_;
  BitslicedCounter stale_;  // the smallest age at which a message is too old
  std::conditional_t<is_queue, BitslicedQueue<message_bits>, BitslicedBeacons<content_bits>> mail_;

  BitslicedCommand commands_;
  BitslicedCaseMetrics cases_;
};

template <class Table>
struct BitslicedTeam<TableTeam<Table>> : BitslicedTableTeam<Table> {
  static constexpr bool exist = true;
};

}  // namespace palmbots
