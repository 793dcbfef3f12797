// SPDX-License-Identifier: Apache-2.0
// Whole carries from C++: nothing in a tick takes memory from the heap, and recorders only watch.
//
// carry_test [ROUNDS]   ROUNDS: of random carries; 1 if not given
#include <cstdint>
#include <cstdlib>
#include <new>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/no_controller.hpp"
#include "palmbots/sim/recorder.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"
#include "support/robot_teams.hpp"

namespace {

long allocations = 0;
std::uint64_t rounds = 1;  // of random carries

void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  std::abort();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

using namespace palmbots;

// Everything that a scene can switch on, so that every part of a tick is reached.
Spec busy_spec() {
  Spec spec = paper_spec();
  spec.false_rate = 0.01;
  spec.jitter = 0.03;
  spec.loss = 0.001;
  spec.bump_rate = 5;
  spec.bump_max = 0.004;
  spec.bumps[0] = {0, 1, 1.0, 0.008};
  spec.bumps[1] = {1, 0, 0.2, -0.008};
  spec.bump_count = 2;
  for (PalmSpec& palm : spec.palms) palm.offset = 0.01;
  return spec;
}

struct Ran {
  std::uint32_t ticks;
  std::uint32_t corrections;
  std::uint32_t sent;
  Outcome outcome;
  double square_sum;
};

template <class Real, class Recorder, class Team>
Ran run_counting(const Spec& spec, std::uint64_t seed, Team team, Recorder* recorder) {
  Carry<Real, Team, Recorder> carry(spec, seed, std::move(team), std::move(*recorder));
  while (carry.metrics().outcome == Outcome::running) {
    carry.recorder().make_room();
    const long before = allocations;
    carry.tick();
    CHECK(allocations == before);
  }
  *recorder = std::move(carry.recorder());
  const Metrics& m = carry.metrics();
  return {carry.ticks(), m.corrections, carry.team().link_totals.sent, m.outcome,
          m.square_sum[left] + m.square_sum[right]};
}

template <class Team>
void test_no_allocation(const Spec& spec, std::uint64_t seed, const Team& team) {
  NoRecorder none;
  TraceRecorder hash(false);
  TraceRecorder trace;
  TraceRecorder in_float;
  const Ran bare = run_counting<double>(spec, seed, team, &none);
  const Ran hashed = run_counting<double>(spec, seed, team, &hash);
  const Ran traced = run_counting<double>(spec, seed, team, &trace);
  // A recorder watches and changes nothing.
  CHECK(bare.ticks == hashed.ticks && bare.ticks == traced.ticks);
  CHECK(bare.square_sum == hashed.square_sum && bare.square_sum == traced.square_sum);
  CHECK(bare.corrections == traced.corrections && bare.sent == traced.sent);
  CHECK(hash.hash() == trace.hash());
  CHECK(bare.ticks > 10);
  const std::vector<Row> rows = trace.take_rows();
  CHECK(hash.take_rows().empty() && rows.size() == traced.ticks);
  TraceHash of_rows;
  for (const Row& row : rows) row.numbers([&](double value) { of_rows.add(value); });
  CHECK(of_rows.value() == hash.hash());
  CHECK(run_counting<float>(spec, seed, team, &in_float).ticks > 10);
}

void test_no_allocation_by_any_team() {
  const Spec busy = busy_spec();
  const Spec plain = paper_spec();
  const Channel channel = Channel::of(busy.latency, busy.jitter, busy.loss, busy.period);
  for (std::uint64_t seed = 0; seed < 2 * rounds; ++seed) {
    for (const Spec& spec : {plain, busy}) {
      test_no_allocation(spec, seed, NoController{});
      test_no_allocation(spec, seed, CentralizedTeam(channel, seed, right));
      test_no_allocation(spec, seed, distributed_team(channel, seed, right));
      test_no_allocation(spec, seed, resilient_team({5, 52, {69, 6, 6}}, {}, channel, seed, right));
    }
  }
}

// Checks the counter itself: a trace allocates memory, outside the ticks.
void test_allocations_are_counted() {
  const long before = allocations;
  TraceRecorder trace;
  trace.make_room();
  CHECK(allocations > before);
}

void test_paper_box_arrives() {
  const Spec spec = paper_spec();
  const Channel channel = Channel::of(spec.latency, spec.jitter, spec.loss, spec.period);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const DistributedTeam team = distributed_team(channel, seed, right);
    NoRecorder none;
    const Ran ran = run_counting<double>(spec, seed, team, &none);
    CHECK(ran.outcome == Outcome::delivered);
    CHECK(ran.ticks > 2300 && ran.ticks < 2800);
    CHECK(ran.corrections > 15 && ran.corrections < 60);
  }
}

