// SPDX-License-Identifier: Apache-2.0
// The schedule of what breaks, tick by tick.
#include "palmbots/sim/faults.hpp"

#include <cstdint>
#include <initializer_list>

#include "support/check.hpp"

using namespace palmbots;

namespace {

Spec spec_of(std::initializer_list<FaultSpec> faults) {
  Spec spec{};
  spec.period = 0.01;
  spec.watchdog = 0.04;
  for (const FaultSpec& fault : faults) spec.faults[spec.fault_count++] = fault;
  return spec;
}

// What a robot's program does in ticks 0, 1, …: r runs, f frozen, o off, b boots.
void check_host(std::initializer_list<FaultSpec> faults, std::size_t side, const char* wanted) {
  const Faults schedule = Faults::of(spec_of(faults), 0);
  CHECK(schedule.any());
  ProgramMonitor monitor;
  for (std::uint32_t tick = 0; wanted[tick] != 0; ++tick) {
    const ProgramState state = monitor.program_state(schedule, tick, side);
    const char observed = state == ProgramState::running  ? 'r'
                          : state == ProgramState::frozen ? 'f'
                          : state == ProgramState::off    ? 'o'
                                                          : 'b';
    CHECK(observed == wanted[tick]);
  }
}

void test_program_states_of_scripted_faults() {
  constexpr auto reboot = FaultKind::reboot;
  constexpr auto freeze = FaultKind::freeze;
  check_host({{reboot, 0, 0.03, 0.02, 0, 0}}, left, "rrroobrr");
  check_host({{reboot, 0, 0.03, 0.02, 0, 0}}, right, "rrrrrrrr");
  // A freeze longer than the watchdog's four ticks ends in a reboot; one as long or shorter does
  // not.
  check_host({{freeze, 1, 0.02, 0.06, 0, 0}}, right, "rrffffoobr");
  check_host({{freeze, 1, 0.02, 0.04, 0, 0}}, right, "rrffffrr");
  check_host({{freeze, 1, 0.02, 0.03, 0, 0}}, right, "rrfffrrr");
  // Off goes before frozen, whichever is listed first; a boot waits until nothing keeps it off.
  check_host({{freeze, 0, 0.01, 0.04, 0, 0}, {reboot, 0, 0.02, 0.02, 0, 0}}, left, "rfoofbr");
  check_host({{reboot, 0, 0.02, 0.02, 0, 0}, {freeze, 0, 0.01, 0.04, 0, 0}}, left, "rfoofbr");
  check_host({{reboot, 0, 0.01, 0.02, 0, 0}, {reboot, 0, 0.02, 0.03, 0, 0}}, left, "roooobrr");
  CHECK(!Faults::of(spec_of({}), 0).any());
  // What does not touch programs leaves them running.
  check_host({{FaultKind::stuck, 0, 0, 1, 1, 0}, {FaultKind::station, 0, 0, 1, 0, 0}}, left, "rrr");
}

void test_station_and_sensors() {
  const Faults schedule = Faults::of(spec_of({{FaultKind::station, 0, 0.03, 0.02, 0, 0},
                                              {FaultKind::stuck, 1, 0.05, 0.02, -1, 0},
                                              {FaultKind::flicker, 0, 0.10, 50.0, 0, 0.25}}),
                                     7);
  for (std::uint32_t tick = 0; tick < 10; ++tick) {
    CHECK(schedule.station_lost(tick) == (tick == 3 || tick == 4));
    const Sign felt = schedule.reading(tick, right, Sign::positive);
    CHECK(felt == (tick == 5 || tick == 6 ? Sign::negative : Sign::positive));
    CHECK(schedule.reading(tick, left, Sign::positive) == Sign::positive);
  }
  // A quarter of the readings is random: a third of these is right by chance.
  int wrong = 0;
  int read[3]{};
  for (std::uint32_t tick = 10; tick < 5010; ++tick) {
    const Sign felt = schedule.reading(tick, left, Sign::zero);
    wrong += felt != Sign::zero ? 1 : 0;
    ++read[static_cast<int>(felt) + 1];
  }
  CHECK(wrong > 5000 / 6 - 5 * 27 && wrong < 5000 / 6 + 5 * 27);
  CHECK(read[0] > 300 && read[2] > 300);
  CHECK(schedule.reading(5010, left, Sign::zero) == Sign::zero);
}

// The mirrored carry has the mirrored reboots: of the robot that leads, or of the one that follows.
void test_random_reboots() {
  Spec spec = spec_of({});
  spec.distance = 0.6;  // 10 s at the nominal speed
  spec.random_reboots = 2;
  spec.reboot = 0.05;
  int of_left = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    spec.direction = 1;
    const Faults there = Faults::of(spec, seed);
    spec.direction = -1;
    const Faults back = Faults::of(spec, seed);
    int off[2]{};
    for (std::uint32_t tick = 0; tick < 1100; ++tick) {
      for (const std::size_t side : {left, right}) {
        CHECK(there.program_state(tick, side) == back.program_state(tick, other(side)));
        off[side] += there.program_state(tick, side) == ProgramState::off ? 1 : 0;
      }
    }
    CHECK(off[left] + off[right] <= 10 && off[left] + off[right] >= 5);
    of_left += off[left];
  }
  CHECK(of_left > 1000 - 5 * 71 && of_left < 1000 + 5 * 71);
}

