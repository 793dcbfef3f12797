// SPDX-License-Identifier: Apache-2.0
// Builds the parts of a carry from a spec, in the carry's own precision, and computes bounds that
// are known beforehand.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "palmbots/base/gravity.hpp"
#include "palmbots/control/resilient_timing.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/robot/actuators.hpp"
#include "palmbots/sim/ground_blocks.hpp"
#include "palmbots/sim/radio_channel.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/spec.hpp"
#include "palmbots/sim/speed_errors.hpp"
#include "palmbots/stability/safe_reach.hpp"

namespace palmbots {

inline PalmProfile profile_of(const PalmSpec& palm) {
  PalmProfile profile{palm.tip_thickness(), palm.heel, palm.stops};
  const double narrows = palm.thickness - profile.nose;
  const double long_side = std::sqrt(palm.bevel * palm.bevel + narrows * narrows);
  if (palm.bevel > 0 && narrows > 0) {
    profile.under_along = -narrows / long_side;
    profile.under_across = -palm.bevel / long_side;
  }
  return profile;
}

// Whether a nose or a heel may touch the object although both contacts are within reach. A nose
// touches only what hangs below the contact vertices. A heel that stops the contacts touches nothing
// while they are within reach (`clear_of_heel`).
inline bool touches_within_reach(const Spec& spec, std::size_t side) {
  const PalmSpec& palm = spec.palms[side];
  const PerSide<double> radius = contact_radii(spec.outline);
  const double lowest = -smaller(radius[left], radius[right]) - 1e-9 * spec.width;
  bool hangs = false;
  for (std::size_t i = 0; i < spec.outline.count; ++i) {
    const bool rests = i == spec.outline.contact[left] || i == spec.outline.contact[right];
    hangs = hangs || (!rests && spec.outline.vertices[i].height < lowest);
  }
  const bool is_clear = palm.stops && palm.usable > least_usable && !may_go_limp(spec);
  return (palm.nose > 0 && hangs) || (palm.heel > 0 && !is_clear);
}

// The model of object, palms and friction.
template <class Real>
Model<Real> model_of(const Spec& spec) {
  Model<Real> model{};
  model.object = {Real(spec.width), Real(spec.com_left), Real(spec.com_right),
                  Real(spec.com_height), Real(spec.slope)};
  model.moments = Moments<Real>::of(model.object);
  model.outline.count = spec.outline.count;
  model.outline.contact = spec.outline.contact;
  for (std::size_t i = 0; i < spec.outline.count; ++i) {
    const Vertex<double>& v = spec.outline.vertices[i];
    model.outline.vertices[i] = {
        {Real(v.along[left]), Real(v.along[right])}, Real(v.height), Real(v.radius)};
  }
  for (const std::size_t side : {left, right}) {
    model.clear[side] = clear_cone(model.outline, side);
    model.offset[side] =
        Real(spec.palms[side].offset + spec.outline.vertices[spec.outline.contact[side]].radius);
    model.half_length[side] = Real(0.5 * spec.palms[side].length);
    model.reach[side] = Real(spec.palms[side].reach());
    model.friction[side] = Real(spec.palms[side].friction);
    model.profile[side] = profile_of(spec.palms[side]);
    model.profile[side].touches_within_reach = touches_within_reach(spec, side);
    model.limit[side] = spec.robots[side].force_limit();
  }
  model.safe_reach = Real(spec.safe_reach);
  return model;
}

// The sensors of the palms.
template <class Real>
TactileSensor<Real> tactile_of(const Spec& spec) {
  std::array<Zone<Real>, max_zones> zones{};
  for (std::size_t i = 0; i < spec.zone_count; ++i) {
    const ZoneSpec& zone = spec.zones[i];
    zones[i] = {static_cast<Sign>(zone.sign), Real(zone.from), Real(zone.to)};
  }
  return TactileSensor<Real>(zones, spec.zone_count, spec.false_rate);
}

// The initial configuration: both palms steep, the contacts where the spec puts them, the robots at
// the separation that the object's width requires. A pipe touches both at one height.
template <class Real>
Configuration<Real> configuration_of(const Spec& spec, const Model<Real>& model) {
  Configuration<Real> configuration{};
  for (const std::size_t side : {left, right}) {
    configuration.palms[side] = PalmAngle<Real>::at(Real(spec.palms[side].steep));
    configuration.contacts[side] = Real(spec.start[side]);
  }
  if (is_pipe(model.object)) {
    const Real rise = contact_vector(configuration, model.offset).dy;
    for (const std::size_t side : {left, right}) {
      configuration.contacts[side] +=
          Real(0.5) * mirrored(side, rise) / configuration.palms[side].sin;
    }
  }
  configuration.separation = closing_separation(configuration, model.offset, model.object.width);
  return configuration;
}

// The share of a first-order lag's initial value that remains after a period: e^(−period/lag).
template <class Real>
Real memory_of(double period, double lag) {
  return lag > 0 ? exp_minus(Real(period / lag)) : Real(0);
}

// The wheels of a robot; `period` is the control period [s], `gain` that of this carry.
template <class Real>
Wheels<Real> wheels_of(const RobotSpec& robot, double period, double gain) {
  const Real memory = memory_of<Real>(period, robot.noise_tau);
  const Real drive = Real(robot.noise) * std::sqrt(Real(1) - memory * memory);
  const double creep = robot.noise > 0 ? smaller(1.0, robot.standing_noise / robot.noise) : 0;
  return {Real(gain * (robot.acceleration * period)),
          Real(robot.max_speed),
          Real(0),  // until a tick sets it (RobotPair::change_biases)
          memory,
          drive,
          Real(creep),
          Real(gain)};
}

// The palm motor; `period` is the control period [s].
template <class Real>
Wrist<Real> wrist_of(const PalmSpec& palm, double period) {
  return {Real(palm.steep), Real(palm.shallow), Real(palm.rate * period)};
}

// The inertia of a pair at rest. The object moves with the mean of the two robots, and a push is an
// acceleration in units of g.
template <class Real>
InertiaFilter<Real> inertia_of(const Spec& spec) {
  InertiaFilter<Real> inertia{};
  if (spec.inertia != 0) inertia.gain = Real(0.5 / (spec.period * standard_gravity));
  inertia.memory = memory_of<Real>(spec.period, spec.inertia_lag);
  inertia.share = Real(1) - inertia.memory;
  return inertia;
}

// Both robots at rest, before they start.
template <class Real>
Robots<Real> robots_of(const Spec& spec, std::uint64_t seed) {
  Robots<Real> robots{};
  robots.travel_sense = Real(spec.direction);
  robots.period = Real(spec.period);
  robots.inertia = inertia_of<Real>(spec);
  // The noise is stationary: its first value already has its long-term spread.
  const Words words = draw(seed, ~0U, Stream::noise);
  for (const std::size_t side : {left, right}) {
    const RobotSpec robot = SpeedErrors::modelled(spec.robots[side]);
    robots.wheels[side] = wheels_of<Real>(robot, spec.period, SpeedErrors::gain(spec, seed, side));
    robots.wrists[side] = wrist_of<Real>(spec.palms[side], spec.period);
    robots.wheels[side].noise =
        Real(robot.noise) * unit_noise<Real>(words[side == leader_of(spec) ? 0 : 1]);
  }
  return robots;
}

// The radio channel, with times converted to control ticks.
inline Channel channel_of(const Spec& spec) {
  Channel channel = Channel::of(spec.latency, spec.jitter, spec.loss, spec.period);
  channel.duplicate_words = Channel::words_of(spec.duplicate);
  channel.corrupt_words = Channel::words_of(spec.corruption);
  channel.reorders = spec.reorders != 0;
  channel.has_sessions = spec.sessions != 0;
  channel.burst_share = spec.burst_share;
  channel.burst_rate = spec.period / ((1 - spec.burst_share) * spec.burst_mean);
  channel.airtime_ticks = spec.airtime / spec.period;
  channel.outage_count = spec.outage_count;
  for (std::size_t i = 0; i < spec.outage_count; ++i) {
    const OutageSpec& outage = spec.outages[i];
    const auto tick = [&](double s) { return static_cast<std::uint32_t>(s / spec.period + 0.5); };
    channel.outages[i] = {static_cast<std::uint32_t>(outage.sender), tick(outage.from),
                          tick(outage.to)};
  }
  channel.message_fault_count = spec.message_fault_count;
  for (std::size_t i = 0; i < spec.message_fault_count; ++i) {
    const MessageFaultSpec& m = spec.message_faults[i];
    channel.message_faults[i] = {m.link, m.message, static_cast<MessageEffect>(m.effect),
                                 static_cast<std::uint32_t>(m.late / spec.period + 0.5)};
  }
  for (std::size_t sender = 0; sender < channel.directions.size(); ++sender) {
    const DirectionSpec& d = spec.directions[sender];
    channel.has_directions =
        channel.has_directions || d.latency >= 0 || d.jitter >= 0 || d.loss >= 0;
    const Channel own =
        Channel::of(d.latency < 0 ? spec.latency : d.latency, d.jitter < 0 ? spec.jitter : d.jitter,
                    d.loss < 0 ? spec.loss : d.loss, spec.period);
    channel.directions[sender] = {own.latency_ticks, own.jitter_ticks, own.loss_words};
  }
  channel.replay_words = Channel::words_of(spec.replay);
  channel.replay_ticks = spec.replay_delay / spec.period;
  channel.fates = spec.fates;
  channel.period = spec.period;
  return channel;
}

// The safe reach at any angles of the palms [m]: the object is held while both |p| are at most
// this. −1 if there is none.
inline double safe_reach(const Spec& spec) {
  PerSide<AnglePair<double>> angles{};
  for (const std::size_t side : {left, right}) {
    const PalmSpec& palm = spec.palms[side];
    angles[side] = {PalmAngle<double>::at(palm.shallow), PalmAngle<double>::at(palm.steep)};
  }
  return safe_reach(model_of<double>(spec), angles);
}

namespace detail {

// The greatest distance of a contact from the pivot at which the sensor can read 0. On each side it
// extends to the nearest coordinate from which on the sensor reads another sign; the farther side
// counts.
inline double zero_zone_reach(const Spec& spec) {
  const auto tactile = tactile_of<double>(spec);
  double reach = 0;
  for (const double side : {-1.0, 1.0}) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spec.zone_count; ++i) {
      for (const double edge : {spec.zones[i].from * side, spec.zones[i].to * side}) {
        const bool leaves = edge >= 0 && tactile.sign((edge + 1e-9) * side) != Sign::zero;
        if (leaves) nearest = smaller(nearest, edge);
      }
    }
    reach = larger(reach, nearest);
  }
  return reach;
}

