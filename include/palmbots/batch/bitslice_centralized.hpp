// SPDX-License-Identifier: Apache-2.0
// The centralized algorithm for 64 pairs of robots at once, each with its station. Every truth
// value is one bit for each pair or robot.
//
// CentralizedTeam (sim/centralized_team.hpp) handles single packets; this header does the same with
// operations on words. The cases are those of Centralized::table. It requires that the only faults
// are reboots of robots, that the stations never fail, and that all packets of a carry have the
// same delay or are lost.
#pragma once

#include "palmbots/batch/bitslice_counters.hpp"
#include "palmbots/batch/bitslice_io.hpp"
#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/metrics.hpp"

namespace palmbots {

// The reports of the robots.
struct BitslicedReport {
  RobotMask positive{};
  RobotMask negative{};
  RobotMask shallow{};         // the angle last commanded
  RobotMask palm_at_target{};  // the palm has reached that angle
};

// 64 stations without their radio: Centralized::step() for all of them. The conditions are shared
// with control/centralized.hpp. The stages are implemented twice, here for 64 stations and there
// for one: in this form a single carry would execute two fifths more instructions.
// tests/cpp/batch/transition_table_test.cpp compares both in every state and for every input.
class BitslicedStations {
  using Table = Centralized;

 public:
  void insert(int i) { decide_ |= CarryMask{1} << i; }
  void erase(int i) {
    for (CarryMask* stage : {&decide_, &tilt_, &first_, &second_, &restore_})
      *stage &= ~(CarryMask{1} << i);
  }

  // One tick of the stations that have received reports from both of their robots.
  BitslicedCommand step(CarryMask hear, const BitslicedReport& in) {
    CarryMask to_decide = 0;
    CarryMask to_tilt = 0;
    CarryMask to_first = 0;
    CarryMask to_second = 0;
    CarryMask to_restore = 0;
    entered_ = 0;
    const auto heard = [&](std::size_t side) {
      return Table::Heard<CarryMask>{
          {in.positive[side], in.negative[side], in.palm_at_target[side]}, in.shallow[side]};
    };
    const Table::Heard<CarryMask> robots[2] = {heard(left), heard(right)};
    each_case([&](std::size_t k, const Table::Case& now) {
      const CarryMask here = in_case_[k] & hear;
      to_first |= here & tilt_ & Table::palm_is_at(now.tilt, Palm::shallow, robots);
      const CarryMask done_first = here & first_ & Table::done(now.first, robots);
      (now.second.move == Move::hold ? to_restore : to_second) |= done_first;
      to_restore |= here & second_ & Table::done(now.second, robots);
      to_decide |= here & restore_ & Table::palm_is_at(now.tilt, Palm::steep, robots);
      const CarryMask enter = hear & decide_ & Table::shows(now.sign[left], robots[left]) &
                              Table::shows(now.sign[right], robots[right]);
      (now.tilt == Table::Who::none ? to_first : to_tilt) |= enter;
      in_case_[k] = (in_case_[k] & ~(hear & decide_)) | enter;
      entered_ |= enter;
    });
    const CarryMask leave_tilt = tilt_ & to_first;
    const CarryMask leave_first = first_ & (to_second | to_restore);
    decide_ = (decide_ & ~entered_) | to_decide;
    second_ = (second_ & ~to_restore) | to_second;
    tilt_ = (tilt_ & ~leave_tilt) | to_tilt;
    first_ = (first_ & ~leave_first) | to_first;
    restore_ = (restore_ & ~to_decide) | to_restore;
    return commands();
  }

  // The stations that entered a case in this tick.
  CarryMask entered() const { return entered_; }

 private:
  template <class Visit>
  [[gnu::always_inline]] static void each_case(Visit visit) {
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      (visit(k, Table::table[k]), ...);
    }(std::make_index_sequence<std::size(Table::table)>());
  }

  BitslicedCommand commands() const {
    BitslicedCommand output;
    const CarryMask up = tilt_ | first_ | second_;
    CarryMask away = 0;
    CarryMask closer = 0;
    each_case([&](std::size_t k, const Table::Case& now) {
      const auto act = [&](Move move, CarryMask stage) {
        if (move == Move::away) away |= in_case_[k] & stage;
        if (move == Move::closer) closer |= in_case_[k] & stage;
      };
      act(now.first.move, first_);
      act(now.second.move, second_);
      if (now.tilt == Table::Who::on_left) output.shallow[left] |= in_case_[k] & up;
      if (now.tilt == Table::Who::on_right) output.shallow[right] |= in_case_[k] & up;
    });
    output.away = RobotMask{away, away};
    output.closer = RobotMask{closer, closer};
    return output;
  }

