// SPDX-License-Identifier: Apache-2.0
// Team with a station: two robots that report to it every tick and execute the command in its newest
// packet. The station runs the centralized algorithm, or the rows of a policy.
//
// The robots' reports and the station's commands answer each other, so only a station that has not
// yet heard both robots sends a hello (sim/session_link.hpp).
//
// Over a plain radio the messages repeat until a robot's observation changes. Once nothing new has
// been sent for as long as messages travel, nothing new is received either, so the repeated
// messages are only counted. This ends before a robot or the station fails.
#pragma once

#include <array>
#include <cstring>
#include <type_traits>

#include "palmbots/control/centralized.hpp"
#include "palmbots/control/row_policy.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/session_link.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

// What the pair does in a case of Table 1 (0: none). The left robot stands for both.
inline CorrectionActivity activity_of_case(int number, std::size_t side) {
  if (side != left || number == 0) return {};
  constexpr auto nobody = CorrectionActivity::nobody;
  constexpr auto both = CorrectionActivity::both;
  struct Part {
    std::int8_t robot;
    std::int8_t assistant;
    PerSide<std::int8_t> sense;
  };
  constexpr Part parts[8] = {
      {0, 1, {1, 0}},          {1, 0, {0, 1}},            // cases 1, 2
      {0, nobody, {-1, 0}},    {1, nobody, {0, -1}},      // 3, 4
      {both, nobody, {1, 1}},  {both, nobody, {-1, -1}},  // 5, 6
      {both, nobody, {1, -1}}, {both, nobody, {-1, 1}},   // 7, 8
  };
  const Part& part = parts[number - 1];
  return {static_cast<char>('0' + number), part.robot, part.assistant, part.sense};
}

// What the station's program does at the moment. The left robot stands for both.
inline CorrectionActivity activity_of_station(const Centralized& station, std::size_t side) {
  return activity_of_case(station.current(), side);
}
inline CorrectionActivity activity_of_station(const RowPolicy& station, std::size_t side) {
  if (side != left || station.current() == 0) return {};
  const PerSide<std::int8_t> sense{static_cast<std::int8_t>(station.sense(0)),
                                   static_cast<std::int8_t>(station.sense(1))};
  const bool both = sense[left] != 0 && sense[right] != 0;
  const std::int8_t robot = both ? CorrectionActivity::both : (sense[left] != 0 ? 0 : 1);
  return {static_cast<char>('0' + station.current()), robot, CorrectionActivity::nobody, sense};
}

// What is sent in one tick, for a recorder.
struct StationPackets {
  static constexpr std::uint32_t not_sent = ~0U;
  std::array<std::uint32_t, 4> arrivals;  // ticks, by link (LinkTotals); 0: lost
  PerSide<Centralized::Report> reports;
  PerSide<Command> commands;
  PerSide<bool> hellos;  // the station answers a packet without a session, and commands nothing
};

// Station, robots and the links between them. A Station provides step(reports) →
// Centralized::Output, current() and activity_of_station().
template <class Station>
class StationTeam {
 public:
  static constexpr bool half_moves = Station::half_moves;
  static constexpr bool expects_turns = false;
  LinkTotals link_totals{};

