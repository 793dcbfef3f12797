// SPDX-License-Identifier: Apache-2.0
// Sessions on the simulated radio, with losses, copies, overtaking, damage, collisions, reboots and
// freezes: who answers with a hello, what is found and rejected, and that a team that is stepped only
// when something happens does the same as one that is stepped in every tick.
// (tests/robot/test_remote_programs.py compares them with robots that exchange packets.)
#include "palmbots/sim/session_link.hpp"

#include <cstdint>
#include <utility>
#include <vector>

#include "palmbots/sim/centralized_team.hpp"
#include "support/check.hpp"
#include "support/robot_teams.hpp"

using namespace palmbots;

namespace {

// A channel and faults under which the verdicts differ, or do not.
struct Condition {
  Channel channel = Channel::of(0.03, 0, 0, 0.01);
  Spec spec{};
  bool boots = false;    // hellos are to be expected
  bool repeats = false;  // packets that are stale and not damaged are to be expected

  Faults faults(std::uint64_t seed) const { return Faults::of(spec, seed); }
};

void add_fault(Spec& spec, FaultKind kind, std::uint32_t side, double at, double lasts) {
  spec.faults[spec.fault_count++] = {kind, side, at, lasts, 0, 0};
}

std::vector<Condition> conditions() {
  Condition plain;
  plain.spec.period = 0.01;
  plain.spec.watchdog = 0.05;
  Condition lossy = plain;
  lossy.channel.loss_words = Channel::words_of(0.2);
  Condition jittery = lossy;
  jittery.channel.jitter_ticks = 5;
  Condition copying = jittery;
  copying.channel.duplicate_words = Channel::words_of(0.2);
  copying.repeats = true;
  Condition overtaking = copying;
  overtaking.channel.reorders = true;
  Condition damaged = overtaking;
  damaged.channel.corrupt_words = Channel::words_of(0.1);
  damaged.channel.airtime_ticks = 0.3;
  Condition scripted = plain;
  scripted.repeats = true;
  for (const std::uint32_t n : {1U, 2U, 5U, 6U}) {
    scripted.channel.message_faults[scripted.channel.message_fault_count++] = {
        n % 2, n, MessageEffect::copied, 40 * n};
  }
  Condition rebooting = plain;
  rebooting.boots = true;
  add_fault(rebooting.spec, FaultKind::reboot, left, 0.0, 0.1);  // before anybody was heard
  add_fault(rebooting.spec, FaultKind::reboot, right, 2.0, 0.3);
  add_fault(rebooting.spec, FaultKind::reboot, left, 2.2, 0.3);  // both at once
  add_fault(rebooting.spec, FaultKind::freeze, left, 4.0, 0.03);
  add_fault(rebooting.spec, FaultKind::freeze, right, 5.0, 0.5);  // ends in a boot
  add_fault(rebooting.spec, FaultKind::station, left, 6.0, 0.4);
  add_fault(rebooting.spec, FaultKind::reboot, right, 6.1, 0.1);
  add_fault(rebooting.spec, FaultKind::reboot, right, 7.0, 0.01);
  Condition all = damaged;
  all.spec = rebooting.spec;
  all.boots = true;
  Condition rebooting_slowly = rebooting;
  rebooting_slowly.channel.latency_ticks = 20;
  rebooting_slowly.channel.loss_words = Channel::words_of(0.1);
  return {plain,   lossy,    jittery,   copying, overtaking,
          damaged, scripted, rebooting, all,     rebooting_slowly};
}

// A robot that says and commands something new in many ticks, depending on all that it has heard.
struct Talker : QueueController {
  std::uint32_t heard = 1;
  Talker booted() const { return {}; }
  RobotOutput step(const RobotInput& in) {
    heard = heard * 1664525U + 1013904223U + static_cast<std::uint32_t>(in.message);
    const std::uint32_t luck = heard >> 16;
    const auto send = static_cast<MessageKind>(luck % 8 < 4 ? luck % 4 : 0);
    return said({Palm::shallow, static_cast<Move>(luck / 8 % 3)}, send, luck / 32 % 4 != 0);
  }
};

// What the robots sense: signs that last for a while, palms that arrive or do not.
PerSide<RobotObservation> observation(std::uint64_t seed, std::uint32_t tick) {
  const Words words = draw(seed, tick / 40, Stream::tactile, 7);
  const Words turned = draw(seed, tick / 8, Stream::tactile, 8);
  PerSide<RobotObservation> seen{};
  for (const std::size_t side : {left, right}) {
    const std::uint32_t felt = words[side] % 5;  // 0 most of the time
    seen[side] = {felt < 2 ? static_cast<Sign>(2 * static_cast<int>(felt) - 1) : Sign::zero,
                  (turned[side] & 7) != 0};
  }
  return seen;
}

bool same(const LinkTotals& a, const LinkTotals& b) {
  bool all = a.sent == b.sent && a.lost == b.lost;
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    const LinkCounts& x = a.links[i];
    const LinkCounts& y = b.links[i];
    all = all && x.sent == y.sent && x.lost == y.lost && x.duplicated == y.duplicated &&
          x.late == y.late && x.rejected == y.rejected;
  }
  return all;
}

