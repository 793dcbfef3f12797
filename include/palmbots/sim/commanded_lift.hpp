// SPDX-License-Identifier: Apache-2.0
// A job on the floor whose robots are commanded from outside tick by tick: wheels, palms and arms.
// Their programs know what they have to do, and report their phases; the world only moves. It ends when
// the object falls.
#pragma once

#include "palmbots/sim/lift_carry.hpp"

namespace palmbots {

// What one robot does from the next tick on.
struct LiftCommand {
  Command command{Palm::steep, Move::hold, true};
  ArmMove arm = ArmMove::hold;
  int state = 0;  // of the table
};

// The inner team of such a job; the caller owns the commands.
struct CommandedLift {
  const PerSide<LiftCommand>* commands;
};

template <class Table>
class LiftTeam<CommandedLift, Table> {
 public:
  using State = Table::State;
  static constexpr bool ends_jobs = false;  // its programs know when the job is over
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = false;
  LinkTotals link_totals{};

  LiftTeam(const Spec&, std::uint64_t, CommandedLift inner) : inner_(inner) {}

  void feel(const PerSide<LiftSenses>& senses) { senses_ = senses; }
  const PerSide<LiftSenses>& senses() const { return senses_; }

  template <class Log>
  const PerSide<Command>& step(std::uint32_t, const PerSide<RobotObservation>&, Log&&) {
    for (const std::size_t side : {left, right}) commands_[side] = (*inner_.commands)[side].command;
    return commands_;
  }

  std::uint32_t next_decision_tick(std::uint32_t tick) const { return tick + 1; }
  void close(std::uint32_t) {}
  void fork(std::uint64_t) {}

  State state(std::size_t side) const { return static_cast<State>((*inner_.commands)[side].state); }
  ArmMove arm(std::size_t side) const { return (*inner_.commands)[side].arm; }

  char name(std::size_t) const { return ' '; }
  bool waits(std::size_t) const { return false; }
  MessageKind awaits(std::size_t) const { return MessageKind::none; }
  CorrectionActivity activity(std::size_t) const { return {}; }

 private:
  CommandedLift inner_;
  PerSide<LiftSenses> senses_{};
  PerSide<Command> commands_{};
};

}  // namespace palmbots