// The largest scheduled change of the rate of a robot's clock, upwards or (sense −1) downwards.
inline double fastest_gain(const Spec& spec, std::uint32_t side, double sense = 1) {
  double most = 0;
  for (std::size_t i = 0; i < spec.fault_count; ++i) {
    const FaultSpec& f = spec.faults[i];
    if (f.kind == FaultKind::clock_rate && f.side == side) most = larger(most, sense * f.rate);
  }
  return most;
}

// The time until a correction begins, at most [s].
inline double longest_reaction(const Spec& spec, double delay_s) {
  double turning = 0;  // the longer turn of a palm [s]
  for (const PalmSpec& palm : spec.palms) {
    turning = larger(turning, std::abs(palm.steep - palm.shallow) / palm.rate);
  }
  return spec.longest_period() + 2 * (delay_s + spec.beacon) + turning;
}

// The error of a robot's speed that does not change in a carry, and the variance of the errors that
// are random, on average over a time of at least `reaction` [m/s, m²/s²].
inline double lasting_error(const RobotSpec& robot) {
  return std::abs(robot.bias) + std::abs(robot.gain - 1) * robot.speed;
}
inline double random_variance(const RobotSpec& robot, double reaction) {
  const double of_gain = robot.gain_sd * robot.speed;
  return robot.noise * robot.noise + of_gain * of_gain +
         robot.white_noise * robot.white_noise / reaction;
}

