// SPDX-License-Identifier: Apache-2.0
// Everything that a robot decides, as one object without I/O: packets in, packets and a drive out.
//
// The caller moves bytes. Once per control tick it passes what the robot reads and the packets that
// have arrived, and carries out what comes back. The node of a robot, a simulated robot, a browser
// and a microcontroller call the same step.
//
// The mode machine (runtime/mode_machine.hpp) decides whether the controller runs. While it does,
// palm and wheels do what it commands. Otherwise the wheels rest and the palm keeps its angle. In a
// job on the floor the table that lifts runs beside the controller (runtime/phase_program.hpp). It
// says when the controller acts, and what the arm does. What does not depend on the program is in
// runtime/robot_talk.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "palmbots/runtime/phase_program.hpp"
#include "palmbots/runtime/robot_program.hpp"
#include "palmbots/runtime/robot_talk.hpp"

namespace palmbots::runtime {

// One robot.
template <class Program, class Phases = PhaseProgram<Lifting>>
class RobotRuntime : public RobotTalk {
  using Table = typename Phases::Table;

 public:
  // `fresh` begins a carry, `rebooted` goes on with one after a boot. With `carries` the program
  // runs from the first step, as `fresh` if this is the robot's first boot.
  RobotRuntime(const wire::Identity& identity, std::uint32_t epoch, Program fresh, Program rebooted,
               const Phases& phases, const RuntimeSettings& settings, const StoredMode& stored,
               bool carries)
      : RobotTalk(identity, epoch, settings, mode_settings(settings, phases), stored, carries),
        fresh_(std::move(fresh)),
        rebooted_(std::move(rebooted)),
        program_(epoch == 1 ? fresh_ : rebooted_),
        phases_(phases) {}

  // Writes a hello to the partner, or to the station that decides, to establish a session before a
  // carry in lockstep. Returns false if the program sends nothing but what its controller says.
  bool greet(wire::Bytes& bytes) {
    if constexpr (Program::greets)
      return say_hello(Program::with_station ? wire::Role::station : partner(), bytes);
    return false;
  }

  // Begins a tick: `elapsed` ticks of this robot's clock have passed since the last one.
  void begin(std::uint16_t elapsed) {
    begin_tick(elapsed);
    if (!runs()) return;
    program_.pass(elapsed);
    phases_.pass(elapsed);
    if (travels()) travelled_ += elapsed;
  }

  // A packet has arrived. Returns what the endpoint has judged, for statistics and logs.
  wire::Decoded receive(std::span<const std::uint8_t> bytes) {
    const wire::Decoded got = judge(bytes);
    if (!runs()) return got;
    if (got.packet.kind == wire::PacketKind::phase) {
      if (phases_.lifts()) received_phases_.count(phases_.hear(got));
    } else {
      received_.count(program_.hear(got));
    }
    return got;
  }

  // Decides, and writes the packets of this tick.
  Outputs step(const Reading& reading) {
    Outputs out{};
    out.mode =
        step_mode(reading, {phases_.lifts(), phases_.may_begin(reading.arm_steps),
                            phases_.has_ended(), phases_.has_failed(), phases_.ends_alone()});
    if (out.mode.controller != ControllerStart::none) {
      const bool fresh_job = out.mode.controller == ControllerStart::fresh;
      program_ = fresh_job ? fresh_ : rebooted_;
      program_.begin(tick_ - 1);
      program_.pass(1);
      fresh_job ? phases_.begin(tick_ - 1) : phases_.go_on(tick_ - 1);
      phases_.pass(1);
      travelled_ = 0;
    }
    out.decision.command = {command_.palm, Move::hold, true};
    if (runs()) decide(reading, out);
    if (!runs()) rest(reading, out);
    out.holds = phases_.holds();
    command_ = out.decision.command;
    if (!Table::alone && !runs() && phases_.has_ended() && is_time()) out.phase = phases_.says();
    const ProgramTalk talk{Program::repeats, Program::answers_with_hello, program_.silence()};
    talk_to_partner(out, talk);
    const int phase = phases_.lifts() ? phase_number<Table>(phases_.state()) : -1;
    talk_to_station(out, reading, talk, name(), phase);
    return out;
  }

  const Program& program() const { return program_; }
  const Phases& phases() const { return phases_; }
  const ReceivedCounts& received() const { return received_; }
  // Of the packets with phases.
  const ReceivedCounts& received_phases() const { return received_phases_; }
  // The case, and whether it waits; while the table of phases drives the robot, there is none.
  char name() const { return corrects() ? program_.name() : ' '; }
  bool waits() const { return corrects() && program_.waits(); }

 private:
  // In a job on the floor the table says when the distance is covered, and not the mode machine.
  static ModeSettings mode_settings(const RuntimeSettings& settings, const Phases& phases) {
    ModeSettings mode = settings.mode;
    if (phases.lifts()) mode.travel = 0;
    return mode;
  }
  bool travels() const { return phases_.is_carrying() && !command_.stop && travelled_ < never / 2; }
  // It has travelled for the time that takes the place of the distance.
  bool is_far() const {
    const std::uint64_t travel = settings_.mode.travel;
    return travel > 0 && 2 * std::uint64_t{travelled_} >= phases_.halves_of_way() * travel;
  }
  bool corrects() const { return !phases_.lifts() || phases_.corrects(); }

  void decide(const Reading& reading, Outputs& out) {
    Observation seen = reading.seen;
    if (phases_.lifts()) {
      // As in simulations: where nothing presses the palm, its contact is inward.
      if (!reading.contact) seen.sign = Sign::negative;
      out.phase =
          phases_.step(seen, {reading.contact, reading.arm_there, reading.covered || is_far(),
                              reading.arm_steps, reading.beneath});
    }
    if constexpr (requires { program_.controller().set_in_place(true); })
      program_.controller().set_in_place(phases_.lifts() && !phases_.travels());
    // While the table drives, the controller sees a centred contact.
    out.decision = program_.step(corrects() ? seen : Observation{Sign::zero, true});
    if (phases_.lifts()) {
      Command& command = out.decision.command;
      command = phases_.command(out.phase.command, command);
      // After a boot a palm that carries alone has to be at its angle before its servo moves.
      if constexpr (Table::on_one_palm) out.decision.assists = command.palm == Palm::shallow;
    }
    out.arm = phases_.arm(true);
    out.arm_ends = phases_.is_ending();
  }

  // The arm holds, or follows the floor. Once a robot is disarmed and nothing is on its palm, the arm
  // goes to where a job begins.
  void rest(const Reading& reading, Outputs& out) {
    out.arm = phases_.arm(false);
    out.arm_ends = phases_.is_ending() && !is_disarmed();
    if (!is_disarmed()) return;
    if (returns_ && reading.arm_there) phases_.begin(tick_);
    returns_ = !phases_.may_begin(reading.arm_steps) && !reading.contact;
    out.arm = returns_ ? phases_.way_back() : phases_.arm(false);
  }

  Program fresh_;
  Program rebooted_;
  Program program_;
  Phases phases_;
  ReceivedCounts received_;
  ReceivedCounts received_phases_;
  bool returns_ = false;  // the arm goes to where a job begins
};

}  // namespace palmbots::runtime
