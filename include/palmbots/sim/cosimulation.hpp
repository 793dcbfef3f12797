// SPDX-License-Identifier: Apache-2.0
// Co-simulation: both robots of a carry (sensors, controllers, radio, wheels, wrists, metrics and
// trace) without a world, for an external simulator that moves the object, such as a dynamics
// engine.
//
// One tick takes two calls. `step_controllers` reads the sensors at the last observed state of the
// world, lets the team decide and returns the motion of wheels and wrists until the next tick.
// `observe` takes in the resulting state of the world. The external simulator moves in between.
// Driven with the quasistatic world, the result equals `Carry` to the last bit; a test checks this.
// Bumps, which shift contacts, belong to the quasistatic world and are left out.
#pragma once

#include <cstdint>
#include <utility>

#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/robot_pair.hpp"

namespace palmbots {

// The observed state of a world at the end of a tick.
struct WorldObservation {
  PerSide<double> contacts{};           // p of the contact vertices [m]
  PerSide<double> lift{};               // of the contact vertices above their palms [m]
  PerSide<double> touched{};            // p of the point where each palm is pressed [m]
  PerSide<bool> pressed{{true, true}};  // hard enough to close a switch
  PerSide<double> palms{};              // angles of the palms in the world [rad]
  PerSide<double> wrists{};             // angles as the robots measure them [rad]
  double separation = 0;                // of the pivots [m]
  double midpoint = 0;                  // of the pivots, from where it started [m]
  double rise = 0;                      // of the right contact vertex over the left one [m]
  PerSide<int> motion{};  // over the tick: contacts slide down −1, stick 0, slide up +1
  DropReason reason = DropReason::none;
  double fraction = 1;  // share of the tick after which the carry ended
  // Of a job that begins or ends on the floor.
  PerSide<double> heights{};  // of the pivots over the floor [m]
  PerSide<double> rolled{};   // by the wheels towards +x, since any start [m]
  double moved = 0;           // of the COM towards +x since the start [m]
  double object_sine = 0;     // of the angle of the object over the floor
  bool stands = false;        // the object is on the floor alone
  PerSide<bool> stalls{};     // wheels of each robot stalled in the tick
  double turn = 0;            // of a pipe, whose contacts do not show it [rad]
};

// The observation, with the interface of a world for the recorder.
class ObservedWorld {
 public:
  void observe(const WorldObservation& observation) {
    for (const std::size_t side : {left, right}) {
      configuration_.contacts[side] = observation.contacts[side];
      configuration_.lift[side] = observation.lift[side];
      configuration_.palms[side].angle = observation.palms[side];
      last_.motion[side] = static_cast<SlipDirection>(observation.motion[side]);
    }
    configuration_.separation = observation.separation;
    contact_vector_.dy = observation.rise;
    turn_ = observation.turn;
  }
  const Configuration<double>& configuration() const { return configuration_; }
  const ContactVector<double>& contact_vector() const { return contact_vector_; }
  const Advance<double>& last() const { return last_; }
  double tilt(double width) const {
    return width > 0 ? std::asin(contact_vector_.dy / width) : turn_;
  }

 private:
  Configuration<double> configuration_{};
  ContactVector<double> contact_vector_{};
  double turn_ = 0;
  Advance<double> last_{};
};

// One carry whose world is moved by an external simulator.
template <class Team>
class CoSimulation : public RobotPair<double, Team> {
  using Base = RobotPair<double, Team>;

 public:
  // `slack` [rad]: a palm counts as at its target if its wrist is within this of the angle last
  // commanded.
  CoSimulation(const Spec& spec, std::uint64_t seed, Team team, double slack,
               const WorldObservation& first)
      : Base(spec, seed, std::move(team)), slack_(slack), observation_(first) {
    for (const std::size_t side : {left, right}) {
      set_points_[side] = PalmAngle<double>::at(spec.palms[side].steep);
    }
    metrics_.reason = first.reason;
    world_.observe(first);
    robots_.midpoint = first.midpoint;
    if (metrics_.reason == DropReason::none) return;
    drop();
    finish();
  }

  // The observations of the robots at the last observed state of the world.
  PerSide<RobotObservation> sense() const {
    PerSide<double> touched{};
    for (const std::size_t side : {left, right}) {
      // Where the pressure is too low no switch is closed, which reads as 0.
      touched[side] = observation_.pressed[side] ? observation_.touched[side] : 0.0;
    }
    const PerSide<Sign> signs = read(touched);
    PerSide<RobotObservation> sensed{};
    for (const std::size_t side : {left, right}) {
      const double off = observation_.wrists[side] - robots_.goal_angle[side];
      sensed[side] = {signs[side], off <= slack_ && off >= -slack_};
    }
    return sensed;
  }

  // The motion of wheels and wrists until the next tick.
  Actuation<double> step_controllers() {
    recorder_.make_room();
    const PerSide<RobotObservation> sensed = sense();
    if (notice(sensed)) think([&](const SentMessage& p) { recorder_.message(p); });
    if (tick_ % block_ticks == 0) collect();
    const PerSide<double> random = this->noise();
    statistics_.add(observation_.touched);
    change_biases();
    this->let_palms_fall();
    const Actuation<double> act = actuate(robots_, set_points_, random);
    for (const std::size_t side : {left, right}) set_points_[side].angle = act.angles[side];
    recorder_.before(*this, sensed);
    return act;
  }

  // Takes in the world at the end of the tick.
  void observe(const WorldObservation& observation) {
    const double before = observation_.midpoint;
    observation_ = observation;
    world_.observe(observation);
    robots_.midpoint = observation.midpoint;
    recorder_.after(*this);
    finish_tick(observation.reason, observation.fraction, before);
    if (this->done()) finish();
  }

  TraceRecorder& recorder() { return recorder_; }
  const ObservedWorld& world() const { return world_; }

 private:
  using Base::collect, Base::drop, Base::finish_tick, Base::notice, Base::change_biases;
  using Base::metrics_, Base::robots_, Base::seed_, Base::statistics_, Base::think, Base::tick_;
  using Base::read;

  void finish() {
    recorder_.make_room();
    recorder_.end(*this);
  }

  double slack_;
  TraceRecorder recorder_;
  WorldObservation observation_;
  ObservedWorld world_;
  PerSide<PalmAngle<double>> set_points_{};  // of the wrist motors
};

}  // namespace palmbots
