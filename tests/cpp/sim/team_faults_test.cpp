// SPDX-License-Identifier: Apache-2.0
// Teams whose robots reboot or freeze, a station that goes down, and messages that collide: what the
// robots remember, hear and command.
#include <cstdint>

#include "palmbots/sim/centralized_team.hpp"
#include "support/check.hpp"
#include "support/robot_teams.hpp"

using namespace palmbots;

namespace {

constexpr auto ignore = [](const SentMessage&) {};

// A robot that counts its steps since it was made, and asks all the time.
struct Counter : QueueController {
  bool asks = false;
  std::uint32_t steps = 0;
  std::uint32_t heard = 0;
  Counter() = default;
  explicit Counter(bool asks_too) : asks(asks_too) {}
  Counter booted() const { return Counter(asks); }
  RobotOutput step(const RobotInput& in) {
    ++steps;
    heard += in.message != MessageKind::none ? 1 : 0;
    const auto move = static_cast<Move>(1 + (steps - 1) % 2);  // each step has its own command
    return said({Palm::shallow, move}, asks ? MessageKind::tilt_up : MessageKind::none, true);
  }
  char name() const { return static_cast<char>('0' + heard); }
};
using CounterTeam = RobotTeam<Counter>;

Faults fault_of(FaultKind kind, std::uint32_t side, double at, double lasts) {
  Spec spec{};
  spec.period = 0.01;
  spec.watchdog = 0.04;
  spec.faults[0] = {kind, side, at, lasts, 0, 0};
  spec.fault_count = 1;
  return Faults::of(spec, 0);
}

Channel channel_of(double latency, bool has_sessions) {
  Channel channel = Channel::of(latency, 0, 0, 0.01);
  channel.has_sessions = has_sessions;
  return channel;
}

// Off for ticks 10 to 14: it rests with the palm as commanded, hears nothing of what comes
// meanwhile, and begins anew in tick 15, with what comes then. With sessions what comes in tick 15
// is only answered; the answer is there in tick 18, and what is sent then comes in tick 21.
void test_rebooted_robot_starts_from_its_initial_state(bool has_sessions) {
  CounterTeam team({Counter(), Counter(true)}, {}, channel_of(0.03, has_sessions), 0, right,
                   fault_of(FaultKind::reboot, left, 0.1, 0.05));
  const std::uint32_t again = has_sessions ? 21 : 15;
  for (std::uint32_t tick = 0; tick < 28; ++tick) {
    const auto out = team.step(tick, {}, ignore);
    const bool off = tick >= 10 && tick < 15;
    CHECK(out[left].stop == off && !out[right].stop);
    CHECK(out[left].palm == Palm::shallow);
    const std::uint32_t step = tick < 10 ? tick : tick - 15;  // of the same life, from 0
    if (!off) CHECK(out[left].move == static_cast<Move>(1 + step % 2));
    if (off) CHECK(out[left].move == Move::hold);
    // One message a tick from tick 3 on; those of ticks 10 to 14 came to nobody.
    const std::uint32_t since = tick < again ? 0 : tick + 1 - again;
    const std::uint32_t heard = tick < 10 ? (tick < 3 ? 0 : tick - 2) : (off ? 7 : since);
    CHECK(team.name(left) == static_cast<char>('0' + heard));
  }
  // Six messages had no session. Until the first hello comes, there is one for each.
  CHECK(team.link_totals.links[right].rejected == (has_sessions ? 6 : 0));
  CHECK(team.link_totals.links[left].sent == (has_sessions ? 6 : 0));
}

// Frozen for ticks 10 to 13 it continues its last command; then the watchdog makes it rest and
// reboot.
void test_frozen_robot_keeps_its_command_until_the_watchdog_reboots_it() {
  CounterTeam team({}, {}, Channel::of(0.03, 0, 0, 0.01), 0, right,
                   fault_of(FaultKind::freeze, right, 0.1, 0.08));
  for (std::uint32_t tick = 0; tick < 25; ++tick) {
    const auto out = team.step(tick, {}, ignore);
    CHECK(out[right].stop == (tick >= 14 && tick < 18));
    if (tick >= 9 && tick < 14) CHECK(out[right].move == Move::closer);  // of the tenth step
    if (tick == 18) CHECK(out[right].move == Move::away);                // of the first
  }
  // One that ends before that has only stood still.
  CounterTeam brief({}, {}, Channel::of(0.03, 0, 0, 0.01), 0, right,
                    fault_of(FaultKind::freeze, right, 0.1, 0.03));
  for (std::uint32_t tick = 0; tick < 25; ++tick) {
    const auto out = brief.step(tick, {}, ignore);
    const std::uint32_t step = tick < 10 ? tick : (tick < 13 ? 9 : tick - 3);
    CHECK(!out[right].stop && out[right].move == static_cast<Move>(1 + step % 2));
  }
}

// Case 1: the right palm is up. The right robot, off for ticks 60 to 69, then does nothing until
// the next command has come; a command that came while it was off is gone. With sessions the next
// command is the answer to its report of tick 70.
void test_reboot_of_a_robot_with_a_station(bool has_sessions) {
  CentralizedTeam team(channel_of(0.05, has_sessions), 0, right,
                       fault_of(FaultKind::reboot, right, 0.6, 0.1));
  const std::uint32_t again = has_sessions ? 80 : 70;
  std::uint32_t before = 0;
  for (std::uint32_t tick = 0; tick < 90; ++tick) {
    const auto out = team.step(tick, {{{Sign::positive, true}, {Sign::zero, true}}}, ignore);
    const bool off = tick >= 60 && tick < 70;
    CHECK(out[right].stop == off && !out[left].stop);
    if (tick >= 12 && tick < 70) CHECK(out[right].palm == Palm::shallow);
    if (off) CHECK(out[right].move == Move::hold);
    if (tick >= 70 && tick < again) CHECK((out[right] == Command{Palm::steep, Move::hold}));
    // Commands come every tick; that of this tick too.
    if (tick >= again) CHECK(out[right].palm == Palm::shallow && out[right].move == Move::away);
    const std::uint32_t reports = team.link_totals.links[right].sent;
    CHECK(reports == before + (off ? 0 : 1));
    before = reports;
  }
  CHECK(team.link_totals.links[2 + right].rejected == (has_sessions ? 10 : 0));
  // One that hears nothing afterwards drives on, palm steep.
  Channel dead = Channel::of(0.05, 0, 0, 0.01);
  dead.outages[0] = {2, 60, 1000};
  dead.outage_count = 1;
  CentralizedTeam alone(dead, 0, right, fault_of(FaultKind::reboot, right, 0.6, 0.1));
  for (std::uint32_t tick = 0; tick < 90; ++tick) {
    const auto out = alone.step(tick, {{{Sign::positive, true}, {Sign::zero, true}}}, ignore);
    if (tick >= 70) CHECK((out[right] == Command{Palm::steep, Move::hold}));
    if (tick >= 70) CHECK((out[left] == Command{Palm::steep, Move::away}));  // the last command
  }
}

// What comes while the station is lost, ticks 10 to 29, comes to nobody: that the left contact was
// off then, and that its robot is silent since. A station that was there all along acts on it.
void test_station_that_is_down_receives_nothing() {
  Channel channel = Channel::of(0.05, 0, 0, 0.01);
  channel.outages[0] = {0, 23, 1000};
  channel.outage_count = 1;
  for (const bool lost : {false, true}) {
    CentralizedTeam team(channel, 0, right,
                         lost ? fault_of(FaultKind::station, left, 0.1, 0.2) : Faults());
    bool acts = false;
    for (std::uint32_t tick = 0; tick < 60; ++tick) {
      const Sign sign = tick >= 12 && tick < 23 ? Sign::positive : Sign::zero;
      team.step(tick, {{{sign, true}, {Sign::zero, true}}}, ignore);
      acts = acts || team.name(left) != ' ';
    }
    CHECK(acts == !lost);
  }
}

// Messages that are sent at once collide as they overlap: with airtime a of a tick in 1 − (1 − a)²
// of all ticks. A robot that is off does not disturb the other.
void test_overlapping_messages_collide() {
  Channel channel = Channel::of(0.05, 0, 0, 0.01);
  channel.airtime_ticks = 0.3;
  CounterTeam team({Counter(true), Counter(true)}, {}, channel, 1, right);
  constexpr int n = 20000;
  for (std::uint32_t tick = 0; tick < n; ++tick) team.step(tick, {}, ignore);
  const LinkCounts& there = team.link_totals.links[left];
  CHECK(there.sent == n && there.lost == team.link_totals.links[right].lost);
  const double share = there.lost / double(n);
  CHECK(share > 0.51 - 5 * 0.0036 && share < 0.51 + 5 * 0.0036);
  CentralizedTeam station(channel, 1, right, fault_of(FaultKind::reboot, right, 0, 100));
  for (std::uint32_t tick = 0; tick < 1000; ++tick) station.step(tick, {}, ignore);
  CHECK(station.link_totals.links[left].sent == 1000 && station.link_totals.links[left].lost == 0);
}

}  // namespace

int main() {
  for (const bool has_sessions : {true, false}) {
    test_rebooted_robot_starts_from_its_initial_state(has_sessions);
    test_reboot_of_a_robot_with_a_station(has_sessions);
  }
  test_frozen_robot_keeps_its_command_until_the_watchdog_reboots_it();
  test_station_that_is_down_receives_nothing();
  test_overlapping_messages_collide();
}
