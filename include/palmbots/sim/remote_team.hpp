// SPDX-License-Identifier: Apache-2.0
// Team of robots whose programs run elsewhere, for example in processes of their own. The
// simulation has the world, the radio and the faults. The programs get only what real robots would
// get.
//
// In a tick every program that runs gets the readings of its robot, the ticks that passed on its
// clock and the packets that have arrived, as bytes. It answers with its command and its packets.
// The simulation waits for all answers, so a carry does not depend on how fast they come.
//
// In a job on the floor the programs run the table that lifts, too. Its packets have a radio of their
// own, as in sim/lift_team.hpp, whose `LiftTeam` this header specializes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/lift_team.hpp"
#include "palmbots/sim/team.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots {

// The programs: the left robot, the right one, and the station.
inline constexpr std::size_t programs = 3;

// What a program gets in a tick. The station has no readings.
struct ProgramInput {
  RobotObservation sensed{};
  std::uint16_t elapsed = 1;         // ticks of its own clock since its last step
  bool boots = false;                // it starts anew, with what it had stored
  std::vector<wire::Bytes> packets;  // that have arrived, in order
  LiftSenses senses{};               // in a job on the floor
};

// A packet that a program sends.
struct ProgramPacket {
  wire::Role receiver;
  wire::Bytes bytes;
  MessageKind message = MessageKind::none;  // what a robot says in it, for the log; none: a hello
};

// What a program answers.
struct ProgramOutput {
  Command command{Palm::steep, Move::hold, true};
  std::vector<ProgramPacket> packets;
  char name = ' ';  // the case
  bool waits = false;
  MessageKind awaits = MessageKind::none;
  std::uint32_t rejected = 0;  // packets since the last step that were copies, overtaken, or
                               // without a session
  std::uint32_t late = 0;      // packets since the last step that were older than the lease
  PerSide<std::uint32_t> rejected_from{};  // by the station, of each robot
  // In a job on the floor: the state of the table, and its packets as above.
  int phase = 0;
  std::uint32_t rejected_phases = 0;
  std::uint32_t late_phases = 0;
};

using ProgramInputs = std::array<std::optional<ProgramInput>, programs>;
using ProgramOutputs = std::array<ProgramOutput, programs>;

// With a station, robots send to it and hear it alone; else they send to each other.
//
// Exchange is called as exchange(tick, ProgramInputs) → ProgramOutputs. An input is absent for a
// program that does not run in this tick; its output is ignored.
template <class Exchange, bool has_station = false>
class RemoteTeam {
 public:
  static constexpr bool half_moves = has_station;  // as in CentralizedTeam
  static constexpr bool expects_turns = false;
  LinkTotals link_totals{};

