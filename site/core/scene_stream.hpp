// SPDX-License-Identifier: Apache-2.0
// A scene as the page has it, in the units of scene files, read into a Spec.
//
// site/src/shared/scene.ts writes the numbers in this order. The conversions are those of
// src/palmbots/scene/spec.py; tests/site compares trace hashes.
#pragma once

#include <cmath>
#include <limits>

#include "number_stream.hpp"
#include "object_frame.hpp"
#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots::page {

namespace detail {

inline void read_object(NumberStream& in, Spec& spec) {
  Polygon polygon;
  polygon.count = in.count(max_outline);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    polygon.vertices[i].x = in.next();
    polygon.vertices[i].y = in.next();
  }
  for (std::size_t& contact : polygon.contacts) contact = in.whole() % polygon.count;
  polygon.com.x = in.next();
  polygon.com.y = in.next();
  set_object(polygon, spec);
}

inline void read_robots(NumberStream& in, Spec& spec) {
  constexpr double degree = radians_per_degree<double>;
  for (PalmSpec& palm : spec.palms) {
    palm.length = in.next();
    palm.offset = in.next();
    const double coefficient = in.next();
    const double angle = in.next();  // in place of the coefficient; not a number: not given
    palm.friction = angle == angle ? tangent(angle * degree) : coefficient;
    palm.shallow = in.next() * degree;
    palm.steep = in.next() * degree;
    palm.rate = in.next() * degree;
  }
  for (RobotSpec& robot : spec.robots) {
    robot.speed = in.next();
    robot.correction = in.next();
    robot.acceleration = in.next();
    robot.max_speed = in.next();
    robot.noise = in.next();
    robot.noise_tau = in.next();
    robot.bias = in.next();
    robot.clock_drift = in.next() * 1e-6;
    robot.stride = in.whole();
  }
  spec.zone_count = in.count(max_zones);
  for (std::size_t i = 0; i < spec.zone_count; ++i) {
    const auto sign = static_cast<std::int64_t>(in.next());
    const double from = in.next();
    spec.zones[i] = {sign, from, in.next()};
  }
  spec.false_rate = in.next();
  spec.period = in.next();
  spec.brake = in.whole();
  spec.start_by_touch = in.whole();
  spec.watchdog = in.next();
}

inline void read_radio(NumberStream& in, Spec& spec) {
  for (double* number :
       {&spec.latency, &spec.jitter, &spec.loss, &spec.duplicate, &spec.corruption}) {
    *number = in.next();
  }
  spec.reorders = static_cast<std::uint16_t>(in.whole());
  spec.sessions = static_cast<std::uint16_t>(in.whole());
  for (double* number :
       {&spec.burst_share, &spec.burst_mean, &spec.airtime, &spec.beacon, &spec.lease}) {
    *number = in.next();
  }
  spec.outage_count = in.count(max_outages);
  for (std::size_t i = 0; i < spec.outage_count; ++i) {
    OutageSpec& outage = spec.outages[i];
    outage.sender = in.whole();
    outage.from = in.next();
    outage.to = in.next();
  }
  spec.message_fault_count = in.count(max_message_faults);
  for (std::size_t i = 0; i < spec.message_fault_count; ++i) {
    MessageFaultSpec& fault = spec.message_faults[i];
    fault.link = in.whole();
    fault.message = in.whole();
    fault.effect = in.whole();
    fault.late = in.next();
  }
  for (DirectionSpec& direction : spec.directions) {
    direction.latency = in.next();
    direction.jitter = in.next();
    direction.loss = in.next();
  }
  spec.replay = in.next();
  spec.replay_delay = in.next();
}

inline void read_disturbances(NumberStream& in, Spec& spec) {
  spec.fault_count = in.count(max_faults);
  for (std::size_t i = 0; i < spec.fault_count; ++i) {
    FaultSpec& fault = spec.faults[i];
    fault.kind = static_cast<FaultKind>(in.whole());
    fault.side = in.whole();
    fault.at = in.next();
    fault.lasts = in.next();
    fault.reads = static_cast<std::int32_t>(in.next());
    fault.rate = in.next();
    fault.marks = in.whole();
    if ((fault.marks & palm_goes_limp) != 0) fault.rate *= radians_per_degree<double>;
    if (fault.kind == FaultKind::clock_rate) fault.rate *= 1e-6;
  }
  spec.random_reboots = in.whole();
  spec.reboot = in.next();
  spec.bump_count = in.count(max_bumps);
  for (std::size_t i = 0; i < spec.bump_count; ++i) {
    BumpSpec& bump = spec.bumps[i];
    bump.side = in.whole();
    bump.by_time = in.whole();
    bump.at = in.next();
    bump.shift = in.next();
  }
  spec.push_count = in.count(max_pushes);
  for (std::size_t i = 0; i < spec.push_count; ++i) {
    PushSpec& push = spec.pushes[i];
    push.side = in.whole();
    push.at = in.next();
    push.lasts = in.next();
    push.speed = in.next();
  }
  spec.bump_rate = in.next();
  spec.bump_max = in.next();
  for (double& start : spec.start) start = in.next();
}

// The time limit [s] where the scene gives none, as Scene.timeout_s computes it.
inline double default_timeout(const Spec& spec) {
  double speed = std::numeric_limits<double>::infinity();
  double speedup = 0;
  for (const RobotSpec& robot : spec.robots) {
    speed = robot.speed < speed ? robot.speed : speed;
    const double own = robot.speed / robot.acceleration;
    speedup = own > speedup ? own : speedup;
  }
  const double nominal = spec.distance / speed;
  return nominal + (nominal > 2 * speedup ? nominal : 2 * speedup);
}

}  // namespace detail

// Longest carry that the page records [ticks]: twenty minutes at the default period. The page refuses
// a scene with a longer time limit, so that no carry is cut.
inline constexpr double most_ticks = 120000;

// A scene of the page.
struct PageScene {
  Spec spec;
  double timeout = 0;  // time limit of a carry [s], which may exceed what the page records

  double longest_timeout() const { return most_ticks * spec.period; }
  bool is_too_long() const { return !(std::nearbyint(timeout / spec.period) <= most_ticks); }
};

inline PageScene read_scene(NumberStream in) {
  PageScene scene;
  Spec& spec = scene.spec;
  detail::read_object(in, spec);
  detail::read_robots(in, spec);
  detail::read_radio(in, spec);
  detail::read_disturbances(in, spec);
  spec.distance = in.next();
  spec.direction = in.next();
  spec.slope = spec.direction * tangent(in.next() * radians_per_degree<double>) + 0.0;
  spec.inertia = in.next();
  spec.inertia_lag = in.next();
  const double given = in.next();  // not a number: not given
  scene.timeout = given == given ? given : detail::default_timeout(spec);
  const double ticks = std::nearbyint(scene.timeout / spec.period);
  spec.timeout_ticks =
      static_cast<std::uint64_t>(ticks < 1 ? 1 : (ticks < most_ticks ? ticks : most_ticks));
  spec.safe_reach = may_go_limp(spec) ? -1.0 : safe_reach(spec);  // a limp palm may turn anywhere
  return scene;
}

}  // namespace palmbots::page
