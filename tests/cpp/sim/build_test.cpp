// SPDX-License-Identifier: Apache-2.0
// What a simulation gets from a spec, in numbers that are easily computed by hand.
#include "palmbots/sim/build.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/pushes.hpp"
#include "palmbots/sim/remote_team.hpp"
#include "palmbots/sim/session_link.hpp"
#include "palmbots/sim/spec_bytes.hpp"
#include "palmbots/sim/table_team.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

bool near(double a, double b) { return std::abs(a - b) < 1e-12; }

// A spec that is made while the program runs is the one that the table of keys is made from.
constexpr Spec default_spec() {
  Spec spec;
  spec.zone_count = spec.outage_count = spec.message_fault_count = 1;
  spec.fault_count = spec.bump_count = spec.push_count = 1;
  return spec;
}

void test_defaults() {
  constexpr Spec constant = default_spec();
  const Spec made = default_spec();
  std::vector<std::byte> a;
  std::vector<std::byte> b;
  append_bytes(constant, a);
  append_bytes(made, b);
  CHECK(a == b);
  const Spec none;
  CHECK(none.zone_count + none.outage_count + none.message_fault_count == 0);
  CHECK(none.fault_count + none.bump_count + none.push_count == 0);
}

void test_periods_and_faults() {
  Spec spec = paper_spec();
  spec.period = 0.01;
  for (const std::size_t slow : {left, right}) {
    spec.robots[slow].stride = 3;
    spec.robots[other(slow)].stride = 2;
    CHECK(near(spec.longest_period(), 0.03));
  }
  CHECK(!may_go_limp(spec));
  spec.fault_count = 2;
  for (std::size_t k = 0; k < 2; ++k) {
    spec.faults[k].marks = palm_goes_limp;
    CHECK(may_go_limp(spec));
    spec.faults[k].marks = 0;
  }
}

void test_outages() {
  Spec spec = paper_spec();
  spec.outages[0] = {2, 1.0, 2.0};
  spec.outages[1] = {1, 3.0, 4.0};
  spec.outage_count = 2;
  const Channel channel = channel_of(spec);
  CHECK(channel.is_dead(2, 150) && !channel.is_dead(1, 150) && !channel.is_dead(2, 250));
  CHECK(channel.is_dead(1, 350) && !channel.is_dead(2, 350));
}

// The reaction takes 0.01 + 2 (0.03 + 0.05) s and a turn of 10° at 50°/s, 0.37 s together.
void test_reach_beyond_the_zero_zone() {
  Spec spec = paper_spec();
  spec.beacon = 0.05;
  for (RobotSpec& robot : spec.robots) robot.noise = 0;
  CHECK(near(detail::off_zone_reach(spec, 0.03, 0.06), 0));
  spec.robots[left].bias = 0.002;
  spec.robots[right].bias = -0.001;
  spec.robots[left].noise = 0.003;
  spec.robots[right].noise = 0.004;
  CHECK(near(detail::off_zone_reach(spec, 0.03, 0.06), (0.003 + 0.005) * 0.37));
  spec.robots[right].acceleration = 0.25;  // and of the other one 0.5
  const double unequal = 0.5 * 0.06 * 0.06 * (4 - 2);
  CHECK(near(detail::off_zone_reach(spec, 0.03, 0.06), 0.008 * 0.37 + unequal));
}

// A beacon, a step and the delay in both directions, and what clocks of other periods add.
void test_round_trip() {
  Spec spec = paper_spec();
  spec.latency = 0.05;
  CHECK(near(round_trip_of(spec, 0.07), 2 * (0.05 + 0.07 + 0.01)));
  spec.latency = 0.001;
  CHECK(near(round_trip_of(spec, 0.07), 2 * (0.01 + 0.07 + 0.01)));
  spec.robots[right].stride = 3;
  CHECK(near(round_trip_of(spec, 0.07), 2 * (0.01 + 0.07 + 0.03) + 4 * 0.02));
}

// With short palms all times of a table are below a second.
void test_table_timing() {
  Spec spec = paper_spec();
  spec.latency = 0.05;
  for (PalmSpec& palm : spec.palms) palm.length = 0.012;
  const TableTiming timing = table_timing_of(spec);
  CHECK(near(timing.turn, 0.2) && near(timing.delay, 0.06));
  CHECK(near(timing.reach, 0.006 / 0.03));
  CHECK(near(timing.crossing, 0.01 / 0.06 + 0.5 * 0.06 / 0.5));
}

// The largest change of a clock among all faults, upwards or downwards.
void test_gains_of_a_clock() {
  Spec spec = paper_spec();
  spec.fault_count = 2;
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    spec.faults = {};
    spec.faults[k] = {FaultKind::clock_rate, right, 1.0, 2.0, 0, 0.02, 0};
    CHECK(near(detail::fastest_gain(spec, right), 0.02));
    CHECK(near(detail::fastest_gain(spec, right, -1), 0));
    CHECK(near(detail::fastest_gain(spec, left), 0));
    spec.faults[k].rate = -0.03;
    CHECK(near(detail::fastest_gain(spec, right, -1), 0.03));
  }
}

// A push of 20 ms, from 50 ms on, lasts for two ticks.
void test_pushes() {
  Spec spec = paper_spec();
  spec.push_count = 1;
  spec.pushes[0].side = right;
  spec.pushes[0].at = 0.05;
  spec.pushes[0].lasts = 0.02;
  spec.pushes[0].speed = 0.01;
  for (std::uint32_t tick = 0; tick < 10; ++tick) {
    const double expected = tick == 5 || tick == 6 ? 0.01 : 0;
    CHECK(near(Pushes::speed(spec, tick, right), expected));
    CHECK(near(Pushes::speed(spec, tick, left), 0));
    const std::uint32_t next = tick <= 5 ? 5 : tick <= 7 ? 7 : ~0U;
    CHECK(Pushes::next_change(spec, tick) == next);
  }
}