bool same(const SentMessage& a, const SentMessage& b) {
  return a.sent == b.sent && a.received == b.received && a.sender == b.sender &&
         a.receiver == b.receiver && a.kind == b.kind && a.is_hello == b.is_hello;
}

constexpr std::uint32_t length = 1500;

// A team that is stepped only when its observations change or it says so.
template <class Team>
struct Lazy {
  Team team;
  std::uint32_t next = 0;
  PerSide<RobotObservation> seen{};
  PerSide<Command> commands{};

  template <class Log>
  void step(std::uint32_t tick, const PerSide<RobotObservation>& sensed, Log&& log) {
    if (tick < next && sensed == seen) return;
    seen = sensed;
    const PerSide<Command> before = std::exchange(commands, team.step(tick, sensed, log));
    next = team.next_decision_tick(tick);
    // A palm that has just been commanded to turn is expected not to be there in the next tick.
    for (const std::size_t side : {left, right}) {
      if (Team::expects_turns && commands[side].palm != before[side].palm)
        seen[side].palm_at_target = false;
    }
  }
};

template <class Controller>
RobotTeam<Controller> team_of(const Condition& condition, std::uint64_t seed) {
  return {{}, {}, condition.channel, seed, right, condition.faults(seed)};
}

// Returns the number of hellos.
template <class Controller>
std::uint32_t test_robots(const Condition& condition, std::uint64_t seed) {
  RobotTeam<Controller> team = team_of<Controller>(condition, seed);
  Lazy<RobotTeam<Controller>> lazy{team};
  std::vector<SentMessage> log;
  std::vector<SentMessage> lazy_log;
  std::uint32_t hellos = 0;
  for (std::uint32_t tick = 0; tick < length; ++tick) {
    const PerSide<RobotObservation> seen = observation(seed, tick);
    for (auto* list : {&log, &lazy_log}) list->clear();
    lazy.step(tick, seen, [&](const SentMessage& m) { lazy_log.push_back(m); });
    const PerSide<Command> commands =
        team.step(tick, seen, [&](const SentMessage& m) { log.push_back(m); });
    CHECK(lazy.commands == commands && lazy_log.size() == log.size());
    for (std::size_t i = 0; i < log.size(); ++i) {
      CHECK(same(lazy_log[i], log[i]));
      hellos += log[i].is_hello ? 1 : 0;
    }
    CHECK(same(lazy.team.link_totals, team.link_totals));
  }
  return hellos;
}

void test_centralized(const Condition& condition, std::uint64_t seed) {
  CentralizedTeam team(condition.channel, seed, right, condition.faults(seed));
  Lazy<CentralizedTeam> lazy{team};
  const auto ignore = [](const SentMessage&) {};
  for (std::uint32_t tick = 0; tick < length; ++tick) {
    const PerSide<RobotObservation> seen = observation(seed, tick);
    const PerSide<Command> commands = team.step(tick, seen, ignore);
    lazy.step(tick, seen, ignore);
    CHECK(lazy.commands == commands);
  }
  for (CentralizedTeam* one : {&team, &lazy.team}) one->close(length);
  CHECK(same(lazy.team.link_totals, team.link_totals));
}

// On the bare channel a copy and a message from before a boot are acted upon.
bool differs_on_the_bare_channel(Condition condition, std::uint64_t seed) {
  RobotTeam<Talker> with = team_of<Talker>(condition, seed);
  condition.channel.has_sessions = false;
  RobotTeam<Talker> without = team_of<Talker>(condition, seed);
  bool differs = false;
  for (std::uint32_t tick = 0; tick < length; ++tick) {
    const PerSide<RobotObservation> seen = observation(seed, tick);
    const auto ignore = [](const SentMessage&) {};
    differs = with.step(tick, seen, ignore) != without.step(tick, seen, ignore) || differs;
  }
  CHECK(without.link_totals.links[left].rejected == 0 || condition.channel.corrupt_words > 0);
  return differs;
}

}  // namespace

int main() {
  for (const Condition& condition : conditions()) {
    std::uint32_t hellos = 0;
    bool differ = false;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      hellos += test_robots<Talker>(condition, seed);
      test_robots<TableRobot<Distributed>>(condition, seed);
      test_centralized(condition, seed);
      differ = differs_on_the_bare_channel(condition, seed) || differ;
    }
    CHECK((hellos > 0) == condition.boots);
    CHECK(differ == (condition.boots || condition.repeats));
  }
}
