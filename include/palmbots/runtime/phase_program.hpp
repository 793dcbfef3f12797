// SPDX-License-Identifier: Apache-2.0
// The phases of a job on the floor, on a robot: the table that lifts (control/lifting.hpp) as a program
// beside that of the controller (runtime/robot_program.hpp). It has the packets of the kind phase.
//
// A robot stores whether its partner may have raised its arm, or the object has been put down. If so,
// it holds everything after a boot until it hears its partner.
#pragma once

#include <cstdint>

#include "palmbots/control/lifting.hpp"
#include "palmbots/control/table_robot.hpp"
#include "palmbots/runtime/robot_program.hpp"

namespace palmbots::runtime {

struct PhaseSettings {
  bool lifts = false;       // the job begins or ends on the floor; if not, there are no phases
  bool begins_low = false;  // with the object on the floor
  bool ends_low = false;    // the same
  bool leads = false;       // the robot is the front one in the direction of travel
  bool stands_by = false;   // it docks after its partner
  TableTimes<Lifting> times{};
};

class PhaseProgram {
 public:
  using State = Lifting::State;

  // `epoch` is the number of this boot, `holds` what was stored before it.
  PhaseProgram(const PhaseSettings& settings, std::uint32_t epoch, bool holds)
      : settings_(settings),
        epoch_(epoch),
        program_(epoch == 1 || !(holds || settings.begins_low) ? fresh() : robot().booted(holds),
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
    program_.controller().clock().own.senses = senses;
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
  // To be stored.
  bool holds() const { return lifts() && program_.controller().assists(); }
  const LiftSenses& senses() const { return program_.controller().clock().own.senses; }
  bool corrects() const { return Lifting::driver(state(), senses()) != Driver::table; }
  bool travels() const { return Lifting::driver(state(), senses()) == Driver::controller; }
  bool has_ended() const { return lifts() && Lifting::has_ended(state(), settings_.ends_low); }
  bool has_failed() const { return lifts() && state() == State::failed; }
  // Its partner has to go on even if this robot is done.
  bool ends_alone() const { return lifts() && settings_.ends_low; }
  // The arm, so many steps up, is where a new job begins.
  bool may_begin(std::uint8_t steps) const {
    const bool is_alike = Lifting::role(state()).arm == Lifting::role(first()).arm;
    return !lifts() || (is_alike && (settings_.begins_low || steps > 0));
  }
  // How the arm of a robot that is disarmed gets there, once nothing is on its palm.
  ArmMove way_back() const { return settings_.begins_low ? ArmMove::sink : ArmMove::rise; }
  // What the arm does; `runs`: the program does.
  ArmMove arm(bool runs) const { return lifts() ? Lifting::arm(state(), runs) : ArmMove::hold; }

 private:
  using Robot = TableRobot<Lifting>;
  using Program = PartnerProgram<Robot>;

  State first() const { return Lifting::first(settings_.begins_low, settings_.stands_by); }
  Robot robot() const { return Robot(settings_.times, {settings_.leads}); }
  Robot fresh() const {
    Robot made = robot();
    made.enter(first());
    return made;
  }

  PhaseSettings settings_;
  std::uint32_t epoch_;
  Program program_;
};

}  // namespace palmbots::runtime
