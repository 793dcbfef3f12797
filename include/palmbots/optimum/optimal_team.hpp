// SPDX-License-Identifier: Apache-2.0
// The optimal controller: a reference with full information, which no robot can run.
//
// It reads the world itself: both contact coordinates, the separation, the wheel speeds and their
// noise. The wheels follow a table of costs (optimum/opening_policy.hpp). The palms bring the
// difference p_L − p_R to zero: where they differ, every change of the separation moves the contact
// on the shallow palm outward or the one on the steep palm inward, and so moves the difference
// towards the shallow side.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "palmbots/optimum/opening_policy.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

class OptimalTeam {
 public:
  LinkTotals link_totals{};
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = false;

  // The policy is kept by reference. `may_stop`: the robots may also stop travelling.
  OptimalTeam(const OpeningPolicy& policy, const Spec& spec, bool may_stop)
      : policy_(&policy), leader_(leader_of(spec)) {
    constexpr std::array moves{Move::hold, Move::away, Move::closer};
    if (!may_stop) {
      for (const Move move : moves) add(spec, {move, false}, {move, false});
      return;
    }
    // One robot is as fast as it can be, and the other one sets the opening speed. The roles change
    // when both are as fast as they can be.
    const double equal = fastest(spec, leader_) - fastest(spec, other(leader_));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const bool stops : {false, true}) {
      for (const Move move : moves) {
        add(spec, {Move::away, false}, {move, stops}, equal - rounding, infinity);
        add(spec, {move, stops}, {Move::closer, false}, -infinity, equal + rounding);
      }
    }
  }

  // Takes in the state of the world before step().
  template <class World, class AnyRobots>
  void look(const World& world, const AnyRobots& robots) {
    const auto& now = world.configuration();
    steer_palms(now, robots);
    const std::size_t follower = other(leader_);
    const double noise =
        double(robots.wheels[leader_].noise) - double(robots.wheels[follower].noise);
    const PerSide<double> speeds{double(robots.wheels[left].speed),
                                 double(robots.wheels[right].speed)};
    const double opening = speeds[leader_] - speeds[follower];
    bool is_first = true;
    double least = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      if (opening < options_[i].from || opening > options_[i].to) continue;
      PerSide<double> next{};
      for (const std::size_t side : {left, right}) {
        const double gain = double(robots.wheels[side].gain);
        next[side] = clamp(options_[i].goals[side], speeds[side] - gain, speeds[side] + gain);
      }
      const double cost =
          policy_->cost(double(now.separation), noise, next[leader_] - next[follower]);
      if (is_first || cost < least) {
        least = cost;
        chosen_ = i;
        is_first = false;
      }
    }
  }

  template <class Log>
  PerSide<Command> step(std::uint32_t, const PerSide<RobotObservation>&, Log&&) {
    PerSide<Command> commands = options_[chosen_].commands;
    for (const std::size_t side : {left, right}) commands[side].palm = palms_[side];
    return commands;
  }
  void fork(std::uint64_t) {}
  void close(std::uint32_t) {}
  char name(std::size_t) const { return ' '; }
  bool waits(std::size_t) const { return false; }
  MessageKind awaits(std::size_t) const { return MessageKind::none; }
  CorrectionActivity activity(std::size_t) const { return {}; }
  std::uint32_t next_decision_tick(std::uint32_t tick) const { return tick + 1; }

 private:
  // The difference keeps its direction until the turning palms are parallel. So its value at that
  // time decides: the side whose contact is then farther inward gets the shallow palm.
  template <class Real, class AnyRobots>
  void steer_palms(const Configuration<Real>& now, const AnyRobots& robots) {
    const double apart = double(now.palms[right].angle) - double(now.palms[left].angle);
    const double turn = double(robots.wrists[left].gain) + double(robots.wrists[right].gain);
    const double until = magnitude(apart) / turn * double(robots.period);
    const double rate = magnitude(double(robots.speeds[right]) - double(robots.speeds[left]));
    const double difference = double(now.contacts[left]) - double(now.contacts[right]) +
                              (apart > 0 ? rate : -rate) * until;
    if (difference == 0) return;
    const std::size_t inner = difference < 0 ? left : right;
    palms_[inner] = Palm::shallow;
    palms_[other(inner)] = Palm::steep;
  }

  struct Drive {
    Move move;
    bool stops;
  };
  // What both robots can be commanded, with the speeds that they then approach, along the direction
  // of travel [m/s].
  struct Option {
    PerSide<Command> commands;
    PerSide<double> goals;
    double from;  // opening speeds at which it may be chosen [m/s]
    double to;
  };
  static constexpr double rounding = 1e-6;  // of a speed [m/s]

  static double fastest(const Spec& spec, std::size_t side) {
    const RobotSpec& robot = spec.robots[side];
    return smaller(robot.speed + robot.correction, robot.max_speed);
  }

  // Adds an option in the order of the midpoint's speed: of equal costs the fastest is chosen.
  void add(const Spec& spec, Drive leader, Drive follower,
           double from = -std::numeric_limits<double>::infinity(),
           double to = std::numeric_limits<double>::infinity()) {
    Option option{};
    option.from = from;
    option.to = to;
    option.commands[leader_] = {Palm::steep, leader.move, leader.stops};
    option.commands[other(leader_)] = {Palm::steep, follower.move, follower.stops};
    for (const std::size_t side : {left, right}) {
      const RobotSpec& robot = spec.robots[side];
      const Command& command = option.commands[side];
      const double away = side == leader_ ? robot.correction : -robot.correction;
      const double move =
          command.move == Move::away ? away : (command.move == Move::closer ? -away : 0);
      const double goal = (command.stop ? 0 : robot.speed) + move;
      // A robot that stands has no noise in the simulation: that is not to be exploited.
      if (command.stop && goal == 0) return;
      option.goals[side] = clamp(goal, -robot.max_speed, robot.max_speed);
    }
    std::size_t place = count_++;
    const auto speed = [](const Option& one) { return one.goals[left] + one.goals[right]; };
    for (; place > 0 && speed(options_[place - 1]) < speed(option); --place) {
      options_[place] = options_[place - 1];
    }
    options_[place] = option;
  }

  const OpeningPolicy* policy_;
  std::size_t leader_;
  std::array<Option, 12> options_{};
  std::size_t count_ = 0;
  std::size_t chosen_ = 0;
  PerSide<Palm> palms_{Palm::steep, Palm::steep};
};

static_assert(Team<OptimalTeam>);

// What the teams of one scene share.
struct OptimalController {
  OpeningPolicy policy;
  bool may_stop = false;
};

}  // namespace palmbots