  // `first` is in force until a robot's program has run for the first time.
  RemoteTeam(Exchange exchange, Command first, PerSide<double> clock_drift, const Channel& channel,
             std::uint64_t seed, std::size_t leader, const Faults& faults)
      : exchange_(std::move(exchange)),
        rate_{1 + clock_drift[left], 1 + clock_drift[right]},
        commands_{first, first},
        radio_(channel, seed, leader),
        phase_radio_(channel, seed_of_phases(seed), leader),
        faults_(faults) {}

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    ProgramInputs inputs{};
    for (const std::size_t side : {left, right}) {
      clock_[side] += rate_[side] + faults_.clock_gain(tick, side);
      const ProgramState state = monitor_.program_state(faults_, tick, side);
      if (state == ProgramState::off) {
        inbox_[side].drop(tick);
        phase_inbox_[side].drop(tick);
        commands_[side] = switched_off(commands_[side]);
      }
      if (is_absent_[side]) continue;
      if (state == ProgramState::booting) clock_[side] = 1;
      if (state == ProgramState::off || state == ProgramState::frozen) continue;
      const auto elapsed = static_cast<std::uint16_t>(clock_[side]);
      if (elapsed == 0) continue;  // a slow clock: the next step is not due yet
      clock_[side] -= elapsed;
      const bool boots = state == ProgramState::booting;
      ProgramInput input{sensed[side], elapsed, boots, {}, senses_[side]};
      for (Link<wire::Bytes>* link : {&phase_inbox_[side], &inbox_[side]}) {
        for (; const wire::Bytes* bytes = link->oldest(tick); link->pop()) {
          input.packets.push_back(*bytes);
        }
      }
      inputs[side] = std::move(input);
    }
    if constexpr (has_station) inputs[2] = station_input(tick);
    const ProgramOutputs outputs = exchange_(tick, inputs);
    if (inputs[2]) command(tick, outputs[2]);
    for (const std::size_t side : {left, right}) {
      if (!inputs[side]) continue;
      shown_[side] = outputs[side];
      commands_[side] = outputs[side].command;
      // What it hears comes from the partner, or from the station.
      LinkCounts& counts = link_totals.links[has_station ? 2 + side : other(side)];
      counts.rejected += outputs[side].rejected;
      counts.late += outputs[side].late;
      LinkCounts& of_phases = phase_totals_.links[other(side)];
      of_phases.rejected += outputs[side].rejected_phases;
      of_phases.late += outputs[side].late_phases;
    }
    post(tick, inputs, outputs, true, log);
    post(tick, inputs, outputs, false, log);
    return commands_;
  }

  // Of a job on the floor: what the robots know besides their observations, before each step, and the
  // state of each table.
  void feel(const PerSide<LiftSenses>& senses) { senses_ = senses; }
  void enter(std::size_t side, int state) { shown_[side].phase = state; }
  int phase(std::size_t side) const { return shown_[side].phase; }
  // This robot stands aside, and has no program.
  void leave_out(std::size_t side) { is_absent_[side] = true; }
  const LiftSenses& senses(std::size_t side) const { return senses_[side]; }
  const LinkTotals& phase_totals() const { return phase_totals_; }
  const Faults& faults() const { return faults_; }

  void fork(std::uint64_t seed) {
    radio_.fork(seed);
    phase_radio_.fork(seed_of_phases(seed));
  }
  void close(std::uint32_t) {}
  std::uint32_t next_decision_tick(std::uint32_t tick) const { return tick + 1; }

  char name(std::size_t side) const { return has_station ? station_.name : shown_[side].name; }
  bool waits(std::size_t side) const { return shown_[side].waits; }
  MessageKind awaits(std::size_t side) const { return shown_[side].awaits; }
  CorrectionActivity activity(std::size_t side) const {
    if constexpr (has_station)
      return activity_of_case(name(side) == ' ' ? 0 : name(side) - '0', side);
    return activity_of(name(side), side);
  }

 private:
  static bool is_phase(const ProgramPacket& packet) {
    return packet.bytes[wire::kind_field.offset] ==
           static_cast<std::uint8_t>(wire::PacketKind::phase);
  }

  // Sends what the robots' programs answer: the phases, or all other packets.
  template <class Log>
  void post(std::uint32_t tick, const ProgramInputs& inputs, const ProgramOutputs& outputs,
            bool phases, Log&& log) {
    PerSide<bool> sends{};
    for (const std::size_t side : {left, right}) {
      if (!inputs[side]) continue;
      for (const ProgramPacket& packet : outputs[side].packets)
        sends[side] = sends[side] || is_phase(packet) == phases;
    }
    const Radio& radio = phases ? phase_radio_ : radio_;
    LinkTotals& totals = phases ? phase_totals_ : link_totals;
    const bool goes_to_station = has_station && !phases;
    const bool collides = sends[left] && sends[right] && radio.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!sends[side]) continue;
      for (const ProgramPacket& packet : outputs[side].packets) {
        if (is_phase(packet) != phases) continue;
        auto& inbox = phases ? phase_inbox_ : inbox_;
        Link<wire::Bytes>& link = goes_to_station ? station_inbox_[side] : inbox[other(side)];
        const std::uint32_t received =
            radio.post(link, tick, packet.bytes, side, side, collides, totals);
        if (goes_to_station) continue;
        log(SentMessage{tick, received, static_cast<std::uint8_t>(side),
                        static_cast<std::uint8_t>(other(side)), packet.message,
                        packet.message == MessageKind::none});
      }
    }
  }

  // What the station's program gets; nothing while the station is lost.
  std::optional<ProgramInput> station_input(std::uint32_t tick) {
    if (faults_.station_lost(tick)) {
      for (Link<wire::Bytes>& link : station_inbox_) link.drop(tick);
      return std::nullopt;
    }
    ProgramInput input;
    for (Link<wire::Bytes>& link : station_inbox_) {
      for (; const wire::Bytes* bytes = link.oldest(tick); link.pop()) {
        input.packets.push_back(*bytes);
      }
    }
    return input;
  }

  // Sends what the station's program answers, in a time slot of its own.
  void command(std::uint32_t tick, const ProgramOutput& output) {
    station_ = output;
    for (const ProgramPacket& packet : output.packets) {
      const auto side = static_cast<std::size_t>(packet.receiver);
      radio_.post(inbox_[side], tick, packet.bytes, 2, side, false, link_totals);
    }
    for (const std::size_t side : {left, right}) {
      link_totals.links[side].rejected += output.rejected_from[side];
    }
  }

  Exchange exchange_;
  PerSide<double> rate_;                      // of the robots' clocks
  PerSide<double> clock_{};                   // ticks of these clocks not yet stepped
  PerSide<Link<wire::Bytes>> inbox_;          // of each robot
  PerSide<Link<wire::Bytes>> station_inbox_;  // of the station, by sender
  PerSide<Link<wire::Bytes>> phase_inbox_;    // of each robot
  PerSide<LiftSenses> senses_{};
  LinkTotals phase_totals_{};
  PerSide<ProgramOutput> shown_{};
  ProgramOutput station_{};
  PerSide<Command> commands_;
  PerSide<bool> is_absent_{};
  Radio radio_;
  Radio phase_radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

