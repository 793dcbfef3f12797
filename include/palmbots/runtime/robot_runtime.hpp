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
// says when the controller acts, and what the arm does.
//
// TO THE PARTNER a robot sends the messages of the controller. While the controller does not run,
// or says nothing, it sends a state without a message at intervals, and sometimes a hello with the
// number of the settings. Robots whose controllers send beacons send each other nothing else while
// these controllers run. They repeat the newest one at the same intervals, also where the controller
// spares it, as long as the partner may wait for it: to start, or because silence ends its carry. TO
// THE STATION a robot sends its status, in which a few numbers take turns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "palmbots/runtime/answer_age.hpp"
#include "palmbots/runtime/mode_machine.hpp"
#include "palmbots/runtime/phase_program.hpp"
#include "palmbots/runtime/robot_program.hpp"
#include "palmbots/runtime/runtime_io.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots::runtime {

// One robot.
template <class Program, class Phases = PhaseProgram<Lifting>>
class RobotRuntime {
  using Table = typename Phases::Table;

 public:
  // `fresh` begins a carry, `rebooted` goes on with one after a boot. With `carries` the program
  // runs from the first step, as `fresh` if this is the robot's first boot.
  RobotRuntime(const wire::Identity& identity, std::uint32_t epoch, Program fresh, Program rebooted,
               const Phases& phases, const RuntimeSettings& settings, const StoredMode& stored,
               bool carries)
      : settings_(settings),
        endpoint_(identity, epoch),
        fresh_(std::move(fresh)),
        rebooted_(std::move(rebooted)),
        program_(epoch == 1 ? fresh_ : rebooted_),
        phases_(phases),
        machine_(mode_settings(settings, phases), stored, first(carries), mode_table),
        runs_(carries) {}

  // Writes a hello to the partner, or to the station that decides, to establish a session before a
  // carry in lockstep. Returns false if the program sends nothing but what its controller says.
  bool greet(wire::Bytes& bytes) {
    if constexpr (Program::greets) {
      const wire::Role other = Program::with_station ? wire::Role::station : partner();
      return endpoint_.send(other, wire::PacketKind::hello, wire::payload_of(hello()), bytes);
    }
    return false;
  }

  // Begins a tick: `elapsed` ticks of this robot's clock have passed since the last one.
  void begin(std::uint16_t elapsed) {
    tick_ += elapsed;
    elapsed_ = elapsed;
    if (runs_) program_.pass(elapsed);
    if (runs_) phases_.pass(elapsed);
    if (runs_ && travels()) travelled_ += elapsed;
    arrived_ = {};
    unanswered_ = {};
  }

  // A packet has arrived. Returns what the endpoint has judged, for statistics and logs.
  wire::Decoded receive(std::span<const std::uint8_t> bytes) {
    const wire::Decoded got = endpoint_.receive(bytes);
    // Phases answer themselves: they are repeated.
    if (got.verdict == wire::Verdict::no_session && got.packet.kind != wire::PacketKind::phase)
      unanswered_[index(got.packet.sender)] = true;
    if (got.verdict == wire::Verdict::accepted || got.verdict == wire::Verdict::no_session) {
      note(got.packet, got.verdict == wire::Verdict::accepted);
    }
    if (!runs_) return got;
    if (got.packet.kind == wire::PacketKind::phase) {
      if (phases_.lifts()) received_phases_.count(phases_.hear(got));
    } else {
      received_.count(program_.hear(got));
    }
    return got;
  }

  // The operator wants something at the robot itself, by a button. To be called between `begin` and
  // `step`.
  void operate(wire::Operation wish) { arrived_.order(wish, true); }