  std::array<CarryMask, Table::cases> in_case_{};  // the case in progress, or the last one
  CarryMask decide_ = 0;                           // stations in that stage
  CarryMask tilt_ = 0;
  CarryMask first_ = 0;
  CarryMask second_ = 0;
  CarryMask restore_ = 0;
  CarryMask entered_ = 0;
};

// 64 stations with their robots and radio, and their counts (sim/metrics.hpp).
class BitslicedCentralized {
 public:
  static constexpr bool can_stop = true;  // a robot that is off
  static constexpr bool station = true;

  static bool supports(const CentralizedTeam& team) {
    return BitslicedDelay::supports(team.radio().steady_delay()) && team.faults().are_reboots();
  }

  void insert(int i, const CentralizedTeam& team) {
    controllers_.insert(i);
    delays_.insert(i, team.radio().steady_delay());
    for (BitslicedCounts* counts :
         {&corrections_, &off_, &reports_lost_, &commands_lost_, &hellos_})
      counts->clear(both_at(i));
    sessions_.insert(i, team.judges());
  }

  void erase(int i) {
    const RobotMask those = ~both_at(i);
    controllers_.erase(i);
    delays_.erase(i);
    for (Row& row : line_) {
      row.reported &= those;
      row.commands_arrive &= those;
    }
    commands_.erase(~those);
    heard_ &= those;
    sessions_.erase(i);
  }

  CarryMask step(std::uint64_t tick, const BitslicedObservation& sensed,
                 const BitslicedProgramState& programs, const BitslicedLoss& lost) {
    const Row& arrived = line_[tick % line_.size()];
    const BitslicedCommand before = commands_;
    const BitslicedReport said{sensed.positive, sensed.negative, commands_.shallow,
                               sensed.palm_at_target};
    sessions_.boot(programs.booting, line_);
    hear(arrived, tick);
    obey(arrived, programs);
    const CarryMask hear_both = heard_[left] & heard_[right];
    const BitslicedCommand sent = controllers_.step(hear_both, reports_);
    const RobotMask commanded = RobotMask{} + hear_both;
    const RobotMask greeted = sessions_.unanswered(arrived) & ~commanded;
    const RobotMask addressed = commanded | greeted;
    if (either(greeted) != 0) [[unlikely]]
      hellos_.add(greeted);
    // Robots are seldom off, and messages are seldom lost.
    if (either(programs.off) != 0) [[unlikely]]
      off_.add(programs.off);
    if (either(lost.from_robot | lost.from_station) != 0) {
      reports_lost_.add(lost.from_robot & ~programs.off);
      commands_lost_.add(lost.from_station & addressed);
    }
    corrections_.add(RobotMask{controllers_.entered(), 0});
    delays_.each(tick, [&](std::size_t place, RobotMask whose) {
      Row& row = line_[place];
      const auto put = [&](RobotMask& there, RobotMask what) {
        there = (there & ~whose) | (what & whose);
      };
      put(row.report.positive, said.positive);
      put(row.report.negative, said.negative);
      put(row.report.shallow, said.shallow);
      put(row.report.palm_at_target, said.palm_at_target);
      put(row.commands.shallow, sent.shallow);
      put(row.commands.away, sent.away);
      put(row.commands.closer, sent.closer);
      put(row.reported, ~(programs.off | lost.from_robot));
      put(row.commands_arrive, addressed & ~lost.from_station);
      if (sessions_.any()) {
        put(row.answers, sessions_.robot_heard);
        put(row.is_present, ~RobotMask{});
        put(row.is_known, sessions_.station_knows & commanded);
      }
    });
    now_ = tick;
    return commands_.differ(before);
  }

  const BitslicedCommand& commands() const { return commands_; }

  // In every tick each running robot sends to the station. The station commands both robots once it
  // has received from both. Before that it only answers reports without a session.
  void write_results(int i, std::uint32_t ticks, Metrics& metrics, LinkTotals& link_totals) const {
    metrics.corrections = corrections_.of(left, i);
    const bool heard = (heard_[left] & heard_[right] & CarryMask{1} << i) != 0;
    const std::uint64_t answers = heard ? now_ + 1 - heard_since_[static_cast<std::size_t>(i)] : 0;
    link_totals.sent = 0;
    link_totals.lost = 0;
    for (const std::size_t side : {left, right}) {
      metrics.waiting_ticks[side] = 0;
      metrics.waits_since[side] = ticks;
      link_totals.links[side].sent = ticks - off_.of(side, i);
      link_totals.links[side].lost = reports_lost_.of(side, i);
      link_totals.links[side + 2].sent = static_cast<std::uint32_t>(answers) + hellos_.of(side, i);
      link_totals.links[side + 2].lost = commands_lost_.of(side, i);
    }
    for (const LinkCounts& link : link_totals.links) {
      link_totals.sent += link.sent;
      link_totals.lost += link.lost;
    }
  }

