// SPDX-License-Identifier: Apache-2.0
// What all robots have in common, whatever their program: packets to the partner and to the station,
// what was heard of them, and the mode. A board has many programs, and this part only once.
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

#include "palmbots/runtime/answer_age.hpp"
#include "palmbots/runtime/mode_machine.hpp"
#include "palmbots/runtime/runtime_io.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots::runtime {

// What the table of a job states before a step. Without a job on the floor `lifts` is false.
struct JobState {
  bool lifts = false;
  bool may_begin = true;
  bool has_ended = false;
  bool has_failed = false;
  bool ends_alone = false;
};

// What the program of a controller states about what it says (runtime/robot_program.hpp).
struct ProgramTalk {
  bool repeats;
  bool answers_with_hello;
  std::uint32_t silence;
};

class RobotTalk {
 public:
  // The operator wants something at the robot itself, by a button. To be called between `begin` and
  // `step`.
  void operate(wire::Operation wish) { arrived_.order(wish, true); }

  const wire::Endpoint& endpoint() const { return endpoint_; }
  bool runs() const { return runs_; }

 protected:
  RobotTalk(const wire::Identity& identity, std::uint32_t epoch, const RuntimeSettings& settings,
            const ModeSettings& mode, const StoredMode& stored, bool carries)
      : settings_(settings),
        endpoint_(identity, epoch),
        machine_(mode, stored, first(carries), mode_table),
        runs_(carries) {}

  wire::Role partner() const {
    return endpoint_.identity().role == wire::Role::left ? wire::Role::right : wire::Role::left;
  }
  bool say_hello(wire::Role other, wire::Bytes& bytes) {
    return endpoint_.send(other, wire::PacketKind::hello, wire::payload_of(hello()), bytes);
  }

  void begin_tick(std::uint16_t elapsed) {
    tick_ += elapsed;
    elapsed_ = elapsed;
    arrived_ = {};
    unanswered_ = {};
  }

  // A packet has arrived: what the endpoint judges of it.
  wire::Decoded judge(std::span<const std::uint8_t> bytes) {
    const wire::Decoded got = endpoint_.receive(bytes);
    // Phases answer themselves: they are repeated.
    if (got.verdict == wire::Verdict::no_session && got.packet.kind != wire::PacketKind::phase)
      unanswered_[index(got.packet.sender)] = true;
    if (got.verdict == wire::Verdict::accepted || got.verdict == wire::Verdict::no_session) {
      note(got.packet, got.verdict == wire::Verdict::accepted);
    }
    return got;
  }

  // The mode of this step.
  ModeOutputs step_mode(const Reading& reading, const JobState& job) {
    ModeInputs in = arrived_;
    in.elapsed = elapsed_;
    in.stop = in.stop || reading.stop;
    in.partner = {partner_mode_, age(partner_tick_)};
    in.station_age = age(station_.newest());
    in.preflight = {reading.contact || job.lifts,
                    reading.seen.palm_at_target,
                    reading.battery_ok,
                    settings_.number == 0 || partner_settings_ == settings_.number,
                    reading.stopping,
                    job.may_begin};
    in.driver_ok = reading.driver_ok;
    in.storage_ok = reading.storage_ok;
    in.overruns = reading.overruns;
    in.covered = job.lifts ? settings_.ends_jobs && job.has_ended : reading.covered;
    in.failed = settings_.ends_jobs && job.has_failed;
    in.ends_alone = job.ends_alone;
    in.travels = !command_.stop;
    const ModeOutputs out = machine_.step(in);
    runs_ = out.wheels;
    return out;
  }

  bool is_disarmed() const { return machine_.memory().mode == wire::RobotMode::disarmed; }
  // It is time for the state that is sent at intervals.
  bool is_time() const {
    return settings_.state_period > 0 && tick_ % settings_.state_period < elapsed_;
  }

