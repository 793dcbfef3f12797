// SPDX-License-Identifier: Apache-2.0
// The controllers of both robots as tables that Python made (control/machine_table.hpp).
#pragma once

#include <array>

#include "bindings.hpp"
#include "palmbots/control/machine_table.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/distributed_team.hpp"

namespace palmbots::bindings {

// The tables of the left and the right robot.
struct Machines {
  std::array<MachineTable, 2> tables;
};

// The team of a carry. The machines must outlive it.
inline DistributedTeam<MachineRobot> machine_team(const Machines& machines, const Spec& spec,
                                                  std::uint64_t seed) {
  return {PerSide<MachineRobot>{MachineRobot(&machines.tables[left]),
                                MachineRobot(&machines.tables[right])},
          channel_of(spec), seed, leader_of(spec), Faults::of(spec, seed)};
}

}  // namespace palmbots::bindings
