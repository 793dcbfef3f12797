// SPDX-License-Identifier: Apache-2.0
// The sections `palm`, `robot`, `arm`, `tactile` and `control` of a scene. Lengths in m, angles in rad,
// speeds in m/s, times in s.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "palmbots/robot/tactile_sensor.hpp"
#include "palmbots/sim/scene_key.hpp"

namespace palmbots {

inline constexpr double least_usable = 0.001;  // least length of the usable part of a palm [m]

struct PalmSpec {
  double length = 0.15;
  double usable = unset;  // of the length; unset: all of it
  double offset = 0;      // of the surface from the pivot
  double thickness = 0;   // of the plate
  double nose = unset;    // thickness at its inner end; unset: that of the plate
  double bevel = 0;       // length over which the plate narrows to the nose, on its lower side
  double heel = 0;        // height of the stop at the outer end, above the surface; 0: none
  bool stops = false;     // whether a carry uses all of the palm up to the heel, not only `usable`
  double friction = 0.3;
  double shallow = 5 * radians_per_degree<double>;
  double steep = 15 * radians_per_degree<double>;
  double rate = 50 * radians_per_degree<double>;  // [rad/s]

  // How far from the foot of the pivot a contact may be [m].
  constexpr double reach() const { return 0.5 * (usable < length ? usable : length); }

  constexpr double tip_thickness() const { return nose < thickness ? nose : thickness; }

  // Height of the pivot over a level floor that the plate touches: with its inner end, or with the
  // outer edge of the bevel if that is lower [m].
  constexpr double lowest_pivot(SinCos<double> angle) const {
    const double below =
        larger(tip_thickness() * angle.cos, thickness * angle.cos - bevel * angle.sin);
    return 0.5 * length * angle.sin - offset * angle.cos + below;
  }
};
inline constexpr Key palm_keys[] = {
    number<&PalmSpec::length>("length_m", Unit::m, 0.001, 10),
    number<&PalmSpec::usable>("usable_m", Unit::m, least_usable, 10),
    number<&PalmSpec::offset>("pivot_offset_m", Unit::m, -1, 1),
    number<&PalmSpec::thickness>("thickness_m", Unit::m, 0, 0.1),
    number<&PalmSpec::nose>("nose_m", Unit::m, 0, 0.1),
    number<&PalmSpec::bevel>("bevel_m", Unit::m, 0, 10),
    number<&PalmSpec::heel>("heel_m", Unit::m, 0, 1),
    derived<&PalmSpec::stops>(),
    number<&PalmSpec::friction>("friction", Unit::none, 0.001, 100),
    source_number("friction_angle_deg", Unit::degrees, 0.1, 89),
    between(number<&PalmSpec::shallow>("shallow_deg", Unit::degrees, -80, 80)),
    between(number<&PalmSpec::steep>("steep_deg", Unit::degrees, -80, 80)),
    number<&PalmSpec::rate>("rate_deg_s", Unit::degrees_s, 0.1, 100000),
};

struct ErrorTrace;  // sim/recorded_traces.hpp

inline constexpr Choices trace_gain_choices(0, "carry", "segment");

struct RobotSpec {
  double speed = 0.06;
  double correction = 0.03;
  double acceleration = 0.5;  // [m/s²]
  double max_speed = 0.2;
  double gain = 1;            // actual speed per commanded speed, on average over carries
  double gain_sd = 0;         // standard deviation of the gain between carries
  double noise = 0.01;        // stationary standard deviation
  double noise_tau = 0.5;     // correlation time of the noise
  double standing_noise = 0;  // the part of the noise that a robot at rest keeps, as `noise`
  double white_noise = 0;     // standard deviation of the displacement after 1 s [m/√s]
  double bias = 0;
  double clock_drift = 0;    // share by which its clock runs too fast
  std::uint64_t stride = 1;  // ticks of the carry between two steps of its program
  // The largest forces of its motors and of its wheels on the floor [weights of the object].
  double motor_limit = std::numeric_limits<double>::infinity();
  double traction_limit = std::numeric_limits<double>::infinity();
  bool gain_by_segment = false;  // of the recording; otherwise it keeps the gain of the first one
  // A recording that takes the place of gain, noise, white noise and bias, or null.
  const ErrorTrace* recorded = nullptr;

