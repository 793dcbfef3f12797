// SPDX-License-Identifier: Apache-2.0
// What a robot sends, tick by tick, and what the station of the centralized algorithm answers.
#include "palmbots/runtime/robot_runtime.hpp"

#include <cstdint>
#include <optional>
#include <vector>

#include "palmbots/control/resilient.hpp"
#include "palmbots/control/table_robot.hpp"
#include "palmbots/runtime/station_runtime.hpp"
#include "support/check.hpp"
#include "support/wire_packets.hpp"

namespace {

using namespace palmbots;
using namespace palmbots::runtime;
using wire::Decoded;
using wire::PacketKind;
using wire::Role;

constexpr wire::Identity identity_of(Role role) { return {wire::test_key, wire::test_pair, role}; }

// How the robot has called its program: when it began, and the ticks of its steps.
struct Calls {
  std::uint32_t begun = never;
  std::uint32_t passed = 0;
};
Calls calls;

// A program that says nothing. It drives away from the partner, or closer after a boot.
struct Silent {
  bool is_rebooted = false;

  static constexpr bool answers_with_hello = true;
  static constexpr bool repeats = false;
  static constexpr bool greets = false;
  static constexpr bool with_station = false;

  void begin(std::uint32_t tick) { calls = {tick, 0}; }
  void pass(std::uint16_t elapsed) { calls.passed += elapsed; }
  Taken hear(const Decoded&) { return Taken::ignored; }
  Decision step(const runtime::Observation&) {
    return {{Palm::shallow, is_rebooted ? Move::closer : Move::away, false}};
  }
  static constexpr char name() { return ' '; }
  static constexpr bool waits() { return false; }
  static constexpr MessageKind awaits() { return MessageKind::none; }
  static constexpr std::uint32_t silence() { return 0; }
};

// A robot on the left with its partner and a station, which hear everything.
struct Ends {
  explicit Ends(const RuntimeSettings& settings, bool carries = false, StoredMode stored = {},
                std::uint32_t epoch = 1, const PhaseSettings<Lifting>& phases = {},
                bool holds = false)
      : robot(identity_of(Role::left), epoch, Silent{}, Silent{true},
              PhaseProgram<Lifting>(phases, epoch, holds), settings, stored, carries) {}

  void step(const Reading& reading = {}, std::uint16_t elapsed = 1) {
    robot.begin(elapsed);
    for (const wire::Bytes& bytes : to_robot) robot.receive(bytes);
    to_robot.clear();
    out = robot.step(reading);
    to_partner.reset();
    to_station.reset();
    for (std::size_t i = 0; i < out.packet_count; ++i) {
      const Outgoing& packet = out.packets[i];
      const bool is_partner = packet.receiver == Role::right;
      const Decoded got = (is_partner ? partner : station).receive(packet.bytes);
      (is_partner ? to_partner : to_station) = got;
    }
  }
  void say(wire::Endpoint& end, PacketKind kind, const wire::Payload& payload) {
    wire::Bytes bytes{};
    CHECK(end.send(Role::left, kind, payload, bytes));
    to_robot.push_back(bytes);
  }

