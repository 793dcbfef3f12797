// SPDX-License-Identifier: Apache-2.0
// Sixty-four teams at once do what each does alone, and robots never have more messages than there
// is room for.
//
// bitslice_test [TICKS]   TICKS: of sixty-four teams with each algorithm; 16000 if not given
#include "palmbots/batch/bitslice.hpp"

#include <array>
#include <cstdlib>
#include <deque>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "palmbots/batch/bitslice_centralized.hpp"
#include "palmbots/batch/bitslice_distributed.hpp"
#include "palmbots/batch/bitslice_resilient.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

using Robot = Distributed;
constexpr auto ignore = [](const SentMessage&) {};

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
        CHECK(Robot::reads(node.robots[side].state(), palmbots::observation_of(sign, true)));
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
            next.robots[side].step({static_cast<Sign>(own % 3 - 1), got, own / 3 % 2 != 0});
        if (out.read && has_come) next.messages[side].erase(next.messages[side].begin());
        sent[side] = own / 12 != 0 ? MessageKind::none : out.send;
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
    const Resilient::Times times{of(1, 12), of(9, 254), of(17, 255), of(24, 20), of(5, 70)};
    return ResilientTeam(times, {}, channel, 0, leader, faults);
  } else if constexpr (std::is_same_v<Team, CentralizedTeam>) {
    return CentralizedTeam(channel, 0, leader, faults);
  } else {
    return Team({}, channel, 0, leader, faults);
  }
}

// Reboots at any time, some that follow each other at once; for teams that can have them in bits.
template <class Team>
Faults some_faults(std::uint32_t chance, std::uint32_t tick) {
  if (std::is_same_v<Team, DistributedTeam<Robot>> || chance % 2 == 0) return {};
  Spec spec = paper_spec();
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Words words = draw(chance, tick, Stream::fault, i);
    spec.faults[i] = {FaultKind::reboot, words[0] % 2, (words[1] % 6000) * 0.01,
                      (1 + words[2] % (words[3] % 8 == 0 ? 400 : 40)) * 0.01};
  }
  spec.faults[0].at = chance % 3 == 0 ? 0 : spec.faults[0].at;
  spec.fault_count = 12;
  return Faults::of(spec, chance);
}

