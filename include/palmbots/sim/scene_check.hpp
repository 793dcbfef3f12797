// SPDX-License-Identifier: Apache-2.0
// Which relations between the keys of a scene do not hold. Each value alone is within the limits of
// its key already.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/object_check.hpp"
#include "palmbots/sim/scene_problem.hpp"
#include "palmbots/sim/scene_values.hpp"
#include "palmbots/sim/spec_of_scene.hpp"
#include "palmbots/sim/surroundings_check.hpp"

namespace palmbots {

inline constexpr double most_carry_ticks = 1e7;  // a carry counts its ticks in 32 bits
inline constexpr double most_delay_ticks = 200;  // a link buffers so many
// Most of the distance between its contacts by which an object may rise from one to the other.
inline constexpr double most_lean = 0.99;
inline constexpr double most_unlevel = 1e-6;  // the contacts of a pipe at the start [m]

// Upper limit of the friction coefficient on a palm at this angle [degrees]; infinite if it is level.
// There the friction angle and the palm angle add up to 90°: an edge of the friction cone is level,
// and the contact holds against any horizontal force.
inline double friction_limit(double steepest) {
  return 1 / tangent(steepest * radians_per_degree<double>);
}

namespace detail {

// Where the value that counts for a holder stands: in its own table or in that of all.
template <Name path>
std::size_t place_of(const SceneValues& scene, std::size_t holder) {
  return scene.has<path>(own(holder)) ? own(holder) : common;
}

inline void check_palms(const SceneValues& scene, Problems& problems) {
  for (const std::size_t place : {common, own(left), own(right)}) {
    if (!scene.has<"palm.friction">(place) || !scene.has<"palm.friction_angle_deg">(place))
      continue;
    report(problems, "palm.friction_angle_deg", place, "is given beside friction, which is {0}",
           "one of the two", {scene.of<"palm.friction">(place)});
  }
  for (const std::size_t side : {left, right}) {
    const double steep = scene.of<"palm.steep_deg">(own(side));
    const double shallow = scene.of<"palm.shallow_deg">(own(side));
    if (steep <= shallow) {
      report(problems, "palm.steep_deg", place_of<"palm.steep_deg">(scene, side),
             "is not more than shallow_deg, which is {0}",
             "a number in degrees, more than {0} and less than {1}",
             {shallow, SceneValues::row<"palm.steep_deg">.most});
    }
    const double steepest = larger(std::abs(steep), std::abs(shallow));
    const double length = scene.of<"palm.length_m">(own(side));
    if (scene.of<"palm.usable_m">(own(side)) > length) {
      report(problems, "palm.usable_m", place_of<"palm.usable_m">(scene, side),
             "is more than length_m, which is {0}", "a number in m, from {1} to {0}",
             {length, SceneValues::row<"palm.usable_m">.least});
    }
    const double thick = scene.of<"palm.thickness_m">(own(side));
    if (scene.of<"palm.nose_m">(own(side)) > thick) {
      report(problems, "palm.nose_m", place_of<"palm.nose_m">(scene, side),
             "is more than thickness_m, which is {0}", "a number in m, from {1} to {0}",
             {thick, SceneValues::row<"palm.nose_m">.least});
    }
    const double bevel = scene.of<"palm.bevel_m">(own(side));
    if (bevel > length) {
      report(problems, "palm.bevel_m", place_of<"palm.bevel_m">(scene, side),
             "is more than length_m, which is {0}", "a number in m, from {1} to {0}",
             {length, SceneValues::row<"palm.bevel_m">.least});
    }
    if (scene.of<"palm.nose_m">(own(side)) < thick && bevel == 0) {
      report(problems, "palm.nose_m", place_of<"palm.nose_m">(scene, side),
             "is less than thickness_m, which is {0}, but bevel_m is 0",
             "{0}, or a bevel_m above 0", {thick});
    }
    const double friction = friction_of(scene, side);
    const double most = friction_limit(steepest);
    if (friction >= most) {
      report(problems, "palm.friction", place_of<"palm.friction">(scene, side),
             "is too large for a palm at {0} degrees",
             "less than {1} (friction angle + palm angle below 90 degrees)", {steepest, most},
             {friction});
    }
  }
}

inline void check_robots(const SceneValues& scene, Problems& problems) {
  for (const std::size_t side : {left, right}) {
    const double most = scene.of<"robot.max_speed_m_s">(own(side));
    if (scene.of<"robot.speed_m_s">(own(side)) > most) {
      report(problems, "robot.speed_m_s", place_of<"robot.speed_m_s">(scene, side),
             "is more than max_speed_m_s", "a number in m/s, from {1} to {0}",
             {most, SceneValues::row<"robot.speed_m_s">.least});
    }
  }
}

// A robot's period is no time between two ticks, and no longer than its motors wait. Without one it
// is the tick.
inline void check_periods(const SceneValues& scene, Problems& problems) {
  const double tick = scene.of<"control.period_s">();
  const double watchdog = scene.of<"control.watchdog_s">();
  if (tick > watchdog * (1 + 1e-9)) {
    report(problems, "control.watchdog_s", common, "is shorter than period_s, which is {0}",
           "a number in s, at least {0}", {tick});
    return;
  }
  for (const std::size_t side : {left, right}) {
    const double period = scene.of<"robot.period_s">(own(side));
    if (!(period == period)) continue;
    const double ratio = period / tick;
    const bool is_whole = ratio > 0.5 && std::abs(ratio - std::nearbyint(ratio)) < 1e-6;
    if (is_whole && period <= watchdog * (1 + 1e-9)) continue;
    report(problems, "robot.period_s", place_of<"robot.period_s">(scene, side),
           is_whole ? "is longer than control.watchdog_s, which is {1}"
                    : "is not a whole multiple of control.period_s, which is {0}",
           "whole multiples of {0} s up to {1} s", {tick, watchdog});
  }
}

inline void check_zones(const SceneValues& scene, Problems& problems) {
  const auto& zones = scene.list<"tactile.zones">();
  constexpr std::size_t sign = SceneValues::place_in_record<"tactile.zones", "sign">;
  constexpr std::size_t from = SceneValues::place_in_record<"tactile.zones", "from_m">;
  constexpr std::size_t to = SceneValues::place_in_record<"tactile.zones", "to_m">;
  for (std::size_t k = 0; k < zones.size(); ++k) {
    if (zones[k][to] > zones[k][from]) continue;
    report(problems, "tactile.zones[].to_m", k, "is not more than from_m, which is {0}",
           "a number in m, more than {0} and at most {1}",
           {zones[k][from], SceneValues::row_in_record<"tactile.zones", "to_m">.most});
  }
  for (const auto& minus : zones) {
    for (std::size_t k = 0; k < zones.size(); ++k) {
      const auto& plus = zones[k];
      if (minus[sign] != -1 || plus[sign] != 1) continue;
      if (minus[to] <= plus[from] || plus[to] <= minus[from]) continue;
      report(problems, "tactile.zones[]", k, "overlaps the zone - from {0} to {1}",
             "zones + and - that do not overlap each other", {minus[from], minus[to]});
    }
  }
}

inline void check_radio(const SceneValues& scene, Problems& problems) {
  const auto& outages = scene.list<"radio.outages">();
  for (std::size_t k = 0; k < outages.size(); ++k) {
    const double from = outages[k][SceneValues::place_in_record<"radio.outages", "start_s">];
    if (outages[k][SceneValues::place_in_record<"radio.outages", "end_s">] > from) continue;
    report(problems, "radio.outages[].end_s", k, "is not more than start_s, which is {0}",
           "a number in s, more than {0}", {from});
  }
  const auto& script = scene.list<"radio.script">();
  for (std::size_t k = 0; k < script.size(); ++k) {
    const double receiver = script[k][SceneValues::place_in_record<"radio.script", "receiver">];
    const double delay = script[k][SceneValues::place_in_record<"radio.script", "delay_s">];
    const bool is_station = script[k][SceneValues::place_in_record<"radio.script", "sender">] == 2;
    const bool is_lost = script[k][SceneValues::place_in_record<"radio.script", "effect">] == 0;
    if ((receiver == receiver) != is_station) {
      report(problems, "radio.script[]", k, is_station ? "has no receiver" : "has a receiver",
             "receiver = \"left\" or \"right\" with the sender station, not with a robot");
    }
    if ((delay == delay) == is_lost) {
      report(problems, "radio.script[]", k, is_lost ? "has a delay" : "has no delay",
             "delay_s with the effect delayed or duplicated, not with lost");
    }
  }
}

inline void check_delays(const SceneValues& scene, Problems& problems) {
  const double tick = scene.of<"control.period_s">();
  for (std::size_t sender = 0; sender < sender_choices.count; ++sender) {
    const double latency = scene.of<"radio.latency_s">(own(sender));
    const double jitter = scene.of<"radio.jitter_s">(own(sender));
    if ((latency + jitter) / tick <= most_delay_ticks) continue;
    report(problems, "radio.latency_s", place_of<"radio.latency_s">(scene, sender),
           "and a jitter_s of {0} are too long for control periods of {1} s",
           "latency_s + jitter_s at most {2} ({3} periods)",
           {jitter, tick, most_delay_ticks * tick, most_delay_ticks});
    return;
  }
}

// The keys of a fault that depend on its kind: those that it needs, and those that it may have.
struct KeysOfKind {
  std::string_view needs;
  std::string_view may_have;
  const char* allowed;
};
inline constexpr std::array<KeysOfKind, fault_choices.count> keys_of_kind = {{
    {"robot", "loses_boot_counter limp_deg",
     "with kind reboot, besides at_s and duration_s: robot"},
    {"robot", "", "with kind freeze, besides at_s and duration_s: robot"},
    {"robot stuck_at", "", "with kind stuck, besides at_s and duration_s: robot, stuck_at"},
    {"robot probability", "",
     "with kind intermittent, besides at_s and duration_s: robot, probability"},
    {"", "",
     "with kind station-down, besides at_s and duration_s: none of robot, stuck_at and "
     "probability"},
    {"robot ppm", "", "with kind clock-rate, besides at_s and duration_s: robot, ppm"},
    {"robot", "", "with kind clock-jump, besides at_s and duration_s: robot"},
}};

inline void refuse_bumps(const SceneValues& scene, Problems& problems, const char* why) {
  if (scene.of<"bumps.rate_per_m">() > 0) report(problems, "bumps.rate_per_m", common, why, "0");
  if (!scene.list<"bumps.script">().empty()) report(problems, "bumps.script[]", 0, why, "none");
}

inline void check_disturbances(const SceneValues& scene, Problems& problems) {
  const auto& faults = scene.list<"faults.script">();
  for (std::size_t k = 0; k < faults.size(); ++k) {
    const auto kind =
        static_cast<std::size_t>(faults[k][SceneValues::place_in_record<"faults.script", "kind">]);
    const auto& [needs, may_have, allowed] = keys_of_kind[kind];
    bool is_right = true;
    for (std::size_t i = 0; i < std::size(fault_keys); ++i) {
      const Key& key = fault_keys[i];
      if (key.name.empty() || key.initial == key.initial) continue;  // every fault has it
      const bool is_given = faults[k][i] == faults[k][i];
      const bool is_needed = needs.find(key.name) != needs.npos;
      const bool is_allowed = is_needed || may_have.find(key.name) != may_have.npos;
      is_right = is_right && (is_given ? is_allowed : !is_needed);
    }
    if (is_right) continue;
    report(problems, "faults.script[]", k, "has the wrong keys", allowed);
  }
  const auto& bumps = scene.list<"bumps.script">();
  for (std::size_t k = 0; k < bumps.size(); ++k) {
    const double place = bumps[k][SceneValues::place_in_record<"bumps.script", "at_m">];
    const double time = bumps[k][SceneValues::place_in_record<"bumps.script", "at_s">];
    if ((place == place) != (time == time)) continue;
    report(problems, "bumps.script[]", k,
           place == place ? "has a place and a time" : "has no place and no time",
           "exactly one of at_m and at_s");
  }
  if (scene.of<"task.from">() == 0 && scene.of<"task.to">() == 0) return;
  refuse_bumps(
      scene, problems,
      "shifts contacts, but in a job from or onto the floor or a stand (task.from, task.to) "
      "palms do not hold the object all the time");
}

// The cross-section of a ridge is a circular arc, at most half a circle.
inline void check_ridges(const SceneValues& scene, Problems& problems) {
  const auto& ridges = scene.list<"mujoco.ridges">();
  constexpr std::size_t of_length = SceneValues::place_in_record<"mujoco.ridges", "length_m">;
  for (std::size_t k = 0; k < ridges.size(); ++k) {
    const double height = ridges[k][SceneValues::place_in_record<"mujoco.ridges", "height_m">];
    const double given = ridges[k][of_length];
    const Key& row = SceneValues::row_in_record<"mujoco.ridges", "length_m">;
    const double length = given == given ? given : row.initial;
    if (length >= 2 * height) continue;
    report(problems, "mujoco.ridges[].length_m", k, "is less than twice height_m, which is {0}",
           "a number in m, from {1} to {2} (a flat arc)", {height, 2 * height, row.most}, {length});
  }
}

// Blames a time limit that is infinite or too long on one key: the first one whose default would
// make it short enough.
inline void check_time(const SceneValues& scene, Problems& problems) {
  const double period = scene.of<"control.period_s">();
  const double limit = time_limit_of(scene);
  const auto speed_of = [&](std::size_t side) {
    return scene.of<"robot.gain">(own(side)) * scene.of<"robot.speed_m_s">(own(side));
  };
  const std::size_t slower = speed_of(right) < speed_of(left) ? right : left;
  const std::size_t place = place_of<"robot.speed_m_s">(scene, slower);
  if (std::isinf(limit)) {
    report(problems, "robot.speed_m_s", place, "sets no time limit",
           "a speed above 0, or a task.timeout_s");
    return;
  }
  if (limit / period <= most_carry_ticks) return;
  const double most = most_carry_ticks * period;
  if (scene.has<"task.timeout_s">()) {
    report(problems, "task.timeout_s", common, "is too long for control periods of {0} s",
           "at most {1} s (ten million periods)", {period, most});
    return;
  }
  const SceneValues defaults;
  double speedup = 0;
  for (const std::size_t side : {left, right}) {
    speedup = larger(speedup, speed_of(side) / scene.of<"robot.acceleration_m_s2">(own(side)));
  }
  const double distance = scene.of<"task.distance_m">();
  const double usual_speed = defaults.of<"robot.speed_m_s">();
  const double usual_distance = defaults.of<"task.distance_m">();
  const char* key = "robot.speed_m_s";
  std::size_t blamed = place;
  if (default_time_limit(distance, usual_speed, speedup) / period > most_carry_ticks) {
    if (default_time_limit(usual_distance, speed_of(slower), speedup) / period <=
        most_carry_ticks) {
      key = "task.distance_m";
      blamed = common;
    } else if (limit / defaults.of<"control.period_s">() <= most_carry_ticks) {
      key = "control.period_s";
      blamed = common;
    }
  }
  report(problems, key, blamed,
         "leads to a time limit of {0} s, which is too long for control periods of {1} s",
         "a time limit of at most {2} s (ten million periods), or a task.timeout_s",
         {limit, period, most});
}

// The object must reach from palm to palm at the start.
inline void check_start(const SceneValues& scene, Problems& problems) {
  const std::array<double, 2> start = {scene.of<"start.left_m">(), scene.of<"start.right_m">()};
  std::array<double, 2> heights{};
  for (const std::size_t side : {left, right}) {
    const double usable = scene.of<"palm.usable_m">(own(side));
    const double length = scene.of<"palm.length_m">(own(side));
    const double half = (usable < length ? usable : length) / 2;
    if (std::abs(start[side]) > half) {
      report(problems, side == left ? "start.left_m" : "start.right_m", common,
             usable < length ? "is not on the usable part of the palm" : "is not on the palm",
             "a number in m, from {0} to {1}", {-half, half});
    }
    const auto angle = sin_cos(scene.of<"palm.steep_deg">(own(side)) * radians_per_degree<double>);
    heights[side] =
        start[side] * angle.sin + scene.of<"palm.pivot_offset_m">(own(side)) * angle.cos;
  }
  const SceneObject object = object_of(scene);
  if (object.is_simple && object.has_contacts && is_pipe(object_frame(object))) return;
  const Point& l = object.vertices[object.contacts[left]];
  const Point& r = object.vertices[object.contacts[right]];
  const double width = std::sqrt((r.x - l.x) * (r.x - l.x) + (r.y - l.y) * (r.y - l.y));
  if (std::abs(heights[right] - heights[left]) <= most_lean * width) return;
  report(problems, "start", common,
         "puts the contacts at heights {0} and {1} m, too far apart for an object "
         "that is {2} m wide between them",
         "left_m and right_m at more equal heights", {heights[left], heights[right], width},
         {start[left], start[right]});
}

// A pipe touches both palms with one arc. While both contacts are at their pivots, each is the radius
// times the tangent of the palm angle from where the lines of the palms meet: the palms must end
// before that. No sudden shift moves one contact without the other.
inline void check_pipe(const SceneValues& scene, Problems& problems) {
  const SceneObject object = object_of(scene);
  if (!object.is_simple || !object.has_contacts || !is_pipe(object_frame(object))) return;
  const double radius = object.radii[object.contacts[left]];
  std::array<double, 2> heights{};
  for (const std::size_t side : {left, right}) {
    const double half = scene.of<"palm.length_m">(own(side)) / 2;
    const double shallow = scene.of<"palm.shallow_deg">(own(side));
    const auto steep = sin_cos(scene.of<"palm.steep_deg">(own(side)) * radians_per_degree<double>);
    const double slope = tangent(shallow * radians_per_degree<double>);
    if (!(radius * slope >= half)) {
      report(
          problems, "palm.shallow_deg", place_of<"palm.shallow_deg">(scene, side),
          "is too shallow for a pipe with a radius of {0} m: where it touches both palms at their "
          "pivots, palms of {1} m would cross below it",
          "an angle whose tangent is at least {2}, or shorter palms",
          {radius, 2 * half, half / radius});
      return;
    }
    const double p = side == left ? scene.of<"start.left_m">() : scene.of<"start.right_m">();
    heights[side] =
        p * steep.sin + (scene.of<"palm.pivot_offset_m">(own(side)) + radius) * steep.cos;
  }
  if (std::abs(heights[left] - heights[right]) > most_unlevel) {
    report(
        problems, "start", common,
        "puts the two contacts of a pipe where its centre would be {0} and {1} m above the pivots",
        "left_m and right_m at which both are equal", {heights[left], heights[right]},
        {scene.of<"start.left_m">(), scene.of<"start.right_m">()});
  }
  refuse_bumps(scene, problems, "shifts one contact, but those of a pipe move together");
}

}  // namespace detail

// Every relation that does not hold, in the order in which they are to be reported.
inline Problems check(const SceneValues& scene) {
  Problems problems;
  detail::check_object(scene, problems);
  detail::check_palms(scene, problems);
  detail::check_robots(scene, problems);
  detail::check_zones(scene, problems);
  detail::check_radio(scene, problems);
  detail::check_disturbances(scene, problems);
  detail::check_ridges(scene, problems);
  detail::check_surroundings(scene, problems);
  detail::check_time(scene, problems);
  detail::check_delays(scene, problems);
  detail::check_periods(scene, problems);
  detail::check_start(scene, problems);
  detail::check_pipe(scene, problems);
  return problems;
}

}  // namespace palmbots