// Of 20 seeds some have reboots, some robots that freeze, sensors that fail and a station that is
// lost.
void break_some(Spec& spec, std::uint64_t seed) {
  spec.random_reboots = seed % 4 == 1 ? 2 : 0;
  spec.reboot = 0.3;
  spec.fault_count = 0;
  if (seed % 4 != 2) return;
  const auto side = static_cast<std::uint32_t>(seed / 4 % 2);
  spec.faults[spec.fault_count++] = {FaultKind::freeze, side, 3.03, 0.72, 0, 0};
  spec.faults[spec.fault_count++] = {FaultKind::stuck, 0, 6.0, 0.5, 1, 0};
  spec.faults[spec.fault_count++] = {FaultKind::flicker, 1, 8.0, 1.0, 0, 0.2};
  spec.faults[spec.fault_count++] = {FaultKind::station, 0, 10.0, 0.33, 0, 0};
  spec.faults[spec.fault_count++] = {FaultKind::freeze, 1 - side, 12.01, 0.05, 0, 0};
}

// The same algorithm, but it does not say when it has nothing to do: so it is asked in every tick.
struct Restless : QueueController {
  TableRobot<Distributed> robot;
  Restless booted() const { return {}; }
  RobotOutput step(const RobotInput& in) {
    ++steps;
    return robot.step(in);
  }
  char name() const { return robot.name(); }
  bool waits() const { return robot.waits(); }
  static inline long steps = 0;
};

// Robots that are stepped only when they have something to do carry like robots that are stepped in
// every tick, on any radio.
void test_sleeping_robots_carry_like_robots_stepped_every_tick() {
  Spec spec = paper_spec();
  for (PalmSpec& palm : spec.palms) palm.offset = 0.01;
  for (std::uint64_t seed = 0; seed < 20 * rounds; ++seed) {
    spec.jitter = seed % 2 == 0 ? 0 : 0.05;
    spec.loss = seed % 3 == 0 ? 0 : 0.003;
    Channel channel = Channel::of(spec.latency, spec.jitter, spec.loss, spec.period);
    // A copy is a message that nobody waits for.
    if (seed % 5 == 1) channel.duplicate_words = Channel::words_of(0.2);
    break_some(spec, seed);
    const Faults faults = Faults::of(spec, seed);
    Carry<double, DistributedTeam, NoRecorder> one(
        spec, seed, distributed_team(channel, seed, right, faults), NoRecorder{});
    Carry<double, RobotTeam<Restless>, NoRecorder> other(
        spec, seed, RobotTeam<Restless>({}, {}, channel, seed, right, faults), NoRecorder{});
    one.run();
    const long before = Restless::steps;
    other.run();
    if (!faults.any()) CHECK(Restless::steps - before == 2L * other.ticks());
    const Metrics &a = one.metrics(), &b = other.metrics();
    CHECK(a.outcome == b.outcome && a.time_ticks == b.time_ticks && a.square_sum == b.square_sum);
    CHECK(a.corrections == b.corrections && a.waiting_ticks == b.waiting_ticks);
    CHECK(a.waits_since == b.waits_since && a.longest_correction == b.longest_correction);
    CHECK(one.team().link_totals.sent == other.team().link_totals.sent);
  }
}

// A station that counts how often it is asked: when it wants to be, or every tick.
template <bool sleepless>
struct Counted : CentralizedTeam {
  using CentralizedTeam::CentralizedTeam;
  std::uint32_t next_decision_tick(std::uint32_t tick) const {
    return sleepless ? tick + 1 : CentralizedTeam::next_decision_tick(tick);
  }
  template <class Log>
  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed, Log&& log) {
    ++steps;
    return CentralizedTeam::step(tick, sensed, log);
  }
  static inline long steps = 0;
};
using Sleeping = Counted<false>;
using Sleepless = Counted<true>;

