// SPDX-License-Identifier: Apache-2.0
// Team of two robots that decide by themselves: a program each (control/mailbox.hpp), their
// clocks, and a link in each direction if they exchange mail.
//
// Messages of a queue are judged when they arrive if the verdicts can differ (sim/session_link.hpp).
// Beacons are judged by their own stamps.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "palmbots/control/mailbox.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/session_link.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

template <class TheController>
class RobotTeam {
 public:
  using Controller = TheController;
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = true;
  static constexpr bool has_clock = TheController::has_clock;
  LinkTotals link_totals{};

  RobotTeam(PerSide<Controller> controllers, PerSide<double> clock_drift, const Channel& channel,
            std::uint64_t seed, std::size_t leader, const Faults& faults = {})
      : programs_{Program(std::move(controllers[left])), Program(std::move(controllers[right]))},
        rate_{1 + clock_drift[left], 1 + clock_drift[right]},
        radio_(channel, seed, leader),
        faults_(faults),
        judges_(is_queue && needs_sessions(channel, faults)) {
    if constexpr (is_queue) establish(ends_[left], ends_[right]);
  }

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    PerSide<RobotOutput> outs{};
    PerSide<bool> sends{};
    for (const std::size_t side : {left, right}) {
      if (tick < due_[side] && sensed[side] == sensed_[side] && !link_[side].oldest(tick)) continue;
      catch_up(tick, side);
      sensed_[side] = sensed[side];
      due_[side] = tick;
      const std::uint16_t elapsed = elapse(tick, side);
      if (elapsed == 0) continue;
      Program& program = programs_[side];
      program.pass(elapsed);
      receive(tick, side);
      outs[side] = program.step(sensed[side].sign, sensed[side].palm_at_target);
      sends[side] = outs[side].send || must_answer(side);
      // A palm is not at its new target in the next tick; if it is, that wakes the robot.
      if (outs[side].command.palm != commands_[side].palm) sensed_[side].palm_at_target = false;
      commands_[side] = outs[side].command;
    }
    if (sends[left] || sends[right]) post(tick, outs, sends, log);
    for (const std::size_t side : {left, right}) {
      if (due_[side] == tick) due_[side] = due(tick, side);
    }
    return commands_;
  }

  void fork(std::uint64_t seed) { radio_.fork(seed); }
  void close(std::uint32_t) {}

  // The next tick at which a robot acts without a new observation.
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    std::uint32_t next = ~0U;
    for (const std::size_t side : {left, right}) {
      next = std::min({next, due_[side], link_[side].next_arrival(tick)});
    }
    return next;
  }

  // For a tick that is still to come: whether a robot's program runs, whether it boots, and the
  // message of a queue that it will find.
  bool is_on(std::uint32_t tick, std::size_t side) const {
    const ProgramState state = monitor_.next_program_state(faults_, tick, side);
    return state == ProgramState::running || state == ProgramState::booting;
  }
  bool boots(std::uint32_t tick, std::size_t side) const {
    return monitor_.next_program_state(faults_, tick, side) == ProgramState::booting;
  }
  MessageKind message(std::uint32_t tick, std::size_t side) const {
    if (!is_on(tick, side)) return MessageKind::none;
    const MessageKind unread = programs_[side].mailbox().oldest();
    if (unread != MessageKind::none && !boots(tick, side)) return unread;
    SessionEnd end = ends_[side];
    if (boots(tick, side)) end.boot();
    for (std::uint32_t i = 0; const Packet* packet = link_[side].arrived(tick, i); ++i) {
      if ((!judges_ || end.accepts(*packet)) && !packet->is_hello) return packet->content;
    }
    return MessageKind::none;
  }

  char name(std::size_t side) const { return robot(side).name(); }
  bool waits(std::size_t side) const { return robot(side).waits(); }
  MessageKind awaits(std::size_t side) const { return robot(side).awaits(); }
  CorrectionActivity activity(std::size_t side) const { return activity_of(name(side), side); }

  const Controller& robot(std::size_t side) const { return programs_[side].controller(); }
  // For a team around this one that knows more of a robot than its observation: the controller,
  // which makes its next step in the next tick.
  Controller& wake(std::size_t side) {
    due_[side] = 0;
    return programs_[side].controller();
  }
  // True if the robots' clocks run like the carry's.
  bool keeps_time() const { return rate_[left] == 1 && rate_[right] == 1; }
  const Radio& radio() const { return radio_; }
  const Faults& faults() const { return faults_; }

 private:
  using Program = ControllerWithMail<Controller>;
  static constexpr bool is_queue = Program::mail == Mail::queue;
  using Packet = std::conditional_t<is_queue, Stamped<MessageKind>, Beacon>;

  // Advances a robot by the ticks since its last step, in which nothing changed.
  void catch_up(std::uint32_t tick, std::size_t side) {
    const auto rested = static_cast<std::uint16_t>(tick - stepped_[side] - 1);
    stepped_[side] = tick;
    if (rested != 0) programs_[side].idle(sensed_[side].sign, rested);
  }

  // The time since the last step by the robot's clock [ticks]. 0: it makes no step, because its
  // program does not run, or because its clock is slow and the next step is not due yet.
  std::uint16_t elapse(std::uint32_t tick, std::size_t side) {
    if constexpr (Program::has_clock) clock_[side] += rate_[side] + faults_.clock_gain(tick, side);
    if (faults_.any() && !runs(tick, side)) return 0;
    if (!Program::has_clock) return 1;
    const auto elapsed = static_cast<std::uint16_t>(clock_[side]);
    clock_[side] -= elapsed;
    return elapsed;
  }

  // The next tick in which a robot acts on its own: it has something to say, a time limit is
  // reached, or its program stops or starts to run. A robot whose clock differs from the carry's is
  // looked at in every tick. So is a frozen program, because it learns how long it was frozen when
  // it continues.
  std::uint32_t due(std::uint32_t tick, std::size_t side) const {
    if (Program::has_clock && (rate_[side] != 1 || faults_.changes_clock(side))) return tick + 1;
    const std::uint32_t change = faults_.any() ? faults_.next_change(tick, side) : ~0U;
    if (faults_.any()) {
      const ProgramState state = faults_.program_state(tick, side);
      if (state == ProgramState::frozen) return tick + 1;
      if (state == ProgramState::off) return change;
    }
    const RobotObservation& seen = sensed_[side];
    return std::min(tick + 1 + programs_[side].quiet(seen.sign, seen.palm_at_target), change);
  }

  // Takes in what has arrived.
  void receive(std::uint32_t tick, std::size_t side) {
    LinkCounts& counts = link_totals.links[other(side)];
    auto& mailbox = programs_[side].mailbox();
    if constexpr (is_queue) {
      palmbots::receive(link_[side], tick, judges_, ends_[side], counts, [&](MessageKind message) {
        if (!mailbox.accept(message)) ++counts.rejected;
      });
    } else if constexpr (Program::mail == Mail::beacons) {
      for (; const Beacon* beacon = link_[side].oldest(tick); link_[side].pop()) {
        const bool is_newer = mailbox.accept(*beacon);
        counts.rejected += is_newer ? 0 : 1;
        counts.late += is_newer && mailbox.age() > programs_[side].lease() ? 1 : 0;
      }
    }
  }

  // True if a robot has to answer a packet without a session, by a hello if there is nothing else.
  bool must_answer(std::size_t side) const { return is_queue && ends_[side].must_answer(); }

  Packet packet(std::size_t side, const RobotOutput& out) {
    if constexpr (is_queue) {
      return ends_[side].stamp(out.message, out.message == MessageKind::none);
    } else if constexpr (Program::mail == Mail::beacons) {
      return programs_[side].mailbox().beacon(out.message, robot(side).stopped(), out.ready);
    } else {
      return {};
    }
  }

  template <class Log>
  void post(std::uint32_t tick, const PerSide<RobotOutput>& outs, const PerSide<bool>& sends,
            Log&& log) {
    const bool collides = sends[left] && sends[right] && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!sends[side]) continue;
      const std::uint32_t received = radio_.post(link_[other(side)], tick, packet(side, outs[side]),
                                                 side, side, collides, link_totals);
      log(SentMessage{tick, received, static_cast<std::uint8_t>(side),
                      static_cast<std::uint8_t>(other(side)), outs[side].message,
                      outs[side].message == MessageKind::none});
    }
  }

  // True if a robot's program runs. A program that boots knows its epoch and what it had stored.
  bool runs(std::uint32_t tick, std::size_t side) {
    const ProgramState state = monitor_.program_state(faults_, tick, side);
    if (state == ProgramState::off) {
      link_[side].drop(tick);
      commands_[side] = switched_off(commands_[side]);
    }
    if (state == ProgramState::booting) {
      programs_[side].reboot(++epoch_[side]);
      ends_[side].boot();
      clock_[side] = 1;
    }
    return state == ProgramState::running || state == ProgramState::booting;
  }

  // A robot that counts time starts at rest.
  static constexpr Command first{Palm::steep, Move::hold, Program::has_clock};

  PerSide<Program> programs_;
  PerSide<std::uint32_t> epoch_{1, 1};        // survives a reboot
  PerSide<double> rate_;                      // of the robots' clocks
  PerSide<double> clock_{};                   // ticks of these clocks not yet stepped
  PerSide<Link<Packet>> link_;                // to each robot
  PerSide<std::uint32_t> stepped_{~0U, ~0U};  // the tick of a robot's last step
  PerSide<std::uint32_t> due_{};              // tick of the next step if the input stays the same
  PerSide<RobotObservation> sensed_{};        // observation in the last step, and expected since
  PerSide<Command> commands_{{first, first}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
  bool judges_;  // messages of a queue may be rejected
  PerSide<SessionEnd> ends_;
};

}  // namespace palmbots
