// SPDX-License-Identifier: Apache-2.0
// Sixty-four teams at once do what each does alone, and robots never have more messages than there
// is room for.
//
// bitslice_test [TICKS]   TICKS: of sixty-four teams with each algorithm; 8000 if not given
#include "palmbots/batch/bitslice.hpp"

#include <array>
#include <cstdlib>
#include <deque>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "palmbots/batch/bitslice_centralized.hpp"
#include "palmbots/batch/bitslice_table_team.hpp"
#include "support/bitslice_alone.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"
#include "support/robot_teams.hpp"

using namespace palmbots;

namespace {

using Robot = TableRobot<Distributed>;

// All that two robots can come to, however long each message takes and whichever is lost, whatever
// they sense: of the messages for one of them, on their way or unread, there are never more than
// two; and where there are two the first is read as soon as it is there. So of messages that all
// take the same time never two are unread.
void test_there_is_never_more_than_one_unread_message() {
  struct Node {
    PerSide<Robot> robots;
    PerSide<std::vector<MessageKind>> messages;  // for each, oldest first

    auto key() const {
      return std::tuple(robots[left].state(), robots[right].state(), messages[left],
                        messages[right]);
    }
  };
  std::set<decltype(Node{}.key())> seen;
  std::deque<Node> queue{Node{}};
  seen.insert(queue.front().key());
  std::size_t most = 0;
  while (!queue.empty()) {
    const Node node = queue.front();
    queue.pop_front();
    for (const std::size_t side : {left, right}) {
      if (node.messages[side].size() < 2) continue;
      for (const Sign sign : {Sign::negative, Sign::zero, Sign::positive}) {
        Robot robot = node.robots[side];
        CHECK(robot.step({sign, true, 1, node.messages[side].front()}).read);
      }
    }
    // What they sense, whether the oldest message has come, and whether one that is sent now is
    // lost, in all combinations: 3 · 2 · 2 · 2 each.
    for (int choice = 0; choice < 576; ++choice) {
      Node next = node;
      PerSide<MessageKind> sent{};
      for (const std::size_t side : {left, right}) {
        const int own = side == left ? choice % 24 : choice / 24;
        const bool has_come = own / 6 % 2 != 0 && !node.messages[side].empty();
        const MessageKind got = has_come ? node.messages[side].front() : MessageKind::none;
        const auto out =
            next.robots[side].step({static_cast<Sign>(own % 3 - 1), own / 3 % 2 != 0, 1, got});
        if (out.read && has_come) next.messages[side].erase(next.messages[side].begin());
        sent[side] = own / 12 != 0 ? MessageKind::none : out.message;
      }
      for (const std::size_t side : {left, right}) {
        if (sent[side] != MessageKind::none) next.messages[other(side)].push_back(sent[side]);
        most = std::max(most, next.messages[other(side)].size());
      }
      CHECK(most <= 4);
      if (seen.insert(next.key()).second) queue.push_back(next);
    }
  }
  CHECK(most == 2);
  CHECK(seen.size() > 50);
}

// Teams of any kind, of which some take other times than others.
template <class Team>
Team team_over(const Channel& channel, const Faults& faults, std::uint32_t chance) {
  const std::size_t leader = chance % 2;
  if constexpr (std::is_same_v<Team, ResilientTeam>) {
    // Leases that beacons keep, and shorter ones.
    const auto of = [&](std::uint32_t bit, std::uint32_t most) {
      return static_cast<std::uint16_t>(1 + (chance >> bit & 0xFF) * most / 256);
    };
    const TableTimes<Resilient> times{of(1, 12), of(9, 254), {of(17, 255), of(24, 20), of(5, 70)}};
    return resilient_team(times, {}, channel, 0, leader, faults);
  } else if constexpr (std::is_same_v<Team, CentralizedTeam>) {
    return CentralizedTeam(channel, 0, leader, faults);
  } else {
    return distributed_team(channel, 0, leader, faults);
  }
}

// Teams cannot run bitsliced if messages may be lost or have varying delays, or if robots fail in
// other ways than these.
template <class Team>
void test_supported_teams(bool with_reboots) {
  const auto goes = [](const Channel& channel, const Faults& faults = {}) {
    return BitslicedTeam<Team>::supports(team_over<Team>(channel, faults, 0));
  };
  const auto delayed = [](double ticks) { return Channel::of(0.01 * ticks, 0, 0, 0.01); };
  CHECK(team_over<Team>(delayed(5), {}, 0).radio().steady_delay() == 5);
  CHECK(goes(delayed(0)) && goes(delayed(5)) && goes(delayed(63)) && !goes(delayed(64)));
  CHECK(goes(Channel::of(0.05, 0, 0.1, 0.01)) && !goes(Channel::of(0.05, 0.01, 0, 0.01)));
  const auto goes_with = [&](auto change) {
    Channel channel = delayed(5);
    change(channel);
    return goes(channel);
  };
  CHECK(!goes_with([](Channel& c) { c.airtime_ticks = 0.1; }));
  CHECK(!goes_with([](Channel& c) { c.burst_share = 0.1; }));
  CHECK(!goes_with([](Channel& c) { c.duplicate_words = 1; }));
  CHECK(!goes_with([](Channel& c) { c.corrupt_words = 1; }));
  CHECK(!goes_with([](Channel& c) { c.outage_count = 1; }));
  CHECK(!goes_with([](Channel& c) { c.message_fault_count = 1; }));
  for (const FaultKind kind : {FaultKind::reboot, FaultKind::freeze, FaultKind::stuck,
                               FaultKind::flicker, FaultKind::station}) {
    Spec failing = paper_spec();
    failing.faults[0] = {kind, 0, 1.0, 0.5};
    failing.fault_count = 1;
    const bool is_reboot = kind == FaultKind::reboot;
    CHECK(goes(delayed(5), Faults::of(failing, 0)) == (is_reboot && with_reboots));
  }
}

// Leases and clocks with which the resilient algorithm can run bitsliced.
void test_supported_times_and_clocks_of_the_resilient_algorithm() {
  const auto goes = [](const TableTimes<Resilient>& times, const PerSide<double>& drift) {
    const Channel channel = Channel::of(0.05, 0, 0, 0.01);
    return BitslicedTeam<ResilientTeam>::supports(resilient_team(times, drift, channel, 0, left));
  };
  CHECK(goes({4095, 254, {4095, 255, 254}}, {0, 0}));
  CHECK(!goes({4096, 254, {255, 255, 254}}, {0, 0}) && !goes({255, 255, {255, 255, 254}}, {0, 0}));
  CHECK(!goes({255, 254, {4096, 255, 254}}, {0, 0}));
  CHECK(!goes({255, 254, {255, 256, 254}}, {0, 0}) && !goes({255, 254, {255, 255, 255}}, {0, 0}));
  CHECK(!goes({5, 50, {70, 5, 6}}, {1e-6, 0}) && !goes({5, 50, {70, 5, 6}}, {0, -1e-6}));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t ticks = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 8000;
  test_there_is_never_more_than_one_unread_message();
  constexpr auto ignore = [](const auto&, const PerSide<Command>&) {};
  const Seen pairs = test_every_team_goes_as_it_does_alone<DistributedTeam>(
      false, ticks, team_over<DistributedTeam>, ignore);
  CHECK(pairs.longest_wait > 300 && pairs.ended_waiting > 50 && pairs.ended_not_waiting > 50);
  const Seen stations = test_every_team_goes_as_it_does_alone<CentralizedTeam>(
      true, ticks, team_over<CentralizedTeam>, ignore);
  CHECK(pairs.boots == 0 && stations.boots > 500);
  CHECK(pairs.most_lost > 1 && stations.most_lost > 500);
  std::array<std::uint32_t, Resilient::states> states{};
  std::uint32_t travelled = 0;
  const Seen peers = test_every_team_goes_as_it_does_alone<ResilientTeam>(
      true, ticks, team_over<ResilientTeam>,
      [&](const ResilientTeam& team, const PerSide<Command>& commands) {
        ++states[static_cast<std::size_t>(team.robot(left).state())];
        travelled += commands[left].stop ? 0 : 1;
      });
  CHECK(peers.ended_waiting > 30 && peers.ended_not_waiting > 50 && peers.most_late > 100);
  for (const std::uint32_t count : states) CHECK(count > 500);
  CHECK(travelled > 5000 && peers.boots > 500 && peers.most_lost > 500);
  CHECK(pairs.most_corrections > 256);
  for (const Seen* seen : {&stations, &peers}) CHECK(seen->most_corrections > 128);
  test_supported_teams<DistributedTeam>(false);
  test_supported_teams<CentralizedTeam>(true);
  test_supported_teams<ResilientTeam>(true);
  test_supported_times_and_clocks_of_the_resilient_algorithm();
}