// One team, as it goes alone, and what it senses: signs that last a while, palms that take theirs.
template <class Team>
struct Alone {
  std::unique_ptr<Team> team;
  std::unique_ptr<Metrics> metrics;
  Faults faults;
  ProgramMonitor monitor;
  double loss = 0;
  std::uint32_t tick = 0;
  std::uint32_t hold = 1;  // ticks that a sign lasts
  PerSide<Command> before{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
};

struct Seen {
  std::uint32_t began = 0;
  std::uint32_t longest_wait = 0;
  std::uint32_t most_corrections = 0;
  std::uint32_t most_late = 0;
  std::uint32_t most_lost = 0;
  std::array<std::uint32_t, Resilient::states> states{};  // of resilient robots
  std::uint32_t travelled = 0;                            // ticks of theirs
  std::uint32_t boots = 0;
  std::uint32_t ended_waiting = 0;
  std::uint32_t ended_not_waiting = 0;
};

template <class Team>
void compare(const BitslicedTeam<Team>& bits, int i, Alone<Team>& alone, Seen& seen) {
  alone.team->close(alone.tick);
  alone.metrics->close(alone.tick);
  Metrics found;
  LinkTotals link_totals;
  bits.write_results(i, alone.tick, found, link_totals);
  const Metrics& truth = *alone.metrics;
  CHECK(found.corrections == truth.corrections);
  CHECK(found.waiting_ticks == truth.waiting_ticks && found.waits_since == truth.waits_since);
  CHECK(link_totals.sent == alone.team->link_totals.sent &&
        link_totals.lost == alone.team->link_totals.lost);
  for (const std::size_t side : {left, right}) {
    const std::uint32_t waits = alone.tick - truth.waits_since[side];
    seen.longest_wait = std::max(seen.longest_wait, waits);
    (waits > 0 ? seen.ended_waiting : seen.ended_not_waiting) += 1;
  }
  for (std::size_t link = 0; link < link_totals.links.size(); ++link) {
    CHECK(link_totals.links[link].sent == alone.team->link_totals.links[link].sent);
    CHECK(link_totals.links[link].lost == alone.team->link_totals.links[link].lost);
    seen.most_lost = std::max(seen.most_lost, link_totals.links[link].lost);
    CHECK(link_totals.links[link].late == alone.team->link_totals.links[link].late);
    seen.most_late = std::max(seen.most_late, link_totals.links[link].late);
  }
  seen.most_corrections = std::max(seen.most_corrections, truth.corrections);
}

template <class Team>
Seen test_every_team_goes_as_it_does_alone(std::uint64_t ticks) {
  auto bits = std::make_unique<BitslicedTeam<Team>>();
  std::array<Alone<Team>, 64> all;
  Seen seen;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    BitslicedObservation sensed;
    BitslicedProgramState programs;
    BitslicedLoss lost;
    std::array<PerSide<RobotObservation>, 64> senses{};
    for (int i = 0; i < 64; ++i) {
      Alone<Team>& alone = all[static_cast<std::size_t>(i)];
      const Words chance =
          draw(7, static_cast<std::uint32_t>(tick), Stream::radio, static_cast<std::uint32_t>(i));
      if (alone.team && chance[0] % 4096 == 0) {
        compare(*bits, i, alone, seen);
        bits->erase(i);
        alone = {};
      }
      if (!alone.team && chance[1] % 4 == 0) {
        // Of every delay some, and some that hang for a long time.
        const std::uint32_t delay = 1 + chance[2] % BitslicedDelay::longest;
        alone.loss = chance[3] % 3 == 0 ? 0.2 : 0;
        const Channel channel = Channel::of(delay * 0.01, 0, alone.loss, 0.01);
        alone.faults = some_faults<Team>(chance[3], static_cast<std::uint32_t>(tick));
        alone.team = std::make_unique<Team>(team_over<Team>(channel, alone.faults, chance[0]));
        alone.metrics = std::make_unique<Metrics>();
        alone.hold = 1U << chance[3] % 10;
        CHECK(alone.team->radio().steady_delay() == delay);
        CHECK(bits->supports(*alone.team));
        bits->insert(i, *alone.team);
        // As if it ended before its first tick: nothing is left of who was there before.
        Metrics none;
        LinkTotals silence;
        bits->write_results(i, 0, none, silence);
        CHECK(none.corrections == 0 && none.waiting_ticks == PerSide<std::uint32_t>{});
        CHECK(none.waits_since == PerSide<std::uint32_t>{} && silence.sent == 0);
        ++seen.began;
      }
      // Who is not there senses something, too.
      const Words felt = draw(8, static_cast<std::uint32_t>(tick / alone.hold), Stream::tactile,
                              static_cast<std::uint32_t>(i));
      for (const std::size_t side : {left, right}) {
        const RobotObservation one{static_cast<Sign>(static_cast<int>(felt[side] % 3) - 1),
                                   (chance[2 + side] & 7 << 16) == 0};
        senses[static_cast<std::size_t>(i)][side] = one;
        sensed.positive[side] |= CarryMask{one.sign == Sign::positive} << i;
        sensed.negative[side] |= CarryMask{one.sign == Sign::negative} << i;
        sensed.palm_at_target[side] |= CarryMask{one.palm_at_target} << i;
        if (!alone.team) continue;
        const ProgramState state = alone.monitor.program_state(alone.faults, alone.tick, side);
        programs.off[side] |= CarryMask{state == ProgramState::off} << i;
        programs.booting[side] |= CarryMask{state == ProgramState::booting} << i;
        seen.boots += state == ProgramState::booting ? 1 : 0;
        // The draws of the radio, the leading robot's first.
        const auto is_lost = [&](std::uint32_t lane) {
          return draw(0, alone.tick, Stream::radio, lane)[0] < Channel::words_of(alone.loss);
        };
        const std::uint32_t rank = side == alone.team->radio().leader() ? 0 : 1;
        lost.from_robot[side] |= CarryMask{is_lost(rank)} << i;
        lost.from_station[side] |= CarryMask{is_lost(2 + rank)} << i;
      }
    }
    const CarryMask are_new = bits->step(tick, sensed, programs, lost);
    const BitslicedCommand& bitsliced = bits->commands();
    for (int i = 0; i < 64; ++i) {
      Alone<Team>& alone = all[static_cast<std::size_t>(i)];
      const auto bit = [&](RobotMask both, std::size_t side) { return (both[side] >> i & 1) != 0; };
      if (!alone.team) {
        CHECK((are_new >> i & 1) == 0);
        continue;
      }
      const PerSide<Command> commands =
          alone.team->step(alone.tick, senses[static_cast<std::size_t>(i)], ignore);
      alone.metrics->note(alone.tick++, *alone.team);
      CHECK(((are_new >> i & 1) != 0) == (commands != alone.before));
      alone.before = commands;
      if constexpr (std::is_same_v<Team, ResilientTeam>) {
        ++seen.states[static_cast<std::size_t>(alone.team->robot(left).state())];
        seen.travelled += commands[left].stop ? 0 : 1;
      }
      for (const std::size_t side : {left, right}) {
        CHECK(bit(bitsliced.shallow, side) == (commands[side].palm == Palm::shallow));
        CHECK(bit(bitsliced.away, side) == (commands[side].move == Move::away));
        CHECK(bit(bitsliced.closer, side) == (commands[side].move == Move::closer));
        CHECK(bit(bitsliced.stop, side) == commands[side].stop);
      }
    }
  }
  CHECK(seen.began > 150 && seen.most_corrections > 256);
  return seen;
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
  const auto goes = [](const Resilient::Times& times, const PerSide<double>& drift) {
    const Channel channel = Channel::of(0.05, 0, 0, 0.01);
    return BitslicedTeam<ResilientTeam>::supports(ResilientTeam(times, drift, channel, 0, left));
  };
  CHECK(goes({255, 254, 255, 255, 254}, {0, 0}));
  CHECK(!goes({256, 254, 255, 255, 254}, {0, 0}) && !goes({255, 255, 255, 255, 254}, {0, 0}));
  CHECK(!goes({255, 254, 256, 255, 254}, {0, 0}) && !goes({255, 254, 255, 256, 254}, {0, 0}));
  CHECK(!goes({255, 254, 255, 255, 255}, {0, 0}));
  CHECK(!goes({5, 50, 70, 5, 6}, {1e-6, 0}) && !goes({5, 50, 70, 5, 6}, {0, -1e-6}));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t ticks = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 16000;
  test_there_is_never_more_than_one_unread_message();
  const Seen pairs = test_every_team_goes_as_it_does_alone<DistributedTeam<Robot>>(ticks);
  CHECK(pairs.longest_wait > 300 && pairs.ended_waiting > 50 && pairs.ended_not_waiting > 50);
  const Seen stations = test_every_team_goes_as_it_does_alone<CentralizedTeam>(ticks);
  CHECK(pairs.boots == 0 && stations.boots > 500);
  CHECK(pairs.most_lost > 1 && stations.most_lost > 500);
  const Seen peers = test_every_team_goes_as_it_does_alone<ResilientTeam>(ticks);
  CHECK(peers.ended_waiting > 50 && peers.ended_not_waiting > 50 && peers.most_late > 100);
  for (const std::uint32_t each : peers.states) CHECK(each > 500);
  CHECK(peers.travelled > 5000 && peers.boots > 500 && peers.most_lost > 500);
  test_supported_teams<DistributedTeam<Robot>>(false);
  test_supported_teams<CentralizedTeam>(true);
  test_supported_teams<ResilientTeam>(true);
  test_supported_times_and_clocks_of_the_resilient_algorithm();
}
