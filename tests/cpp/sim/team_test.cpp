// SPDX-License-Identifier: Apache-2.0
// Controllers and radio wired together: mirror symmetry, the order of a tick, and what a lost
// packet does where a station decides.
#include "palmbots/sim/centralized_team.hpp"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "palmbots/sim/random_streams.hpp"
#include "support/check.hpp"
#include "support/robot_teams.hpp"

using namespace palmbots;

namespace {

constexpr auto ignore = [](const SentMessage&) {};

RobotObservation sensed_of(const Words& words, int lane) {
  return {static_cast<Sign>(static_cast<int>(words[static_cast<std::size_t>(lane)] % 3) - 1),
          (words[static_cast<std::size_t>(lane) + 1] & 3) == 0};
}

bool same(Command a, Command b) { return a.palm == b.palm && a.move == b.move; }

// The same readings on exchanged sides, with the other robot leading: the same commands on
// exchanged sides, and the same messages between exchanged robots.
template <class Team>
void test_mirror(Team forward, Team backward, std::uint64_t seed) {
  std::vector<SentMessage> there;
  std::vector<SentMessage> back;
  for (std::uint32_t tick = 0; tick < 4000; ++tick) {
    // Signs that last a while, so that corrections get somewhere.
    const Words words = draw(seed, tick / 16, Stream::tactile, 7);
    const Words palm_at_target = draw(seed, tick, Stream::tactile, 8);
    PerSide<RobotObservation> seen{sensed_of(words, 0), sensed_of(words, 2)};
    for (const std::size_t side : {left, right})
      seen[side].palm_at_target = (palm_at_target[side] & 3) == 0;
    const auto a = forward.step(tick, seen, [&](const SentMessage& p) { there.push_back(p); });
    const auto b = backward.step(tick, {seen[right], seen[left]},
                                 [&](const SentMessage& p) { back.push_back(p); });
    CHECK(same(a[left], b[right]) && same(a[right], b[left]));
    CHECK(forward.waits(left) == backward.waits(right));
    CHECK(forward.waits(right) == backward.waits(left));
  }
  CHECK(forward.link_totals.sent == backward.link_totals.sent && forward.link_totals.sent > 100);
  CHECK(forward.link_totals.lost == backward.link_totals.lost);
  CHECK(there.size() == back.size());
  std::uint32_t lost = 0;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const SentMessage& p = there[i];
    lost += p.received == 0 ? 1 : 0;
    // Messages of one tick are posted left first on both sides of the mirror.
    bool found = false;
    for (std::size_t k = i > 0 ? i - 1 : 0; k < there.size() && k <= i + 1; ++k) {
      const SentMessage& q = back[k];
      found = found || (q.sent == p.sent && q.received == p.received && q.kind == p.kind &&
                        q.sender == p.receiver && q.receiver == p.sender);
    }
    CHECK(found);
  }
  if (!there.empty()) CHECK(lost == forward.link_totals.lost);
}

void test_teams_are_mirror_symmetric() {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    for (const Channel& channel : {Channel::of(0.05, 0, 0, 0.01), Channel::of(0.02, 0.06, 0, 0.01),
                                   Channel::of(0.02, 0.06, 0.01, 0.01)}) {
      const bool hangs = channel.loss_words > 0;  // the distributed algorithm after a loss
      if (!hangs) {
        test_mirror(distributed_team(channel, seed, right), distributed_team(channel, seed, left),
                    seed);
      }
      test_mirror(CentralizedTeam(channel, seed, right), CentralizedTeam(channel, seed, left),
                  seed);
    }
  }
}

// A robot that records what it is given.
struct Probe : QueueController {
  std::vector<MessageKind>* got;
  MessageKind say;
  Probe(std::vector<MessageKind>* list, MessageKind message) : got(list), say(message) {}
  Probe booted() const { return *this; }
  RobotOutput step(const RobotInput& in) {
    got->push_back(in.message);
    return said({Palm::steep, Move::hold}, say, in.message == MessageKind::ack);
  }
};

