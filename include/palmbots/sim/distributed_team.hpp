// SPDX-License-Identifier: Apache-2.0
// Team of two robots that exchange messages, with one controller each.
#pragma once

#include <algorithm>
#include <utility>

#include "palmbots/control/distributed.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

// Two robots with one controller each, and a link in each direction. A Controller provides
// step(Distributed::Input) → Distributed::Output and now() → Distributed::StateOutput.
template <class Controller>
class DistributedTeam {
 public:
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = true;
  LinkTotals link_totals{};

  DistributedTeam(PerSide<Controller> controllers, const Channel& channel, std::uint64_t seed,
                  std::size_t leader, const Faults& faults = {})
      : controllers_(std::move(controllers)),
        asleep_(controllers_),
        radio_(channel, seed, leader),
        faults_(faults) {}

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    PerSide<MessageKind> messages{};
    const bool may_fail = faults_.any();
    PerSide<bool> rest{};   // robots whose state and command stay as they are
    PerSide<bool> turns{};  // robots that command their palm to turn
    for (const std::size_t side : {left, right}) {
      if (may_fail && !runs(tick, side)) continue;
      const Distributed::Input in = input(tick, side, sensed[side]);
      rest[side] = !may_fail && is_quiescent(controllers_[side], in);
      if (rest[side]) continue;
      const auto out = controllers_[side].step(in);
      if (out.read && in.message != MessageKind::none) inbox_[side].pop();
      turns[side] = out.command.palm != commands_[side].palm;
      commands_[side] = out.command;
      messages[side] = out.send;
    }
    if (messages[left] != MessageKind::none || messages[right] != MessageKind::none)
      post(tick, messages, log);
    settled_ = true;
    for (const std::size_t side : {left, right}) {
      if (!rest[side]) {
        const RobotObservation then{sensed[side].sign, sensed[side].palm_at_target && !turns[side]};
        settled_ = settled_ && is_quiescent(controllers_[side], input(tick, side, then));
      }
    }
    return commands_;
  }

  void fork(std::uint64_t seed) { radio_.fork(seed); }
  void close(std::uint32_t) {}

  const Radio& radio() const { return radio_; }
  const Faults& faults() const { return faults_; }

  // For a tick that is still to come: whether a robot's program runs, whether it boots, and the
  // message that it will find.
  bool is_on(std::uint32_t tick, std::size_t side) const {
    const ProgramState state = monitor_.next_program_state(faults_, tick, side);
    return state == ProgramState::running || state == ProgramState::booting;
  }
  bool boots(std::uint32_t tick, std::size_t side) const {
    return monitor_.next_program_state(faults_, tick, side) == ProgramState::booting;
  }
  MessageKind message(std::uint32_t tick, std::size_t side) const {
    const MessageKind* oldest = is_on(tick, side) ? inbox_[side].oldest(tick) : nullptr;
    return oldest != nullptr ? *oldest : MessageKind::none;
  }

  char name(std::size_t side) const { return controllers_[side].now().name; }
  bool waits(std::size_t side) const { return controllers_[side].now().waits; }
  MessageKind awaits(std::size_t side) const { return controllers_[side].now().awaits; }
  CorrectionActivity activity(std::size_t side) const { return activity_of(name(side), side); }

  // Robots that are quiescent with their present input stay so until a message arrives or one of
  // them fails.
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    if (!settled_) return tick + 1;
    return std::min({inbox_[left].next_arrival(tick), inbox_[right].next_arrival(tick),
                     faults_.next_outage(tick)});
  }

 private:
  Distributed::Input input(std::uint32_t tick, std::size_t side,
                           const RobotObservation& sensed) const {
    const MessageKind* message = inbox_[side].oldest(tick);
    return {sensed.sign, message != nullptr ? *message : MessageKind::none, sensed.palm_at_target};
  }

  // A controller that does not provide is_quiescent() is never treated as quiescent.
  static bool is_quiescent(const Controller& controller, const Distributed::Input& in) {
    if constexpr (requires { controller.is_quiescent(in); }) {
      return controller.is_quiescent(in);
    } else {
      return false;
    }
  }

  template <class Log>
  void post(std::uint32_t tick, const PerSide<MessageKind>& messages, Log&& log) {
    const bool both = messages[left] != MessageKind::none && messages[right] != MessageKind::none;
    const bool collides = both && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (messages[side] == MessageKind::none) continue;
      const std::uint32_t received =
          radio_.post(inbox_[other(side)], tick, messages[side], side, side, collides, link_totals);
      log(SentMessage{tick, received, static_cast<std::uint8_t>(side),
                      static_cast<std::uint8_t>(other(side)), messages[side]});
    }
  }

  // True if a robot's program runs. A program that boots starts from its initial state.
  bool runs(std::uint32_t tick, std::size_t side) {
    const ProgramState state = monitor_.program_state(faults_, tick, side);
    if (state == ProgramState::off) {
      inbox_[side].drop(tick);
      commands_[side] = switched_off(commands_[side]);
    }
    if (state == ProgramState::booting) controllers_[side] = asleep_[side];
    return state == ProgramState::running || state == ProgramState::booting;
  }

  PerSide<Controller> controllers_;
  PerSide<Controller> asleep_;        // initial state, as after a boot
  bool settled_ = false;              // both are quiescent with their present input
  PerSide<Link<MessageKind>> inbox_;  // of each robot
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

static_assert(Team<DistributedTeam<Distributed>>);

}  // namespace palmbots