// Each of these changes more than which messages arrive; a loss does not.
void test_steady_channels() {
  const Channel plain = Channel::of(0.03, 0, 0, 0.01);
  CHECK(plain.is_plain() && plain.is_steady() && !plain.is_random());
  Channel lossy = plain;
  lossy.loss_words = Channel::words_of(0.1);
  CHECK(!lossy.is_plain() && lossy.is_steady() && lossy.is_random());
  std::array<Channel, 7> others;
  others.fill(plain);
  others[0].jitter_ticks = 1;
  others[1].burst_share = 0.1;
  others[2].airtime_ticks = 0.5;
  others[3].outage_count = 1;
  others[4].message_fault_count = 1;
  others[5].has_directions = true;
  others[6].replay_words = 1;
  for (const Channel& channel : others) CHECK(!channel.is_steady() && !channel.is_plain());
}

// The scripted fault of a message is that of its link: of a robot, or from the station to a robot.
void test_message_faults() {
  for (std::uint32_t faulty = 0; faulty < 4; ++faulty) {
    Channel channel = Channel::of(0.02, 0, 0, 0.01);
    channel.message_fault_count = 1;
    channel.message_faults[0] = {faulty, 1, MessageEffect::lost, 0};
    const Radio radio(channel, 1, left);
    for (std::uint32_t number = 0; number < 4; ++number) {
      Link<MessageKind> link;
      LinkTotals totals{};
      const std::size_t robot = number % 2;
      radio.post(link, 3, MessageKind::tilt_up, number < 2 ? robot : 2, robot, false, totals);
      CHECK(totals.links[number].sent == 1);
      CHECK(totals.links[number].lost == (number == faulty ? 1U : 0U));
    }
  }
}

// What a station does with a table of rows: nothing where both contacts are centred.
void test_activity_of_a_station() {
  for (const Sign l : {Sign::positive, Sign::zero, Sign::negative}) {
    for (const Sign r : {Sign::positive, Sign::zero, Sign::negative}) {
      RowPolicy station;
      station.step({{l, Palm::steep, true}, {r, Palm::steep, true}});
      const CorrectionActivity found = activity_of_station(station, left);
      const bool rests = l == Sign::zero && r == Sign::zero;
      CHECK((found.name == CorrectionActivity{}.name) == rests);
      CHECK(found.sense[left] == static_cast<int>(l) && found.sense[right] == static_cast<int>(r));
      CHECK(activity_of_station(station, right).name == CorrectionActivity{}.name);
    }
  }
}

// An attacker repeats a message if its random word is below the limit, not if it is equal to it.
void test_limit_of_replays() {
  constexpr std::uint64_t seed = 5;
  const std::uint32_t word = draw(seed, 3U, Stream::replay, 0U)[0];
  for (const std::uint64_t limit : {std::uint64_t{word}, std::uint64_t{word} + 1}) {
    Channel channel = Channel::of(0.02, 0, 0, 0.01);
    channel.replay_words = limit;
    channel.replay_ticks = 50;
    const Radio radio(channel, seed, left);
    Link<MessageKind> link;
    LinkTotals totals{};
    radio.post(link, 3, MessageKind::tilt_up, left, left, false, totals);
    CHECK(totals.links[left].duplicated == (limit > word ? 1U : 0U));
  }
}

void test_hello_of_a_session() {
  const wire::PacketHeader header{wire::Role::left, wire::Role::right, 0, {}, {}};
  for (const bool is_hello : {false, true}) {
    const Stamped<MessageKind> stamped{MessageKind::ack, is_hello, {1, 2}, {3, 4}};
    const wire::Packet packet = packet_of(stamped, header);
    CHECK((packet.kind == wire::PacketKind::hello) == is_hello);
    CHECK(packet.sent.sequence == 2 && packet.heard.epoch == 3);
  }
}

// The program of the station goes on: only robots boot.
void test_programs_that_boot() {
  Spec spec = paper_spec();
  spec.watchdog = 0.05;
  spec.fault_count = 1;
  spec.faults[0].kind = FaultKind::reboot;
  spec.faults[0].side = right;
  spec.faults[0].at = 0.05;
  spec.faults[0].lasts = 0.03;
  std::array<int, programs> boots{};
  const auto exchange = [&](std::uint32_t, const ProgramInputs& inputs) {
    for (std::size_t k = 0; k < programs; ++k) boots[k] += inputs[k] && inputs[k]->boots ? 1 : 0;
    return ProgramOutputs{};
  };
  RemoteTeam<decltype(exchange), true> team(exchange, {Palm::steep, Move::hold}, {0, 0},
                                            channel_of(spec), 1, left, Faults::of(spec, 1));
  const PerSide<RobotObservation> sensed{};
  for (std::uint32_t tick = 0; tick < 20; ++tick) team.step(tick, sensed, [](const auto&) {});
  CHECK(boots[0] == 0 && boots[1] == 1 && boots[2] == 0);
}

}  // namespace

int main() {
  test_defaults();
  test_periods_and_faults();
  test_outages();
  test_reach_beyond_the_zero_zone();
  test_round_trip();
  test_table_timing();
  test_gains_of_a_clock();
  test_pushes();
  test_steady_channels();
  test_message_faults();
  test_activity_of_a_station();
  test_limit_of_replays();
  test_hello_of_a_session();
  test_programs_that_boot();
}
