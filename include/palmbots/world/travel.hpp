// SPDX-License-Identifier: Apache-2.0
// How palms and ground move in one step.
#pragma once

#include "palmbots/mechanics/feature_contact.hpp"

namespace palmbots {

// The palms at the start of a step, and what changes in it, linearly.
struct PalmTravel {
  Vec pivot;
  Vec by;
  double angle;
  double turn;
  double goal;  // angle + turn, without its rounding
};

struct Travel {
  PerSide<PalmTravel> palms;

  // Palms that move by `by` and turn to `goals`.
  static constexpr Travel of(const PerSide<Vec>& pivots, const PerSide<double>& angles,
                             const PerSide<Vec>& by, const PerSide<double>& goals) {
    Travel travel{};
    for (const std::size_t side : {left, right}) {
      const double turn = goals[side] - angles[side];
      travel.palms[side] = {pivots[side], by[side], angles[side], turn, goals[side]};
    }
    return travel;
  }

  constexpr Frame frame(Carrier carrier, double t) const {
    if (carrier == Carrier::ground) return {1.0, {0.0, 0.0}, 0.0, 0.0, 1.0, {0.0, 0.0}, 0.0};
    const std::size_t side = carrier == Carrier::left_palm ? left : right;
    const PalmTravel& palm = palms[side];
    const double angle = t == 1.0 ? palm.goal : palm.angle + t * palm.turn;
    const SinCos<double> turned = sin_cos(angle);
    return {outward<double>(side),
            palm.pivot + palm.by * t,
            angle,
            turned.sin,
            turned.cos,
            palm.by,
            palm.turn};
  }
  // The frames of all carriers at one instant of the step.
  constexpr std::array<Frame, 3> frames(double t) const {
    return {frame(Carrier::left_palm, t), frame(Carrier::right_palm, t), frame(Carrier::ground, t)};
  }
  constexpr bool turns() const { return palms[left].turn != 0.0 || palms[right].turn != 0.0; }
};

using Frames = std::array<Frame, 3>;

// How fast a point of a surface moves near a body of this size, at most.
inline double pace_of(const Frames& frames, double size) {
  double pace = 0.0;
  for (const Frame& frame : frames)
    pace = larger(pace, length(frame.velocity) + magnitude(frame.rate) * size);
  return pace;
}

// The frames a little later, or earlier.
inline Frames moved(const Frames& frames, double by) {
  Frames then = frames;
  for (Frame& frame : then) {
    frame.origin = frame.origin + frame.velocity * by;
    frame.angle = frame.angle + frame.rate * by;
    const SinCos<double> turned = sin_cos(frame.angle);
    frame.sin = turned.sin;
    frame.cos = turned.cos;
  }
  return then;
}

}  // namespace palmbots
