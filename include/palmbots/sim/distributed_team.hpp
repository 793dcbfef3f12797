// SPDX-License-Identifier: Apache-2.0
// Team of two robots that exchange messages, with one controller each.
//
// With sessions, messages are judged when they arrive, and those to be acted upon wait in an inbox
// until the controller reads them (sim/session_link.hpp). On the bare channel of the paper, and
// wherever all of them would be accepted, they wait in the link.
#pragma once

#include <algorithm>
#include <utility>

#include "palmbots/control/distributed.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/message_inbox.hpp"
#include "palmbots/sim/session_link.hpp"
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
        faults_(faults),
        judges_(needs_sessions(channel, faults)) {
    establish(ends_[left], ends_[right]);
  }

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    PerSide<MessageKind> messages{};
    const bool may_fail = faults_.any();
    PerSide<bool> rest{};   // robots whose state and command stay as they are
    PerSide<bool> turns{};  // robots that command their palm to turn
    for (const std::size_t side : {left, right}) {
      if (may_fail && !runs(tick, side)) continue;
      if (judges_) receive(tick, side);
      const Distributed::Input in = input(tick, side, sensed[side]);
      rest[side] = !may_fail && is_quiescent(controllers_[side], in);
      if (rest[side]) continue;
      const auto out = controllers_[side].step(in);
      if (out.read && in.message != MessageKind::none) pop(side);
      turns[side] = out.command.palm != commands_[side].palm;
      commands_[side] = out.command;
      messages[side] = out.send;
    }
    const PerSide<bool> sends{sends_packet(messages[left], left),
                              sends_packet(messages[right], right)};
    if (sends[left] || sends[right]) post(tick, messages, sends, log);
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
    if (!is_on(tick, side)) return MessageKind::none;
    const MessageKind unread = oldest(tick, side);
    if (unread != MessageKind::none || !judges_) return unread;
    SessionEnd end = ends_[side];
    if (boots(tick, side)) end.boot();
    for (std::uint32_t i = 0; const Packet* packet = link_[side].arrived(tick, i); ++i) {
      if (end.accepts(*packet) && !packet->is_hello) return packet->content;
    }
    return MessageKind::none;
  }

  char name(std::size_t side) const { return controllers_[side].now().name; }
  bool waits(std::size_t side) const { return controllers_[side].now().waits; }
  MessageKind awaits(std::size_t side) const { return controllers_[side].now().awaits; }
  CorrectionActivity activity(std::size_t side) const { return activity_of(name(side), side); }

  // Robots that are quiescent with their present input stay so until a message arrives or one of
  // them fails.
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    if (!settled_) return tick + 1;
    return std::min({link_[left].next_arrival(tick), link_[right].next_arrival(tick),
                     faults_.next_outage(tick)});
  }

 private:
  using Packet = Stamped<MessageKind>;

  // Takes in what has arrived.
  void receive(std::uint32_t tick, std::size_t side) {
    LinkCounts& counts = link_totals.links[other(side)];
    palmbots::receive(link_[side], tick, true, ends_[side], counts, [&](MessageKind message) {
      if (!inbox_[side].push(message)) ++counts.rejected;
    });
  }

  // The oldest message that the controller has not read, or none.
  MessageKind oldest(std::uint32_t tick, std::size_t side) const {
    if (judges_) {
      const MessageKind* message = inbox_[side].oldest();
      return message != nullptr ? *message : MessageKind::none;
    }
    const Packet* packet = link_[side].oldest(tick);
    return packet != nullptr ? packet->content : MessageKind::none;
  }
  void pop(std::size_t side) {
    if (judges_) {
      inbox_[side].pop();
    } else {
      link_[side].pop();
    }
  }

  Distributed::Input input(std::uint32_t tick, std::size_t side,
                           const RobotObservation& sensed) const {
    return {sensed.sign, oldest(tick, side), sensed.palm_at_target};
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
  void post(std::uint32_t tick, const PerSide<MessageKind>& messages, const PerSide<bool>& sends,
            Log&& log) {
    const bool collides = sends[left] && sends[right] && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!sends[side]) continue;
      const MessageKind message = messages[side];
      const bool is_hello = message == MessageKind::none;
      const std::uint32_t received =
          radio_.post(link_[other(side)], tick, ends_[side].stamp(message, is_hello), side, side,
                      collides, link_totals);
      log(SentMessage{tick, received, static_cast<std::uint8_t>(side),
                      static_cast<std::uint8_t>(other(side)), message, is_hello});
    }
  }

  // A robot whose controller has nothing to say sends a hello if it has to answer.
  bool sends_packet(MessageKind message, std::size_t side) const {
    return message != MessageKind::none || ends_[side].must_answer();
  }

  // True if a robot's program runs. A program that boots starts from its initial state.
  bool runs(std::uint32_t tick, std::size_t side) {
    const ProgramState state = monitor_.program_state(faults_, tick, side);
    if (state == ProgramState::off) {
      link_[side].drop(tick);
      inbox_[side].clear();
      commands_[side] = switched_off(commands_[side]);
    }
    if (state == ProgramState::booting) {
      controllers_[side] = asleep_[side];
      ends_[side].boot();
    }
    return state == ProgramState::running || state == ProgramState::booting;
  }

  PerSide<Controller> controllers_;
  PerSide<Controller> asleep_;   // initial state, as after a boot
  bool settled_ = false;         // both are quiescent with their present input
  PerSide<Link<Packet>> link_;   // to each robot
  PerSide<MessageInbox> inbox_;  // of each robot
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
  bool judges_;
  PerSide<SessionEnd> ends_;
};

static_assert(Team<DistributedTeam<Distributed>>);

}  // namespace palmbots