// A message is there ⌈latency⌉ ticks after it was sent, oldest first, and stays until it is read.
void test_messages_wait_until_read() {
  std::vector<MessageKind> left_got;
  std::vector<MessageKind> right_got;
  RobotTeam<Probe> team(
      {Probe(&left_got, MessageKind::tilt_up), Probe(&right_got, MessageKind::ack)}, {},
      Channel::of(0.03, 0, 0, 0.01), 0, right);
  for (std::uint32_t tick = 0; tick < 10; ++tick) team.step(tick, {}, ignore);
  for (std::size_t tick = 0; tick < 10; ++tick) {
    CHECK(left_got[tick] == (tick < 3 ? MessageKind::none : MessageKind::ack));  // read one by one
    CHECK(right_got[tick] == (tick < 3 ? MessageKind::none : MessageKind::tilt_up));  // never read
  }
  CHECK(team.link_totals.sent == 20 && team.link_totals.lost == 0);
}

// Ticks until the station's answer to a positive left contact reaches the right robot.
int ticks_to_answer(Channel channel, std::uint64_t seed) {
  CentralizedTeam team(channel, seed, right);
  for (std::uint32_t tick = 0; tick < 40; ++tick) {
    team.step(tick, {{{Sign::zero, true}, {Sign::zero, true}}}, ignore);
  }
  for (std::uint32_t tick = 40; tick < 4000; ++tick) {
    const auto out = team.step(tick, {{{Sign::positive, true}, {Sign::zero, true}}}, ignore);
    CHECK(out[left].palm == Palm::steep);  // case 1 tilts the right palm
    if (out[right].palm == Palm::shallow) return static_cast<int>(tick) - 40;
  }
  return -1;
}

void test_answer_of_the_station_takes_two_latencies_and_loss_delays_it() {
  CHECK(ticks_to_answer(Channel::of(0, 0, 0, 0.01), 0) == 2);
  CHECK(ticks_to_answer(Channel::of(0.05, 0, 0, 0.01), 0) == 10);
  CHECK(ticks_to_answer(Channel::of(0.20, 0, 0, 0.01), 0) == 40);
  int slowest = 0;
  double sum = 0;
  constexpr int n = 2000;
  for (std::uint64_t seed = 0; seed < n; ++seed) {
    const int ticks = ticks_to_answer(Channel::of(0.05, 0, 0.5, 0.01), seed);
    CHECK(ticks >= 10);
    if (ticks > slowest) slowest = ticks;
    sum += ticks;
  }
  // Each of the two links delays by a geometric number of ticks, of mean loss / (1 − loss) = 1 and
  // variance 2.
  const double mean = sum / n - 10;
  CHECK(mean > 2 - 5 * 0.045 && mean < 2 + 5 * 0.045);
  CHECK(slowest < 45);
  CHECK(ticks_to_answer(Channel::of(0.05, 0, 1, 0.01), 0) == -1);
}

// With everything lost the station is silent and the robots keep palms and speed.
void test_robots_keep_palms_and_speed_without_reception() {
  CentralizedTeam team(Channel::of(0.05, 0, 1, 0.01), 0, right);
  for (std::uint32_t tick = 0; tick < 100; ++tick) {
    const auto out = team.step(tick, {{{Sign::positive, true}, {Sign::negative, true}}}, ignore);
    for (const std::size_t side : {left, right}) {
      CHECK(same(out[side], {Palm::steep, Move::hold}));
    }
    CHECK(team.name(left) == ' ');
  }
  CHECK(team.link_totals.sent == 200 && team.link_totals.lost == 200);
}

// Losses are independent in both directions between robots, and from and to the station.
void test_links_are_independent() {
  CentralizedTeam team(Channel::of(0.05, 0, 0.5, 0.01), 2, right);
  constexpr int n = 4000;
  std::array<std::vector<bool>, 4> lost;
  LinkTotals before;
  for (std::uint32_t tick = 0; tick < n; ++tick) {
    team.step(tick, {{{Sign::zero, true}, {Sign::zero, true}}}, ignore);
    for (std::size_t i = 0; i < 4; ++i) {
      lost[i].push_back(team.link_totals.links[i].lost != before.links[i].lost);
    }
    before = team.link_totals;
  }
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      int same = 0;
      for (std::size_t i = 100; i < n; ++i) same += lost[a][i] == lost[b][i] ? 1 : 0;
      CHECK(same > 1950 - 5 * 31 && same < 1950 + 5 * 31);
    }
  }
}

