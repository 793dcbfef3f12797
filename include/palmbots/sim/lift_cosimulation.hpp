// SPDX-License-Identifier: Apache-2.0
// Co-simulation of a job that begins or ends on the floor or on a stand: its robots
// (sim/lift_robots.hpp) without a world, for an external simulator. The protocol is that of
// `CoSimulation`; the simulator moves the arms as well.
#pragma once

#include <utility>

#include "palmbots/sim/cosimulation.hpp"
#include "palmbots/sim/lift_robots.hpp"

namespace palmbots {

template <class Inner, class Table = Lifting>
class LiftCoSimulation : public LiftRobots<Inner, TraceRecorder, Table> {
  using Base = LiftRobots<Inner, TraceRecorder, Table>;

 public:
  LiftCoSimulation(const Spec& spec, std::uint64_t seed, Inner inner, double slack,
                   const WorldObservation& first)
      : Base(spec, seed, std::move(inner), true), slack_(slack), observation_(first) {
    for (const std::size_t side : {left, right})
      set_points_[side] = PalmAngle<double>::at(first_angle(spec, side));
    if (spec.begins_on == StandsOn::palms)
      this->hold_at(0.5 * (first.heights[left] + first.heights[right]));
    metrics_.reason = first.reason;
    robots_.midpoint = first.midpoint;
    world_.observe(first);
    this->note_phases(first.moved);
    if (metrics_.reason == DropReason::none) return;
    this->drop();
    finish();
  }

  // The motion of wheels and wrists until the next tick; `heights` has that of the arms.
  Actuation<double> step_controllers() {
    recorder_.make_room();
    const PerSide<RobotObservation> sensed =
        this->observe(observation_.pressed, observation_.touched, observation_.wrists, slack_);
    if (this->notice(sensed)) this->think([&](const SentMessage& p) { recorder_.message(p); });
    this->note_phases(observation_.moved);
    if (tick_ % block_ticks == 0) this->collect();
    this->add_statistics();
    this->change_biases();
    this->let_palms_fall();
    const Actuation<double> act = actuate(robots_, set_points_, this->noise());
    for (const std::size_t side : {left, right}) {
      set_points_[side].angle = act.angles[side];
      height_[side] += this->rise(side, act.angles[side]);
    }
    recorder_.before(*this, sensed);
    this->record(observation_.heights);
    return act;
  }

  // Takes in the world at the end of the tick.
  void observe(const WorldObservation& observation) {
    for (const std::size_t side : {left, right}) {
      this->count_travel(side, observation.rolled[side] - observation_.rolled[side]);
      metrics_.stalled_ticks[side] += observation.stalls[side] ? 1 : 0;
    }
    observation_ = observation;
    world_.observe(observation);
    robots_.midpoint = observation.midpoint;
    recorder_.after(*this);
    this->end_tick(observation.reason, observation.fraction, observation.stands);
    if (this->done()) finish();
  }

  const ObservedWorld& world() const { return world_; }
  double object_sine() const { return observation_.object_sine; }
  double moved() const { return observation_.moved; }

 private:
  using Base::observe, Base::height_, Base::metrics_, Base::recorder_, Base::robots_;
  using Base::tick_;

  void finish() {
    recorder_.make_room();
    recorder_.end(*this);
    this->record(observation_.heights);
  }

  double slack_;
  WorldObservation observation_;
  ObservedWorld world_;
  PerSide<PalmAngle<double>> set_points_{};  // of the wrist motors
};

}  // namespace palmbots
