// SPDX-License-Identifier: Apache-2.0
// Compares 64 bit-sliced teams with the same teams on their own, tick by tick, over random
// observations, losses and reboots.
#pragma once

#include <algorithm>
#include <array>
#include <memory>

#include "palmbots/batch/bitslice_io.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/metrics.hpp"
#include "palmbots/sim/radio.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

namespace palmbots {

// Reboots at any time, some that follow each other at once.
inline Faults some_reboots(std::uint32_t chance, std::uint32_t tick) {
  if (chance % 2 == 0) return {};
  Spec spec = paper_spec();
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Words words = draw(chance, tick, Stream::fault, i);
    spec.faults[i] = {FaultKind::reboot, words[0] % 2, (words[1] % 2000) * 0.01,
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

// Teams of one kind: make(channel, faults, chance) gives one, `watch(team)` sees each of them after
// each tick.
template <class Team, class Make, class Watch>
Seen test_every_team_goes_as_it_does_alone(bool with_reboots, std::uint64_t ticks, Make&& make,
                                           Watch&& watch) {
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
        Channel channel = Channel::of(delay * 0.01, 0, alone.loss, 0.01);
        channel.has_sessions = (chance[2] >> 16) % 4 != 0;
        if (with_reboots) alone.faults = some_reboots(chance[3], static_cast<std::uint32_t>(tick));
        alone.team = std::make_unique<Team>(make(channel, alone.faults, chance[0]));
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
          return alone.loss > 0 &&
                 draw(0, alone.tick, Stream::radio, lane)[0] < Channel::words_of(alone.loss);
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
      const PerSide<Command> commands = alone.team->step(
          alone.tick, senses[static_cast<std::size_t>(i)], [](const SentMessage&) {});
      alone.metrics->note(alone.tick++, *alone.team);
      CHECK(((are_new >> i & 1) != 0) == (commands != alone.before));
      alone.before = commands;
      watch(*alone.team, commands);
      for (const std::size_t side : {left, right}) {
        CHECK(bit(bitsliced.shallow, side) == (commands[side].palm == Palm::shallow));
        CHECK(bit(bitsliced.away, side) == (commands[side].move == Move::away));
        CHECK(bit(bitsliced.closer, side) == (commands[side].move == Move::closer));
        CHECK(bit(bitsliced.stop, side) == commands[side].stop);
      }
    }
  }
  CHECK(seen.began > ticks / 100);
  return seen;
}

}  // namespace palmbots