  // Decides, and writes the packets of this tick.
  Outputs step(const Reading& reading) {
    ModeInputs in = arrived_;
    in.elapsed = elapsed_;
    in.stop = in.stop || reading.stop;
    in.partner = {partner_mode_, age(partner_tick_)};
    in.station_age = age(station_.newest());
    in.preflight = {reading.contact || phases_.lifts(),
                    reading.seen.palm_at_target,
                    reading.battery_ok,
                    settings_.number == 0 || partner_settings_ == settings_.number,
                    reading.stopping,
                    phases_.may_begin(reading.arm_steps)};
    in.driver_ok = reading.driver_ok;
    in.storage_ok = reading.storage_ok;
    in.overruns = reading.overruns;
    in.covered = phases_.lifts() ? settings_.ends_jobs && phases_.has_ended() : reading.covered;
    in.failed = settings_.ends_jobs && phases_.has_failed();
    in.ends_alone = phases_.ends_alone();
    in.travels = !command_.stop;
    Outputs out{};
    out.mode = machine_.step(in);
    if (out.mode.controller != ControllerStart::none) {
      const bool fresh_job = out.mode.controller == ControllerStart::fresh;
      program_ = fresh_job ? fresh_ : rebooted_;
      program_.begin(tick_ - 1);
      program_.pass(1);
      fresh_job ? phases_.begin(tick_ - 1) : phases_.go_on(tick_ - 1);
      phases_.pass(1);
      travelled_ = 0;
    }
    runs_ = out.mode.wheels;
    out.decision.command = {command_.palm, Move::hold, true};
    if (runs_) decide(reading, out);
    if (!runs_) rest(reading, out);
    out.holds = phases_.holds();
    command_ = out.decision.command;
    talk_to_partner(out);
    talk_to_station(out, reading);
    return out;
  }

  const wire::Endpoint& endpoint() const { return endpoint_; }
  const Program& program() const { return program_; }
  const Phases& phases() const { return phases_; }
  const ReceivedCounts& received() const { return received_; }
  // Of the packets with phases.
  const ReceivedCounts& received_phases() const { return received_phases_; }
  bool runs() const { return runs_; }
  // The case, and whether it waits; while the table of phases drives the robot, there is none.
  char name() const { return corrects() ? program_.name() : ' '; }
  bool waits() const { return corrects() && program_.waits(); }

 private:
  static ModeMemory first(bool carries) {
    ModeMemory memory;
    if (carries) memory.mode = wire::RobotMode::carrying;
    return memory;
  }
  static constexpr std::size_t index(wire::Role role) { return static_cast<std::size_t>(role); }
  // One in so many packets without a message is a hello.
  static constexpr std::uint32_t hello_every = 8;

