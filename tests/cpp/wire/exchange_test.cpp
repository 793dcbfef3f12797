// SPDX-License-Identifier: Apache-2.0
// What controllers say goes through packets and back unchanged; two resilient robots that talk in
// packets, with a stranger between them, do tick for tick what those of the simulator do that hand
// each other beacons; and what damage does to a packet.
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/runtime/robot_program.hpp"
#include "palmbots/sim/corruption.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/wire/endpoint.hpp"
#include "support/check.hpp"
#include "support/robot_teams.hpp"
#include "support/wire_packets.hpp"

using namespace palmbots;
namespace wire = palmbots::wire;
using wire::Bytes;
using wire::Endpoint;
using wire::RandomWords;
using wire::Role;
using wire::Verdict;

namespace {

constexpr MessageKind messages[] = {MessageKind::tilt_up, MessageKind::tilt_down, MessageKind::ack,
                                    MessageKind::closing, MessageKind::raised};

void test_beacons_there_and_back() {
  for (const MessageKind message : messages) {
    for (const bool stopped : {false, true}) {
      for (const bool ready : {false, true}) {
        const Beacon beacon{message, stopped, ready, {70000, 4000000000U}, {3, 9}};
        const wire::Packet packet =
            wire::packet_of(beacon, {Role::left, Role::right, wire::test_pair, {}, {}});
        CHECK(wire::well_formed(packet) && packet.kind == wire::PacketKind::state);
        CHECK(wire::state_of(packet.payload).language == wire::Language::beacons);
        const wire::State back = wire::state_of(packet.payload);
        CHECK(back.message == message && back.at_rest == stopped && back.ready == ready);
        CHECK((packet.sent == wire::SequenceNumber{70000, 4000000000U}));
        CHECK((packet.heard == wire::SequenceNumber{3, 9}));
      }
    }
  }
}

// The messages of a table that shares signs are a language of their own, with the same stamps.
void test_signs_there_and_back() {
  for (const MessageKind kind : {MessageKind::minus, MessageKind::zero, MessageKind::plus,
                                 MessageKind::minus_shallow, MessageKind::plus_shallow}) {
    const Beacon beacon{kind, false, false, {70000, 4000000000U}, {3, 9}};
    const wire::Packet packet =
        wire::packet_of(beacon, {Role::left, Role::right, wire::test_pair, {}, {}});
    CHECK(wire::well_formed(packet));
    CHECK(wire::state_of(packet.payload).language == wire::Language::signs);
    const wire::State back = wire::state_of(packet.payload);
    CHECK(back.message == kind && !back.at_rest && !back.ready);
    CHECK((packet.sent == wire::SequenceNumber{70000, 4000000000U}));
    CHECK((packet.heard == wire::SequenceNumber{3, 9}));
    // A robot takes in only the language that its controller uses.
    const wire::Decoded heard{Verdict::accepted, packet};
    runtime::PartnerProgram signs(TableRobot<SharedSign>({1, 5, {}}, {true}), 1);
    runtime::PartnerProgram beacons(TableRobot<Resilient>({1, 5, {3, 0, 3}}, {true}), 1);
    CHECK(signs.hear(heard) != runtime::Taken::ignored);
    CHECK(beacons.hear(heard) == runtime::Taken::ignored);
  }
}

void test_reports_commands_and_messages_survive_encoding() {
  const wire::PacketHeader up{Role::right, Role::station, 7, {1, 2}, {3, 4}};
  const wire::PacketHeader down{Role::station, Role::left, 7, {1, 2}, {3, 4}};
  const wire::PacketHeader across{Role::left, Role::right, 7, {1, 2}, {3, 4}};
  for (const Sign sign : {Sign::negative, Sign::zero, Sign::positive}) {
    const Centralized::Report report{sign, Palm::shallow, sign == Sign::zero};
    const wire::Packet packet = wire::packet_of(report, up);
    const Centralized::Report back = wire::report_of(packet.payload);
    CHECK(wire::well_formed(packet) && packet.kind == wire::PacketKind::report);
    CHECK(back.sign == sign && back.palm == Palm::shallow &&
          back.palm_at_target == (sign == Sign::zero));
  }
  for (const Move move : {Move::hold, Move::away, Move::closer}) {
    const wire::Packet packet = wire::packet_of(Command{Palm::shallow, move}, down);
    CHECK(wire::well_formed(packet) && packet.kind == wire::PacketKind::command);
    CHECK((wire::command_of(packet.payload) == Command{Palm::shallow, move}));
  }
  const wire::Packet message = wire::packet_of(MessageKind::ack, across);
  CHECK(wire::well_formed(message) && wire::state_of(message.payload).message == MessageKind::ack);
  CHECK(
      (message.sent == wire::SequenceNumber{1, 2} && message.heard == wire::SequenceNumber{3, 4}));
}

// Numbers may be left out, but never come again, and used up they stay used up.
void test_numbers_left_out() {
  const wire::Identity identity{wire::test_key, wire::test_pair, Role::left};
  const auto number = [](Endpoint& end) {
    Bytes bytes{};
    if (!end.send(Role::right, wire::PacketKind::hello, wire::up, bytes)) return std::uint32_t{0};
    return wire::get<std::uint32_t>(bytes, wire::sequence_field);
  };
  Endpoint end(identity, 1);
  end.skip_to(Role::right, 40);
  CHECK(number(end) == 40 && number(end) == 41);
  end.skip_to(Role::right, 41);
  CHECK(number(end) == 42);
  end.skip_to(Role::right, 0xFFFFFFFF);
  CHECK(number(end) == 0xFFFFFFFF && number(end) == 0);
  end.skip_to(Role::right, 50);
  CHECK(number(end) == 0);
}

// One robot as it would run on a processor: a program, an end of the wire, and nothing but bytes in
// and out.
struct Machine {
  using Controller = TableRobot<Resilient>;
  Controller controller;
  std::size_t side;
  std::uint32_t epoch = 1;
  std::uint32_t tick = 0;
  Endpoint end;
  runtime::PartnerProgram<Controller> program;
  bool assists = false;
  std::uint32_t stale = 0;  // packets that were not new
  std::uint32_t late = 0;   // news older than the lease

