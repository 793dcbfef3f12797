// SPDX-License-Identifier: Apache-2.0
// The cross-section of a palm's plate.
#pragma once

#include <array>

#include "palmbots/mechanics/rounded_body.hpp"
#include "palmbots/sim/robot_keys.hpp"

namespace palmbots {

// How thick an infinitely thin plate is drawn, and is in worlds with mass [m]. Assumed.
inline constexpr double thin_plate_thickness = 0.006;

constexpr double plate_thickness(const PalmSpec& palm) {
  return palm.thickness > 0 ? palm.thickness : thin_plate_thickness;
}

using PlateSection = std::array<Vec, 7>;

// The corners in the frame of the palm: x outward from the foot of the pivot, y along the palm's
// normal from the pivot [m], of a plate that is this thick [m]. The first one is the inner end of the surface, the last one its outer
// end. A heel is as thick as the plate. Without heel or bevel some corners coincide.
constexpr PlateSection plate_section(const PalmSpec& palm, double thick) {
  const double half = 0.5 * palm.length;
  const double nose = palm.thickness > 0 ? palm.tip_thickness() : thick;
  const double end = palm.heel > 0 ? half + thick : half;
  const double top = palm.offset;
  return {Vec{-half, top},    {-half, top - nose},    {-half + palm.bevel, top - thick},
          {end, top - thick}, {end, top + palm.heel}, {half, top + palm.heel},
          {half, top}};
}

}  // namespace palmbots
