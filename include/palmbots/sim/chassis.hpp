// SPDX-License-Identifier: Apache-2.0
// Where a robot's wheels, caster, arm and masses are: for statics and for the MuJoCo model.
//
// Outward is away from the partner. On a straight path the wheels are outward of the middle of the
// body and the caster is inward, below the load. The paper states that its robots are "approximately
// the size of a 20 cm cube". All else is assumed; section `mujoco` of a scene sets some of it.
#pragma once

#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/scene_values.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// Dimensions of the robots [m].
inline constexpr double body_size = 0.20;  // edge of the cubic body
inline constexpr double body_gap = 0.05;   // from the pivot outward to the near face of the body
inline constexpr double ground_clearance = 0.02;  // from the floor to the body
// From the floor to the pivots, at least; clears the body at usual palm angles.
inline constexpr double pivot_height = 0.25;
inline constexpr double shoulder_inset =
    0.03;  // from near and upper face of the body to the shoulder

// Positions relative to the middle of the body on the floor [m]; x outward, y up.
struct Chassis {
  double axle;
  double caster;
  Vec com;
  Vec shoulder;
  Vec pivot;  // the wrist, where the palm turns
};

inline constexpr double usual_axle = 0.2;  // outward of the pivot, on a straight path [m]

// On a robot whose pivot is `height` above the floor and whose wheels are `axle` outward of it [m].
inline Chassis chassis_of(double height, double axle) {
  constexpr double middle = body_gap + body_size / 2;
  const double top = -height + ground_clearance + body_size - shoulder_inset;  // over the pivot
  return {axle == usual_axle ? 0.05 : axle - middle,
          axle > middle + 0.02 ? -0.07 : 0.07,  // on the other side of the COM
          {0.02, ground_clearance + 0.06},
          {body_gap + shoulder_inset - middle, top + height},
          {-middle, height}};
}

// The distance of the wheels outward of the pivot [m]. On a curved path the axle follows the path
// and is below the palm.
inline double axle_of(const SceneValues& scene, bool is_curved) {
  if (scene.has<"mujoco.axle_m">()) return scene.of<"mujoco.axle_m">();
  return is_curved ? 0.0 : usual_axle;
}

// The height of the floor over the pivots [m]: low enough for the robots and for any object.
inline double floor_level(const Spec& spec) {
  double lowest = spec.outline.vertices[0].height;
  for (const Vec& point : silhouette(spec)) lowest = smaller(lowest, point.y);
  const PerSide<double> radius = contact_radii(spec.outline);
  return smaller(-pivot_height, lowest + larger(radius[left], radius[right]) - 0.05);
}

}  // namespace palmbots
