// SPDX-License-Identifier: Apache-2.0
// Two robots, and a station with two robots, that exchange bytes between real endpoints over the
// channel of the simulator. They share with its teams the channel, the faults and the controllers,
// but nothing that judges, answers or keeps packets.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "palmbots/control/distributed.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/radio.hpp"
#include "palmbots/sim/team.hpp"
#include "palmbots/wire/endpoint.hpp"
#include "support/check.hpp"
#include "support/wire_packets.hpp"

namespace palmbots {

// What the channel of the endpoints carries.
struct Envelope {
  wire::Bytes bytes;
};

// For the channel, which damages packets: what a link to the station carries.
struct EnvelopeToStation : Envelope {};
template <>
inline constexpr bool goes_to_station<EnvelopeToStation> = true;

inline wire::Packet packet_of(const Envelope& envelope, const wire::PacketHeader& header) {
  return wire::decode(envelope.bytes, wire::test_key, wire::test_pair, header.receiver).packet;
}

// An endpoint that notes whether it has to answer.
struct CountingEnd {
  wire::Role self;
  std::uint32_t epoch = 1;
  wire::Endpoint endpoint{identity(), 1};
  PerSide<bool> owes{};  // to a robot, by its side; a robot owes its one partner owes[0]

  explicit CountingEnd(wire::Role role) : self(role) {}
  wire::Identity identity() const { return {wire::test_key, wire::test_pair, self}; }

  void boot() {
    endpoint = wire::Endpoint(identity(), ++epoch);
    owes = {};
  }

  Envelope write(wire::Role to, wire::PacketKind kind, const wire::Payload& payload) {
    Envelope envelope{};
    CHECK(endpoint.send(to, kind, payload, envelope.bytes));
    return envelope;
  }

  // Returns the packet if it is to be acted upon, and counts it otherwise. An empty packet is of the
  // kind hello.
  wire::Packet read(const Envelope& envelope, LinkCounts& counts, bool& must_answer) {
    const wire::Decoded decoded = endpoint.receive(envelope.bytes);
    const bool accepted = decoded.verdict == wire::Verdict::accepted;
    if (decoded.verdict == wire::Verdict::no_session) must_answer = true;
    counts.rejected += accepted ? 0 : 1;
    return accepted ? decoded.packet : wire::Packet{};
  }
};

// One hello each way, beside the radio.
inline void shake_hands(CountingEnd& one, CountingEnd& other) {
  const Envelope there = one.write(other.self, wire::PacketKind::hello, wire::up);
  CHECK(other.endpoint.receive(there.bytes).verdict == wire::Verdict::no_session);
  const Envelope back = other.write(one.self, wire::PacketKind::hello, wire::up);
  CHECK(one.endpoint.receive(back.bytes).verdict == wire::Verdict::accepted);
}

// Two robots of these controllers, on endpoints.
template <class Controller>
class EndpointPair {
 public:
  LinkTotals totals{};
  PerSide<MessageKind> found{};  // by the robots in the last tick

  EndpointPair(const Channel& channel, std::uint64_t seed, const Faults& faults)
      : radio_(channel, seed, right), faults_(faults) {
    shake_hands(ends_[left], ends_[right]);
  }

  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                        std::vector<SentMessage>& log) {
    PerSide<MessageKind> says{};
    PerSide<bool> sends{};
    found = {};
    for (const std::size_t side : {left, right}) {
      const ProgramState state = monitor_.program_state(faults_, tick, side);
      if (state == ProgramState::frozen) continue;
      if (state == ProgramState::off) {
        air_[side].drop(tick);
        inbox_[side].clear();
        commands_[side] = switched_off(commands_[side]);
        continue;
      }
      CountingEnd& end = ends_[side];
      if (state == ProgramState::booting) {
        end.boot();
        controllers_[side] = Controller{};
      }
      while (const Envelope* envelope = air_[side].oldest(tick)) {
        const wire::Packet packet = end.read(*envelope, totals.links[other(side)], end.owes[0]);
        if (packet.kind == wire::PacketKind::state)
          inbox_[side].push_back(wire::state_of(packet.payload).word);
        air_[side].pop();
      }
      const MessageKind first = inbox_[side].empty() ? MessageKind::none : inbox_[side].front();
      found[side] = first;
      const auto out =
          controllers_[side].step({sensed[side].sign, first, sensed[side].palm_at_target});
      if (out.read && first != MessageKind::none) inbox_[side].pop_front();
      commands_[side] = out.command;
      says[side] = out.send;
      sends[side] = out.send != MessageKind::none || end.owes[0];
    }
    const bool collides = sends[left] && sends[right] && radio_.collide(tick);
    for (const std::size_t side : {left, right}) {
      if (!sends[side]) continue;
      CountingEnd& end = ends_[side];
      const bool is_hello = says[side] == MessageKind::none;
      const auto to = static_cast<wire::Role>(other(side));
      end.endpoint.skip_to(to, tick + 2);  // between robots the numbers are control ticks
      const wire::Payload payload = wire::packet_of(says[side], {}).payload;
      const Envelope envelope = is_hello ? end.write(to, wire::PacketKind::hello, wire::up)
                                         : end.write(to, wire::PacketKind::state, payload);
      end.owes[0] = false;
      const std::uint32_t received =
          radio_.post(air_[other(side)], tick, envelope, side, side, collides, totals);
      log.push_back({tick, received, static_cast<std::uint8_t>(side),
                     static_cast<std::uint8_t>(other(side)), says[side], is_hello});
    }
    return commands_;
  }

