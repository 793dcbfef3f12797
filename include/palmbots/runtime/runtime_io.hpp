// SPDX-License-Identifier: Apache-2.0
// What a robot's runtime (runtime/robot_runtime.hpp) is given, and what it returns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/control/lift_rules.hpp"
#include "palmbots/runtime/mode_machine.hpp"
#include "palmbots/runtime/robot_program.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots::runtime {

struct RuntimeSettings {
  ModeSettings mode;
  std::uint16_t state_period = 0;   // longest silence to the partner [ticks]; 0: no limit
  std::uint16_t status_period = 0;  // of the status [ticks]; 0: none is sent
  std::uint32_t number = 0;         // equal on both robots if their settings are; 0: not compared
  std::uint32_t order_age = never;  // greatest age of an order to arm, start or release [ticks]
  bool ends_jobs =
      true;  // a job on the floor that is over ends the carry; in lockstep the world does
};

// What a robot reads in a tick.
struct Reading {
  Observation seen;
  bool contact = true;                // the object is on the palm: a switch is closed
  bool battery_ok = true;             // the voltage suffices
  bool driver_ok = true;              // the motor board answers
  bool storage_ok = true;             // what has to survive a boot can be stored
  bool covered = false;               // the distance, by odometry
  bool stop = false;                  // a stop is given by hand
  std::uint16_t overruns = 0;         // late ticks within the time that the node counts
  std::uint16_t battery_mv = 0xFFFF;  // 0xFFFF: not measured
  std::uint16_t progress = 0;         // covered part of the distance, times 65535, by odometry
  std::uint32_t stopping = 0;         // measured time in which the wheels stop [ticks]
  bool arm_there = false;             // the arm has reached the height last commanded
  std::uint8_t arm_steps = 0;         // its height, as in LiftSenses
  bool beneath = false;               // the same
};

// A packet to send.
struct Outgoing {
  wire::Role receiver;
  wire::Bytes bytes;
  MessageKind message = MessageKind::none;  // what it says to the partner, for logs
};

// The outputs of one tick.
struct Outputs {
  Decision decision;  // of the controller, or rest
  ModeOutputs mode;
  Decision phase;               // of the table that lifts, in a job on the floor
  ArmMove arm = ArmMove::hold;  // what the arm does
  bool arm_ends = false;        // its lowest height is that at the end of the job
  bool holds = false;           // to be stored: the arms may be up (runtime/phase_program.hpp)
  std::array<Outgoing, wire::role_count + 1> packets{};
  std::size_t packet_count = 0;
};

// Counts of packets from the partner, for the report of a run.
struct ReceivedCounts {
  std::uint32_t rejected = 0;  // copies, overtaken packets, packets without a session
  std::uint32_t late = 0;      // older than the lease

  constexpr void count(Taken taken) {
    rejected += taken == Taken::rejected ? 1U : 0U;
    late += taken == Taken::late ? 1U : 0U;
  }
};

}  // namespace palmbots::runtime