  constexpr double force_limit() const { return smaller(motor_limit, traction_limit); }
  // Whether the wheels of a robot that stalls go on turning.
  constexpr bool spins() const { return traction_limit < motor_limit; }
};
inline constexpr Key robot_keys[] = {
    number<&RobotSpec::speed>("speed_m_s", Unit::m_s, 0, 10),
    number<&RobotSpec::correction>("correction_m_s", Unit::m_s, 0, 10),
    number<&RobotSpec::acceleration>("acceleration_m_s2", Unit::m_s2, 0.001, 1000),
    number<&RobotSpec::max_speed>("max_speed_m_s", Unit::m_s, 0, 10),
    number<&RobotSpec::gain>("gain", Unit::none, 0.5, 2),
    number<&RobotSpec::gain_sd>("gain_sd", Unit::none, 0, 0.1),
    number<&RobotSpec::noise>("noise_m_s", Unit::m_s, 0, 1),
    number<&RobotSpec::noise_tau>("noise_tau_s", Unit::s, 0.001, 1000),
    number<&RobotSpec::standing_noise>("standing_noise_m_s", Unit::m_s, 0, 1),
    number<&RobotSpec::white_noise>("white_noise_m_per_sqrt_s", Unit::m_per_sqrt_s, 0, 1),
    choice<&RobotSpec::gain_by_segment>("trace_gain", trace_gain_choices),
    number<&RobotSpec::bias>("bias_m_s", Unit::m_s, -1, 1),
    number<&RobotSpec::clock_drift>("clock_ppm", Unit::parts_per_million, -100000, 100000),
    source_number("motor_force_n", Unit::newton, 0.01, 10000),
    source_number("traction_n", Unit::newton, 0.01, 10000),
    source_number("period_s", Unit::s, 0.0001, 1),
    derived<&RobotSpec::stride>(),
    derived<&RobotSpec::motor_limit>(),
    derived<&RobotSpec::traction_limit>(),
};

// What raises and lowers the pivot of a palm, in jobs that begin or end on the floor.
struct ArmSpec {
  double rate = 0.05;           // of the pivot's height, at most [m/s]
  double carry_height = 0.15;   // of the pivot over the floor while the pair carries [m]
  double lowest_pivot = 0;      // the least height that the wrist permits [m]
  double height_error = 0.002;  // the largest error of its height [m]
};
inline constexpr Key arm_keys[] = {
    number<&ArmSpec::rate>("rate_m_per_s", Unit::m_s, 0.001, 10),
    number<&ArmSpec::carry_height>("carry_height_m", Unit::m, 0.001, 10),
    number<&ArmSpec::lowest_pivot>("lowest_pivot_m", Unit::m, 0, 1),
    number<&ArmSpec::height_error>("height_error_m", Unit::m, 0, 0.1),
};

// A stretch of the palm in which the sensor reads one sign (`Sign`), as in Zone.
struct ZoneSpec {
  std::int64_t sign = 0;
  double from = 0;  // closed
  double to = 0;    // closed
};
inline constexpr Key zone_keys[] = {
    choice<&ZoneSpec::sign>("sign", sign_choices),
    number<&ZoneSpec::from>("from_m", Unit::m, -10, 10),
    number<&ZoneSpec::to>("to_m", Unit::m, -10, 10),
};

struct TactileSpec {
  std::array<ZoneSpec, max_zones> zones{};
  std::size_t zone_count = 0;
  double false_rate = 0;
};
inline constexpr Key tactile_keys[] = {
    source_number("zero_half_width_m", Unit::m, 0, 10, 0.005),
    number<&TactileSpec::false_rate>("false_rate", Unit::none, 0, 1),
};
inline constexpr RecordList tactile_lists[] = {
    records<&TactileSpec::zones, &TactileSpec::zone_count>("zones", zone_keys),
};

struct ControlSpec {
  double period = 0.01;
  double watchdog = 0.1;        // time without a step after which a robot is stopped and reboots
  bool brake = true;            // a robot may stop as a correction
  bool start_by_touch = false;  // the follower starts first
};
inline constexpr Choices start_choices(0, "together", "touch");
inline constexpr Key control_keys[] = {
    number<&ControlSpec::period>("period_s", Unit::s, 0.0001, 1),
    number<&ControlSpec::watchdog>("watchdog_s", Unit::s, 0.001, 1e6),
    flag<&ControlSpec::brake>("brake"),
    choice<&ControlSpec::start_by_touch>("start", start_choices),
};

}  // namespace palmbots
