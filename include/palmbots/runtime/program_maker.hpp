// SPDX-License-Identifier: Apache-2.0
// Makes the program of a robot, by the kind of its controller. The times of the controller are a list
// of numbers, so that a board can have them in its settings.
//
// A maker has
//   Program           the program (runtime/robot_program.hpp)
//   times             how many times its controller has; with some, its robots measure time and start
//                     at rest, and without they act on messages and contacts alone
//   fresh(start)      the program that begins a carry
//   rebooted(start)   the program that goes on with a carry after a boot of its robot
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/control/table_robot.hpp"
#include "palmbots/runtime/robot_program.hpp"

namespace palmbots::runtime {

// What a program is made from, after a boot.
struct ProgramStart {
  std::span<const std::uint16_t> times;  // of the controller [ticks], in the order of its `Times`
  std::uint32_t epoch;                   // the number of this boot
  bool leads;                            // the robot is the front one in the direction of travel
  bool may_stop;                         // the scene lets robots stop as a correction
  bool by_touch;                         // the follower starts first
  bool assists;                          // stored: the palm was up for the partner
};

// A controller without a program on robots.
struct NoProgramMaker {
  static constexpr std::size_t times = 0;
};

// A controller that is a table (control/table.hpp).
template <class TheTable>
struct TableProgramMaker {
  using Table = TheTable;
  using Controller = TableRobot<Table>;
  using Program = PartnerProgram<Controller>;
  static constexpr std::size_t times = Controller::has_clock ? 2 + Table::limits : 0;

  constexpr Program fresh(const ProgramStart& start) const {
    return Program(robot(start), start.epoch);
  }
  constexpr Program rebooted(const ProgramStart& start) const {
    return Program(robot(start).booted(start.assists), start.epoch);
  }

 private:
  static constexpr Controller robot(const ProgramStart& start) {
    if constexpr (Controller::has_clock) {
      TableTimes<Table> own{start.times[0], start.times[1], {}};
      for (std::size_t i = 0; i < Table::limits; ++i) own.limits[i] = start.times[2 + i];
      return Controller(own, {start.leads, start.may_stop, start.by_touch});
    } else {
      return Controller();
    }
  }
};

// A controller whose decisions a station takes.
struct ReportProgramMaker {
  using Program = ReportProgram;
  static constexpr std::size_t times = 0;

  constexpr Program fresh(const ProgramStart&) const { return Program(); }
  constexpr Program rebooted(const ProgramStart& start) const { return Program(start.assists); }
};

}  // namespace palmbots::runtime
