// SPDX-License-Identifier: Apache-2.0
// Teams of two robots for the tests: of tables with given times, and of controllers that a test makes.
#pragma once

#include "palmbots/control/distributed.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

using DistributedTeam = TableTeam<Distributed>;
using ResilientTeam = TableTeam<Resilient>;

// Two robots of a table with these times.
template <class Table>
PerSide<TableRobot<Table>> table_robots(const TableTimes<Table>& times, std::size_t leader,
                                        bool may_stop = false, bool by_touch = false) {
  return {TableRobot<Table>(times, {leader == left, may_stop, by_touch}),
          TableRobot<Table>(times, {leader == right, may_stop, by_touch})};
}

inline DistributedTeam distributed_team(const Channel& channel, std::uint64_t seed,
                                        std::size_t leader, const Faults& faults = {}) {
  return {{}, {}, channel, seed, leader, faults};
}
inline ResilientTeam resilient_team(const TableTimes<Resilient>& times, PerSide<double> drift,
                                    const Channel& channel, std::uint64_t seed, std::size_t leader,
                                    const Faults& faults = {}) {
  return {table_robots<Resilient>(times, leader), drift, channel, seed, leader, faults};
}

// What a controller with a queue of messages has besides step() and booted().
struct QueueController {
  static constexpr Mail mail = Mail::queue;
  static constexpr bool has_clock = false;
  static constexpr char name() { return ' '; }
  static constexpr bool waits() { return false; }
  static constexpr MessageKind awaits() { return MessageKind::none; }
  static constexpr bool stopped() { return false; }
};

// The output of such a controller.
constexpr RobotOutput said(const Command& command, MessageKind message, bool read) {
  return {command, message, message != MessageKind::none, read};
}

}  // namespace palmbots