  RobotRuntime<Silent> robot;
  wire::Endpoint partner{identity_of(Role::right), 1};
  wire::Endpoint station{identity_of(Role::station), 1};
  std::vector<wire::Bytes> to_robot;
  Outputs out;
  std::optional<Decoded> to_partner;
  std::optional<Decoded> to_station;
};

RuntimeSettings calm() {
  RuntimeSettings settings{};
  settings.mode.station_lost = StationLost::carry_on;
  settings.mode.partner_lost = PartnerLost::controller;
  settings.mode.lease = settings.mode.station_limit = settings.mode.time_limit = never;
  settings.mode.stopping_limit = never;
  settings.mode.most_overruns = 0xFFFF;
  return settings;
}

wire::Status status(const Ends& ends) {
  CHECK(ends.to_station && ends.to_station->packet.kind == PacketKind::status);
  return wire::status_of(ends.to_station->packet.payload);
}

// Every third tick; every other status has the progress, and the other numbers take turns.
void test_numbers_take_turns() {
  RuntimeSettings settings = calm();
  settings.status_period = 3;
  Ends ends(settings, true);
  Reading reading{};
  reading.battery_mv = 7400;
  reading.overruns = 5;
  const wire::Bytes noise{};  // a packet of another version
  std::uint32_t sent = 0;
  for (unsigned tick = 1; tick <= 3 * 4 * wire::status_items; ++tick) {
    ends.to_robot.push_back(noise);
    ends.step(reading);
    CHECK(ends.to_station.has_value() == (tick % 3 == 0));
    if (!ends.to_station) continue;
    const unsigned turn = tick / 3 - 1;
    const unsigned others = wire::status_items - 1;
    const wire::Status seen = status(ends);
    CHECK(static_cast<unsigned>(seen.item) == (turn % 2 == 0 ? 0 : 1 + turn / 2 % others));
    // Packets to the station leave no gaps in the sequence.
    CHECK(ends.to_station->packet.sent.sequence == turn + 1);
    const auto first = static_cast<unsigned>(wire::StatusItem::received);
    const unsigned wrong = first + static_cast<unsigned>(wire::Verdict::wrong_version);
    switch (seen.item) {
      case wire::StatusItem::progress: CHECK(seen.value == 0); break;
      case wire::StatusItem::battery: CHECK(seen.value == 7400); break;
      case wire::StatusItem::overruns: CHECK(seen.value == 5); break;
      case wire::StatusItem::sent: CHECK(seen.value == sent); break;
      case wire::StatusItem::phase: CHECK(seen.value == 0xFFFF); break;
      default: CHECK(seen.value == (static_cast<unsigned>(seen.item) == wrong ? tick : 0));
    }
    sent += static_cast<std::uint32_t>(ends.out.packet_count);
  }
  // After a long pause there is one status.
  for (int k = 0; k < 3; ++k) {
    ends.step(reading, 0xFFFF);
    CHECK(ends.to_station.has_value());
  }
  ends.step(reading);
  CHECK(!ends.to_station);
}

// The part of the time for the distance, or what odometry reads.
void test_progress() {
  RuntimeSettings settings = calm();
  settings.status_period = 2;
  settings.mode.travel = 40;
  Ends ends(settings, true);
  Reading reading{};
  reading.progress = 1234;
  for (unsigned tick = 1; tick <= 36; ++tick) {
    ends.step(reading);
    // The robot rests in one step, until its program has decided for the first time.
    if (tick % 4 == 2) CHECK(status(ends).value == 65535 * (tick - 1) / 40);
  }
  settings.mode.travel = 0;
  Ends odometry(settings, true);
  odometry.step(reading);
  odometry.step(reading);
  CHECK(status(odometry).value == 1234);
}

// A carry is alone when the partner has been silent for longer than the lease.
void test_warning_of_a_silent_partner() {
  RuntimeSettings settings = calm();
  settings.status_period = 1;
  settings.mode.lease = 5;
  Ends ends(settings, true);
  for (unsigned tick = 1; tick <= 10; ++tick) {
    ends.step();
    CHECK(ends.out.mode.wheels);
    const bool is_alone = status(ends).fault == wire::FaultCode::partner_lost;
    CHECK(is_alone == (tick > 5));
  }
  // The newest packet of the partner acknowledges that of tick 10.
  settings.state_period = 1;
  Ends heard(settings, true);
  for (unsigned tick = 1; tick <= 20; ++tick) {
    if (tick > 1 && tick <= 11) {
      heard.say(heard.partner, PacketKind::state,
                wire::payload_of(wire::State{.mode = wire::RobotMode::carrying}));
    }
    heard.step();
    const bool is_alone = status(heard).fault == wire::FaultCode::partner_lost;
    CHECK(is_alone == (tick > 15));
  }
}

// Before a carry: at intervals a state, once in eight times a hello instead; a new mode at once.
void test_news_for_the_partner() {
  RuntimeSettings settings = calm();
  settings.state_period = 2;
  settings.number = 77;
  Ends ends(settings);
  unsigned extras = 0;
  for (unsigned tick = 1; tick <= 41; ++tick) {
    ends.step();
    const bool is_new = tick == 1;  // off becomes disarmed
    CHECK(ends.out.mode.mode == wire::RobotMode::disarmed);
    CHECK(ends.out.decision.command.stop && ends.out.decision.command.move == Move::hold);
    CHECK(ends.to_partner.has_value() == (is_new || tick % 2 == 1));
    if (!ends.to_partner) continue;
    const wire::Packet& packet = ends.to_partner->packet;
    CHECK(packet.sent.sequence == tick);
    const bool hello = !is_new && extras++ % 8 == 0;
    CHECK(packet.kind == (hello ? PacketKind::hello : PacketKind::state));
    if (hello) CHECK(wire::hello_of(packet.payload).settings == 77);
    if (!hello) CHECK(wire::state_of(packet.payload).at_rest);
  }
  // A packet without a session is answered by a hello at once, whenever it arrives.
  wire::Endpoint booted{identity_of(Role::right), 2};
  for (const int pause : {0, 1}) {
    for (int k = 0; k < pause; ++k) ends.step();
    ends.say(booted, PacketKind::hello, wire::payload_of(wire::Hello{}));
    ends.step();
    CHECK(ends.to_partner && ends.to_partner->packet.kind == PacketKind::hello);
  }

  // In a carry, too, as the program answers with a hello.
  Ends carrying(settings, true);
  for (int tick = 1; tick <= 8; ++tick) {
    carrying.step();
    CHECK(carrying.to_partner.has_value() == (tick <= 2 || tick % 2 == 0));
  }
  settings.state_period = 1;
  Ends often(settings);
  for (int tick = 1; tick <= 5; ++tick) {
    often.step();
    CHECK(often.to_partner);
  }
  settings.state_period = 0;
  Ends never_late(settings);
  for (int tick = 1; tick <= 5; ++tick) {
    never_late.step();
    CHECK(!never_late.to_partner);
  }
}

// The partner has to have said that its settings are the same, even if their number is 1.
void test_other_settings_are_refused() {
  RuntimeSettings settings = calm();
  settings.number = settings.state_period = settings.status_period = 1;
  for (const bool says : {false, true}) {
    Ends ends(settings);
    Reading reading{};
    reading.seen.palm_at_target = true;
    ends.step(reading);
    if (says) ends.say(ends.partner, PacketKind::hello, wire::payload_of(wire::Hello{1}));
    ends.say(ends.partner, PacketKind::state,
             wire::payload_of(wire::State{.mode = wire::RobotMode::disarmed}));
    ends.say(ends.station, PacketKind::operate,
             wire::payload_of(wire::Operate{wire::Operation::arm}));
    ends.step(reading);
    CHECK(ends.out.mode.mode == (says ? wire::RobotMode::armed : wire::RobotMode::disarmed));
    CHECK(ends.out.mode.code == (says ? wire::FaultCode::none : wire::FaultCode::settings));
  }
}

// A program that goes on after a boot has begun one tick before its first step. In a carry that is
// under way, the first boot begins it.
void test_program_begins() {
  RuntimeSettings settings = calm();
  settings.mode.after_reboot = AfterReboot::rejoin;
  Ends ends(settings, false, {true, false});
  calls = {};
  ends.step({}, 7);
  CHECK(ends.out.mode.mode == wire::RobotMode::carrying);
  CHECK(calls.begun == 6 && calls.passed == 1);
  CHECK(ends.out.decision.command.move == Move::closer);
  ends.step({}, 3);
  CHECK(calls.begun == 6 && calls.passed == 4);
  for (const std::uint32_t epoch : {1U, 2U}) {
    Ends begun(calm(), true, {}, epoch);
    begun.step();
    CHECK(begun.out.decision.command.move == (epoch == 1 ? Move::away : Move::closer));
  }
}

// A robot of the centralized algorithm executes commands of the session, and only these.
void test_commands() {
  const Command command{Palm::shallow, Move::closer};
  const auto packet = [&](wire::Verdict verdict, PacketKind kind) -> Decoded {
    return {verdict,
            {kind,
             Role::station,
             Role::left,
             wire::test_pair,
             {1, 1},
             {1, 1},
             wire::payload_of(command)}};
  };
  ReportProgram program;
  CHECK(program.hear(packet(wire::Verdict::no_session, PacketKind::command)) == Taken::rejected);
  CHECK(program.hear(packet(wire::Verdict::stale, PacketKind::command)) == Taken::rejected);
  CHECK(program.hear(packet(wire::Verdict::accepted, PacketKind::hello)) == Taken::ignored);
  CHECK(program.step({Sign::zero, true}).command.palm == Palm::steep);
  CHECK(program.hear(packet(wire::Verdict::accepted, PacketKind::command)) == Taken::taken);
  // The report is about the command before.
  const Decision first = program.step({Sign::zero, true});
  CHECK(first.command.palm == Palm::shallow && first.command.move == Move::closer);
  CHECK(first.report.palm == Palm::steep && first.assists);
  CHECK(program.step({Sign::zero, true}).report.palm == Palm::shallow);
}

// A beacon is late when it is older than the lease.
void test_late_beacons() {
  constexpr std::uint16_t lease = 5;
  for (std::uint16_t age = 1; age <= 8; ++age) {
    using Program = PartnerProgram<TableRobot<Resilient>>;
    Program program(TableRobot<Resilient>({1, lease, {3, 0, 3}}, {true}), 1);
    program.pass(10);
    const wire::State state{wire::Language::beacons, MessageKind::tilt_down,
                            wire::RobotMode::carrying, true};
    const wire::Packet beacon{PacketKind::state, Role::right, Role::left,
                              wire::test_pair,   {1, 4},      {1, std::uint32_t{10} - age},
                              payload_of(state)};
    const Taken taken = program.hear({wire::Verdict::accepted, beacon});
    CHECK(taken == (age > lease ? Taken::late : Taken::taken));
  }
}

// The station answers with a hello until it has a report of both robots, then with commands.
void test_station() {
  StationRuntime station(identity_of(Role::station), 1);
  wire::Endpoint robots[2] = {{identity_of(Role::left), 1}, {identity_of(Role::right), 1}};
  const auto say = [&](std::size_t robot, PacketKind kind, const wire::Payload& payload) {
    wire::Bytes bytes{};
    CHECK(robots[robot].send(Role::station, kind, payload, bytes));
    return station.receive(bytes);
  };
  const wire::Payload hello = wire::payload_of(wire::Hello{});
  const auto answers = [&](PacketKind kind) {
    const StationRuntime::Outputs out = station.step();
    std::size_t heard = 0;
    for (std::size_t i = 0; i < out.packet_count; ++i) {
      const Outgoing& packet = out.packets[i];
      const Decoded got = robots[static_cast<std::size_t>(packet.receiver)].receive(packet.bytes);
      heard += got.packet.kind == kind ? 1U << static_cast<unsigned>(packet.receiver) : 0U;
    }
    station.begin();
    return heard;
  };
  for (const std::size_t robot : {std::size_t{0}, std::size_t{1}}) {
    CHECK(say(robot, PacketKind::hello, hello) == wire::Verdict::no_session);
  }
  CHECK(answers(PacketKind::hello) == 3);
  for (const std::size_t robot : {std::size_t{0}, std::size_t{1}}) {
    CHECK(say(robot, PacketKind::hello, hello) == wire::Verdict::accepted);
  }
  CHECK(answers(PacketKind::command) == 0);
  const wire::Payload report = wire::payload_of(Centralized::Report{Sign::zero, Palm::steep, true});
  CHECK(say(0, PacketKind::report, report) == wire::Verdict::accepted);
  CHECK(answers(PacketKind::command) == 0);
  CHECK(say(1, PacketKind::report, report) == wire::Verdict::accepted);
  CHECK(answers(PacketKind::command) == 3);
}

}  // namespace

int main() {
  test_numbers_take_turns();
  test_progress();
  test_warning_of_a_silent_partner();
  test_news_for_the_partner();
  test_other_settings_are_refused();
  test_program_begins();
  test_commands();
  test_late_beacons();
  test_station();
}
