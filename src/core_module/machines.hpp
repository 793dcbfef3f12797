// SPDX-License-Identifier: Apache-2.0
// The controllers of both robots as tables that Python made (control/machine_table.hpp).
#pragma once

#include <array>
#include <stdexcept>
#include <tuple>

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

// One tick of a robot that reads one message at most, checked; (palm, move, message sent, message
// read).
template <class Robot>
auto checked_step(Robot& robot, int sign, int message, bool palm_at_target) {
  if (sign < -1 || sign > 1 || message < 0 || message > 3) {
    throw std::out_of_range("sign is -1, 0 or 1; message is 0 to 3");
  }
  const auto out =
      robot.step({static_cast<Sign>(sign), palm_at_target, 1, static_cast<MessageKind>(message)});
  return std::tuple(static_cast<int>(out.command.palm), static_cast<int>(out.command.move),
                    static_cast<int>(out.message), out.read);
}

}  // namespace palmbots::bindings
