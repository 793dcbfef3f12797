// SPDX-License-Identifier: Apache-2.0
// Places of the palms, contacts and object in the world frame, for drawing.
//
// The same as src/palmbots/scene/placement.py: x forward, y up, the origin halfway between the
// pivots at the start, at their height.
#pragma once

#include <cmath>
#include <vector>

#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/plate_section.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots::page {

// A configuration with the place of the pair [m] and the sine of the object's angle.
struct Pose {
  Configuration<double> configuration;
  double midpoint;
  double object_sine;
};

// Appends x and y of: pivots, inner ends, outer ends and contacts (left, right each), COM, the left
// contact vertex as the scene has it, the corners of the left and the right plate, and the outline
// to draw. For one picture at a time, so it is compiled to be small.
[[clang::minsize]] inline void append_places(const Spec& spec, const Pose& pose,
                                             std::vector<double>& out) {
  struct Xy {
    double x;
    double y;
  };
  PerSide<Xy> pivot{};
  PerSide<Xy> inner{};
  PerSide<Xy> outer{};
  PerSide<Xy> contact{};
  PerSide<std::array<Xy, PlateSection{}.size()>> plate{};
  Xy vertex{};
  for (const std::size_t side : {left, right}) {
    const PalmAngle<double>& palm = pose.configuration.palms[side];
    const double away = outward<double>(side);
    const Xy along{away * palm.cos, palm.sin};
    const Xy normal{-away * palm.sin, palm.cos};
    const double half = 0.5 * spec.palms[side].length;
    const double p = pose.configuration.contacts[side];
    const double lift = pose.configuration.lift[side];
    pivot[side] = {pose.midpoint + away * 0.5 * pose.configuration.separation, 0};
    const Xy foot{pivot[side].x + spec.palms[side].offset * normal.x,
                  pivot[side].y + spec.palms[side].offset * normal.y};
    inner[side] = {foot.x - half * along.x, foot.y - half * along.y};
    outer[side] = {foot.x + half * along.x, foot.y + half * along.y};
    contact[side] = {foot.x + p * along.x, foot.y + p * along.y};
    const PlateSection corners = plate_section(spec.palms[side]);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      plate[side][i] = {pivot[side].x + corners[i].x * along.x + corners[i].y * normal.x,
                        pivot[side].y + corners[i].x * along.y + corners[i].y * normal.y};
    }
    if (side == left) {
      const double above = lift + spec.outline.vertices[0].radius;
      vertex = {contact[side].x + above * normal.x, contact[side].y + above * normal.y};
    }
  }
  const double sine = pose.object_sine;
  const double cosine = std::sqrt((1 - sine) * (1 + sine));
  const auto put = [&](const Xy& at) {
    out.push_back(at.x);
    out.push_back(at.y);
  };
  const auto put_carried = [&](double x, double y) {
    put({vertex.x + cosine * x - sine * y, vertex.y + sine * x + cosine * y});
  };
  for (const PerSide<Xy>* pair : {&pivot, &inner, &outer, &contact}) {
    put((*pair)[left]);
    put((*pair)[right]);
  }
  put_carried(spec.com_left, spec.com_height);
  put_carried(spec.outline.vertices[0].along[left], spec.outline.vertices[0].height);
  for (const auto& corners : plate)
    for (const Xy& corner : corners) put(corner);
  for (const Vec& point : silhouette(spec)) put_carried(point.x, point.y);
}

}  // namespace palmbots::page
