// SPDX-License-Identifier: Apache-2.0
// The distributed algorithm for 64 pairs of robots at once, with one bit for each robot.
//
// DistributedTeam<Distributed> (sim/distributed_team.hpp) handles single messages; this header does
// the same with operations on words. The table is the one in control/distributed.hpp. It requires
// that robots never fail and that all messages of a carry have the same delay or are lost.
#pragma once

#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/sim/distributed_team.hpp"

namespace palmbots {

// 64 pairs with their radio, and their counts.
class BitslicedDistributed {
  using Robot = Distributed;
  using Messages = BitslicedMessage<2>;

 public:
  static constexpr bool can_stop = false;
  static constexpr bool station = false;

  static bool supports(const DistributedTeam<Robot>& team) {
    return BitslicedDelay::supports(team.radio().steady_delay()) && !team.faults().any();
  }

  void insert(int i, const DistributedTeam<Robot>& team) {
    robots_.insert(both_at(i), Robot::State::idle);
    delays_.insert(i, team.radio().steady_delay());
    for (BitslicedCounts* counts : {&sent_, &lost_}) counts->clear(both_at(i));
    cases_.insert(i);
  }

  void erase(int i) {
    robots_.erase(both_at(i));
    for (Messages& messages : line_) messages.erase(both_at(i));
    inbox_.erase(both_at(i));
    delays_.erase(i);
    commands_.erase(both_at(i));
    cases_.erase(i);
  }

  CarryMask step(std::uint64_t tick, const BitslicedObservation& sensed,
                 const BitslicedProgramState&, const BitslicedLoss& lost) {
    Messages& arrived = line_[tick % line_.size()];
    inbox_.insert(~RobotMask{}, arrived);
    arrived = {};
    const RobotMask read = inbox_.any() & who_read(sensed);
    Messages send;
    robots_.step(
        ~RobotMask{},
        [&](const Robot::Row& row) { return Robot::fits<RobotMask>(row, sensed, inbox_); },
        [&](const Robot::Row& row, RobotMask whose) { send.insert(whose, row.send); });
    inbox_.erase(read);
    const Messages messages = send.swapped();
    const RobotMask come = ~swapped(lost.from_robot);
    delays_.each(
        tick, [&](std::size_t row, RobotMask whose) { line_[row].insert(whose & come, messages); });
    sent_.add(send.any());
    lost_.add(send.any() & lost.from_robot);
    cases_.note(robots_);
    const BitslicedCommand before = std::exchange(commands_, robots_.commands());
    return commands_.differ(before);
  }

  const BitslicedCommand& commands() const { return commands_; }

  void write_results(int i, std::uint32_t ticks, Metrics& metrics, LinkTotals& link_totals) const {
    cases_.write_results(i, ticks, metrics);
    write_link_totals(i, sent_, lost_, link_totals);
  }

 private:
  // The robots that read their messages.
  [[gnu::always_inline]] RobotMask who_read(const Observation<RobotMask>& seen) const {
    return robots_.where_each([&](Robot::State state) { return Robot::reads(state, seen); });
  }

  BitslicedTable<Robot> robots_;
  // Messages under way to a robot, by tick of arrival, and the one that it has not read. There is
  // never more than one unread message: if another is under way, the robot reads the first as soon
  // as it arrives (bitslice_test).
  std::array<Messages, BitslicedDelay::longest + 1> line_;
  Messages inbox_;
  BitslicedDelay delays_;
  BitslicedCommand commands_;
  BitslicedCounts sent_;
  BitslicedCounts lost_;
  BitslicedCaseMetrics cases_;
};

template <>
struct BitslicedTeam<DistributedTeam<Distributed>> : BitslicedDistributed {
  static constexpr bool exist = true;
};
static_assert(
    DecidesInBits<BitslicedTeam<DistributedTeam<Distributed>>, DistributedTeam<Distributed>>);

}  // namespace palmbots
