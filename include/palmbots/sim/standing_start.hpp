// SPDX-License-Identifier: Apache-2.0
// An object that stands on the floor or on a stand, on its two contact vertices, between two palms
// whose inner ends are at the same height.
#pragma once

#include <string>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// Distance between the object and the inner ends where a job begins on the floor [m].
inline constexpr double approach_distance = 0.03;
// The same of the robot that stands aside while its partner works alone [m].
inline constexpr double aside_distance = 1.0;

// Whether one robot does the job and the other one stands aside.
inline bool is_alone(const Spec& spec) {
  return uses_floor(spec) && spec.docking == Docking::alone;
}

// Whether one robot hands the object to the other one.
inline bool hands_over(const Spec& spec) {
  return uses_floor(spec) && spec.docking == Docking::hand_over;
}

// Whether one palm at a time carries the object, so that controllers have nothing to do.
inline bool on_one_palm(const Spec& spec) { return is_alone(spec) || hands_over(spec); }

// The angle of a palm where a job begins [rad]. A robot that picks up alone docks with a shallow palm.
inline double first_angle(const Spec& spec, std::size_t side) {
  const PalmSpec& palm = spec.palms[side];
  const bool leads = side == leader_of(spec);
  return (is_alone(spec) && leads) || (hands_over(spec) && !leads) ? palm.shallow : palm.steep;
}

// The height at which the object begins, or ends after it moved by `moved`: that of the highest stand
// under its contact vertices, or of the floor [m].
inline double standing_level(const Spec& spec, double moved = 0.0) {
  double level = 0.0;
  for (std::size_t i = 0; i < spec.stand_count; ++i) {
    const StandSpec& stand = spec.stands[i];
    if (stand.from < moved + spec.com_right && stand.to > moved - spec.com_left)
      level = larger(level, stand.height);
  }
  return level;
}

// Heights of the pivot of a steep palm below an object that lies level on a stand of this height [m].
struct StandHeights {
  double low;    // the palm touches the object nowhere, whatever the error of its height
  double clear;  // at which it touches the object with its inner end at the latest

  static StandHeights of(const Spec& spec, std::size_t side, double top) {
    const PalmSpec& palm = spec.palms[side];
    const SinCos<double> at = sin_cos(palm.steep);
    const double radius = contact_radii(spec.outline)[side];
    const double middle = top + radius - (palm.offset + radius) * at.cos;
    const double end = 0.5 * palm.length * at.sin + spec.arms[side].height_error;
    return {middle - end, middle + end};
  }
};

// Positions of the pivots and of the COM, which is above x = 0; the floor is y = 0 [m].
struct StandingStart {
  PerSide<Vec> pivots{};
  Vec com{};

  // With palms at these angles [rad], whose inner ends have these horizontal distances from the
  // object [m].
  static StandingStart of(const Spec& spec, const PerSide<double>& angles,
                          const PerSide<double>& gaps) {
    StandingStart start;
    const double level = standing_level(spec);
    PerSide<double> end{};
    const PerSide<double> radius = contact_radii(spec.outline);
    for (const Vec& point : silhouette(spec)) {
      end[left] = larger(end[left], -(point.x - spec.com_left));
      end[right] = larger(end[right], point.x - spec.com_left);
    }
    for (const std::size_t side : {left, right}) {
      const PalmSpec& palm = spec.palms[side];
      const SinCos<double> at = sin_cos(angles[side]);
      const double arm = 0.5 * palm.length * at.cos + palm.offset * at.sin;
      start.pivots[side] = {outward<double>(side) * (end[side] + gaps[side] + arm),
                            level + palm.lowest_pivot(at)};
    }
    start.com = {0.0, level + spec.com_height + larger(radius[left], radius[right])};
    return start;
  }

  // Where a job begins: the palms are below the top of a stand.
  static StandingStart of(const Spec& spec) {
    PerSide<double> gaps{approach_distance, approach_distance};
    if (is_alone(spec)) gaps[other(leader_of(spec))] = aside_distance;
    StandingStart start = of(spec, {first_angle(spec, left), first_angle(spec, right)}, gaps);
    if (spec.begins_on != StandsOn::stand) return start;
    for (const std::size_t side : {left, right})
      start.pivots[side].y = StandHeights::of(spec, side, standing_level(spec)).low;
    return start;
  }

  // How far a robot drives from there until its steep palm is below the object, so that it touches at
  // the contact coordinate of the scene's start [m].
  double way_below(const Spec& spec, std::size_t side) const {
    const PalmSpec& palm = spec.palms[side];
    const SinCos<double> at = sin_cos(palm.steep);
    const double lever = palm.offset + contact_radii(spec.outline)[side];
    const double vertex = side == left ? spec.com_left : spec.com_right;
    return outward<double>(side) * pivots[side].x - vertex + spec.start[side] * at.cos -
           lever * at.sin;
  }
};

// Why an object does not stand on its two contact vertices; empty: it does.
inline std::string standing_refusal(const Spec& spec) {
  const PerSide<double> radius = contact_radii(spec.outline);
  const double height = spec.com_height + larger(radius[left], radius[right]);
  double lowest = 0.0;
  for (const Vec& point : silhouette(spec)) {
    lowest = smaller(lowest, point.y + (height - spec.com_height));
  }
  // Where the line of action meets the floor: a force towards −x moves it back.
  const double back = spec.slope * height;
  const bool is_inside = -spec.com_right < back && back < spec.com_left;
  if (lowest >= -1e-9 && radius[left] == radius[right] && is_inside) return "";
  return sentence(
      "object.vertices_m: the outline does not stand on its contact vertices, {} m apart; allowed: "
      "an object whose two contact vertices are its lowest, with equal radii, and whose weight "
      "acts "
      "on the floor between them",
      {short_text(spec.width)});
}

}  // namespace palmbots