// The team of a job on the floor whose programs run elsewhere. Each runs the table beside its
// controller, and answers for both.
template <class Exchange, bool has_station, class Table>
class LiftTeam<RemoteTeam<Exchange, has_station>, Table> {
  using Inner = RemoteTeam<Exchange, has_station>;

 public:
  using State = Table::State;
  static constexpr bool ends_jobs = true;
  static constexpr bool half_moves = Inner::half_moves;
  static constexpr bool expects_turns = Inner::expects_turns;
  LinkTotals link_totals{};

  LiftTeam(const Spec& spec, std::uint64_t, Inner inner) : inner_(std::move(inner)) {
    const bool low = spec.begins_on != StandsOn::palms;
    for (const std::size_t side : {left, right}) {
      inner_.enter(side, static_cast<int>(Table::first(low, stands_by(spec, side))));
      if (Table::alone && side != leader_of(spec)) inner_.leave_out(side);
    }
  }

  void feel(const PerSide<LiftSenses>& senses) { inner_.feel(senses); }

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    for (const std::size_t side : {left, right}) runs_[side] = !inner_.faults().stops(tick, side);
    const PerSide<Command>& commands = inner_.step(tick, sensed, log);
    count_messages();
    return commands;
  }

  std::uint32_t next_decision_tick(std::uint32_t tick) const { return tick + 1; }
  void close(std::uint32_t tick) {
    inner_.close(tick);
    count_messages();
  }
  void fork(std::uint64_t seed) { inner_.fork(seed); }

  State state(std::size_t side) const { return static_cast<State>(inner_.phase(side)); }
  ArmMove arm(std::size_t side) const { return Table::arm(state(side), runs_[side]); }

  char name(std::size_t side) const { return is_correcting(side) ? inner_.name(side) : ' '; }
  bool waits(std::size_t side) const { return is_correcting(side) && inner_.waits(side); }
  MessageKind awaits(std::size_t side) const { return inner_.awaits(side); }
  CorrectionActivity activity(std::size_t side) const {
    return obeyed(inner_.activity(side), is_correcting(left), is_correcting(right));
  }

 private:
  bool is_correcting(std::size_t side) const {
    return Table::driver(state(side), inner_.senses(side)) != Driver::table;
  }
  void count_messages() {
    link_totals = inner_.link_totals;
    link_totals += inner_.phase_totals();
  }

  Inner inner_;
  PerSide<bool> runs_{true, true};
};

}  // namespace palmbots
