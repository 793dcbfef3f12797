// SPDX-License-Identifier: Apache-2.0
// The sections `faults` and `bumps` of a scene: what fails, and what disturbs the pair. Lengths in
// m, times in s.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/sim/scene_key.hpp"

namespace palmbots {

inline constexpr std::size_t max_faults = 32;
inline constexpr std::size_t max_bumps = 64;
inline constexpr std::size_t max_pushes = 16;

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
inline constexpr Choices fault_choices(0, "reboot", "freeze", "stuck", "intermittent",
                                       "station-down", "clock-rate", "clock-jump");

// What a reboot does besides: bits of FaultSpec::marks.
inline constexpr std::uint64_t loses_boot_counter = 1;  // the program does not start again
inline constexpr std::uint64_t palm_goes_limp = 2;      // the servo does not hold the palm

// A scheduled fault: its kind, side, start and duration.
struct FaultSpec {
  FaultKind kind = FaultKind::reboot;
  std::uint32_t side = 0;
  double at = 0;
  double lasts = 0.0001;
  std::int64_t reads = 0;  // stuck: the sign that the sensor reads
  // flicker: the probability that a reading is random. clock_rate: the share by which the clock
  // gains. clock_jump: by how much it jumps ahead [s]. A limp palm: the angle to which it falls
  // [rad].
  double rate = 0;
  std::uint64_t marks = 0;  // reboot: see above
};
inline constexpr Key fault_keys[] = {
    choice<&FaultSpec::kind>("kind", fault_choices),
    source_choice("robot", side_choices),
    derived<&FaultSpec::side>(),
    number<&FaultSpec::at>("at_s", Unit::s, 0, 1e6),
    number<&FaultSpec::lasts>("duration_s", Unit::s, 0.0001, 1e6),
    source_choice("stuck_at", sign_choices),
    derived<&FaultSpec::reads>(),
    source_number("probability", Unit::none, 0, 1),
    source_number("ppm", Unit::parts_per_million, -100000, 100000),
    source_choice("loses_boot_counter", flag_choices, unset, KeyKind::flag),
    between(source_number("limp_deg", Unit::degrees, -80, 80)),
    derived<&FaultSpec::rate>(),
    derived<&FaultSpec::marks>(),
};

struct FaultsSpec {
  std::array<FaultSpec, max_faults> faults{};
  std::size_t fault_count = 0;
  std::uint32_t random_reboots = 0;  // number per carry
  double reboot = 0.5;               // duration of each
};
inline constexpr Key faults_keys[] = {
    whole<&FaultsSpec::random_reboots>("random_reboots", 0, 8),
    number<&FaultsSpec::reboot>("reboot_s", Unit::s, 0.0001, 1e6),
};
inline constexpr RecordList faults_lists[] = {
    records<&FaultsSpec::faults, &FaultsSpec::fault_count>("script", fault_keys),
};

// A sudden shift of one contact, when the pair has travelled the distance `at`, or at the time
// `at`.
struct BumpSpec {
  std::uint32_t side = 0;
  bool by_time = false;
  double at = 0;     // [m] or [s]
  double shift = 0;  // outward
};
inline constexpr Key bump_keys[] = {
    choice<&BumpSpec::side>("robot", side_choices),
    derived<&BumpSpec::by_time>(),
    derived<&BumpSpec::at>(),
    number<&BumpSpec::shift>("shift_m", Unit::m, -1, 1),
    source_number("at_m", Unit::m, 0, 10000),
    source_number("at_s", Unit::s, 0, 1e6),
};

// A time during which something pushes one robot: its speed changes by `speed` outward. Brakes
// hold against a push.
struct PushSpec {
  std::uint64_t side = 0;
  double at = 0;
  double lasts = 0.0001;
  double speed = 0;  // [m/s]
};
inline constexpr Key push_keys[] = {
    choice<&PushSpec::side>("robot", side_choices),
    number<&PushSpec::at>("at_s", Unit::s, 0, 1e6),
    number<&PushSpec::lasts>("duration_s", Unit::s, 0.0001, 1e6),
    number<&PushSpec::speed>("speed_m_s", Unit::m_s, -1, 1),
};

struct BumpsSpec {
  std::array<BumpSpec, max_bumps> bumps{};
  std::size_t bump_count = 0;
  std::array<PushSpec, max_pushes> pushes{};
  std::size_t push_count = 0;
  double bump_rate = 0;     // random bumps per metre and robot
  double bump_max = 0.004;  // largest random shift
};
inline constexpr Key bumps_keys[] = {
    number<&BumpsSpec::bump_rate>("rate_per_m", Unit::bumps_per_metre, 0, 100),
    number<&BumpsSpec::bump_max>("max_shift_m", Unit::m, 0, 1),
};
inline constexpr RecordList bumps_lists[] = {
    records<&BumpsSpec::bumps, &BumpsSpec::bump_count>("script", bump_keys),
    records<&BumpsSpec::pushes, &BumpsSpec::push_count>("pushes", push_keys),
};

}  // namespace palmbots
