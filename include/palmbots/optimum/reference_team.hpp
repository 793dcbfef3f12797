// SPDX-License-Identifier: Apache-2.0
// What the references have in common: controllers that know more than a robot can, and so show what
// more knowledge would be worth. No robot can run them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "palmbots/sim/build.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

// Chooses the commands of the wheels among all that the robots can be commanded.
class ReferenceTeam {
 public:
  LinkTotals link_totals{};
  static constexpr bool half_moves = false;
  static constexpr bool expects_turns = false;

  void fork(std::uint64_t) {}
  void close(std::uint32_t) {}
  char name(std::size_t) const { return ' '; }
  bool waits(std::size_t) const { return false; }
  MessageKind awaits(std::size_t) const { return MessageKind::none; }
  CorrectionActivity activity(std::size_t) const { return {}; }
  std::uint32_t next_decision_tick(std::uint32_t tick) const { return tick + 1; }

 protected:
  // `may_stop`: the robots may also stop travelling.
  ReferenceTeam(const Spec& spec, bool may_stop) : leader_(leader_of(spec)) {
    constexpr std::array moves{Move::hold, Move::away, Move::closer};
    for (const std::size_t side : {left, right}) {
      gains_[side] = spec.robots[side].acceleration * spec.period;
    }
    if (!may_stop) {
      for (const Move move : moves) add(spec, {move, false}, {move, false});
      return;
    }
    // One robot is as fast as it can be, and the other one sets the opening speed. The roles change
    // when both are as fast as they can be.
    const double equal = fastest(spec, leader_) - fastest(spec, follower());
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const bool stops : {false, true}) {
      for (const Move move : moves) {
        add(spec, {Move::away, false}, {move, stops}, equal - rounding, infinity);
        add(spec, {move, stops}, {Move::closer, false}, -infinity, equal + rounding);
      }
    }
  }

  std::size_t leader() const { return leader_; }
  std::size_t follower() const { return other(leader_); }

  // The commanded opening speed, leading robot minus the other one [m/s].
  double opening(const PerSide<double>& speeds) const {
    return speeds[leader_] - speeds[follower()];
  }

  // The commands after which cost(opening speed at the end of the next tick) is least; of equal
  // costs, those with the fastest midpoint. `speeds` are the commanded speeds that the wheels have
  // reached [m/s].
  template <class Cost>
  PerSide<Command> cheapest(const PerSide<double>& speeds, Cost cost) const {
    const double now = opening(speeds);
    const Option* best = nullptr;
    double least = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Option& option = options_[i];
      if (now < option.from || now > option.to) continue;
      PerSide<double> next{};
      for (const std::size_t side : {left, right}) {
        next[side] =
            clamp(option.goals[side], speeds[side] - gains_[side], speeds[side] + gains_[side]);
      }
      const double its = cost(opening(next));
      if (best == nullptr || its < least) {
        least = its;
        best = &option;
      }
    }
    return (best == nullptr ? options_[0] : *best).commands;
  }

 private:
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

  // Adds an option in the order of the midpoint's speed.
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

  std::size_t leader_;
  PerSide<double> gains_{};  // largest change of a commanded speed in a tick [m/s]
  std::array<Option, 12> options_{};
  std::size_t count_ = 0;
};

// The palms that bring the difference p_L − p_R to zero: where they differ, every change of the
// separation moves the contact on the shallow palm outward or the one on the steep palm inward. The
// difference keeps its direction until the turning palms are parallel, so its value at that time
// decides. `rate` is the opening speed without its sign [m/s], and `turns` are the largest turns of
// the palms in a tick [rad].
inline void steer_palms(const PerSide<double>& angles, const PerSide<double>& contacts, double rate,
                        const PerSide<double>& turns, double period, PerSide<Palm>& palms) {
  const double apart = angles[right] - angles[left];
  const double until = magnitude(apart) / (turns[left] + turns[right]) * period;
  const double difference = contacts[left] - contacts[right] + (apart > 0 ? rate : -rate) * until;
  if (difference == 0) return;
  const std::size_t inner = difference < 0 ? left : right;
  palms[inner] = Palm::shallow;
  palms[other(inner)] = Palm::steep;
}

}  // namespace palmbots
