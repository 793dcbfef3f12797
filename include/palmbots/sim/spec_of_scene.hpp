// SPDX-License-Identifier: Apache-2.0
// The spec of a scene: conversion of units, resolution of left and right, and what follows from the
// keys: the object's frame, zones, strides, slope, time limit, safe reach.
//
// Only + − × ÷ √ and the core's own tangent are used, because the numbers reach the trace. The spec
// of a mirrored scene is the mirror image of the scene's spec to the last bit.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/scene_object.hpp"
#include "palmbots/sim/scene_values.hpp"

namespace palmbots {

namespace detail {

// Converts a number to SI units; a value that is not set leaves the member's initial value.
inline void put_number(const Key& key, void* record, double value) {
  if (key.put != nullptr && value == value) key.put(record, value * scale_of(key.unit));
}

inline void put_numbers(const SceneValues& scene, Spec& spec) {
  for (const Section& section : sections) {
    for (const Key& key : section.keys) {
      if (key.name.empty()) continue;
      const std::size_t at = common_key(section, key);
      for (std::size_t holder = 0; holder < section.holder_count(); ++holder) {
        double value = section.holders == Holders::senders ? unset : scene.at(at, common);
        if (section.holders != Holders::one) {
          if (const double single = scene.at(at, own(holder)); single == single) value = single;
        }
        put_number(key, section.at(spec, holder), value);
      }
    }
  }
}

inline void put_lists(const SceneValues& scene, Spec& spec) {
  std::size_t number = 0;
  for (const Section& section : sections) {
    void* owner = section.at(spec, 0);
    for (const RecordList& list : section.lists) {
      const auto& records = scene.list(number++);
      list.resize(owner, records.size());
      for (std::size_t i = 0; i < records.size(); ++i) {
        for (std::size_t k = 0; k < list.keys.size(); ++k) {
          put_number(list.keys[k], list.at(owner, i), records[i][k]);
        }
      }
    }
  }
}

inline std::uint32_t side_of(double number) {
  return number == number ? static_cast<std::uint32_t>(number) : 0;
}

// The coefficient of friction, for a palm whose own keys or those of both palms give an angle.
inline double friction_of(const SceneValues& scene, std::size_t side) {
  const std::size_t place = own(side);
  const bool is_angle =
      scene.has<"palm.friction_angle_deg">(place) ||
      (scene.has<"palm.friction_angle_deg">() && !scene.has<"palm.friction">(place));
  if (!is_angle) return scene.of<"palm.friction">(place);
  return tangent(scene.of<"palm.friction_angle_deg">(place) * radians_per_degree<double>);
}

inline std::uint64_t stride_of(const SceneValues& scene, std::size_t side) {
  const double period = scene.of<"robot.period_s">(own(side));
  const double ratio = std::nearbyint(period / scene.of<"control.period_s">());
  return ratio > 1 ? static_cast<std::uint64_t>(ratio) : 1;  // not set: 1
}

// Without zones: one about the pivot that reads 0, and − and + beyond it.
inline void derive_zones(const SceneValues& scene, Spec& spec) {
  if (scene.has_list<"tactile.zones">()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double half = scene.of<"tactile.zero_half_width_m">();
  spec.zones[0] = {-1, -infinity, -half};
  spec.zones[1] = {0, -half, half};
  spec.zones[2] = {1, half, infinity};
  spec.zone_count = 3;
}

// From places in the direction of travel. Adding 0.0 turns −0.0 into 0.0.
inline void derive_surroundings(Spec& spec) {
  for (std::size_t i = 0; i < spec.wall_count; ++i) spec.walls[i].at *= spec.direction;
  for (std::size_t i = 0; i < spec.stand_count && spec.direction < 0; ++i) {
    StandSpec& stand = spec.stands[i];
    const double from = stand.from;
    stand.from = 0.0 - stand.to;
    stand.to = 0.0 - from;
  }
}

inline void derive_messages(const SceneValues& scene, Spec& spec) {
  for (std::size_t i = 0; i < spec.message_fault_count; ++i) {
    const auto& given = scene.list<"radio.script">()[i];
    const std::uint32_t sender =
        side_of(given[SceneValues::place_in_record<"radio.script", "sender">]);
    const std::uint32_t to =
        side_of(given[SceneValues::place_in_record<"radio.script", "receiver">]);
    MessageFaultSpec& fault = spec.message_faults[i];
    fault.link = sender == 2 ? 2 + to : sender;
    if (fault.late < 0) fault.late = 0;
  }
}

inline void derive_faults(const SceneValues& scene, Spec& spec) {
  for (std::size_t i = 0; i < spec.fault_count; ++i) {
    const auto& given = scene.list<"faults.script">()[i];
    FaultSpec& fault = spec.faults[i];
    const double probability = given[SceneValues::place_in_record<"faults.script", "probability">];
    const double ppm = given[SceneValues::place_in_record<"faults.script", "ppm">];
    const double limp = given[SceneValues::place_in_record<"faults.script", "limp_deg">];
    const double reads = given[SceneValues::place_in_record<"faults.script", "stuck_at">];
    fault.side = side_of(given[SceneValues::place_in_record<"faults.script", "robot">]);
    if (reads == reads) fault.reads = static_cast<std::int64_t>(reads);
    if (probability == probability) fault.rate = probability;
    if (ppm == ppm) fault.rate = ppm * 1e-6;
    if (fault.kind == FaultKind::clock_jump) fault.rate = fault.lasts;
    if (given[SceneValues::place_in_record<"faults.script", "loses_boot_counter">] == 1) {
      fault.marks |= loses_boot_counter;
    }
    if (limp == limp) {
      fault.rate = limp * radians_per_degree<double>;
      fault.marks |= palm_goes_limp;
    }
  }
  for (std::size_t i = 0; i < spec.bump_count; ++i) {
    const auto& given = scene.list<"bumps.script">()[i];
    const double time = given[SceneValues::place_in_record<"bumps.script", "at_s">];
    spec.bumps[i].by_time = time == time;
    spec.bumps[i].at =
        time == time ? time : given[SceneValues::place_in_record<"bumps.script", "at_m">];
  }
}

// Forces in weights of the object, as everywhere in the mechanics.
inline void derive_limits(const SceneValues& scene, double weight, Spec& spec) {
  for (const std::size_t side : {left, right}) {
    RobotSpec& robot = spec.robots[side];
    const auto put = [&](double force, double& limit) {
      if (force == force) limit = force / weight;
    };
    put(scene.of<"robot.motor_force_n">(own(side)), robot.motor_limit);
    put(scene.of<"robot.traction_n">(own(side)), robot.traction_limit);
  }
}

}  // namespace detail

// The default time limit [s]: twice the time at the slower speed. The second half is at least twice
// the time in which the robots reach their speed.
inline double default_time_limit(double distance, double speed, double speedup) {
  if (!(speed > 0)) return std::numeric_limits<double>::infinity();
  const double nominal = distance / speed;
  return nominal + (nominal > 2 * speedup ? nominal : 2 * speedup);
}

// What the default time limit grants to pick up, and to put down [s].
inline constexpr double most_floor_time = 60;

// The time limit of a carry [s].
inline double time_limit_of(const SceneValues& scene) {
  if (scene.has<"task.timeout_s">()) return scene.of<"task.timeout_s">();
  const double floor_time =
      most_floor_time * ((scene.of<"task.from">() > 0) + (scene.of<"task.to">() > 0));
  double speed = std::numeric_limits<double>::infinity();
  double speedup = 0;
  for (const std::size_t side : {left, right}) {
    const double own_speed = scene.of<"robot.speed_m_s">(own(side));
    speed = smaller(speed, scene.of<"robot.gain">(own(side)) * own_speed);
    speedup = larger(speedup, own_speed / scene.of<"robot.acceleration_m_s2">(own(side)));
  }
  return default_time_limit(scene.of<"task.distance_m">(), speed, speedup) + floor_time;
}

// The length of the middle part of a palm on which the contact vertex may be while the heel is
// certain to touch nothing [m]. A point of the object that lies outward of the vertex by `a` and is
// seen at the height h from the palm, which is inclined to the object by at most β, is seen at most
// a / cos β + h tan β outward of the vertex.
inline double clear_of_heel(const Spec& spec, std::size_t side) {
  double steepest = 0;  // of both palms
  const PerSide<double> radius = contact_radii(spec.outline);
  const auto offset = [&](std::size_t s) { return spec.palms[s].offset + radius[s]; };
  double apart = std::abs(offset(left) - offset(right));
  double reach = 0;
  double farthest = 0;  // contact vertex from the pivot, across the palm
  for (const std::size_t s : {left, right}) {
    const PalmSpec& palm = spec.palms[s];
    steepest = larger(steepest, larger(std::abs(palm.shallow), std::abs(palm.steep)));
    reach += 0.5 * palm.length;
    farthest = larger(farthest, std::abs(offset(s)));
  }
  const SinCos<double> at = sin_cos(steepest);
  apart += reach * at.sin + farthest * (1 - at.cos);
  const double lean = apart / spec.width;  // at most, as a sine
  if (!(lean < 1)) return least_usable;
  const double tan_lean = lean / std::sqrt(1 - lean * lean);
  const double tan_palm = at.sin / at.cos;
  if (!(tan_lean * tan_palm < 1)) return least_usable;
  const double tan_most = (tan_lean + tan_palm) / (1 - tan_lean * tan_palm);
  double overhang = 0;
  for (std::size_t i = 0; i < spec.outline.count; ++i)
    overhang = larger(overhang, -spec.outline.vertices[i].along[side]);
  const PalmSpec& palm = spec.palms[side];
  const double taken = overhang * std::sqrt(1 + tan_most * tan_most) + palm.heel * tan_most;
  return larger(least_usable, palm.length - 2 * taken);
}

// The spec of a scene that passes all checks.
inline Spec spec_of(const SceneValues& scene) {
  Spec spec;
  detail::put_numbers(scene, spec);
  detail::put_lists(scene, spec);
  const SceneObject object = object_of(scene);
  static_cast<ObjectSpec&>(spec) = object_frame(object);
  detail::derive_limits(scene, object.mass * standard_gravity, spec);
  spec.direction = scene.of<"task.direction">() == 1 ? -1 : 1;
  for (const std::size_t side : {left, right}) {
    PalmSpec& palm = spec.palms[side];
    palm.friction = detail::friction_of(scene, side);
    palm.nose = palm.tip_thickness();
    if (!(palm.usable == palm.usable)) {
      palm.stops = palm.heel > 0;
      palm.usable = palm.stops ? clear_of_heel(spec, side) : palm.length;
    }
    spec.robots[side].stride = detail::stride_of(scene, side);
  }
  detail::derive_zones(scene, spec);
  detail::derive_surroundings(spec);
  detail::derive_messages(scene, spec);
  detail::derive_faults(scene, spec);
  // Uphill in the direction of travel pulls the object back: towards −x when travelling forward.
  spec.slope =
      spec.direction * tangent(scene.of<"task.slope_deg">() * radians_per_degree<double>) + 0.0;
  const double ticks = std::nearbyint(time_limit_of(scene) / spec.period);
  constexpr double most = 1e15;  // of a scene that the checks refuse
  spec.timeout_ticks = ticks > 1 ? static_cast<std::uint64_t>(ticks < most ? ticks : most) : 1;
  spec.safe_reach = may_go_limp(spec) || is_pipe(spec)
                        ? -1.0
                        : safe_reach(spec);  // a limp palm may turn anywhere
  return spec;
}

}  // namespace palmbots