  wire::Role partner() const {
    return endpoint_.identity().role == wire::Role::left ? wire::Role::right : wire::Role::left;
  }
  wire::Hello hello() const {
    return {settings_.number, machine_.memory().mode == wire::RobotMode::stopped};
  }
  // In a job on the floor the table says when the distance is covered, and not the mode machine.
  static ModeSettings mode_settings(const RuntimeSettings& settings, const Phases& phases) {
    ModeSettings mode = settings.mode;
    if (phases.lifts()) mode.travel = 0;
    return mode;
  }
  bool travels() const { return phases_.is_carrying() && !command_.stop && travelled_ < never / 2; }
  // It has travelled for the time that takes the place of the distance.
  bool is_far() const { return settings_.mode.travel > 0 && travelled_ >= settings_.mode.travel; }
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
    }
    out.arm = phases_.arm(true);
  }

  // The arm holds, or follows the floor. Once a robot is disarmed and nothing is on its palm, the arm
  // goes to where a job begins.
  void rest(const Reading& reading, Outputs& out) {
    out.arm = phases_.arm(false);
    if (machine_.memory().mode != wire::RobotMode::disarmed) return;
    if (returns_ && reading.arm_there) phases_.begin(tick_);
    returns_ = !phases_.may_begin(reading.arm_steps) && !reading.contact;
    out.arm = returns_ ? phases_.way_back() : phases_.arm(false);
  }

  // The age of what was sent, or arrived, in that tick; `never` for nothing.
  std::uint32_t age(std::uint32_t tick) const { return tick == never ? never : tick_ - tick; }

  // The partner does not wait for what this robot may leave out.
  bool may_spare() const {
    const bool carries =
        partner_mode_ == wire::RobotMode::carrying || partner_mode_ == wire::RobotMode::holding;
    return carries && settings_.mode.partner_lost == PartnerLost::controller;
  }

  // In this carry the partner has not been heard for longer than the lease. A partner that spares
  // what it says may say nothing for its time of silence, and then acknowledge what is as old.
  bool is_alone() const {
    const ModeSettings& mode = settings_.mode;
    const std::uint32_t limit = mode.lease + (may_spare() ? 2 * program_.silence() : 0);
    return mode.has_radio && age(partner_tick_) > limit && machine_.memory().carried > limit;
  }

  // What the mode machine has to know of a packet. Without a session only an e-stop counts. An order
  // that may make a robot move, now or later, has to be young; one that can only stop it has not.
  void note(const wire::Packet& packet, bool in_session) {
    const bool stop = in_session && wire::passes_stop(packet.payload);
    if (packet.sender == wire::Role::station) {
      const std::uint32_t since = in_session ? station_.heard(packet.heard.sequence) : never;
      arrived_.stop = arrived_.stop || stop;
      if (packet.kind != wire::PacketKind::operate) return;
      const wire::Operation wish = wire::operate_of(packet.payload).operation;
      if (age(since) <= settings_.order_age || wire::only_stops(wish)) {
        arrived_.order(wish, in_session);
      }
      return;
    }
    if (!in_session) return;
    arrived_.partner_stop = arrived_.partner_stop || stop;
    if (packet.kind == wire::PacketKind::hello) {
      partner_settings_ = wire::hello_of(packet.payload).settings;
    }
    if (packet.kind != wire::PacketKind::state && packet.kind != wire::PacketKind::phase) return;
    partner_mode_ = wire::state_of(packet.payload).mode;
    // It was sent after the packet that it acknowledges, whose number is a tick of this robot.
    partner_tick_ = packet.heard.sequence < tick_ ? packet.heard.sequence : tick_;
  }

  void talk_to_partner(Outputs& out) {
    const bool stop = out.mode.stop;
    const bool is_time = settings_.state_period > 0 && tick_ % settings_.state_period < elapsed_;
    if (!Table::alone && !runs_ && phases_.has_ended() && is_time) out.phase = phases_.says();
    if (out.phase.speaks) {
      out.phase.state.mode = out.mode.mode;
      out.phase.state.stop = stop;
      send(out, partner(), out.phase.kind, wire::payload_of(out.phase.state), out.phase.message);
    }
    Decision& said = out.decision;
    since_said_ = since_said_ < 0xFFFF - elapsed_ ? since_said_ + elapsed_ : 0xFFFF;
    if (said.speaks && said.kind == wire::PacketKind::report) {
      send(out, wire::Role::station, said.kind, wire::payload_of(said.report, stop));
      return;
    }
    // A change of the mode is news for the partner: it is sent at once.
    const bool has_changed = out.mode.mode != said_mode_;
    const bool is_late = settings_.state_period > 0 && since_said_ >= settings_.state_period;
    const bool is_due = is_late || (settings_.state_period > 0 && has_changed);
    if (Program::repeats && runs_ && is_late && !may_spare()) said.speaks = true;
    const bool may_add = !runs_ || Program::answers_with_hello;
    const bool is_asked = unanswered_[index(partner())];
    if (!said.speaks && !(may_add && (is_due || is_asked))) return;
    since_said_ = 0;
    if (!said.speaks && (is_asked || (!has_changed && extras_++ % hello_every == 0))) {
      send(out, partner(), wire::PacketKind::hello, wire::payload_of(hello()));
      return;
    }
    said.state.mode = said_mode_ = out.mode.mode;
    said.state.stop = stop;
    if (!runs_) said.state.at_rest = true;
    send(out, partner(), wire::PacketKind::state, wire::payload_of(said.state), said.message);
  }

  void talk_to_station(Outputs& out, const Reading& reading) {
    if (settings_.status_period == 0) return;
    since_status_ = since_status_ < 0xFFFF - elapsed_ ? since_status_ + elapsed_ : 0xFFFF;
    if (since_status_ < settings_.status_period) return;
    since_status_ = 0;
    // Every other status has the progress, or in turn with it the phase of a job on the floor; the other
    // numbers take turns.
    const unsigned turn = turn_++;
    constexpr auto phase = static_cast<unsigned>(wire::StatusItem::phase);
    unsigned item = 1 + turn / 2 % (wire::status_items - 1);
    if (turn % 2 == 0) item = phases_.lifts() && turn % 4 == 2 ? phase : 0;
    wire::Status status;
    status.mode = out.mode.mode;
    status.fault = out.mode.code;
    if (runs_ && is_alone()) status.fault = wire::FaultCode::partner_lost;  // a warning
    status.sign = reading.seen.sign;
    status.palm = command_.palm;
    status.palm_at_target = reading.seen.palm_at_target;
    status.activity = runs_ ? name() : ' ';
    status.item = static_cast<wire::StatusItem>(item);
    status.value = value_of(item, reading);
    status.ready = out.decision.state.ready;
    status.at_rest = command_.stop;
    status.stop = out.mode.stop;
    send(out, wire::Role::station, wire::PacketKind::status, wire::payload_of(status));
  }

  std::uint16_t value_of(unsigned item, const Reading& reading) const {
    constexpr auto first = static_cast<unsigned>(wire::StatusItem::received);
    if (item >= first) {
      return static_cast<std::uint16_t>(endpoint_.count(static_cast<wire::Verdict>(item - first)));
    }
    switch (static_cast<wire::StatusItem>(item)) {
      case wire::StatusItem::progress: return progress(reading);
      case wire::StatusItem::battery: return reading.battery_mv;
      case wire::StatusItem::overruns: return reading.overruns;
      case wire::StatusItem::phase:
        return phases_.lifts() ? static_cast<std::uint16_t>(phase_number<Table>(phases_.state()))
                               : std::uint16_t{0xFFFF};
      default: return static_cast<std::uint16_t>(sent_);
    }
  }

  // The covered part of the distance, times 65535; without odometry that of the time for it.
  std::uint16_t progress(const Reading& reading) const {
    const std::uint32_t travel = settings_.mode.travel;
    if (travel == 0) return reading.progress;
    const std::uint32_t gone = phases_.lifts() ? travelled_ : machine_.memory().travelled;
    const std::uint64_t part = std::uint64_t{65535} * gone / travel;
    return part < 65535 ? static_cast<std::uint16_t>(part) : std::uint16_t{65535};
  }

  void send(Outputs& out, wire::Role receiver, wire::PacketKind kind, const wire::Payload& payload,
            MessageKind message = MessageKind::none) {
    Outgoing& packet = out.packets[out.packet_count];
    // Between robots the sequence is the control tick.
    if (receiver != wire::Role::station) endpoint_.skip_to(receiver, tick_, kind);
    if (!endpoint_.send(receiver, kind, payload, packet.bytes)) return;
    if (receiver == wire::Role::station) station_.sent(endpoint_.newest(receiver).sequence, tick_);
    packet.receiver = receiver;
    packet.message = message;
    ++out.packet_count;
    ++sent_;
  }

  RuntimeSettings settings_;
  wire::Endpoint endpoint_;
  Program fresh_;
  Program rebooted_;
  Program program_;
  Phases phases_;
  ModeMachine machine_;
  bool runs_;
  std::uint32_t tick_ = 0;  // since the boot
  std::uint16_t elapsed_ = 1;
  Command command_{Palm::steep, Move::hold, true};
  // What has arrived in this tick, and the newest news of the others.
  ModeInputs arrived_;
  std::array<bool, wire::role_count> unanswered_{};  // senders of packets without a session
  wire::RobotMode partner_mode_ = wire::RobotMode::off;
  std::uint32_t partner_tick_ = never;  // before which the partner's newest state was not sent
  std::uint32_t partner_settings_ = 0;
  AnswerAge station_;
  ReceivedCounts received_;
  ReceivedCounts received_phases_;
  std::uint32_t travelled_ = 0;  // time of a job on the floor in which the pair travels
  bool returns_ = false;         // the arm goes to where a job begins
  std::uint32_t sent_ = 0;
  wire::RobotMode said_mode_ = wire::RobotMode::off;  // the newest that the partner was sent
  std::uint32_t extras_ = 0;                          // packets to the partner without a message
  std::uint32_t turn_ = 0;                            // of the numbers in the status
  int since_said_ = 0;
  int since_status_ = 0;
};

}  // namespace palmbots::runtime
