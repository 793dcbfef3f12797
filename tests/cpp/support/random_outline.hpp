// SPDX-License-Identifier: Apache-2.0
// Outlines with random corners above and below the line of contacts, and what geometry says about
// points and lines: by winding numbers and by cutting every edge.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "palmbots/mechanics/clearance.hpp"

namespace outlines {

struct Point {
  double x;
  double y;
};
using Polygon = std::vector<Point>;

inline double between(std::mt19937& chance, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(chance);
}

// The corners from the left contact at (0, 0) along the bottom to the right one at (width, 0), and
// back over the top. `right` is the number of the right contact.
struct Object {
  Polygon corners;
  std::size_t right;
  double width;
};

inline Object random_object(std::mt19937& chance) {
  const double width = between(chance, 0.15, 0.4);
  const auto places = [&](double from, double to) {
    std::vector<double> x(chance() % 4);
    for (double& one : x) one = between(chance, from, to);
    std::sort(x.begin(), x.end());
    return x;
  };
  Object object{{{0, 0}}, 0, width};
  for (const double x : places(0.01, width - 0.01)) {
    object.corners.push_back({x, between(chance, -0.03, 0.05)});
  }
  object.right = object.corners.size();
  object.corners.push_back({width, 0});
  object.corners.push_back({width + between(chance, -0.05, 0.05), between(chance, 0.06, 0.15)});
  std::vector<double> top = places(0.06, width - 0.06);
  for (std::size_t k = top.size(); k > 0; --k) {
    object.corners.push_back({top[k - 1], between(chance, 0.06, 0.15)});
  }
  object.corners.push_back({between(chance, -0.05, 0.05), between(chance, 0.06, 0.15)});
  return object;
}

template <class Real>
palmbots::Outline<Real> outline_of(const Object& object) {
  palmbots::Outline<Real> outline{};
  for (const Point& at : object.corners) {
    outline.vertices[outline.count++] = {{Real(at.x), Real(object.width - at.x)}, Real(at.y)};
  }
  outline.contact = {0, object.right};
  return outline;
}

// The object seen from a contact vertex: x inward along a palm, y along the palm's normal, turned
// by the angle from the palm to the line of contacts.
inline Polygon seen_from(const Object& object, std::size_t side, double angle) {
  Polygon seen;
  for (const Point& at : object.corners) {
    const double inward = side == palmbots::left ? at.x : object.width - at.x;
    seen.push_back({inward * std::cos(angle) - at.y * std::sin(angle),
                    inward * std::sin(angle) + at.y * std::cos(angle)});
  }
  return seen;
}

// How often the outline winds around the point, by adding up the angles between its corners.
inline bool is_inside(const Polygon& polygon, Point p) {
  double turned = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point a{polygon[i].x - p.x, polygon[i].y - p.y};
    const Point& next = polygon[(i + 1) % polygon.size()];
    const Point b{next.x - p.x, next.y - p.y};
    turned += std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
  }
  return std::abs(turned) > 3;
}

inline double distance(Point p, Point a, Point b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double share = ((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy);
  const double t = std::clamp(share, 0.0, 1.0);
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

// How far inside the polygon the point lies; 0 outside.
inline double depth(const Polygon& polygon, Point p) {
  if (!is_inside(polygon, p)) return 0;
  double least = 1e9;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    least = std::min(least, distance(p, polygon[i], polygon[(i + 1) % polygon.size()]));
  }
  return least;
}

// The greatest depth of the points of a stretch of the x axis, of which `count` are tried.
inline double deepest(const Polygon& polygon, double from, double to, int count) {
  double most = 0;
  for (int k = 0; k <= count; ++k) {
    most = std::max(most, depth(polygon, {from + (to - from) * k / count, 0}));
  }
  return most;
}

}  // namespace outlines
