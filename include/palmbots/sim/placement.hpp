// SPDX-License-Identifier: Apache-2.0
// Placement: points of the robots and the object in the world frame, for drawing.
//
// Frame: x forward (left robot → right robot), y up [m]; the origin is halfway between the pivots at
// the start of the carry, at their height while they carry from palms to palms.
#pragma once

#include <vector>

#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/plate_section.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// A configuration, and where the pair is.
struct PairPose {
  Configuration<double> configuration;
  double midpoint;           // of the robots [m]
  Vec turn;                  // cosine and sine of the object's anticlockwise turn
  PerSide<double> height{};  // y of the pivots [m]
};

// Appends x and y of: pivots, inner ends, outer ends and contacts (left, right each), COM, the left
// contact vertex as the scene has it, the origin of the object's frame, the corners of the left and
// the right plate, and the outline to draw.
//
// The object is placed at its left contact. The loop-closure constraint, which the world keeps, then
// puts its right contact vertex on the right palm. For one picture at a time, so it is compiled to be
// small.
[[gnu::cold]] inline void append_places(const Spec& spec, const PairPose& pose,
                                        std::vector<double>& out) {
  PerSide<Vec> pivot{};
  PerSide<Vec> inner{};
  PerSide<Vec> outer{};
  PerSide<Vec> contact{};
  PerSide<PlateSection> plate{};
  Vec origin{};
  for (const std::size_t side : {left, right}) {
    const PalmSpec& palm = spec.palms[side];
    const PalmAngle<double>& angle = pose.configuration.palms[side];
    const double away = outward<double>(side);
    const Vec along{away * angle.cos, angle.sin};
    const Vec normal{-away * angle.sin, angle.cos};
    pivot[side] = {pose.midpoint + away * 0.5 * pose.configuration.separation, pose.height[side]};
    const Vec foot = pivot[side] + normal * palm.offset;
    inner[side] = foot - along * (0.5 * palm.length);
    outer[side] = foot + along * (0.5 * palm.length);
    contact[side] = foot + along * pose.configuration.contacts[side];
    const PlateSection corners = plate_section(palm, plate_thickness(palm));
    for (std::size_t i = 0; i < corners.size(); ++i)
      plate[side][i] = pivot[side] + along * corners[i].x + normal * corners[i].y;
    if (side == left) {
      const double above = pose.configuration.lift[left] + spec.outline.vertices[0].radius;
      origin = contact[left] + normal * above;
    }
  }
  const auto put = [&](Vec at) {
    out.push_back(at.x);
    out.push_back(at.y);
  };
  const auto put_carried = [&](double x, double y) {
    put(origin + Vec{pose.turn.x * x - pose.turn.y * y, pose.turn.y * x + pose.turn.x * y});
  };
  for (const PerSide<Vec>* pair : {&pivot, &inner, &outer, &contact}) {
    put((*pair)[left]);
    put((*pair)[right]);
  }
  put_carried(spec.com_left, spec.com_height);
  put_carried(spec.outline.vertices[0].along[left], spec.outline.vertices[0].height);
  put(origin);
  for (const PlateSection& corners : plate)
    for (const Vec& corner : corners) put(corner);
  for (const Vec& point : silhouette(spec)) put_carried(point.x, point.y);
}

}  // namespace palmbots
