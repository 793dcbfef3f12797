// SPDX-License-Identifier: Apache-2.0
// What the tables of jobs that begin or end on the floor or on a stand have in common
// (control/lifting.hpp, control/lone.hpp, control/hand_over.hpp): arms, what a robot knows besides its
// sign and its palm, its memory, and who commands palm and wheels.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/control/table_robot.hpp"

namespace palmbots {

// What an arm is commanded to do.
enum class ArmMove : std::uint8_t {
  follow,  // the nose of the palm rests on the floor, also while the palm turns; or, at a stand, the
           // palm is below the object
  reach,   // up until something presses the palm
  hold,
  rise,  // to the height at which the pair carries
  sink,  // until the nose is on the floor, or the palm below the top of a stand
};

// Who commands palm and wheels in a state.
enum class Driver : std::uint8_t {
  table,
  controller_in_place,  // which does not travel
  while_level,          // the same, but the table if the pair corrects at level pivots only
  while_pressed,        // as `while_level` while something presses the palm; otherwise the table
  controller,
};

// What a robot knows besides its sign and its palm.
struct LiftSenses {
  bool touches = false;     // a switch is closed
  bool arm_there = false;   // the arm has reached the height last commanded
  bool far_enough = false;  // it has travelled the distance of the task
  // How many steps its arm is above the height at which it stands on the floor, at which its palm
  // touched an object on a stand, or to which it sinks there. Between, it is on its way to the next
  // step up, or down to this one.
  std::uint8_t steps = 0;
  // By its odometry, it has reached its place below an object on a stand in this attempt.
  bool beneath = false;
  // A setting: the pair corrects its contacts at level pivots only. It raises the object before it
  // centres them, and its wheels stand while its arms move (sim/pivot_rises.hpp).
  bool level_only = false;

  constexpr bool operator==(const LiftSenses&) const = default;
};

// The memory of a robot that lifts. Two bits of a beacon say elsewhere whether its sender travels, and
// whether it may. Here they carry the steps of its arm, modulo 4. That suffices, because the table
// never lets the arms be two steps apart.
template <class B, class Count>
struct LiftMemory {
  static_assert(sizeof(B) == sizeof(bool), "one robot");
  static constexpr int most_tries = 3;
  struct Effect {
    B ready{};
    B is_news{};
  };
  B stopped{};

  LiftSenses senses{};  // the team sets it before each step
  std::uint8_t tries = 0;
  bool was_backing = false;
  std::uint8_t partner_steps = 0;  // modulo 4
  std::uint8_t said_steps = 0;     // the same

