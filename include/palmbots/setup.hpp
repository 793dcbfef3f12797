// What a spec becomes: the parts of a carry in its own precision.
#pragma once

#include "palmbots/ends.hpp"
#include "palmbots/robot.hpp"
#include "palmbots/spec.hpp"

namespace palmbots {

template <class Real>
Rig<Real> rig_of(const Spec& spec) {
  Rig<Real> rig{};
  rig.load = {Real(spec.width), Real(spec.com_left), Real(spec.com_right), Real(spec.com_height),
              Real(spec.slope)};
  rig.moments = Moments<Real>::of(rig.load);
  rig.outline.count = spec.outline.count;
  rig.outline.contact = spec.outline.contact;
  for (std::size_t i = 0; i < spec.outline.count; ++i) {
    const Vertex<double>& v = spec.outline.vertices[i];
    rig.outline.vertices[i] = {{Real(v.along[left]), Real(v.along[right])}, Real(v.height)};
  }
  for (const std::size_t side : {left, right}) {
    rig.clear[side] = clear_cone(rig.outline, side);
    rig.offset[side] = Real(spec.palms[side].offset);
    rig.half_length[side] = Real(0.5 * spec.palms[side].length);
    rig.friction[side] = Real(spec.palms[side].friction);
  }
  rig.safe_reach = Real(spec.safe_reach);
  return rig;
}

// Both palms steep, the contacts where the spec starts them, the robots where the object makes them.
template <class Real>
Stance<Real> stance_of(const Spec& spec, const Rig<Real>& rig) {
  Stance<Real> stance{};
  for (const std::size_t side : {left, right}) {
    stance.palms[side] = PalmAngle<Real>::at(Real(spec.palms[side].steep));
    stance.contacts[side] = Real(spec.start[side]);
  }
  stance.separation = closing_separation(stance, rig.offset, rig.load.width);
  return stance;
}

// What is left of a first-order lag after a period.
template <class Real>
Real memory_of(double period, double lag) {
  return lag > 0 ? exp_minus(Real(period / lag)) : Real(0);
}

template <class Real>
Wheels<Real> wheels_of(const RobotSpec& robot, double period) {
  const Real memory = memory_of<Real>(period, robot.noise_tau);
  const Real drive = Real(robot.noise) * std::sqrt(Real(1) - memory * memory);
  return {Real(robot.acceleration * period), Real(robot.max_speed), Real(robot.bias), memory,
          drive};
}

template <class Real>
Wrist<Real> wrist_of(const PalmSpec& palm, double period) {
  return {Real(palm.steep), Real(palm.shallow), Real(palm.rate * period)};
}

inline std::size_t leader_of(const Spec& spec) { return spec.direction > 0 ? right : left; }

// Both robots before they start.
template <class Real>
Robots<Real> robots_of(const Spec& spec, std::uint64_t seed) {
  Robots<Real> robots{};
  robots.travel_sense = Real(spec.direction);
  robots.period = Real(spec.period);
  // The object goes with the mean of the two robots; a push is an acceleration in units of g.
  if (spec.inertia != 0) robots.inertia = Real(0.5 / (spec.period * standard_gravity));
  robots.push_memory = memory_of<Real>(spec.period, spec.inertia_lag);
  robots.push_share = Real(1) - robots.push_memory;
  // Noise is under way when the carry starts: its first value has its lasting spread.
  const Words words = draw(seed, ~0U, Stream::noise);
  for (const std::size_t side : {left, right}) {
    robots.wheels[side] = wheels_of<Real>(spec.robots[side], spec.period);
    robots.wrists[side] = wrist_of<Real>(spec.palms[side], spec.period);
    robots.wheels[side].noise =
        Real(spec.robots[side].noise) * unit_noise<Real>(words[side == leader_of(spec) ? 0 : 1]);
  }
  return robots;
}

inline Channel channel_of(const Spec& spec) {
  Channel channel = Channel::of(spec.latency, spec.jitter, spec.loss, spec.period);
  channel.duplicate_words = Channel::words_of(spec.duplicate);
  channel.corrupt_words = Channel::words_of(spec.corruption);
  channel.reorders = spec.reorders != 0;
  channel.burst_share = spec.burst_share;
  channel.burst_rate = spec.period / ((1 - spec.burst_share) * spec.burst_mean);
  channel.airtime_ticks = spec.airtime / spec.period;
  channel.outage_count = spec.outage_count;
  for (std::size_t i = 0; i < spec.outage_count; ++i) {
    const OutageSpec& outage = spec.outages[i];
    const auto tick = [&](double s) { return static_cast<std::uint32_t>(s / spec.period + 0.5); };
    channel.outages[i] = {outage.sender, tick(outage.from), tick(outage.to)};
  }
  channel.mishap_count = spec.mishap_count;
  for (std::size_t i = 0; i < spec.mishap_count; ++i) {
    const MishapSpec& m = spec.mishaps[i];
    channel.mishaps[i] = {m.sender, m.message, static_cast<Fate>(m.fate),
                          static_cast<std::uint32_t>(m.late / spec.period + 0.5)};
  }
  return channel;
}

}  // namespace palmbots
