// SPDX-License-Identifier: Apache-2.0
// The controllers of both robots as tables that Python made (control/machine_table.hpp).
#pragma once

#include <array>

#include "bindings.hpp"
#include "palmbots/control/machine_table.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots::bindings {

// The tables of the left and the right robot.
struct Machines {
  std::array<MachineTable, 2> tables;
};

// The team of a carry. The machines must outlive it.
inline RobotTeam<MachineRobot> machine_team(const Machines& machines, const Spec& spec,
                                            std::uint64_t seed) {
  return robot_team_of<MachineRobot>(
      {MachineRobot(&machines.tables[left]), MachineRobot(&machines.tables[right])}, spec, seed);
}

}  // namespace palmbots::bindings
