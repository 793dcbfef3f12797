// SPDX-License-Identifier: Apache-2.0
// Team of robots whose programs run elsewhere, for example in processes of their own. The
// simulation has the world, the radio and the faults. The programs get only what real robots would
// get.
//
// In a tick every program that runs gets the readings of its robot, the ticks that passed on its
// clock and the packets that have arrived, as bytes. It answers with its command and its packets.
// The simulation waits for all answers, so a carry does not depend on how fast they come.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/faults.hpp"
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
        commands_[side] = switched_off(commands_[side]);
      }
      if (state == ProgramState::booting) clock_[side] = 1;
      if (state == ProgramState::off || state == ProgramState::frozen) continue;
      const auto elapsed = static_cast<std::uint16_t>(clock_[side]);
      if (elapsed == 0) continue;  // a slow clock: the next step is not due yet
      clock_[side] -= elapsed;
      ProgramInput input{sensed[side], elapsed, state == ProgramState::booting, {}};
      while (const wire::Bytes* bytes = inbox_[side].oldest(tick)) {
        input.packets.push_back(*bytes);
        inbox_[side].pop();
      }
      inputs[side] = std::move(input);
    }
    if constexpr (has_station) inputs[2] = station_input(tick);
    const ProgramOutputs outputs = exchange_(tick, inputs);
    if (inputs[2]) command(tick, outputs[2]);
    PerSide<bool> sends{};
    for (const std::size_t side : {left, right}) {
      if (!inputs[side]) continue;
      shown_[side] = outputs[side];
      commands_[side] = outputs[side].command;
      sends[side] = !outputs[side].packets.empty();
      // What it hears comes from the partner, or from the station.
      LinkCounts& counts = link_totals.links[has_station ? 2 + side : other(side)];
      counts.rejected += outputs[side].rejected;
      counts.late += outputs[side].late;
    }
    const bool collides = sends[left] && sends[right] && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!inputs[side]) continue;
      for (const ProgramPacket& packet : outputs[side].packets) {
        Link<wire::Bytes>& link = has_station ? station_inbox_[side] : inbox_[other(side)];
        const std::uint32_t received =
            radio_.post(link, tick, packet.bytes, side, side, collides, link_totals);
        if constexpr (has_station) continue;
        log(SentMessage{tick, received, static_cast<std::uint8_t>(side),
                        static_cast<std::uint8_t>(other(side)), packet.message,
                        packet.message == MessageKind::none});
      }
    }
    return commands_;
  }

  void fork(std::uint64_t seed) { radio_.fork(seed); }
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
  PerSide<ProgramOutput> shown_{};
  ProgramOutput station_{};
  PerSide<Command> commands_;
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

}  // namespace palmbots
