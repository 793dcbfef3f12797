// SPDX-License-Identifier: Apache-2.0
// Warnings that are known before a carry starts, from the scene and its controller: one sentence each,
// for the command line, Python and the page.
//
// The dead-band law: a correction stops when the sign changes. The contact then overruns: for one
// control period until the controller sees the sign, for the braking distance, and, where a station
// decides or both robots drive by both signs, for the time that messages travel. If the overrun exceeds
// the width of the zero zone, the contact leaves it on the other side, the opposite correction begins,
// and this repeats forever.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "palmbots/base/few_sorted.hpp"
#include "palmbots/base/number_text.hpp"
#include "palmbots/runtime/controller_registry.hpp"
#include "palmbots/sim/problem_text.hpp"
#include "palmbots/sim/scene_object.hpp"
#include "palmbots/sim/scene_values.hpp"
#include "palmbots/sim/table_lease.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

// Where the sensor stops reading − and starts reading + [m]; infinite where it never does.
struct ZeroZone {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  double width() const { return high - low; }
};

inline ZeroZone zero_zone_of(const Spec& spec) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> edges;
  for (std::size_t i = 0; i < spec.zone_count; ++i) {
    for (const double edge : {spec.zones[i].from, spec.zones[i].to}) {
      if (std::isfinite(edge)) edges.push_back(edge);
    }
  }
  sort_few(edges.data(), edges.size());
  // The reading in a stretch without edges; a zone that reads 0 takes precedence.
  const auto reads = [&](double p) {
    std::int64_t sign = 0;
    for (std::size_t i = 0; i < spec.zone_count; ++i) {
      const ZoneSpec& zone = spec.zones[i];
      if (!(zone.from <= p && p <= zone.to)) continue;
      if (zone.sign == 0) return zone.sign;
      sign = zone.sign;
    }
    return sign;
  };
  ZeroZone found;
  for (std::size_t k = 0; k <= edges.size() && !edges.empty(); ++k) {
    const double low = k == 0 ? -infinity : edges[k - 1];
    const double high = k == edges.size() ? infinity : edges[k];
    if (low == high) continue;
    const double within = k == 0 ? high - 1 : high == infinity ? low + 1 : 0.5 * (low + high);
    const std::int64_t sign = reads(within);
    if (sign < 0) found.low = high;
    if (sign > 0) found.high = std::min(found.high, low);
  }
  return found;
}

// How far a contact can overrun the edge of the zero zone [m]; 0 without a controller.
inline double overrun_of(const Spec& spec, const ControllerInfo& controller) {
  if (controller.decider == Decider::none) return 0;
  const bool by_station = controller.decider == Decider::station;
  // From the correction speed, or half of it, back to the nominal one.
  const auto braking = [&](const RobotSpec& robot, double fraction) {
    const double speed = fraction * robot.correction;
    const double drop = robot.acceleration * spec.period;
    const double steps = std::max(0.0, std::ceil(speed / drop) - 1);
    return robot.gain * spec.period * (steps * speed - drop * steps * (steps + 1) / 2);
  };
  const double step = spec.longest_period();
  // Messages arrive in whole periods, at least one.
  const double periods = std::ceil(spec.longest_delay() / spec.period - 1e-9);
  const double delay = spec.period * std::max(1.0, periods);
  double distance = 0;
  for (const RobotSpec& robot : spec.robots) {
    const double correction = robot.gain * robot.correction;
    if (by_station) {  // each robot drives half of a correction
      distance += 0.5 * correction * (2 * delay + step) + braking(robot, 0.5);
    } else if (controller.drives_by_both_signs) {
      distance += correction * (delay + step) + braking(robot, 1);
    } else {
      distance = std::max(distance, correction * step + braking(robot, 1));
    }
  }
  // Along the palm a contact moves a little farther than the robots do.
  const double steepest = std::max(spec.palms[left].steep, spec.palms[right].steep);
  return distance / sin_cos(steepest).cos;
}

