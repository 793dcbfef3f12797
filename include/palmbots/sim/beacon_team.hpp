// SPDX-License-Identifier: Apache-2.0
// Teams of two robots that broadcast beacons, or nothing: their controllers, receivers, clocks, and
// the data that survives a reboot. Resilient (control/resilient.hpp) is one such controller, and so
// is every table (control/table_robot.hpp).
#pragma once

#include <algorithm>

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

// Two robots with one controller each. A Robot provides
//   talks                        whether it sends beacons at all
//   step(RobotInput) → Output    with command, message, ready, send
//   quiet(), idle()              how to skip steps without effect, as in Resilient
//   booted()                     the robot after a boot, with what it had stored
//   now(), stopped()             the output of its state, and whether it rests
template <class Robot>
class BeaconTeam {
 public:
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = false;
  LinkTotals link_totals{};

  // `lease` is the greatest age at which a beacon counts [ticks].
  BeaconTeam(PerSide<Robot> robots, std::uint16_t lease, PerSide<double> clock_drift,
             const Channel& channel, std::uint64_t seed, std::size_t leader, const Faults& faults)
      : robots_(robots),
        lease_(lease),
        rate_{1 + clock_drift[left], 1 + clock_drift[right]},
        radio_(channel, seed, leader),
        faults_(faults) {}

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    PerSide<bool> sends{};
    for (const std::size_t side : {left, right}) {
      if (tick < due_[side] && sensed[side] == sensed_[side] && !inbox_[side].oldest(tick))
        continue;
      catch_up(tick, side);
      sensed_[side] = sensed[side];
      due_[side] = tick;
      clock_[side] += rate_[side] + faults_.clock_gain(tick, side);
      if (faults_.any() && !runs(tick, side)) continue;
      const auto elapsed = static_cast<std::uint16_t>(clock_[side]);
      if (elapsed == 0) continue;  // a slow clock: the next step is not due yet
      clock_[side] -= elapsed;
      const typename Robot::Output out =
          robots_[side].step(hear(tick, side, sensed[side], elapsed));
      commands_[side] = out.command;
      messages_[side] = out.message;
      ready_[side] = out.ready;
      sends[side] = out.send;
    }
    const bool collides = sends[left] && sends[right] && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!sends[side]) continue;
      const Beacon beacon =
          receivers_[side].beacon(messages_[side], robots_[side].stopped(), ready_[side]);
      const std::uint32_t received =
          radio_.post(inbox_[other(side)], tick, beacon, side, side, collides, link_totals);
      log(SentMessage{tick, received, static_cast<std::uint8_t>(side),
                      static_cast<std::uint8_t>(other(side)), beacon.message});
    }
    for (const std::size_t side : {left, right}) {
      if (due_[side] == tick) due_[side] = due(tick, side);
    }
    return commands_;
  }

  void fork(std::uint64_t seed) { radio_.fork(seed); }
  void close(std::uint32_t) {}

  // The next tick at which a robot acts without a new observation or message.
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    std::uint32_t next = ~0U;
    for (const std::size_t side : {left, right}) {
      next = std::min({next, due_[side], inbox_[side].next_arrival(tick)});
    }
    return next;
  }

  char name(std::size_t side) const { return robots_[side].now().name; }
  bool waits(std::size_t side) const { return robots_[side].now().waits; }
  MessageKind awaits(std::size_t side) const {
    return waits(side) ? MessageKind::ack : MessageKind::none;
  }
  CorrectionActivity activity(std::size_t side) const { return activity_of(name(side), side); }
  const Robot& robot(std::size_t side) const { return robots_[side]; }

  // True if the robots' clocks run like the carry's.
  bool keeps_time() const { return rate_[left] == 1 && rate_[right] == 1; }
  const Radio& radio() const { return radio_; }
  const Faults& faults() const { return faults_; }

 private:
  // Advances a robot by the ticks since its last step, in which nothing changed.
  void catch_up(std::uint32_t tick, std::size_t side) {
    const auto rested = static_cast<std::uint16_t>(tick - stepped_[side] - 1);
    stepped_[side] = tick;
    if (rested == 0) return;
    robots_[side].idle(sensed_[side].sign, rested);
    receivers_[side].tick(rested);
  }

  // The next tick in which a robot acts on its own: a beacon is due, a time limit is reached, or
  // its program stops or starts to run. A robot whose clock differs from the carry's is looked at in
  // every tick. So is a frozen program, because it learns how long it was frozen when it continues.
  std::uint32_t due(std::uint32_t tick, std::size_t side) const {
    const ProgramState state =
        faults_.any() ? faults_.program_state(tick, side) : ProgramState::running;
    if (rate_[side] != 1 || faults_.changes_clock(side) || state == ProgramState::frozen) {
      return tick + 1;
    }
    const std::uint32_t change = faults_.next_change(tick, side);
    if (state == ProgramState::off) return change;
    const std::uint32_t quiet =
        robots_[side].quiet(sensed_[side].sign, sensed_[side].palm_at_target);
    return std::min(tick + 1 + quiet, change);
  }

  // Everything that has arrived is passed to the receiver; the controller gets the newest message.
  RobotInput hear(std::uint32_t tick, std::size_t side, const RobotObservation& sensed,
                  std::uint16_t elapsed) {
    BeaconReceiver& receiver = receivers_[side];
    receiver.tick(elapsed);
    LinkCounts& counts = link_totals.links[other(side)];
    bool news = false;
    while (const Beacon* beacon = inbox_[side].oldest(tick)) {
      const bool newer = receiver.accept(*beacon);
      counts.rejected += newer ? 0 : 1;
      counts.late += newer && receiver.age() > lease_ ? 1 : 0;
      news = news || newer;
      inbox_[side].pop();
    }
    const Beacon& newest = receiver.newest();
    return {sensed.sign,    sensed.palm_at_target,
            elapsed,        news ? newest.message : MessageKind::none,
            newest.stopped, newest.ready,
            receiver.age()};
  }

  // True if a robot's program runs. A program that boots knows its epoch and what it had stored.
  bool runs(std::uint32_t tick, std::size_t side) {
    const ProgramState state = monitor_.program_state(faults_, tick, side);
    if (state == ProgramState::off) {
      inbox_[side].drop(tick);
      commands_[side] = switched_off(commands_[side]);
    }
    if (state == ProgramState::booting) {
      robots_[side] = robots_[side].booted();
      receivers_[side] = BeaconReceiver(++epoch_[side]);
      clock_[side] = 1;
    }
    return state == ProgramState::running || state == ProgramState::booting;
  }

  PerSide<Robot> robots_;
  std::uint16_t lease_;
  PerSide<std::uint32_t> epoch_{1, 1};  // survives a reboot
  PerSide<BeaconReceiver> receivers_{BeaconReceiver(1), BeaconReceiver(1)};
  PerSide<double> rate_;     // of the robots' clocks
  PerSide<double> clock_{};  // ticks of these clocks not yet stepped
  PerSide<Link<Beacon>> inbox_;
  PerSide<std::uint32_t> stepped_{~0U, ~0U};  // the tick of a robot's last step
  PerSide<std::uint32_t> due_{};              // tick of the next step if the input stays the same
  PerSide<RobotObservation> sensed_{};        // observation in the last step
  PerSide<MessageKind> messages_{};
  PerSide<bool> ready_{};
  PerSide<Command> commands_{{{Palm::steep, Move::hold, true}, {Palm::steep, Move::hold, true}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

// Two robots of the resilient algorithm. The follower is the robot that yields, on either side.
class ResilientTeam : public BeaconTeam<Resilient> {
 public:
  ResilientTeam(Resilient::Times times, PerSide<double> clock_drift, const Channel& channel,
                std::uint64_t seed, std::size_t leader, const Faults& faults = {})
      : BeaconTeam({Resilient(times, leader != left), Resilient(times, leader != right)},
                   times.lease, clock_drift, channel, seed, leader, faults),
        times_(times) {}

  const Resilient::Times& times() const { return times_; }

 private:
  Resilient::Times times_;
};

static_assert(Team<ResilientTeam>);

}  // namespace palmbots