// A robot whose inbox is full loses further messages, over a plain radio too.
void test_full_inbox_loses_further_messages() {
  const Radio radio(Channel::of(0.03, 0, 0, 0.01), 0, right);
  Link<MessageKind> link;
  LinkTotals link_totals{};
  for (std::uint32_t tick = 0; tick < 300; ++tick) {
    const std::uint32_t received =
        radio.post(link, tick, MessageKind::ack, left, left, false, link_totals);
    CHECK(received == (tick < 256 ? tick + 3 : 0));
  }
  CHECK(link_totals.sent == 300 && link_totals.lost == 44 && link_totals.links[left].lost == 44);
  for (int i = 0; i < 256; ++i) {
    CHECK(link.oldest(1000) != nullptr);
    link.pop();
  }
  CHECK(link.oldest(1000) == nullptr);
}

// Resilient robots that are stepped only at their next decision tick, or when a reading changes,
// command and send in every tick the same as robots that are stepped in every tick. The latter have
// clocks of their own with an error near 0. Readings and faults are random.
void test_sleeping_resilient_team_equals_one_stepped_every_tick() {
  constexpr double restless = 1e-12;
  int slept = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Spec spec{};
    spec.period = 0.01;
    spec.watchdog = 0.3;
    for (std::uint32_t i = 0; i < 12; ++i) {
      const Words words = draw(seed, i, Stream::fault);
      spec.faults[spec.fault_count++] = {words[0] % 3 == 0 ? FaultKind::reboot : FaultKind::freeze,
                                         words[1] % 2,
                                         unit_uniform<double>(words[2]) * 20,
                                         unit_uniform<double>(words[3]) * 0.4,
                                         0,
                                         0};
    }
    const Faults faults = Faults::of(spec, seed);
    const Channel channel =
        Channel::of(0.05, seed % 3 == 1 ? 0.03 : 0, seed % 3 == 2 ? 0.1 : 0, 0.01);
    const auto team = [&](double drift) {
      return resilient_team({5, 52, {69, 6, 6}}, {drift, drift}, channel, seed, right, faults);
    };
    ResilientTeam sleeper = team(0);
    ResilientTeam watcher = team(restless);
    PerSide<RobotObservation> before{};
    PerSide<Command> said{};
    std::uint32_t wake = 0;
    for (std::uint32_t tick = 0; tick < 2000; ++tick) {
      // Contacts stay for a while where they are, mostly centred; palms settle now and then.
      PerSide<RobotObservation> sensed{};
      for (const std::size_t side : {left, right}) {
        const Words words =
            draw(seed, tick / 24, Stream::tactile, static_cast<std::uint32_t>(side));
        const Words turns =
            draw(seed, tick / 6, Stream::tactile, 2 + static_cast<std::uint32_t>(side));
        constexpr Sign signs[] = {Sign::zero, Sign::zero, Sign::zero, Sign::positive,
                                  Sign::negative};
        sensed[side] = {signs[words[0] % 5], turns[0] % 3 != 0};
      }
      const PerSide<Command> all = watcher.step(tick, sensed, ignore);
      const bool wakes = tick >= wake || !(sensed == before);
      before = sensed;
      if (wakes) {
        const PerSide<Command> earlier = std::exchange(said, sleeper.step(tick, sensed, ignore));
        wake = sleeper.next_decision_tick(tick);
        // A palm that has just been commanded to turn is expected not to be there in the next tick.
        for (const std::size_t side : {left, right}) {
          if (said[side].palm != earlier[side].palm) before[side].palm_at_target = false;
        }
      } else {
        ++slept;
      }
      for (const std::size_t side : {left, right}) {
        CHECK(said[side] == all[side]);
        CHECK(sleeper.name(side) == watcher.name(side) &&
              sleeper.waits(side) == watcher.waits(side));
      }
      CHECK(sleeper.link_totals.sent == watcher.link_totals.sent);
      CHECK(sleeper.link_totals.lost == watcher.link_totals.lost);
    }
  }
  CHECK(slept > 150 * 2000 / 4);
}

}  // namespace

int main() {
  test_teams_are_mirror_symmetric();
  test_messages_wait_until_read();
  test_answer_of_the_station_takes_two_latencies_and_loss_delays_it();
  test_robots_keep_palms_and_speed_without_reception();
  test_links_are_independent();
  test_full_inbox_loses_further_messages();
  test_sleeping_resilient_team_equals_one_stepped_every_tick();
}