// Programs and station: every tick of an outage, and where the next one begins. Sensors do not
// count.
void test_next_outage() {
  const Faults none = Faults::of(spec_of({}), 0);
  CHECK(none.next_outage(0) == ~0U && !none.corrupts_readings());
  const Faults some = Faults::of(spec_of({{FaultKind::stuck, 0, 0.01, 0.01, 1, 0},
                                          {FaultKind::freeze, 0, 0.20, 0.03, 0, 0},
                                          {FaultKind::station, 0, 0.10, 0.02, 0, 0}}),
                                 0);
  CHECK(some.corrupts_readings());
  CHECK(some.next_outage(0) == 10 && some.next_outage(9) == 10);
  CHECK(some.next_outage(10) == 11 && some.next_outage(11) == 12);
  CHECK(some.next_outage(12) == 20);
  CHECK(some.next_outage(22) == 23 && some.next_outage(23) == ~0U);
  CHECK(!Faults::of(spec_of({{FaultKind::reboot, 0, 0.01, 0.01, 0, 0}}), 0).corrupts_readings());
}

// Until then a robot's host stays what it is. Nothing else is waited for, except by a program that does
// not run in every tick.
void test_next_change() {
  for (const std::uint64_t stride : {std::uint64_t{1}, std::uint64_t{3}}) {
    Spec spec = spec_of({{FaultKind::freeze, 0, 0.20, 0.50, 0, 0},
                         {FaultKind::reboot, 0, 0.60, 0.30, 0, 0},
                         {FaultKind::reboot, 1, 0.40, 0.10, 0, 0},
                         {FaultKind::stuck, 0, 0.05, 0.50, 1, 0},
                         {FaultKind::freeze, 0, 2.00, 0.02, 0, 0}});
    spec.robots[left].stride = spec.robots[right].stride = stride;
    const Faults some = Faults::of(spec, 0);
    for (const std::size_t side : {left, right}) {
      int changes = 0;
      for (std::uint32_t tick = 0; tick < 300; ++tick) {
        const std::uint32_t next = some.next_change(tick, side);
        CHECK(next > tick);
        const ProgramState now = some.program_state(tick, side);
        for (std::uint32_t t = tick; t < next && t < 300; ++t)
          CHECK(some.program_state(t, side) == now);
        if (next == tick + 1) ++changes;
      }
      if (stride == 1) CHECK(changes <= (side == left ? 9 : 2));
      if (stride == 1) CHECK(some.next_change(300, side) == ~0U);
    }
  }
}

// A palm falls only with a reboot that says so; clocks change for one robot.
void test_palms_and_clocks() {
  FaultSpec limp{FaultKind::reboot, 0, 0.03, 0.02, 0, 0.25};
  limp.marks = palm_goes_limp;
  const Faults some = Faults::of(spec_of({limp,
                                          {FaultKind::reboot, 0, 0.06, 0.02, 0, 0},
                                          {FaultKind::clock_jump, 1, 0.05, 0, 0, 0.5}}),
                                 0);
  CHECK(some.may_go_limp());
  for (std::uint32_t tick = 0; tick < 10; ++tick) {
    CHECK(some.limp_angle(tick, left).has_value() == (tick == 3 || tick == 4));
    CHECK(!some.limp_angle(tick, right).has_value());
    CHECK(some.clock_gain(tick, right) == (tick == 5 ? 50 : 0));
    CHECK(some.clock_gain(tick, left) == 0);
  }
  CHECK(some.changes_clock(right) && !some.changes_clock(left));
}

}  // namespace

int main() {
  test_program_states_of_scripted_faults();
  test_station_and_sensors();
  test_random_reboots();
  test_next_outage();
  test_next_change();
  test_palms_and_clocks();
}