  static constexpr int limits(const auto&) { return 0; }
  static constexpr void boot(const auto&...) {}
  static constexpr void pass(const auto&...) {}
  static constexpr void until(const auto&...) {}
  static constexpr void stay(const auto&...) {}
  constexpr void hear(const auto&, bool low, bool high) {
    partner_steps = static_cast<std::uint8_t>(low + 2 * high);
  }
  constexpr void meet(TableConditions<B>& met, const auto&, const auto& robot,
                      const auto&...) const {
    met.touches = senses.touches;
    met.level_only = senses.level_only;
    switch (robot.now().message) {
      case MessageKind::carrying: met.reached = senses.far_enough; break;
      case MessageKind::docking:
      case MessageKind::holding: met.reached = senses.beneath; break;
      default: met.reached = senses.arm_there;
    }
    met.gave_up = tries >= most_tries;
    const MessageKind heard = robot.clock().heard();
    const bool partner_rises = heard == MessageKind::ready || heard == MessageKind::raising;
    const bool partner_sinks = heard == MessageKind::arrived || heard == MessageKind::lowering;
    const unsigned above = (senses.steps - partner_steps) % 4U;
    met.abreast = !(partner_rises && above == 1) && !(partner_sinks && above == 3);
  }
  constexpr Effect finish(const auto&, const auto& robot, const auto&...) {
    const bool backs = robot.now().message == MessageKind::backing;
    if (backs && !was_backing && tries < most_tries) ++tries;
    was_backing = backs;
    const auto steps = static_cast<std::uint8_t>(senses.steps % 4);
    const bool is_news = steps != said_steps;
    said_steps = steps;
    stopped = (steps & 1) != 0;
    return {(steps & 2) != 0, is_news};
  }
};

// What arm and controller do in a state.
struct LiftRole {
  ArmMove arm;
  Driver driver;
};

// A state of such a table: what the table commands where it drives, what the robot says, and how long
// the state lasts at most.
struct LiftState {
  Command command;
  MessageKind message;
  ArmMove arm;
  Driver driver;
  std::int8_t limit = -1;  // the number of its time limit; -1: it has none
};

// The same as columns.
template <std::size_t n>
struct LiftColumns {
  TableOutput outputs[n]{};
  LiftRole roles[n]{};
};

template <std::size_t n>
constexpr LiftColumns<n> columns_of(const LiftState (&states)[n]) {
  LiftColumns<n> columns;
  for (std::size_t i = 0; i < n; ++i) {
    const LiftState& state = states[i];
    columns.outputs[i] = {' ', state.command, state.message, state.limit};
    columns.roles[i] = {state.arm, state.driver};
  }
  return columns;
}

// What a robot does in a state of such a table: in teams of carries, and in the programs of robots.
template <class Table>
struct LiftRules {
  static constexpr const LiftRole& role(auto state) {
    return Table::columns.roles[static_cast<int>(state)];
  }
  // An arm that is up holds while its robot's program does not run.
  static constexpr ArmMove arm(auto state, bool runs) {
    const ArmMove arm = role(state).arm;
    return runs || arm == ArmMove::follow ? arm : ArmMove::hold;
  }
  // Who commands the robot, given its senses: never `while_level` or `while_pressed`.
  static constexpr Driver driver(auto state, const LiftSenses& senses) {
    const Driver driver = role(state).driver;
    if (driver != Driver::while_level && driver != Driver::while_pressed) return driver;
    const bool stands = driver == Driver::while_pressed && !senses.touches;
    return stands || senses.level_only ? Driver::table : Driver::controller_in_place;
  }
  // What a robot does whose table commands `own` and whose controller commands `given`.
  static constexpr Command command(auto state, const LiftSenses& senses, Command own,
                                   Command given) {
    const Driver by = driver(state, senses);
    Command command = by == Driver::table ? own : given;
    if (by == Driver::controller_in_place) command.stop = true;
    return command;
  }
  // How many halves of the distance of the task a robot has to travel in a state in which that counts
  // (`Table::is_carrying`). A board computes without fractions.
  static constexpr unsigned halves_of_way(auto, bool) { return 2; }
  // Whether a robot in this state ends its carry as failed, if it has heard this of its partner.
  static constexpr bool gives_up(auto state, MessageKind) { return state == Table::State::failed; }
  // Whether the object feels the accelerations of the robots in these states.
  static constexpr bool moves_object(auto, auto) { return true; }
};

// The number by which a robot reports a state of such a table.
template <class Table>
constexpr int phase_number(typename Table::State state) {
  static_assert(Table::states <= 32);
  return 32 * Table::number + static_cast<int>(state);
}

// A robot with such a table, whose first step after a boot reads its switches as any other step does. Its
// arm has not begun yet with what the state after a boot asks of it. A robot that works alone sends
// nothing.
template <class Table>
struct LiftRobot : TableRobot<Table> {
  using Base = TableRobot<Table>;
  static constexpr Mail mail = Table::alone ? Mail::none : Table::mail;

  explicit LiftRobot(const Base& robot) : Base(robot) {}
  LiftRobot booted() const {
    LiftRobot made(Base::booted());
    made.clock().own.senses = this->clock().own.senses;
    made.clock().own.senses.arm_there = false;
    return made;
  }
  RobotOutput step(const RobotInput& in) {
    RobotOutput out = Base::step(in);
    if (Table::alone) out.send = false;
    // The bit that stops other robots is one of the steps of the arm here.
    if constexpr (Table::on_one_palm) out.command.stop = Base::now().command.stop;
    return out;
  }
};

}  // namespace palmbots