// What a contact may have moved beyond its zero zone when a fault occurs [m], along the floor: the
// robots drift apart until its correction begins, and with different accelerations they come to
// rest in different ways from the nominal speed. Lasting errors add up; random ones count with one
// standard deviation of both robots together.
inline double off_zone_reach(const Spec& spec, double delay_s, double speed) {
  const double reaction = longest_reaction(spec, delay_s);
  double biases = 0;
  double variance = 0;
  for (const RobotSpec& robot : spec.robots) {
    biases += lasting_error(robot);
    variance += random_variance(robot, reaction);
  }
  const double unequal =
      std::abs(1 / spec.robots[left].acceleration - 1 / spec.robots[right].acceleration);
  return (biases + std::sqrt(variance)) * reaction + 0.5 * speed * speed * unequal;
}

}  // namespace detail

// The time bounds of the resilient algorithm in this scene.
inline ResilientTiming resilient_timing_of(const Spec& spec) {
  double braking = 0;
  double fast = 1;
  double slow = 1;
  double speed = 0;
  double error = 0;  // of one robot's speed: what lasts, and one standard deviation of the rest
  double stride = 1;
  const auto delay = double(channel_of(spec).longest());
  const double reaction = detail::longest_reaction(spec, delay * spec.period);
  for (const RobotSpec& robot : spec.robots) {
    braking = larger(braking, std::ceil(robot.correction / (robot.acceleration * spec.period)));
    const auto side = static_cast<std::uint32_t>(&robot - spec.robots);
    const double drift = 1 + robot.clock_drift;
    fast = larger(fast, drift + detail::fastest_gain(spec, side));
    slow = smaller(slow, drift - detail::fastest_gain(spec, side, -1));
    speed = larger(speed, robot.speed);
    stride = larger(stride, double(robot.stride));
    error = larger(
        error, detail::lasting_error(robot) + std::sqrt(detail::random_variance(robot, reaction)));
  }
  double flattest = 1;  // cosine of the steepest palm
  double half = spec.palms[left].reach();
  for (const PalmSpec& palm : spec.palms) {
    flattest = smaller(flattest, sin_cos(palm.steep).cos);
    half = smaller(half, palm.reach());
  }
  return ResilientTiming::of({
      .period = spec.period,
      .beacon = spec.beacon,
      .lease = spec.lease,
      .watchdog = spec.watchdog,
      .delay = delay,
      .braking = braking,
      .clock_ratio = fast / slow,
      .shift = speed * spec.period / flattest,
      .room = half - detail::zero_zone_reach(spec),
      .drift = error * spec.period / flattest,
      .off_zone = detail::off_zone_reach(spec, delay * spec.period, speed) / flattest,
      .stride = stride,
  });
}

}  // namespace palmbots
