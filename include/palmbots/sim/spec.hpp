// SPDX-License-Identifier: Apache-2.0
// The specification of a carry: everything that defines it, as plain numbers in SI units and
// radians.
//
// Trivially copyable, so that a spec can be passed on as bytes, and without padding, so that equal
// specs have equal bytes: some small numbers have 64 bits for that. Numbers are double here whatever
// the precision of the carry. The code that fills in a spec must validate it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/robot/tactile_sensor.hpp"
#include "palmbots/sim/radio_channel.hpp"

namespace palmbots {

// A palm: lengths in m, angles in rad, `friction` is μ.
struct PalmSpec {
  double length = 0.15;
  double offset = 0;  // of the surface from the pivot [m]
  double friction = 0.3;
  double shallow = 0;
  double steep = 0;
  double rate = 0;  // [rad/s]
};

// A robot: speeds in m/s, acceleration in m/s², noise_tau (correlation time of the noise) in s.
struct RobotSpec {
  double speed = 0.06;
  double correction = 0.03;
  double acceleration = 0.5;
  double max_speed = 0.2;
  double noise = 0.01;  // stationary standard deviation [m/s]
  double noise_tau = 0.5;
  double bias = 0;
  double clock_drift = 0;    // share by which its clock runs too fast
  std::uint64_t stride = 1;  // ticks of the carry between two steps of its program
};

// A stretch of the palm in which the sensor reads one sign (`Sign`), as in Zone.
struct ZoneSpec {
  std::int64_t sign = 0;
  double from = 0;  // [m], closed
  double to = 0;    // [m], closed
};

// A sudden shift of one contact, when the pair has travelled the distance `at`, or at the time
// `at`.
struct BumpSpec {
  std::uint32_t side = 0;
  std::uint32_t by_time = 0;
  double at = 0;     // [m] or [s]
  double shift = 0;  // [m], outward
};

// A time during which something pushes one robot: its speed changes by `speed` outward. Brakes
// hold against a push.
struct PushSpec {
  std::uint64_t side = 0;
  double at = 0;     // [s]
  double lasts = 0;  // [s]
  double speed = 0;  // [m/s]
};

// How a robot, a sensor or the station fails. The number is part of the spec: append, never
// renumber.
enum class FaultKind : std::uint32_t {
  reboot = 0,
  freeze = 1,
  stuck = 2,
  flicker = 3,
  station = 4,
  clock_rate = 5,
  clock_jump = 6
};

// What a reboot does besides: bits of FaultSpec::marks.
inline constexpr std::uint64_t loses_boot_counter = 1;  // the program does not start again
inline constexpr std::uint64_t palm_goes_limp = 2;      // the servo does not hold the palm

// A scheduled fault: its kind, side, start and duration.
struct FaultSpec {
  FaultKind kind = FaultKind::reboot;
  std::uint32_t side = 0;
  double at = 0;           // [s]
  double lasts = 0;        // [s]
  std::int64_t reads = 0;  // stuck: the sign that the sensor reads
  // flicker: the probability that a reading is random. clock_rate: the share by which the clock
  // gains. clock_jump: by how much it jumps ahead [s]. A limp palm: the angle to which it falls
  // [rad].
  double rate = 0;
  std::uint64_t marks = 0;  // reboot: see above
};

// A period in which no message of this sender arrives.
struct OutageSpec {
  std::uint64_t sender = 0;  // 0: left, 1: right, 2: the station
  double from = 0;           // [s]
  double to = 0;             // [s]
};

// A scheduled fault of one message (kinds as in MessageEffect).
struct MessageFaultSpec {
  std::uint32_t link = 0;     // as in MessageFault
  std::uint32_t message = 0;  // from 1
  std::uint64_t effect = 0;
  double late = 0;  // [s]
};

// The link from one sender; a negative value is that of all links.
struct DirectionSpec {
  double latency = -1;  // [s]
  double jitter = -1;   // [s]
  double loss = -1;
};

inline constexpr std::size_t max_faults = 32;
inline constexpr std::size_t max_bumps = 64;
inline constexpr std::size_t max_pushes = 16;
inline constexpr double standard_gravity = 9.80665;  // [m/s²]

// The complete specification of one carry: lengths in m, times in s, angles in rad.
struct Spec {
  double width = 0;
  double com_left = 0;
  double com_right = 0;
  double com_height = 0;
  Outline<double> outline{};
  PalmSpec palms[2]{};
  RobotSpec robots[2]{};
  std::array<ZoneSpec, max_zones> zones{};
  std::size_t zone_count = 0;
  double false_rate = 0;
  double period = 0.01;
  double latency = 0.05;
  double jitter = 0;
  double loss = 0;
  double duplicate = 0;
  double corruption = 0;
  std::uint16_t reorders = 0;
  std::uint16_t sessions = 1;  // packets are judged as on the wire
  std::uint32_t brake = 1;     // a robot may stop as a correction (beside the two: no padding)
  double burst_share = 0;      // share of the time in which a link is dead
  double burst_mean = 0.1;
  double airtime = 0;  // 0: no collisions
  double beacon = 0.05;
  double lease = 0;  // 0: the value computed by ResilientTiming
  std::array<OutageSpec, max_outages> outages{};
  std::size_t outage_count = 0;
  std::array<MessageFaultSpec, max_message_faults> message_faults{};
  std::size_t message_fault_count = 0;
  double watchdog = 0.1;  // time without a step after which a robot is stopped and reboots [s]
  std::array<FaultSpec, max_faults> faults{};
  std::size_t fault_count = 0;
  std::uint32_t random_reboots = 0;  // number per carry
  std::uint32_t start_by_touch =
      0;                // the follower starts first (beside random_reboots: no padding)
  double reboot = 0.5;  // duration of each [s]
  double distance = 1.5;
  double slope = 0;           // specific force towards −x
  double inertia = 1;         // 0: accelerations have no effect, as the paper assumes
  double inertia_lag = 0.05;  // time constant of their average [s]
  double direction = 1;       // +1: the right robot leads, −1: the left one
  std::uint64_t timeout_ticks = 5000;
  double start[2]{};
  std::array<BumpSpec, max_bumps> bumps{};
  std::size_t bump_count = 0;
  double bump_rate = 0;  // random bumps per metre and robot
  double bump_max = 0;   // largest random shift [m]
  std::array<PushSpec, max_pushes> pushes{};
  std::size_t push_count = 0;
  double safe_reach = -1;         // see ModelParams; optional
  DirectionSpec directions[3]{};  // from the left robot, the right one, the station
  double replay = 0;              // probability that an attacker sends a packet again
  double replay_delay = 1;        // after this time at most [s]

  // The longest delay of any link [s].
  constexpr double longest_delay() const {
    double longest = 0;
    for (const DirectionSpec& d : directions) {
      const double delay =
          (d.latency < 0 ? latency : d.latency) + (d.jitter < 0 ? jitter : d.jitter);
      longest = delay > longest ? delay : longest;
    }
    return longest;
  }

  // The control period of the robot with the longer one [s].
  constexpr double longest_period() const {
    const std::uint64_t one = robots[0].stride;
    const std::uint64_t two = robots[1].stride;
    return period * static_cast<double>(one < two ? two : one);
  }
};

// True if a palm may go limp. Carries side by side (batch/lockstep.hpp) do not provide for that.
inline bool may_go_limp(const Spec& spec) {
  for (std::size_t i = 0; i < spec.fault_count; ++i) {
    if ((spec.faults[i].marks & palm_goes_limp) != 0) return true;
  }
  return false;
}

}  // namespace palmbots
