// SPDX-License-Identifier: Apache-2.0
// The object in the frame of its two contact vertices, from an outline in any frame.
//
// The formulas and their order are those of src/palmbots/scene/object_frame.py, so that a carry
// has the same bits; tests/site compares trace hashes for every built-in object and for random
// polygons.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "palmbots/sim/spec.hpp"

namespace palmbots::page {

struct Point {
  double x;
  double y;
};

// An outline as a scene states it: vertices, the two that rest on the palms, and the COM [m].
struct Polygon {
  std::array<Point, max_outline> vertices{};
  std::size_t count = 0;
  std::size_t contacts[2]{};
  Point com{};
};

// Twice the signed area: positive if the vertices run counter-clockwise [m²].
inline double doubled_area(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Point& a = polygon.vertices[i];
    const Point& b = polygon.vertices[(i + 1) % polygon.count];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum;
}

// Puts the object into the spec.
inline void set_object(const Polygon& polygon, Spec& spec) {
  const Point l = polygon.vertices[polygon.contacts[0]];
  const Point r = polygon.vertices[polygon.contacts[1]];
  const double dx = r.x - l.x;
  const double dy = r.y - l.y;
  const double width = std::sqrt(dx * dx + dy * dy);
  const double ex = dx / width;
  const double ey = dy / width;
  const auto corner = [&](const Point& p) {
    const double lx = p.x - l.x;
    const double ly = p.y - l.y;
    const double rx = r.x - p.x;
    const double ry = r.y - p.y;
    return Vertex<double>{{(lx * ex + ly * ey) + 0.0, (rx * ex + ry * ey) + 0.0},
                          0.5 * ((ly * ex - lx * ey) + (rx * ey - ry * ex)) + 0.0};
  };
  const bool counter_clockwise = doubled_area(polygon) > 0;
  const std::size_t n = polygon.count;
  spec.width = width;
  spec.outline = {};
  spec.outline.count = n;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i =
        counter_clockwise ? (polygon.contacts[0] + k) % n : (polygon.contacts[0] + n - k) % n;
    spec.outline.vertices[k] = corner(polygon.vertices[i]);
    if (i == polygon.contacts[1]) spec.outline.contact = {0, k};
  }
  spec.outline.vertices[0] = {{0.0, width}, 0.0};
  spec.outline.vertices[spec.outline.contact[1]] = {{width, 0.0}, 0.0};
  const Vertex<double> com = corner(polygon.com);
  spec.com_left = com.along[left];
  spec.com_right = com.along[right];
  spec.com_height = com.height;
}

}  // namespace palmbots::page
