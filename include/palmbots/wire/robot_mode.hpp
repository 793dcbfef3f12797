// SPDX-License-Identifier: Apache-2.0
// What robots and station say about operation: the mode of a robot, why it does not
// carry, and what the operator wants.
#pragma once

#include <cstdint>

namespace palmbots::wire {

// The mode of a robot.
enum class RobotMode : std::uint8_t {
  off,       // its program has just started, and nothing has been checked
  disarmed,  // nothing moves
  armed,     // the preflight has passed; the palm is at its angle
  ready,     // carries as soon as its partner is ready, too
  carrying,  // the controller decides about palm and wheels
  holding,   // as carrying, while the controller does not travel
  done,      // this robot or its partner has covered the distance; has to be armed again
  stopped,   // a stop is in force; has to be released and armed again
  fault,     // the carry cannot go on (FaultCode); has to be armed again
};
inline constexpr unsigned robot_modes = 9;

constexpr const char* name_of(RobotMode mode) {
  constexpr const char* names[] = {"off",     "disarmed", "armed",   "ready", "carrying",
                                   "holding", "done",     "stopped", "fault"};
  return names[static_cast<int>(mode)];
}

// Why a robot is in mode fault, or why it could not be armed; in a carry a warning.
enum class FaultCode : std::uint8_t {
  none,
  driver,        // the motor board does not answer
  contact,       // no contact is sensed on the palm
  palm,          // the palm does not answer, or is not at its angle
  battery,       // the voltage is too low
  partner_lost,  // the partner has not been heard within the lease
  station_lost,  // the station has not been heard within the limit
  time_limit,    // the carry takes too long
  overrun,       // the control loop is late too often
  storage,       // the boot counter or the mode cannot be stored
  settings,      // the partner runs with other settings
  stopping,      // braking takes longer than the watchdog allows
  partner,       // the partner has been heard, but it does not carry
  stop,          // a stop is in force at the partner
  arm,           // the arm is not where a job on the floor begins
  job,           // a job on the floor has been tried as often as it may
};
inline constexpr unsigned fault_codes = 16;

constexpr const char* name_of(FaultCode code) {
  constexpr const char* names[] = {"none",    "driver",       "contact",      "palm",
                                   "battery", "partner_lost", "station_lost", "time_limit",
                                   "overrun", "storage",      "settings",     "stopping",
                                   "partner", "stop",         "arm",          "job"};
  return names[static_cast<int>(code)];
}

// What the operator wants.
enum class Operation : std::uint8_t { arm, disarm, start, stop, e_stop, release };
inline constexpr unsigned operations = 6;

constexpr const char* name_of(Operation operation) {
  constexpr const char* names[] = {"arm", "disarm", "start", "stop", "e_stop", "release"};
  return names[static_cast<int>(operation)];
}

// True if the wish can only stop a robot, now or later: it counts at any age.
constexpr bool only_stops(Operation operation) {
  return operation == Operation::stop || operation == Operation::e_stop ||
         operation == Operation::disarm;
}

}  // namespace palmbots::wire