 private:
  // The arrivals of a tick: reports, commands, and which of them arrive.
  struct Row {
    BitslicedReport report;
    BitslicedCommand commands;
    RobotMask reported{};
    RobotMask commands_arrive{};  // or hellos
    // With sessions: the robot had heard the station since its boot, it has not booted since, and
    // the station knew its present boot.
    RobotMask answers{};
    RobotMask is_present{};
    RobotMask is_known{};
  };

  // The sessions (sim/session_link.hpp) of robots that may boot, for radios on which packets are
  // neither repeated nor overtaken.
  struct Sessions {
    RobotMask judged{};         // robots of carries in which packets are judged
    RobotMask robot_heard{};    // robots that have heard the station since their boot
    RobotMask station_knows{};  // robots whose station has heard them since their boot

    bool any() const { return either(judged) != 0; }

    void insert(int i, bool judges) {
      if (judges) judged |= both_at(i);
      robot_heard |= both_at(i);
      station_knows |= both_at(i);
    }
    void erase(int i) { judged &= ~both_at(i); }

    template <class Line>
    void boot(RobotMask booting, Line& line) {
      if (either(booting & judged) == 0) [[likely]]
        return;
      robot_heard &= ~booting;
      station_knows &= ~booting;
      for (Row& row : line) {
        row.is_present &= ~booting;
        row.is_known &= ~booting;
      }
    }

    // Robots whose report has just come without a session.
    RobotMask unanswered(const Row& arrived) const {
      return arrived.reported & ~arrived.answers & judged;
    }
    // Take in what has arrived at the stations, and at these robots. Return the robots whose packets
    // are acted upon.
    RobotMask reports(const Row& arrived) {
      station_knows |= arrived.reported & arrived.is_present;
      return arrived.reported & (arrived.answers | ~judged);
    }
    RobotMask commands(const Row& arrived, RobotMask running) {
      robot_heard |= arrived.commands_arrive & running;
      return arrived.commands_arrive & running & (arrived.is_known | ~judged);
    }
  };

  // Robots execute the newest command. A robot that boots has none (palm steep, nominal speed)
  // until one arrives.
  void obey(const Row& arrived, const BitslicedProgramState& programs) {
    commands_.erase(programs.booting);
    const RobotMask whose = sessions_.commands(arrived, ~programs.off);
    const auto take = [&](RobotMask& newest, RobotMask said) {
      newest = (newest & ~whose) | (said & whose);
    };
    take(commands_.shallow, arrived.commands.shallow);
    take(commands_.away, arrived.commands.away);
    take(commands_.closer, arrived.commands.closer);
    commands_.switch_off(programs.off);
  }

  // Stations use the newest reports.
  void hear(const Row& arrived, std::uint64_t tick) {
    const RobotMask whose = sessions_.reports(arrived);
    const auto take = [&](RobotMask& newest, RobotMask said) {
      newest = (newest & ~whose) | (said & whose);
    };
    take(reports_.positive, arrived.report.positive);
    take(reports_.negative, arrived.report.negative);
    take(reports_.shallow, arrived.report.shallow);
    take(reports_.palm_at_target, arrived.report.palm_at_target);
    const CarryMask before = heard_[left] & heard_[right];
    heard_ |= whose;
    for_each_bit(heard_[left] & heard_[right] & ~before,
                 [&](int i) { heard_since_[static_cast<std::size_t>(i)] = tick; });
  }

  BitslicedStations controllers_;
  std::array<Row, BitslicedDelay::longest + 1> line_;
  BitslicedDelay delays_;
  BitslicedReport reports_;
  RobotMask heard_{};                            // robots whose station has received from them
  std::array<std::uint64_t, 64> heard_since_{};  // first tick with reports from both robots
  std::uint64_t now_ = 0;                        // the last tick
  BitslicedCommand commands_;
  BitslicedCounts corrections_;
  BitslicedCounts off_;  // ticks in which a robot was off
  BitslicedCounts reports_lost_;
  BitslicedCounts commands_lost_;
  BitslicedCounts hellos_;  // packets that are no commands
  Sessions sessions_;
};

template <>
struct BitslicedTeam<CentralizedTeam> : BitslicedCentralized {
  static constexpr bool exist = true;
};
static_assert(DecidesInBits<BitslicedTeam<CentralizedTeam>, CentralizedTeam>);

}  // namespace palmbots
