// SPDX-License-Identifier: Apache-2.0
// The object frame: coordinates of the object relative to its two contact vertices.
//
// Frame: origin at the left contact vertex, x towards the right one, y up, metres. Every coordinate
// along x is given twice, from the left and from the right contact, by the same formula. A mirrored
// object therefore has the same numbers, swapped, to the last bit. For the same reason a height is
// the mean of the heights above both contacts.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "palmbots/mechanics/rounded_body.hpp"
#include "palmbots/sim/rounded_polygon.hpp"
#include "palmbots/sim/task_keys.hpp"

namespace palmbots {

// An outline as a scene states it: vertices, the two that rest on the palms, and the COM [m].
struct GivenObject : RoundedPolygon {
  std::array<std::size_t, 2> contacts{};
  Point com{};
};

// The object of a simple polygon, counter-clockwise from the left contact vertex on. In place of a
// contact vertex that is rounded, the frame has the centre of its arc. If both arcs have one centre,
// as those of a pipe, the width is 0 and the frame level as the outline is given.
inline ObjectSpec object_frame(const GivenObject& given) {
  const Point l = centre_of(given, given.contacts[left]);
  const Point r = centre_of(given, given.contacts[right]);
  const double dx = r.x - l.x;
  const double dy = r.y - l.y;
  const double apart = std::sqrt(dx * dx + dy * dy);
  const bool is_one = !(apart > one_centre * given.radii[given.contacts[left]]);
  const double width = is_one ? 0.0 : apart;
  const double ex = is_one ? 1.0 : dx / apart;
  const double ey = is_one ? 0.0 : dy / apart;
  // Adding 0.0 turns −0.0 into 0.0; a mirrored object could differ in this bit only.
  const auto corner = [&](const Point& p) {
    const double lx = p.x - l.x;
    const double ly = p.y - l.y;
    const double rx = r.x - p.x;
    const double ry = r.y - p.y;
    return Vertex<double>{{(lx * ex + ly * ey) + 0.0, (rx * ex + ry * ey) + 0.0},
                          0.5 * ((ly * ex - lx * ey) + (rx * ey - ry * ex)) + 0.0};
  };
  const std::size_t n = given.vertices.size();
  const bool is_counter_clockwise = winding(given.vertices) > 0;
  ObjectSpec object;
  object.width = width;
  object.outline.count = n;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i =
        is_counter_clockwise ? (given.contacts[left] + k) % n : (given.contacts[left] + n - k) % n;
    object.outline.vertices[k] = corner(given.vertices[i]);
    object.outline.vertices[k].radius = given.radii[i];
    if (i == given.contacts[right]) object.outline.contact = {0, k};
  }
  const auto set = [&](std::size_t k, double from_left, double from_right) {
    Vertex<double>& vertex = object.outline.vertices[k];
    if (!(vertex.radius > 0)) vertex = {{from_left, from_right}, 0.0};
  };
  set(0, 0.0, width);  // exact, whatever the rounding above
  set(object.outline.contact[right], width, 0.0);
  const Vertex<double> com = corner(given.com);
  object.com_left = com.along[left];
  object.com_right = com.along[right];
  object.com_height = com.height;
  return object;
}

// The object as a body in this frame.
inline RoundedBody body_of(const ObjectSpec& object) {
  return body_of(object.outline, Vertex<double>{{0.0, object.width}, 0.0});
}

// The outline to draw, from its first vertex on: arcs as many short edges [m].
inline std::vector<Vec> silhouette(const ObjectSpec& object) {
  std::vector<Vec> points;
  each_drawn_point(body_of(object), [&](std::size_t i, Vec point) {
    const Vertex<double>& vertex = object.outline.vertices[i];
    points.push_back(vertex.radius > 0 ? point : Vec{vertex.along[left], vertex.height});
  });
  return points;
}

}  // namespace palmbots
