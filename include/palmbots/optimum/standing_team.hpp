// SPDX-License-Identifier: Apache-2.0
// References whose robots stand while the noise is unfavourable: they show that no noise is a limit
// for a controller that reads it, because a robot that stands has none (robot/actuators.hpp).
//
// In each tick every robot gets, of a few commands, the one with the best prospect: the progress of
// the midpoint in the near future, less what the contacts are then off centre. The near future is
// predicted from both contact coordinates, the commanded speeds and the noise of each robot.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "palmbots/optimum/reference_team.hpp"

namespace palmbots {

// What distinguishes the references that stand.
struct StandingFeedback {
  // The robots let themselves be moved by noise alone: commanded speeds never exceed what one tick
  // of acceleration reaches. So they stand within a tick, and travel slowly.
  bool creeps = false;
};

class StandingTeam : public ReferenceTeam {
 public:
  StandingTeam(const StandingFeedback& feedback, const Spec& spec)
      : ReferenceTeam(spec, true), spec_(spec), creeps_(feedback.creeps) {
    for (const std::size_t side : {left, right}) {
      const RobotSpec& robot = spec.robots[side];
      half_[side] = spec.palms[side].reach();
      memory_[side] = memory_of<double>(spec.period, robot.noise_tau);
    }
  }

  // Takes in the state of the world before step().
  template <class World, class AnyRobots>
  void look(const World& world, const AnyRobots& robots) {
    const auto& now = world.configuration();
    PerSide<double> turns{};
    for (const std::size_t side : {left, right}) {
      contacts_[side] = double(now.contacts[side]);
      angles_[side] = double(now.palms[side].angle);
      speeds_[side] = double(robots.wheels[side].speed);
      noises_[side] = double(robots.wheels[side].noise);
      turns[side] = double(robots.wrists[side].gain);
    }
    const double rate = magnitude(double(robots.speeds[right]) - double(robots.speeds[left]));
    const double apart = magnitude(contacts_[left] - contacts_[right]);
    // Robots that creep stand while the palms turn, so they turn them seldom.
    if (!creeps_ || apart > 0.25 * smaller(half_[left], half_[right])) {
      steer_palms(angles_, contacts_, creeps_ ? 0 : rate, turns, spec_.period, palms_);
    }
  }

  template <class Log>
  PerSide<Command> step(std::uint32_t, const PerSide<RobotObservation>& sensed, Log&&) {
    PerSide<Command> best{};
    if (!creeps_ || (sensed[left].palm_at_target && sensed[right].palm_at_target)) {
      double most = -std::numeric_limits<double>::infinity();
      for (const Command& ahead : choices(leader())) {
        const double there = travel(leader(), ahead);
        for (const Command& behind : choices(follower())) {
          const double here = travel(follower(), behind);
          const double found = 0.5 * (here + there) - cost(there - here);
          if (found <= most) continue;
          most = found;
          best[leader()] = ahead;
          best[follower()] = behind;
        }
      }
    } else {
      for (Command& command : best) command.stop = true;
    }
    for (const std::size_t side : {left, right}) best[side].palm = palms_[side];
    return best;
  }

 private:
  static constexpr double horizon = 0.15;  // of the prediction [s]; a tick for robots that creep
  static constexpr double weight = 20;     // of a contact off centre [1/m]
  static constexpr double steepness = 16;  // of its growth towards the ends of the palm

  // The commands of a robot. The first one lets it stand.
  std::array<Command, 6> choices(std::size_t side) const {
    constexpr Palm palm = Palm::steep;  // replaced later
    constexpr Command stand{palm, Move::hold, true};
    if (!creeps_) {
      return {stand,
              {palm, Move::away, true},
              {palm, Move::closer, true},
              {palm, Move::hold, false},
              {palm, Move::away, false},
              {palm, Move::closer, false}};
    }
    const bool ahead = side == leader();
    const Move forward = ahead ? Move::away : Move::closer;
    const Move back = ahead ? Move::closer : Move::away;
    const Command loose{palm, speeds_[side] > 0 ? back : forward, true};
    return {stand, loose, loose, loose, loose, loose};
  }

  // What a robot travels in the near future with a command [m].
  double travel(std::size_t side, const Command& command) const {
    const RobotSpec& robot = spec_.robots[side];
    const double away = side == leader() ? robot.correction : -robot.correction;
    const double move =
        command.move == Move::away ? away : (command.move == Move::closer ? -away : 0);
    const double goal =
        clamp((command.stop ? 0 : robot.speed) + move, -robot.max_speed, robot.max_speed);
    const double time = creeps_ ? spec_.period : horizon;
    const double needed = magnitude(goal - speeds_[side]) / robot.acceleration;
    const double ramp = smaller(needed, time);
    const double reached = clamp(goal, speeds_[side] - robot.acceleration * ramp,
                                 speeds_[side] + robot.acceleration * ramp);
    const double driven = 0.5 * (speeds_[side] + reached) * ramp + goal * (time - ramp);
    const bool stands = command.stop && goal == 0;
    // A ramp of one tick ends before the robot moves.
    const double moving = !stands ? time : (needed <= spec_.period * 1.0001 ? 0 : ramp);
    if (moving == 0) return 0;
    return driven + (robot.bias + memory_[side] * noises_[side]) * moving;
  }

  // What the contacts cost after the separation has changed by `change` [m]. Closing raises the
  // contact on the shallower palm, and opening lowers that on the steeper one; with equal palms, both
  // are taken to move by half.
  double cost(double change) const {
    const double steeper = angles_[left] - angles_[right];
    const double of_left = steeper == 0 ? 0.5 : ((change > 0) == (steeper > 0) ? 1 : 0);
    const PerSide<double> moved{of_left * change, (1 - of_left) * change};
    double sum = 0;
    for (const std::size_t side : {left, right}) {
      const double after = contacts_[side] - moved[side];
      const double share = after / half_[side];
      sum += after * after * (1 + steepness * share * share);
    }
    return weight * sum;
  }

  Spec spec_;
  bool creeps_;
  PerSide<double> half_{};                                       // of the palms' lengths [m]
  PerSide<double> memory_{};                                     // e^(−T/τ)
  PerSide<double> contacts_{}, angles_{}, speeds_{}, noises_{};  // [m], [rad], [m/s], [m/s]
  PerSide<Palm> palms_{Palm::steep, Palm::steep};
};

static_assert(Team<StandingTeam>);

}  // namespace palmbots
