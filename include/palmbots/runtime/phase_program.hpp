// SPDX-License-Identifier: Apache-2.0
// The phases of a job on the floor, on a robot: its table (control/lifting.hpp, control/lone.hpp,
// control/hand_over.hpp) as a program beside that of the controller (runtime/robot_program.hpp). It has
// the packets of the kind phase.
//
// A robot stores whether its table would begin elsewhere after a boot (`Table::assisting`): its partner
// may have raised its arm, or the object may be up or has been put down.
#pragma once

#include <cstdint>

#include "palmbots/control/lifting.hpp"
#include "palmbots/runtime/robot_program.hpp"

namespace palmbots::runtime {

template <class Table>
struct PhaseSettings {
  bool lifts = false;       // the job begins or ends on the floor; if not, there are no phases
  bool begins_low = false;  // with the object on the floor
  bool ends_low = false;    // the same
  bool leads = false;       // the robot is the front one in the direction of travel
  bool stands_by = false;   // it docks after its partner
  bool level_only = false;  // see LiftSenses
  TableTimes<Table> times{};
};

template <class TheTable>
class PhaseProgram {
 public:
  using Table = TheTable;
  using State = typename Table::State;
  using Settings = PhaseSettings<Table>;

  // `epoch` is the number of this boot, `holds` what was stored before it.
  PhaseProgram(const Settings& settings, std::uint32_t epoch, bool holds)
      : settings_(settings),
        epoch_(epoch),
        program_(epoch == 1 || !(holds || settings.begins_low) ? fresh() : after_boot(holds),
                 epoch) {}

  bool lifts() const { return settings_.lifts; }

  // A new job, so many ticks after this boot.
  void begin(std::uint32_t tick) {
    program_ = Program(fresh(), epoch_);
    program_.begin(tick);
  }
  // The job goes on after a boot.
  void go_on(std::uint32_t tick) { program_.begin(tick); }
  void pass(std::uint16_t elapsed) { program_.pass(elapsed); }
  Taken hear(const wire::Decoded& got) { return program_.hear(got); }
  Decision step(const Observation& seen, const LiftSenses& senses) {
    LiftSenses& known = program_.controller().clock().own.senses;
    known = senses;
    known.level_only = settings_.level_only;
    if (!has_stepped_) known.arm_there = false;  // as in LiftRobot::booted
    has_stepped_ = true;
    return program_.step(seen);
  }

  // What a robot says whose part of the job is over: its partner may have to hear that.
  Decision says() const {
    Decision decision;
    decision.speaks = true;
    decision.kind = wire::PacketKind::phase;
    decision.state.language = wire::Language::phases;
    decision.state.message = decision.message = program_.controller().now().message;
    return decision;
  }

  State state() const { return program_.controller().state(); }
  bool is_carrying() const { return Table::is_carrying(state()); }
  // What a robot does whose table commands `own` and whose controller commands `given`.
  Command command(Command own, Command given) const {
    return Table::command(state(), senses(), own, given);
  }
  // To be stored.
  bool holds() const { return lifts() && program_.controller().assists(); }
  const LiftSenses& senses() const { return program_.controller().clock().own.senses; }
  bool corrects() const { return Table::driver(state(), senses()) != Driver::table; }
  // The robot travels as its controller says.
  bool travels() const { return Table::driver(state(), senses()) == Driver::controller; }
  bool has_ended() const { return lifts() && Table::has_ended(state(), settings_.ends_low); }
  bool has_failed() const {
    return lifts() && Table::gives_up(state(), program_.controller().clock().heard());
  }
  // Heights of the arm count from where the object is put down.
  bool is_ending() const { return Table::ending.has(state()); }
  // How many halves of the distance the robot has to travel in this state.
  unsigned halves_of_way() const { return Table::halves_of_way(state(), settings_.leads); }
  // Its partner has to go on even if this robot is done.
  bool ends_alone() const { return lifts() && settings_.ends_low; }
  // The arm, so many steps up, is where a new job begins.
  bool may_begin(std::uint8_t steps) const {
    const bool is_alike = Table::role(state()).arm == Table::role(first()).arm;
    return !lifts() || (is_alike && (settings_.begins_low || steps > 0));
  }
  // How the arm of a robot that is disarmed gets there, once nothing is on its palm.
  ArmMove way_back() const { return settings_.begins_low ? ArmMove::sink : ArmMove::rise; }
  // What the arm does; `runs`: the program does.
  ArmMove arm(bool runs) const { return lifts() ? Table::arm(state(), runs) : ArmMove::hold; }

 private:
  using Robot = LiftRobot<Table>;
  using Program = PartnerProgram<Robot>;

  State first() const { return Table::first(settings_.begins_low, settings_.stands_by); }
  TableRobot<Table> robot() const { return {settings_.times, {settings_.leads}}; }
  Robot after_boot(bool holds) const { return Robot(robot().booted(holds)); }
  Robot fresh() const {
    Robot made(robot());
    made.enter(first());
    return made;
  }

  Settings settings_;
  std::uint32_t epoch_;
  Program program_;
  bool has_stepped_ = false;
};

}  // namespace palmbots::runtime