bool same_links(const LinkTotals& a, const LinkTotals& b) {
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    const LinkCounts &x = a.links[i], &y = b.links[i];
    if (x.sent != y.sent || x.lost != y.lost || x.duplicated != y.duplicated) return false;
    if (x.late != y.late || x.rejected != y.rejected) return false;
  }
  return a.sent == b.sent && a.lost == b.lost;
}

// A station that may sleep decides and counts like one that is stepped in every tick, on any radio.
// On a plain radio it does sleep.
void test_sleeping_station_equals_one_stepped_every_tick() {
  Spec spec = paper_spec();
  long all = 0;
  long asked = 0;
  for (std::uint64_t i = 0; i <= 48 * rounds; ++i) {
    const std::uint64_t seed = i == 0 ? 119 : i - 1;  // 119: a reboot shorter than the latency
    spec.latency = std::array{0.0, 0.05, 0.13, 0.4}[seed % 4];
    spec.bump_rate = seed % 3 == 0 ? 3 : 0;
    spec.bump_max = 0.02;
    Channel channel = Channel::of(spec.latency, 0, 0, spec.period);
    if (seed % 5 == 1) channel.loss_words = Channel::words_of(0.02);
    if (seed % 5 == 2) channel.duplicate_words = Channel::words_of(0.2);
    if (seed % 5 == 3) channel.airtime_ticks = 0.01;
    break_some(spec, seed / 4);
    const Faults faults = Faults::of(spec, seed);
    Carry<double, Sleeping, NoRecorder> one(spec, seed, Sleeping(channel, seed, right, faults),
                                            NoRecorder{});
    Carry<double, Sleepless, NoRecorder> other(spec, seed, Sleepless(channel, seed, right, faults),
                                               NoRecorder{});
    const long before = Sleeping::steps;
    const long before_other = Sleepless::steps;
    one.run();
    other.run();
    const Metrics &a = one.metrics(), &b = other.metrics();
    CHECK(a.outcome == b.outcome && a.time_ticks == b.time_ticks && a.square_sum == b.square_sum);
    CHECK(a.corrections == b.corrections && a.longest_correction == b.longest_correction);
    CHECK(same_links(one.team().link_totals, other.team().link_totals));
    if (channel.is_plain()) {
      asked += Sleeping::steps - before;
      all += Sleepless::steps - before_other;
    } else {
      CHECK(Sleeping::steps - before == Sleepless::steps - before_other);
    }
  }
  CHECK(3 * asked < 2 * all);
}

// Random bumps are those of the seed that counts in their tick, also from a fork inside of a block
// of ticks on. Robots without noise go on at one speed, and bumps of size 0 are counted only.
void test_a_fork_draws_its_own_bumps() {
  Spec spec = paper_spec();
  for (RobotSpec& robot : spec.robots) robot.noise = 0;
  spec.bump_rate = 50;
  const double chance = spec.bump_rate * spec.robots[left].speed * spec.period;
  for (const std::uint32_t fork : {256U, 300U, 319U}) {
    Carry<double, NoController, NoRecorder> carry(spec, 1, NoController{}, NoRecorder{});
    carry.begin();
    std::uint32_t expected = 0;
    std::uint32_t before = 0;  // those while the robots still gather speed
    for (std::uint32_t tick = 0; tick < 700; ++tick) {
      if (tick == 100) before = carry.metrics().bumps;
      if (tick == fork) carry.fork(2);
      const Words words = draw(tick < fork ? 1 : 2, tick, Stream::bump);
      for (const std::size_t robot : {0, 2}) {
        if (tick >= 100 && unit_uniform<double>(words[robot]) < chance) ++expected;
      }
      carry.tick();
    }
    CHECK(expected > 20 && carry.metrics().bumps - before == expected);
  }
}

// Two robots on leases that count how often they are asked.
struct CountedPeers : ResilientTeam {
  using ResilientTeam::RobotTeam;
  template <class Log>
  PerSide<Command> step(std::uint32_t tick, const PerSide<RobotObservation>& sensed, Log&& log) {
    ++steps;
    return ResilientTeam::step(tick, sensed, log);
  }
  static inline long steps = 0;
};