  void talk_to_partner(Outputs& out, const ProgramTalk& program) {
    const bool stop = out.mode.stop;
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
    if (program.repeats && runs_ && is_late && !may_spare()) said.speaks = true;
    const bool may_add = !runs_ || program.answers_with_hello;
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

  // `name` is the case, and `phase` the number of the phase of a job on the floor; −1: there is none.
  void talk_to_station(Outputs& out, const Reading& reading, const ProgramTalk& program, char name,
                       int phase) {
    if (settings_.status_period == 0) return;
    since_status_ = since_status_ < 0xFFFF - elapsed_ ? since_status_ + elapsed_ : 0xFFFF;
    if (since_status_ < settings_.status_period) return;
    since_status_ = 0;
    // Every other status has the progress, or in turn with it the phase of a job on the floor; the other
    // numbers take turns.
    const unsigned turn = turn_++;
    constexpr auto of_phase = static_cast<unsigned>(wire::StatusItem::phase);
    unsigned item = 1 + turn / 2 % (wire::status_items - 1);
    if (turn % 2 == 0) item = phase >= 0 && turn % 4 == 2 ? of_phase : 0;
    wire::Status status;
    status.mode = out.mode.mode;
    status.fault = out.mode.code;
    if (runs_ && is_alone(program)) status.fault = wire::FaultCode::partner_lost;  // a warning
    status.sign = reading.seen.sign;
    status.palm = command_.palm;
    status.palm_at_target = reading.seen.palm_at_target;
    status.activity = runs_ ? name : ' ';
    status.item = static_cast<wire::StatusItem>(item);
    status.value = value_of(item, reading, phase);
    status.ready = out.decision.state.ready;
    status.at_rest = command_.stop;
    status.stop = out.mode.stop;
    send(out, wire::Role::station, wire::PacketKind::status, wire::payload_of(status));
  }

  RuntimeSettings settings_;
  std::uint32_t tick_ = 0;  // since the boot
  Command command_{Palm::steep, Move::hold, true};
  std::uint32_t travelled_ = 0;  // time of a job on the floor in which the pair travels

 private:
  static ModeMemory first(bool carries) {
    ModeMemory memory;
    if (carries) memory.mode = wire::RobotMode::carrying;
    return memory;
  }
  static constexpr std::size_t index(wire::Role role) { return static_cast<std::size_t>(role); }
  // One in so many packets without a message is a hello.
  static constexpr std::uint32_t hello_every = 8;

  wire::Hello hello() const {
    return {settings_.number, machine_.memory().mode == wire::RobotMode::stopped};
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
  bool is_alone(const ProgramTalk& program) const {
    const ModeSettings& mode = settings_.mode;
    const std::uint32_t limit = mode.lease + (may_spare() ? 2 * program.silence : 0);
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
    // It was sent after the packet that it acknowledges, whose number is a tick of this robot. A robot
    // that sends one kind only hears little of that from packets of the other kind.
    const std::uint32_t since = packet.heard.sequence < tick_ ? packet.heard.sequence : tick_;
    if (partner_tick_ == never || since > partner_tick_) partner_tick_ = since;
  }

  std::uint16_t value_of(unsigned item, const Reading& reading, int phase) const {
    constexpr auto first = static_cast<unsigned>(wire::StatusItem::received);
    if (item >= first) {
      return static_cast<std::uint16_t>(endpoint_.count(static_cast<wire::Verdict>(item - first)));
    }
    switch (static_cast<wire::StatusItem>(item)) {
      case wire::StatusItem::progress: return progress(reading, phase >= 0);
      case wire::StatusItem::battery: return reading.battery_mv;
      case wire::StatusItem::overruns: return reading.overruns;
      case wire::StatusItem::phase: return static_cast<std::uint16_t>(phase);
      default: return static_cast<std::uint16_t>(sent_);
    }
  }

  // The covered part of the distance, times 65535; without odometry that of the time for it.
  std::uint16_t progress(const Reading& reading, bool lifts) const {
    const std::uint32_t travel = settings_.mode.travel;
    if (travel == 0) return reading.progress;
    const std::uint32_t gone = lifts ? travelled_ : machine_.memory().travelled;
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

  wire::Endpoint endpoint_;
  ModeMachine machine_;
  bool runs_;
  std::uint16_t elapsed_ = 1;
  // What has arrived in this tick, and the newest news of the others.
  ModeInputs arrived_;
  std::array<bool, wire::role_count> unanswered_{};  // senders of packets without a session
  wire::RobotMode partner_mode_ = wire::RobotMode::off;
  std::uint32_t partner_tick_ =
      never;  // before which the newest packet of the partner was not sent
  std::uint32_t partner_settings_ = 0;
  AnswerAge station_;
  std::uint32_t sent_ = 0;
  wire::RobotMode said_mode_ = wire::RobotMode::off;  // the newest that the partner was sent
  std::uint32_t extras_ = 0;                          // packets to the partner without a message
  std::uint32_t turn_ = 0;                            // of the numbers in the status
  int since_said_ = 0;
  int since_status_ = 0;
};

}  // namespace palmbots::runtime
