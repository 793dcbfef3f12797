// SPDX-License-Identifier: Apache-2.0
// The opening problem: keep the separation of the robots between the two ends of their palms.
//
// Closing raises p_L + p_R and opening lowers it, whichever contact slides. No controller can
// therefore hold the object once the separation leaves the interval in which some palm angles and
// some contacts on both palms close the loop. What remains of a carry is one coordinate x (the
// separation), the commanded opening speed c under the acceleration limit, and the noise n of the
// opening speed, an Ornstein–Uhlenbeck process: dx = (c + bias + n) dt. Speeds are those of the
// leading robot minus those of the other one. Source: docs/theory/optimum.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "palmbots/sim/build.hpp"

namespace palmbots {

// Which speeds the robots may command. The first: nominal speed, plus equal and opposite
// corrections. The second: any speed from the correction backwards to nominal plus correction.
enum class AdmissibleSpeeds : std::uint8_t { corrections, stopping };

// The opening problem of a scene, in SI units.
struct OpeningProblem {
  double lowest = 0;    // separation beyond which the object falls [m]
  double highest = 0;   // [m]
  double start = 0;     // [m]
  double slowest = 0;   // least commanded opening speed [m/s]
  double fastest = 0;   // [m/s]
  double change = 0;    // largest change of the commanded speed in a decision [m/s]
  double bias = 0;      // of the opening speed [m/s]
  double noise = 0;     // stationary standard deviation of the opening speed [m/s]
  double memory = 0;    // share of the noise that remains after a decision
  double period = 0;    // of decisions [s]
  double duration = 0;  // of a carry at nominal speed [s]
  double distance = 0;  // [m]
  // Largest commanded speed of the follower [0] and the leader [1], plus the bias of the midpoint
  // [m/s].
  PerSide<double> most{};
  // Drop probability that a metre of progress is worth [1/m]; 0: progress does not count.
  double price = 0;

  // The greatest speed of the midpoint at a commanded opening speed [m/s].
  double progress(double opening) const {
    return smaller(most[0] + 0.5 * opening, most[1] - 0.5 * opening);
  }
};

namespace detail {

// The widest (sense +1) or the narrowest (−1) separation at which some palm angles, with some
// contacts on both palms, close the loop [m]. The separation is concave in the contacts, and its
// extremes lie at ends of the palms or, where the object is level, between them.
inline double extreme_separation(const Spec& spec, double sense) {
  constexpr int parts = 8;
  const Model<double> model = model_of<double>(spec);
  double best = -sense * std::numeric_limits<double>::infinity();
  Configuration<double> at{};
  const auto part = [](double from, double to, int i) { return from + (to - from) * i / parts; };
  for (int i = 0; i < (parts + 1) * (parts + 1) * (parts + 1) * (parts + 1); ++i) {
    int rest = i;
    for (const std::size_t side : {left, right}) {
      const PalmSpec& palm = spec.palms[side];
      const double half = model.reach[side];
      at.palms[side] = PalmAngle<double>::at(part(palm.shallow, palm.steep, rest % (parts + 1)));
      rest /= parts + 1;
      at.contacts[side] = part(-half, half, rest % (parts + 1));
      rest /= parts + 1;
    }
    const double found = closing_separation(at, model.offset, model.object.width);
    if (sense * (found - best) > 0) best = found;
  }
  return best;
}

}  // namespace detail

// The opening problem of a carry. A decision takes a control period, or as many of them as fit into
// a hundredth of a second. Both robots must have the same noise_tau where both have noise.
inline OpeningProblem opening_problem_of(const Spec& spec, AdmissibleSpeeds speeds) {
  OpeningProblem problem;
  const std::size_t leader = leader_of(spec);
  const RobotSpec& ahead = spec.robots[leader];
  const RobotSpec& behind = spec.robots[other(leader)];
  const Model<double> model = model_of<double>(spec);
  problem.lowest = detail::extreme_separation(spec, -1);
  problem.highest = detail::extreme_separation(spec, 1);
  problem.start = configuration_of(spec, model).separation;
  problem.period = spec.period * larger(1.0, std::floor(0.01 / spec.period + 1e-9));
  const double acceleration = ahead.acceleration + behind.acceleration;
  problem.change = acceleration * problem.period;
  problem.bias = ahead.bias - behind.bias;
  problem.noise = std::sqrt(ahead.noise * ahead.noise + behind.noise * behind.noise);
  problem.memory =
      memory_of<double>(problem.period, ahead.noise > 0 ? ahead.noise_tau : behind.noise_tau);
  const auto limited = [](const RobotSpec& robot, double speed) {
    return clamp(speed, -robot.max_speed, robot.max_speed);
  };
  const auto most = [&](const RobotSpec& robot) {
    return limited(robot, robot.speed + robot.correction);
  };
  const auto least = [&](const RobotSpec& robot) {
    const double travel = speeds == AdmissibleSpeeds::corrections ? robot.speed : 0;
    return limited(robot, travel - robot.correction);
  };
  const double together = 0.5 * (ahead.bias + behind.bias);  // bias of the midpoint
  problem.most = {most(behind) + together, most(ahead) + together};
  problem.slowest = least(ahead) - most(behind);
  problem.fastest = most(ahead) - least(behind);
  const double speed = 0.5 * (ahead.speed + behind.speed);
  // Half of the time of acceleration is lost.
  problem.duration = spec.distance / larger(speed + together, 1e-3) + speed / acceleration;
  problem.distance = spec.distance;
  return problem;
}

}  // namespace palmbots