  Machine(const Controller& robot, std::size_t s)
      : controller(robot), side(s), end(identity(s), 1), program(robot, 1) {}

  static wire::Identity identity(std::size_t side) {
    return {wire::test_key, wire::test_pair, static_cast<Role>(side)};
  }

  void reboot() {
    tick = 0;
    end = Endpoint(identity(side), ++epoch);
    program = runtime::PartnerProgram(controller.booted(assists), epoch);
  }

  Command step(const std::vector<Bytes>& came, const RobotObservation& sensed,
               std::vector<Bytes>& sends) {
    ++tick;
    program.pass(1);
    for (const Bytes& bytes : came) {
      const runtime::Taken taken = program.hear(end.receive(bytes));
      stale += taken == runtime::Taken::rejected ? 1 : 0;
      late += taken == runtime::Taken::late ? 1 : 0;
    }
    const runtime::Decision out = program.step({sensed.sign, sensed.palm_at_target});
    assists = out.assists;
    if (out.speaks) {
      Bytes bytes{};
      const auto partner = static_cast<Role>(other(side));
      end.skip_to(partner, tick);
      wire::State state = out.state;
      state.mode = wire::RobotMode::carrying;
      CHECK(end.send(partner, wire::PacketKind::state, wire::payload_of(state), bytes));
      CHECK(wire::get<std::uint32_t>(bytes, wire::sequence_field) == tick);
      sends.push_back(bytes);
    }
    return out.command;
  }
};

// The same losses and delays, and the same reboots, for robots that hand each other beacons and for
// robots that send bytes, which a stranger doubles, damages, forges and plays back.
void test_robots_that_talk_in_packets(std::uint64_t seed, bool with_stranger) {
  const TableTimes<Resilient> times{5, 52, {69, 6, 6}};
  Channel channel = Channel::of(0.03, 0.04, 0.1, 0.01);
  channel.reorders = true;
  Spec spec{};
  spec.period = 0.01;
  for (const std::uint32_t i : {0U, 1U}) {
    spec.faults[i] = {FaultKind::reboot, i, 10.0 + 8.0 * i, 0.3, 0, 0};
  }
  spec.fault_count = 2;
  const Faults faults = Faults::of(spec, seed);
  ProgramMonitor monitor;
  ResilientTeam peers = resilient_team(times, {0, 0}, channel, seed, right, faults);
  Machine machines[2] = {{peers.robot(left), left}, {peers.robot(right), right}};
  struct Flying {
    std::uint32_t due;
    Bytes bytes;
  };
  std::vector<Flying> air[2];   // by receiver
  std::vector<Flying> tape[2];  // what has come to each, and what it has said itself, and when
  RandomWords dice(seed);
  PerSide<Command> commands{{{Palm::steep, Move::hold, true}, {Palm::steep, Move::hold, true}}};
  std::uint32_t moved = 0;
  std::uint32_t travelled = 0;
  for (std::uint32_t tick = 0; tick < 3000; ++tick) {
    const Words words = draw(seed, tick / 40, Stream::tactile, 7);
    PerSide<RobotObservation> seen{};
    for (const std::size_t side : {left, right}) {
      const std::uint32_t felt = words[side] % 5;  // 0 most of the time
      seen[side] = {felt < 2 ? static_cast<Sign>(2 * static_cast<int>(felt) - 1) : Sign::zero,
                    (draw(seed, tick, Stream::tactile, 8)[side] & 7) != 0};
    }
    std::vector<SentMessage> sent_messages;
    const PerSide<Command> wanted =
        peers.step(tick, seen, [&](const SentMessage& p) { sent_messages.push_back(p); });
    for (const std::size_t side : {left, right}) {
      const ProgramState state = monitor.program_state(faults, tick, side);
      std::vector<Bytes> came;
      std::erase_if(air[side], [&](const Flying& f) {
        if (f.due <= tick) came.push_back(f.bytes);
        return f.due <= tick;
      });
      if (state == ProgramState::off) commands[side] = switched_off(commands[side]);
      if (state == ProgramState::booting) machines[side].reboot();
      if (state == ProgramState::running || state == ProgramState::booting) {
        for (const Bytes& bytes : came) tape[side].push_back({tick, bytes});
        if (with_stranger && !tape[side].empty()) {
          // After what comes from the partner: something damaged, and something older than the
          // lease. (What is younger a robot that has just booted may take, from anybody: it is as
          // if it had come late.)
          const auto size = static_cast<std::uint32_t>(tape[side].size());
          const Flying& old = tape[side][dice.below(size)];
          if (tick - old.due > times.lease) came.push_back(old.bytes);
          Bytes bad = tape[side].back().bytes;
          bad[dice.below(wire::packet_size)] ^= static_cast<std::uint8_t>(1 + dice.below(255));
          came.push_back(bad);
        }
        std::vector<Bytes> sends;
        commands[side] = machines[side].step(came, seen[side], sends);
        for (const Bytes& bytes : sends) {
          tape[side].push_back({tick, bytes});
          for (const SentMessage& p : sent_messages) {
            if (p.sender == side && p.received != 0)
              air[other(side)].push_back({p.received, bytes});
          }
        }
      }
      CHECK(commands[side] == wanted[side]);
      moved += wanted[side].move != Move::hold ? 1 : 0;
      travelled += wanted[side].stop ? 0 : 1;
    }
  }
  CHECK(moved > 100 && travelled > 500);
  for (const std::size_t side : {left, right}) {
    const LinkCounts& link = peers.link_totals.links[other(side)];
    CHECK(link.late > 0 && link.rejected > 0);
    if (with_stranger) continue;
    CHECK(link.late == machines[side].late && link.rejected == machines[side].stale);
  }
  for (const Machine& machine : machines) {
    CHECK(machine.end.count(Verdict::accepted) > 100);
    for (const Verdict verdict : {Verdict::bad_tag, Verdict::stale, Verdict::wrong_receiver}) {
      CHECK(!with_stranger || machine.end.count(verdict) > 100);
    }
  }
}

// Whatever is said, damaged anywhere: never accepted, and the noise does reach every byte.
void test_damage_is_noticed() {
  std::array<std::uint32_t, wire::verdict_count> verdicts{};
  std::uint32_t n = 0;
  for (const wire::Packet& packet : wire::all_sayings()) {
    for (std::uint32_t i = 0; i < 200; ++i, ++n) {
      const Verdict verdict = damaged(packet, draw(11, n, Stream::corruption));
      CHECK(verdict != Verdict::accepted && verdict != Verdict::malformed);
      ++verdicts[static_cast<std::size_t>(verdict)];
    }
  }
  // The first field that is wrong decides. Noise of 1 to 8 bytes begins at each of 32 as often, the
  // first of them always wrong, a later one but for one time in 256.
  const auto share = [&](Verdict verdict) {
    return verdicts[static_cast<std::size_t>(verdict)] / double(n);
  };
  CHECK(share(Verdict::wrong_version) > 0.8 / 32 && share(Verdict::wrong_version) < 1.2 / 32);
  CHECK(share(Verdict::wrong_pair) > 2.0 / 32 && share(Verdict::wrong_pair) < 5.0 / 32);
  CHECK(share(Verdict::bad_tag) > 20.0 / 32);
  CHECK(share(Verdict::wrong_receiver) > 0.1 / 32);
}

}  // namespace

int main() {
  test_beacons_there_and_back();
  test_signs_there_and_back();
  test_reports_commands_and_messages_survive_encoding();
  test_numbers_left_out();
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    test_robots_that_talk_in_packets(seed, false);
    test_robots_that_talk_in_packets(seed, true);
  }
  test_damage_is_noticed();
}