 private:
  PerSide<CountingEnd> ends_{CountingEnd(wire::Role::left), CountingEnd(wire::Role::right)};
  PerSide<Controller> controllers_{};
  PerSide<std::deque<MessageKind>> inbox_;
  PerSide<Link<Envelope>> air_;  // to each robot
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

// A station and two robots, on endpoints.
class EndpointStation {
 public:
  LinkTotals totals{};

  EndpointStation(const Channel& channel, std::uint64_t seed, const Faults& faults)
      : radio_(channel, seed, right), faults_(faults) {
    for (CountingEnd& robot : robots_) shake_hands(robot, station_);
  }

  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed) {
    const bool lost = faults_.station_lost(tick);
    PerSide<bool> runs{};
    for (const std::size_t side : {left, right}) {
      const ProgramState state = monitor_.program_state(faults_, tick, side);
      runs[side] = state == ProgramState::running || state == ProgramState::booting;
      if (state == ProgramState::off) {
        down_[side].drop(tick);
        commands_[side] = switched_off(commands_[side]);
      }
      if (state == ProgramState::booting) {
        robots_[side].boot();
        commands_[side] = {Palm::steep, Move::hold};
      }
      while (const Envelope* envelope = runs[side] ? down_[side].oldest(tick) : nullptr) {
        bool must_answer = false;  // the report of this tick answers
        const wire::Packet packet =
            robots_[side].read(*envelope, totals.links[2 + side], must_answer);
        if (packet.kind == wire::PacketKind::command)
          commands_[side] = wire::command_of(packet.payload);
        down_[side].pop();
      }
      while (const Envelope* envelope = up_[side].oldest(tick)) {
        if (!lost) {
          const wire::Packet packet =
              station_.read(*envelope, totals.links[side], station_.owes[side]);
          if (packet.kind == wire::PacketKind::report) {
            reports_[side] = wire::report_of(packet.payload);
            heard_[side] = true;
          }
        }
        up_[side].pop();
      }
    }
    const bool collides = runs[left] && runs[right] && radio_.collide(tick);
    Centralized::Output output{};
    const bool commands = heard_[left] && heard_[right] && !lost;
    if (commands) output = controller_.step(reports_);
    for (const std::size_t side : {left, right}) {
      const auto robot = static_cast<wire::Role>(side);
      if (commands) {
        const wire::Payload payload = wire::packet_of(output.command[side], {}).payload;
        radio_.post(down_[side], tick, station_.write(robot, wire::PacketKind::command, payload), 2,
                    side, false, totals);
        station_.owes[side] = false;
      } else if (station_.owes[side] && !lost) {
        radio_.post(down_[side], tick, station_.write(robot, wire::PacketKind::hello, wire::up), 2,
                    side, false, totals);
        station_.owes[side] = false;
        ++hellos;
      }
      if (!runs[side]) continue;
      const Centralized::Report report{sensed[side].sign, obeyed_[side],
                                       sensed[side].palm_at_target};
      const EnvelopeToStation envelope{robots_[side].write(
          wire::Role::station, wire::PacketKind::report, wire::packet_of(report, {}).payload)};
      radio_.post(up_[side], tick, envelope, side, side, collides, totals);
      obeyed_[side] = commands_[side].palm;
    }
    return commands_;
  }

  std::uint32_t hellos = 0;

 private:
  PerSide<CountingEnd> robots_{CountingEnd(wire::Role::left), CountingEnd(wire::Role::right)};
  CountingEnd station_{wire::Role::station};
  Centralized controller_;
  Centralized::Report reports_[2]{};
  PerSide<bool> heard_{};
  PerSide<Palm> obeyed_{Palm::steep, Palm::steep};
  PerSide<Link<EnvelopeToStation>> up_;
  PerSide<Link<Envelope>> down_;
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Radio radio_;
  Faults faults_;
  ProgramMonitor monitor_;
};

}  // namespace palmbots