namespace detail {

// The sensor of a palm reads 0 up to an end: it cannot foresee a drop there.
inline void warn_if_blind(const Spec& spec, std::size_t side, std::vector<std::string>& lines) {
  const ZeroZone zone = zero_zone_of(spec);
  const double reach = spec.palms[side].reach();
  const bool sees_minus = zone.low > -reach;
  const bool sees_plus = zone.high < reach;
  if (sees_minus && sees_plus) return;
  const char* never = sees_plus ? "-" : sees_minus ? "+" : "- or +";
  lines.push_back(std::string("the sensor of the ") + (side == left ? "left" : "right") +
                  " palm never reads " + never + ": the zero zone reaches as far as the palm, " +
                  millimetres(reach) +
                  " from the pivot (tactile.zero_half_width_m, tactile.zones)");
}

// The lease of a table within which a beacon may not be answered in time. Below twice the latency of
// the radio no beacon is answered in time: the controller carries as `silent` does. From there up to
// the lease named in the warning, some answers arrive in time.
template <class ProgramMaker>
void warn_of_short_lease(const ProgramMaker&, const Spec&, const ControllerInfo&,
                         std::vector<std::string>&) {}

template <class Table>
void warn_of_short_lease(const runtime::TableProgramMaker<Table>&, const Spec& spec,
                         const ControllerInfo& controller, std::vector<std::string>& lines) {
  if constexpr (Table::mail == Mail::beacons && requires { &Table::seconds; }) {
    const double lease = table_times_of<Table>(spec).lease * spec.period;
    const double shortest = shortest_table_lease<Table>(spec);
    if (lease > shortest - 1e-9) return;
    lines.push_back(sentence(
        "radio.lease_s: {} s is shorter than the round trip of two beacons, {} s: a robot "
        "counts its partner as lost although no message is, and {} carries like the controller "
        "silent meanwhile (raise it, or lower radio.latency_s or radio.beacon_s)",
        {short_text(lease), short_text(shortest), controller.name}));
  }
}

// The noise of the robots leaves no lease that is safe.
inline void warn_of_noisy_lease(const Spec& spec, std::vector<std::string>& lines) {
  const ResilientTiming b = resilient_timing_of(spec);
  if (!b.is_noisy) return;
  lines.push_back(sentence(
      "radio.lease_s: {} s is the shortest lease that this radio permits, but with it a robot that "
      "travels alone, and the noise, can shift a contact by {} mm, and the palm has room for only "
      "{} mm: a fault may drop the object (lower robot.noise_m_s, robot.speed_m_s or "
      "radio.latency_s)",
      {short_text(b.times.lease * spec.period), fixed_text(1e3 * (b.skew + b.noise), 0),
       fixed_text(1e3 * b.room, 0)}));
}

// A value that no one means in the unit of its key, but many in another one: from `low` up to, but not
// including, `high`. `factor` converts the other unit.
template <Name path>
void warn_of_unit(const SceneValues& scene, double low, double high, const char* other,
                  double factor, std::vector<std::string>& lines) {
  constexpr const Key& row = SceneValues::row<path>;
  for (const std::size_t place : {common, own(left), own(right)}) {
    if (!scene.has<path>(place)) continue;
    const double value = scene.of<path>(place);
    if (!(low <= std::abs(value) && std::abs(value) < high)) continue;
    const Problem about{path.view(), place, {}, {}};
    lines.push_back(sentence("{} is {} {}; if that is in {}, write {}",
                             {key_text(about), short_text(value),
                              std::string(unit_names[static_cast<std::size_t>(row.unit)]), other,
                              short_text(value * factor, 3)}));
  }
}

inline void warn_of_units(const SceneValues& scene, std::vector<std::string>& lines) {
  constexpr double degrees_per_radian = 1 / radians_per_degree<double>;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  warn_of_unit<"palm.steep_deg">(scene, 0.05, 1, "rad", degrees_per_radian, lines);
  warn_of_unit<"palm.friction_angle_deg">(scene, 0.1, 1.5, "rad", degrees_per_radian, lines);
  warn_of_unit<"palm.rate_deg_s">(scene, 0.1, 3, "rad/s", degrees_per_radian, lines);
  warn_of_unit<"task.slope_deg">(scene, 0.01, 0.2, "rad", degrees_per_radian, lines);
  warn_of_unit<"robot.noise_m_s">(scene, 0.3, infinity, "cm/s", 0.01, lines);
  warn_of_unit<"mujoco.palm_torque_n_m">(scene, 50, infinity, "mN m", 0.001, lines);
}

}  // namespace detail

// Of the values of a scene, whatever carries the object.
inline std::vector<std::string> value_warnings(const SceneValues& scene) {
  constexpr double degrees_per_radian = 1 / radians_per_degree<double>;
  std::vector<std::string> lines;
  detail::warn_of_units(scene, lines);
  const SceneObject object = object_of(scene);
  const Point l = object.vertices[object.contacts[left]];
  const Point r = object.vertices[object.contacts[right]];
  const double turned = std::atan2(l.y - r.y, r.x - l.x) * degrees_per_radian;
  if (std::abs(turned) > 90) {
    lines.push_back(
        sentence("the object rests upside down: its outline is turned by {}° "
                 "(object.contacts are upper vertices of object.vertices_m)",
                 {fixed_text(turned, 0)}));
  }
  const SceneValues usual;
  const SceneObject box = object_of(usual);
  const auto is_same = [](const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; };
  const bool has_its_outline =
      object.vertices.size() == box.vertices.size() &&
      std::equal(object.vertices.begin(), object.vertices.end(), box.vertices.begin(), is_same);
  if (is_same(object.com, box.com) && !has_its_outline) {
    lines.push_back(
        sentence("object.com_m is [{}, {}], that of the paper's box, but the outline is "
                 "another one (without com_m it is the centroid)",
                 {short_text(box.com.x), short_text(box.com.y)}));
  }
  return lines;
}

// All of a scene and a controller; one that is not in the registry has an empty name. `of_values`:
// the `value_warnings` of the scene.
inline std::vector<std::string> warnings_before(const Spec& spec, const ControllerInfo& controller,
                                                const std::vector<std::string>& of_values) {
  std::vector<std::string> lines;
  const double zone = zero_zone_of(spec).width();
  const double overrun = overrun_of(spec, controller);
  if (overrun > zone) {
    const bool is_late = controller.decider == Decider::station || controller.drives_by_both_signs;
    lines.push_back("the zero zone is " + millimetres(zone) +
                    " wide, but a contact overruns its edge by " + millimetres(overrun) +
                    ": corrections may not end (widen tactile.zero_half_width_m or lower "
                    "robot.correction_m_s, " +
                    (is_late ? "radio.latency_s)" : "control.period_s)"));
  }
  visit_program(controller.name, [&](const auto& maker) {
    detail::warn_of_short_lease(maker, spec, controller, lines);
  });
  if (controller.decider != Decider::none) {
    for (const std::size_t side : {left, right}) detail::warn_if_blind(spec, side, lines);
  }
  lines.insert(lines.end(), of_values.begin(), of_values.end());
  if (controller.has_time_bounds) detail::warn_of_noisy_lease(spec, lines);
  return lines;
}

}  // namespace palmbots
