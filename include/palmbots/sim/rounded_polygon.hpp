// SPDX-License-Identifier: Apache-2.0
// A polygon whose convex corners may be rounded: centres of the arcs, area, centroid, and what keeps
// an arc from fitting.
//
// An arc touches both edges of its corner. With unit vectors a and b along the edge before and after
// a corner that turns by the angle δ, its centre is r (b − a) / sin δ from the corner, and it takes
// r tan(δ/2) of each edge. All numbers come out alike in the mirror.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/polygon.hpp"

namespace palmbots {

struct RoundedPolygon {
  std::vector<Point> vertices;  // where the edges would meet
  std::vector<double> radii;    // of each vertex [m]; 0 where it is sharp
};

namespace detail {

// How the outline turns at a vertex.
struct Turn {
  Point across;   // b − a
  double sine;    // of the angle, without its sign
  double cosine;  // of the angle
  bool convex;

  double half_tangent() const { return sine / (1 + cosine); }
};

inline Turn turn_at(Points vertices, std::size_t k) {
  const std::size_t n = vertices.size();
  const Point& before = vertices[(k + n - 1) % n];
  const Point& here = vertices[k];
  const Point& after = vertices[(k + 1) % n];
  const auto along = [](const Point& from, const Point& to) {
    const double x = to.x - from.x;
    const double y = to.y - from.y;
    const double length = std::sqrt(x * x + y * y);
    return Point{x / length, y / length};
  };
  const Point a = along(before, here);
  const Point b = along(here, after);
  return {{b.x - a.x, b.y - a.y},
          std::abs(a.x * b.y - a.y * b.x),
          a.x * b.x + a.y * b.y,
          turn(before, here, after) * winding(vertices) > 0};
}

}  // namespace detail

// What stands for a vertex: itself, or the centre of its arc.
inline Point centre_of(const RoundedPolygon& polygon, std::size_t k) {
  const Point& at = polygon.vertices[k];
  if (!(polygon.radii[k] > 0)) return at;
  const detail::Turn turn = detail::turn_at(polygon.vertices, k);
  const double by = polygon.radii[k] / turn.sine;
  return {at.x + turn.across.x * by, at.y + turn.across.y * by};
}

// The first edge, by the vertex at which it begins, that is shorter than what two arcs take of it,
// and how much they take [m].
inline std::optional<std::pair<std::size_t, double>> overlapping_arcs(
    const RoundedPolygon& polygon) {
  const std::size_t n = polygon.vertices.size();
  std::vector<double> taken(n);
  for (std::size_t k = 0; k < n; ++k) {
    if (!(polygon.radii[k] > 0)) continue;
    taken[k] = polygon.radii[k] * detail::turn_at(polygon.vertices, k).half_tangent();
  }
  for (std::size_t k = 0; k < n; ++k) {
    const Point& from = polygon.vertices[k];
    const Point& to = polygon.vertices[(k + 1) % n];
    const double x = to.x - from.x;
    const double y = to.y - from.y;
    const double both = taken[k] + taken[(k + 1) % n];
    if (both > std::sqrt(x * x + y * y) * (1 + 1e-9)) return std::pair(k, both);
  }
  return std::nullopt;
}

// The first arc, by its vertex, and a concave vertex that reaches into what the arc cuts off its
// corner. Arcs that fit their edges cross the outline only so: the sharp outline is simple, so it
// enters such a region through the arc, and its deepest vertex in there is concave.
inline std::optional<std::pair<std::size_t, std::size_t>> crossed_arc(
    const RoundedPolygon& polygon) {
  const std::vector<Point>& at = polygon.vertices;
  const std::size_t n = at.size();
  const auto from = [](const Point& a, const Point& b) { return Point{b.x - a.x, b.y - a.y}; };
  const auto cross = [](const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; };
  const auto length = [](const Point& a) { return std::sqrt(a.x * a.x + a.y * a.y); };
  for (std::size_t k = 0; k < n; ++k) {
    if (!(polygon.radii[k] > 0)) continue;
    const Point before = from(at[k], at[(k + n - 1) % n]);
    const Point after = from(at[k], at[(k + 1) % n]);
    const double taken = polygon.radii[k] * detail::turn_at(at, k).half_tangent();
    const Point centre = centre_of(polygon, k);
    for (std::size_t i = 0; i < n; ++i) {
      if (detail::turn_at(at, i).convex) continue;
      // Shares of both edges that lead to the vertex, in lengths of what the arc takes of them.
      const Point to = from(at[k], at[i]);
      const double one = cross(to, after) / cross(before, after) * length(before);
      const double other = cross(before, to) / cross(before, after) * length(after);
      const bool is_before_chord = one >= 0 && other >= 0 && one + other <= taken;
      if (is_before_chord && length(from(centre, at[i])) >= polygon.radii[k])
        return std::pair(k, i);
    }
  }
  return std::nullopt;
}

// The area, and the centroid of a body of even thickness and density. What an arc leaves out of its
// corner is the kite between centre, corner and both ends of the arc, without the sector.
inline std::pair<double, Point> area_and_centroid(const RoundedPolygon& polygon) {
  auto [area, centroid] = area_and_centroid(polygon.vertices);
  double rest = area;
  double mx = 0;  // about the centroid of the sharp polygon
  double my = 0;
  for (std::size_t k = 0; k < polygon.vertices.size(); ++k) {
    const double r = polygon.radii[k];
    if (!(r > 0)) continue;
    const detail::Turn turn = detail::turn_at(polygon.vertices, k);
    const double half = 0.5 * angle_of(turn.sine, turn.cosine);
    const double cosine = std::sqrt(0.5 * (1 + turn.cosine));
    const double sine = std::sqrt(0.5 * (1 - turn.cosine));
    const double kite = r * r * turn.half_tangent();
    const double sector = r * r * half;
    // Along the bisector, from the centre.
    const double moment =
        kite * r * (cosine + 1 / cosine) / 3 - sector * r * (2 * sine) / (3 * half);
    const Point centre = centre_of(polygon, k);
    const Point& corner = polygon.vertices[k];
    const double reach = r / cosine;
    const double cut = kite - sector;
    rest -= cut;
    mx -= cut * (centre.x - centroid.x) + moment * (corner.x - centre.x) / reach;
    my -= cut * (centre.y - centroid.y) + moment * (corner.y - centre.y) / reach;
  }
  return {rest, {centroid.x + mx / rest, centroid.y + my / rest}};
}

}  // namespace palmbots
