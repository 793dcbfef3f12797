// SPDX-License-Identifier: Apache-2.0
// What the mode machine of a robot (runtime/mode_machine.hpp) has to know: settings that are fixed
// before the robot is armed, what is stored over a boot, and the inputs of one step.
//
// All times are control ticks of the robot's own clock.
#pragma once

#include <cstdint>

#include "palmbots/wire/robot_mode.hpp"

namespace palmbots::runtime {

// The age of news that has never arrived, and a stopping time that has not been measured.
inline constexpr std::uint32_t never = 0xFFFF'FFFF;

// What a robot does after a reboot in a carry.
enum class AfterReboot : std::uint8_t {
  disarm,  // nothing: it has to be armed and started again
  rejoin,  // the controller goes on by its own rules for a boot, unless a stop is in force
};

// What ends a carry when another end of the wire falls silent.
enum class StationLost : std::uint8_t { stop, carry_on };
enum class PartnerLost : std::uint8_t {
  stop,        // silence for longer than the lease ends the carry
  controller,  // the controller decides, by its rules for silence
};

struct ModeSettings {
  AfterReboot after_reboot = AfterReboot::disarm;
  StationLost station_lost = StationLost::stop;
  PartnerLost partner_lost = PartnerLost::stop;
  bool has_radio = true;        // the partner can be heard; false: each robot starts by itself
  std::uint32_t lease;          // greatest age at which the partner's news counts
  std::uint32_t station_limit;  // greatest age of the station's newest packet
  std::uint32_t time_limit;     // of a carry
  std::uint32_t travel = 0;     // time in mode carrying that covers the distance; 0: use odometry
  // Greatest measured stopping time at which a robot is armed: the one that the scene assumes.
  std::uint32_t stopping_limit;
  std::uint16_t most_overruns;  // greatest number of late ticks
};

// What permanent memory holds over a boot.
struct StoredMode {
  bool carries = false;  // a carry was under way
  bool stop = false;     // a stop was in force

  constexpr bool operator==(const StoredMode&) const = default;
};

// What has to be in order before a robot is armed.
struct Preflight {
  bool contact = false;            // a contact is sensed on the palm
  bool palm = false;               // the palm answers, and is at its angle
  bool battery = false;            // the voltage suffices
  bool settings = false;           // the partner runs with the same settings
  std::uint32_t stopping = never;  // measured time in which the wheels stop [ticks]
  bool arm = true;                 // the arm is where a job on the floor begins

  constexpr bool operator==(const Preflight&) const = default;
};

// The newest mode that the partner has stated in an accepted packet.
struct PartnerNews {
  wire::RobotMode mode = wire::RobotMode::off;
  std::uint32_t age = never;  // a bound of its age
};

// The inputs of one step. Whatever arrived since the last step is part of them.
struct ModeInputs {
  std::uint32_t elapsed = 1;  // ticks since the last step
  // The newest wish of the operator. A stop is not kept here, but in `stop`.
  bool operates = false;
  wire::Operation operation = wire::Operation::disarm;
  bool stop = false;          // by the operator, in any packet of the station, or by hand
  bool partner_stop = false;  // in any packet of the partner
  PartnerNews partner;
  std::uint32_t station_age = never;  // of the station's newest accepted packet
  Preflight preflight;
  bool driver_ok = true;       // the motor board answers
  bool storage_ok = true;      // the boot counter and the mode can be stored
  std::uint16_t overruns = 0;  // late ticks within the time that the node counts
  bool covered = false;        // the distance, by this robot's odometry since the carry began
  bool failed = false;         // a job on the floor has been tried as often as it may
  bool ends_alone = false;     // a partner that is done does not end this robot's carry
  bool travels = true;         // the controller travelled in the last step

  // The operator's wish has arrived in an authentic and new packet. Without a session only an
  // emergency stop counts: a station that has just started has heard nobody yet, and a replayed
  // stop can only stop. Any stop outlasts other wishes of the same step.
  constexpr void order(wire::Operation wish, bool in_session) {
    if (wish == wire::Operation::e_stop || (wish == wire::Operation::stop && in_session)) {
      stop = true;
    } else if (in_session) {
      operates = true;
      operation = wish;
    }
  }
};

}  // namespace palmbots::runtime
