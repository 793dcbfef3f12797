// SPDX-License-Identifier: Apache-2.0
// Teams of two robots whose program is a table (control/table.hpp), and their times in a scene.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "palmbots/control/table_robot.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/robot_team.hpp"
#include "palmbots/sim/table_lease.hpp"

namespace palmbots {

template <class Table>
using TableTeam = RobotTeam<TableRobot<Table>>;

// So many ticks take at least this time; at least one.
inline std::uint16_t ticks_in(double seconds, double period) {
  const double whole = std::ceil(seconds / period - 1e-9);
  return static_cast<std::uint16_t>(std::clamp(whole, 1.0, 60000.0));
}

// What the time limits of tables depend on in a scene [s].
inline TableTiming table_timing_of(const Spec& spec) {
  TableTiming timing{0, spec.longest_delay() + spec.longest_period(), 0, 0};
  const auto zone = tactile_of<double>(spec).stretch(0.0);
  for (const std::size_t side : {left, right}) {
    const PalmSpec& palm = spec.palms[side];
    timing.turn = larger(timing.turn, std::abs(palm.steep - palm.shallow) / palm.rate);
    const RobotSpec& robot = spec.robots[side];
    if (robot.correction > 0) {
      timing.reach = larger(timing.reach, palm.reach() / robot.correction);
    }
    // At constant acceleration, a robot is late by half the time that it needs to reach its speed.
    if (robot.speed > 0) {
      timing.crossing = larger(timing.crossing, (zone.until - zone.from) / robot.speed +
                                                    0.5 * robot.speed / robot.acceleration);
    }
  }
  return timing;
}

// The time limits of a table [ticks of this many seconds].
template <class Table>
std::array<std::uint16_t, Table::limits> table_limits(const TableTiming& timing, double period) {
  std::array<std::uint16_t, Table::limits> limits{};
  for (std::size_t i = 0; i < Table::limits; ++i) {
    limits[i] = ticks_in(Table::seconds(static_cast<typename Table::Limit>(i), timing), period);
  }
  return limits;
}

// The times of a table in a scene [ticks].
template <class Table>
TableTimes<Table> table_times_of(const Spec& spec) {
  return {ticks_in(spec.beacon, spec.period), ticks_in(table_lease(spec), spec.period),
          table_limits<Table>(table_timing_of(spec), spec.period)};
}
template <>
inline TableTimes<Resilient> table_times_of<Resilient>(const Spec& spec) {
  return resilient_timing_of(spec).times;
}

// The robot of a carry on this side.
template <class Table>
TableRobot<Table> table_robot_of(const Spec& spec, std::size_t side) {
  if constexpr (TableRobot<Table>::has_clock) {
    return {table_times_of<Table>(spec),
            {leader_of(spec) == side, spec.brake != 0, spec.start_by_touch != 0}};
  } else {
    return {};
  }
}

// A team of robots that decide by themselves, with the radio of a scene.
template <class Controller>
RobotTeam<Controller> robot_team_of(PerSide<Controller> controllers, const Spec& spec,
                                    std::uint64_t seed) {
  return {std::move(controllers), {spec.robots[left].clock_drift, spec.robots[right].clock_drift},
          channel_of(spec),       seed,
          leader_of(spec),        Faults::of(spec, seed)};
}

// Makes the team of a carry.
template <class TheTable>
struct TableTeamMaker {
  using Table = TheTable;

  TableTeam<Table> operator()(const Spec& spec, std::uint64_t seed) const {
    return robot_team_of<TableRobot<Table>>(
        {table_robot_of<Table>(spec, left), table_robot_of<Table>(spec, right)}, spec, seed);
  }
};

static_assert(Team<TableTeam<Resilient>>);

}  // namespace palmbots