  StationTeam(const Channel& channel, std::uint64_t seed, std::size_t leader,
              const Faults& faults = {}, const Station& station = {})
      : radio_(channel, seed, leader),
        faults_(faults),
        may_rest_(channel.is_plain()),
        travel_(channel.longest()),
        judges_(needs_sessions(channel, faults)) {
    now_.station = station;
    for (const std::size_t side : {left, right}) establish(robot_ends_[side], station_ends_[side]);
  }

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed, Log&&) {
    close(tick);
    due_ = tick + 1;
    const Moment before = now_;
    const bool lost = faults_.any() && faults_.station_lost(tick);
    arrivals_.fill(StationPackets::not_sent);
    PerSide<bool> runs{true, true};
    bool all_accepted = true;
    for (const std::size_t side : {left, right}) {
      if (faults_.any()) runs[side] = this->runs(tick, side);
      if (runs[side]) all_accepted &= receive_commands(tick, side);
      if (lost) up_[side].drop(tick);
      all_accepted &= receive_reports(tick, side);
    }
    // Time slots separate the station's packets from the robots', but not the robots' packets from
    // each other.
    const bool collides = runs[left] && runs[right] && radio_.collide(tick);
    if (now_.heard[left] && now_.heard[right] && !lost) {
      const Centralized::Output output = now_.station.step(now_.reports);
      on_both_sides([&](std::size_t side) {
        command(tick, side, station_ends_[side].stamp(output.command[side]));
      });
      now_.station_output = output;
    } else {
      for (const std::size_t side : {left, right}) {
        if (station_ends_[side].must_answer())
          command(tick, side, station_ends_[side].stamp(Command{}, true));
      }
    }
    on_both_sides([&](std::size_t side) {
      if (!runs[side]) return;
      // `palm_at_target` refers to the command in force until this tick.
      const Centralized::Report said{sensed[side].sign, obeyed_[side], sensed[side].palm_at_target};
      arrivals_[side] = radio_.post(up_[side], tick, robot_ends_[side].stamp(said), side, side,
                                    collides, link_totals);
      now_.said[side] = said;
      obeyed_[side] = now_.commands[side].palm;
    });
    if (!(now_ == before) || !all_accepted) changed_ = tick;
    return now_.commands;
  }

  // The next tick at which the state may change. Before an outage, messages are sent for as long as
  // they travel, because a robot that returns hears what was sent before the outage.
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    if (!may_rest_ || tick - changed_ <= travel_) return tick + 1;
    const std::uint32_t outage = faults_.next_outage(tick);
    return outage - tick > travel_ + 1 ? outage - travel_ : tick + 1;
  }

  // The carry ends, or continues, with this tick: counts the messages of the ticks before it that
  // had no step.
  void close(std::uint32_t tick) {
    const std::uint32_t skipped = tick - due_;
    for (LinkCounts& link : link_totals.links) link.sent += skipped;
    link_totals.sent += 4 * skipped;
    due_ = tick;
  }

  // The packets of this tick, the last one that has begun. In a tick without a step, the packets of
  // the last step are repeated.
  StationPackets packets(std::uint32_t tick) const {
    StationPackets sent{arrivals_, now_.said, {}, hellos_};
    for (const std::size_t side : {left, right})
      sent.commands[side] = now_.station_output.command[side];
    if (tick >= due_) sent.arrivals.fill(tick + travel_);
    return sent;
  }

  void fork(std::uint64_t seed) { radio_.fork(seed); }

  const Radio& radio() const { return radio_; }
  const Faults& faults() const { return faults_; }
  // True if packets have to be judged when they arrive (sim/session_link.hpp).
  bool judges() const { return judges_; }

  char name(std::size_t) const {
    const int now = now_.station.current();
    return now == 0 ? ' ' : static_cast<char>('0' + now);
  }
  bool waits(std::size_t) const { return false; }
  MessageKind awaits(std::size_t) const { return MessageKind::none; }

  CorrectionActivity activity(std::size_t side) const {
    return activity_of_station(now_.station, side);
  }

 private:
  // Everything that is sent, received and commanded in a tick.
  struct Moment {
    Station station;
    PerSide<bool> heard{};             // the station has received from this robot
    Centralized::Report reports[2]{};  // the newest that the station has
    Centralized::Output station_output{};
    PerSide<Centralized::Report> said{};
    PerSide<Command> commands{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};

    // Compares all fields at once, as bytes without gaps.
    bool operator==(const Moment& other) const {
      static_assert(std::has_unique_object_representations_v<Moment>);
      return std::memcmp(this, &other, sizeof other) == 0;
    }
  };

  // Take in what has arrived at a robot, and from it at the station. Return true if none of it was
  // rejected.
  bool receive_commands(std::uint32_t tick, std::size_t side) {
    return receive(down_[side], tick, judges_, robot_ends_[side], link_totals.links[2 + side],
                   [&](const Command& command) { now_.commands[side] = command; });
  }
  bool receive_reports(std::uint32_t tick, std::size_t side) {
    return receive(up_[side], tick, judges_, station_ends_[side], link_totals.links[side],
                   [&](const Centralized::Report& report) {
                     now_.reports[side] = report;
                     now_.heard[side] = true;
                   });
  }

  // Sends a packet of the station to a robot.
  void command(std::uint32_t tick, std::size_t side, const Stamped<Command>& packet) {
    arrivals_[2 + side] = radio_.post(down_[side], tick, packet, 2, side, false, link_totals);
    hellos_[side] = packet.is_hello;
  }

  // True if a robot's program runs. A robot that boots keeps driving until it hears from the
  // station.
  bool runs(std::uint32_t tick, std::size_t side) {
    const ProgramState state = monitor_.program_state(faults_, tick, side);
    if (state == ProgramState::off) {
      down_[side].drop(tick);
      now_.commands[side] = switched_off(now_.commands[side]);
    }
    if (state == ProgramState::booting) {
      now_.commands[side] = {Palm::steep, Move::hold};
      robot_ends_[side].boot();
    }
    return state == ProgramState::running || state == ProgramState::booting;
  }

  Moment now_;
  PerSide<Link<Stamped<Centralized::Report>>> up_;
  PerSide<Link<Stamped<Command>>> down_;
  PerSide<Palm> obeyed_{Palm::steep, Palm::steep};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
  bool may_rest_;
  std::uint32_t travel_;       // of messages: delay [ticks]
  std::uint32_t changed_ = 0;  // the last tick that differed from the one before
  std::uint32_t due_ = 0;      // the tick after the last step
  bool judges_;
  std::array<std::uint32_t, 4> arrivals_{};  // of the packets of the last step (StationPackets)
  PerSide<bool> hellos_{};
  PerSide<SessionEnd> robot_ends_;
  PerSide<SessionEnd> station_ends_;
};

using CentralizedTeam = StationTeam<Centralized>;
using RowPolicyTeam = StationTeam<RowPolicy>;

static_assert(Team<CentralizedTeam>);
static_assert(Team<RowPolicyTeam>);

}  // namespace palmbots