// Resilient robots that sleep decide, send and receive the same as robots that are stepped in every
// tick, on any radio and with any faults.
void test_sleeping_resilient_robots_equal_those_stepped_every_tick() {
  Spec spec = paper_spec();
  const PerSide<TableRobot<Resilient>> robots = table_robots<Resilient>({5, 52, {69, 6, 6}}, right);
  long ticks = 0;
  long asked = 0;
  for (std::uint64_t seed = 0; seed < 30 * rounds; ++seed) {
    spec.latency = std::array{0.0, 0.05, 0.08}[seed % 3];
    spec.jitter = seed % 2 == 0 ? 0 : 0.05;
    spec.loss = seed % 5 == 0 ? 0.2 : 0;
    break_some(spec, seed);
    // A clock that is not the carry's is stepped in every tick, and this one is as good as exact.
    constexpr double restless = 1e-12;
    const double fast = seed % 7 == 6 ? 1e-3 : 0;
    Channel channel = Channel::of(spec.latency, spec.jitter, spec.loss, spec.period);
    if (seed % 6 == 1) channel.duplicate_words = Channel::words_of(0.2);
    const Faults faults = Faults::of(spec, seed);
    const auto carried = [&](auto team) {
      Carry<double, decltype(team), NoRecorder> carry(spec, seed, team, NoRecorder{});
      carry.run();
      return carry;
    };
    const long before = CountedPeers::steps;
    const auto one = carried(CountedPeers(robots, {0, fast}, channel, seed, right, faults));
    if (fast > 0) CHECK(CountedPeers::steps - before == one.ticks());
    asked += fast == 0 ? CountedPeers::steps - before : 0;
    ticks += fast == 0 ? one.ticks() : 0;
    const auto other = carried(ResilientTeam(robots, {restless, fast == 0 ? restless : fast},
                                             channel, seed, right, faults));
    const Metrics &a = one.metrics(), &b = other.metrics();
    CHECK(a.outcome == b.outcome && a.time_ticks == b.time_ticks && a.square_sum == b.square_sum);
    CHECK(a.corrections == b.corrections && a.waiting_ticks == b.waiting_ticks);
    CHECK(a.longest_correction == b.longest_correction);
    CHECK(same_links(one.team().link_totals, other.team().link_totals));
  }
  CHECK(3 * asked < 2 * ticks);
}

// A fork onto a carry's own seed changes nothing; onto another one the past stays and the rest
// differs.
template <class Team>
void test_forks(const Spec& spec, const Team& team) {
  for (const std::uint32_t at : {0U, 100U, 128U, 1000U}) {
    using One = Carry<double, Team, NoRecorder>;
    One whole(spec, 3, team, NoRecorder{}), same(whole), other(whole);
    const auto run = [](One& carry, std::uint32_t until) {
      while (carry.metrics().outcome == Outcome::running && carry.ticks() < until) carry.tick();
    };
    for (One* one : {&whole, &same, &other}) run(*one, at);
    CHECK(whole.midpoint() == other.midpoint());
    same.fork(3);
    other.fork(4);
    for (One* one : {&whole, &same, &other}) run(*one, ~0U);
    const Metrics &a = whole.metrics(), &b = same.metrics(), &c = other.metrics();
    CHECK(a.time_ticks == b.time_ticks && a.square_sum == b.square_sum && a.reason == b.reason);
    CHECK(whole.team().link_totals.lost == same.team().link_totals.lost);
    CHECK(a.square_sum != c.square_sum);
  }
}

void test_forks_of_any_team() {
  const Spec busy = busy_spec();
  const Channel channel = Channel::of(busy.latency, busy.jitter, busy.loss, busy.period);
  test_forks(busy, NoController{});
  test_forks(busy, CentralizedTeam(channel, 3, right));
  test_forks(busy, distributed_team(channel, 3, right));
  test_forks(busy, resilient_team({5, 52, {69, 6, 6}}, {}, channel, 3, right));
}

}  // namespace

int main(int argc, char** argv) {
  rounds = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1;
  test_allocations_are_counted();
  test_no_allocation_by_any_team();
  test_paper_box_arrives();
  test_sleeping_robots_carry_like_robots_stepped_every_tick();
  test_sleeping_station_equals_one_stepped_every_tick();
  test_sleeping_resilient_robots_equal_those_stepped_every_tick();
  test_forks_of_any_team();
  test_a_fork_draws_its_own_bumps();
}
