// SPDX-License-Identifier: Apache-2.0
// The optimal controller: a reference with full information, which no robot can run.
//
// It reads the world itself: both contact coordinates, the separation, the wheel speeds and their
// noise. The wheels follow a table of costs (optimum/opening_policy.hpp), and the palms bring the
// difference p_L − p_R to zero.
#pragma once

#include <cstdint>

#include "palmbots/optimum/opening_policy.hpp"
#include "palmbots/optimum/reference_team.hpp"

namespace palmbots {

class OptimalTeam : public ReferenceTeam {
 public:
  // The policy is kept by reference. `may_stop`: the robots may also stop travelling.
  OptimalTeam(const OpeningPolicy& policy, const Spec& spec, bool may_stop)
      : ReferenceTeam(spec, may_stop), policy_(&policy) {}

  // Takes in the state of the world before step().
  template <class World, class AnyRobots>
  void look(const World& world, const AnyRobots& robots) {
    const auto& now = world.configuration();
    PerSide<double> speeds{};
    PerSide<double> angles{};
    PerSide<double> contacts{};
    PerSide<double> turns{};
    for (const std::size_t side : {left, right}) {
      speeds[side] = double(robots.wheels[side].speed);
      angles[side] = double(now.palms[side].angle);
      contacts[side] = double(now.contacts[side]);
      turns[side] = double(robots.wrists[side].gain);
    }
    const double rate = magnitude(double(robots.speeds[right]) - double(robots.speeds[left]));
    steer_palms(angles, contacts, rate, turns, double(robots.period), palms_);
    const double noise =
        double(robots.wheels[leader()].noise) - double(robots.wheels[follower()].noise);
    commands_ = cheapest(speeds, [&](double opening) {
      return policy_->cost(double(now.separation), noise, opening);
    });
    for (const std::size_t side : {left, right}) commands_[side].palm = palms_[side];
  }

  template <class Log>
  PerSide<Command> step(std::uint32_t, const PerSide<RobotObservation>&, Log&&) {
    return commands_;
  }

 private:
  const OpeningPolicy* policy_;
  PerSide<Command> commands_{};
  PerSide<Palm> palms_{Palm::steep, Palm::steep};
};

static_assert(Team<OptimalTeam>);

// What the teams of one scene share.
struct OptimalController {
  OpeningPolicy policy;
  bool may_stop = false;
};

}  // namespace palmbots
