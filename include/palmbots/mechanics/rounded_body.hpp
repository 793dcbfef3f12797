// SPDX-License-Identifier: Apache-2.0
// The outline of a rounded object: a polygon whose convex corners may be arcs.
//
// A corner is an arc about a centre, from the normal of the edge before it to that of the edge after
// it; a sharp corner has the radius 0. An edge is the straight line that touches two neighbouring
// arcs. Frame: origin at the COM, x forward, y up; the corners are listed anticlockwise.
#pragma once

#include <algorithm>

#include "palmbots/base/vec.hpp"
#include "palmbots/mechanics/model.hpp"

namespace palmbots {

// A corner of a rounded body, and the edge from it to the next one. The edge is measured from the
// middle of its straight part, so that the mirrored body rounds alike.
struct Corner {
  Vec centre;
  double radius;
  bool convex;
  Vec normal;  // of the edge, outward, of unit size
  Vec middle;
  double half_length;  // [m]
};

struct RoundedBody {
  std::array<Corner, max_outline> corners{};
  std::size_t count = 0;

  // Whether it is one whole circle: a single corner without an edge.
  constexpr bool is_disc() const { return count == 1; }
  constexpr std::size_t before(std::size_t i) const { return i == 0 ? count - 1 : i - 1; }
  constexpr std::size_t after(std::size_t i) const { return i + 1 == count ? 0 : i + 1; }

  // By how much a direction lies inside the arc of a corner: the sine of the angle to its nearer
  // end, negative outside. The arc of a disc has no end.
  constexpr double within_arc(std::size_t i, Vec direction) const {
    if (is_disc()) return 1.0;
    return smaller(cross(corners[before(i)].normal, direction),
                   cross(direction, corners[i].normal));
  }
};

inline constexpr double one_centre = 1e-6;  // arcs whose centres are nearer have one [radii]

// The body of an outline, which is listed anticlockwise. `com` is its COM, as a vertex. Mirrored
// outlines give mirrored bodies to the last bit.
template <class Real>
RoundedBody body_of(const Outline<Real>& outline, const Vertex<Real>& com) {
  RoundedBody body{};
  body.count = outline.count;
  std::array<Vec, max_outline> sharp{};
  for (std::size_t i = 0; i < body.count; ++i) {
    const Vertex<Real>& v = outline.vertices[i];
    // Half of each, because in the mirror both distances change places.
    sharp[i] = {0.5 * ((double(v.along[left]) - double(com.along[left])) -
                       (double(v.along[right]) - double(com.along[right]))),
                double(v.height) - double(com.height)};
  }
  for (std::size_t i = 0; i < body.count; ++i) {
    const Vec edge = sharp[body.after(i)] - sharp[i];
    const double size = length(edge);
    body.corners[i].normal = {edge.y / size, -edge.x / size};
  }
  for (std::size_t i = 0; i < body.count; ++i) {
    Corner& corner = body.corners[i];
    const Vec in = body.corners[body.before(i)].normal;
    const Vec out = corner.normal;
    corner.convex = cross(in, out) > 0.0;
    corner.radius = corner.convex ? double(outline.vertices[i].radius) : 0.0;
    // The centre lies on the bisector, r behind both edges.
    corner.centre = sharp[i] - (in + out) * (corner.radius / (1.0 + dot(in, out)));
  }
  for (std::size_t i = 0; i < body.count; ++i) {
    Corner& corner = body.corners[i];
    const Corner& next = body.corners[body.after(i)];
    const Vec from = corner.centre + corner.normal * corner.radius;
    const Vec to = next.centre + corner.normal * next.radius;
    corner.middle = (from + to) * 0.5;
    corner.half_length = 0.5 * length(to - from);
  }
  // Arcs about one centre are a disc. The mirror image of its first corner is the right contact.
  Corner& first = body.corners[0];
  const auto is_concentric = [&](const Corner& corner) {
    return length(corner.centre - first.centre) < one_centre * corner.radius;
  };
  if (std::all_of(body.corners.begin(), body.corners.begin() + body.count, is_concentric)) {
    first.centre = (first.centre + body.corners[outline.contact[right]].centre) * 0.5;
    body.count = 1;
  }
  return body;
}

// Calls visit(i, point) for points along the outline: its sharp corners, and points of each arc so
// close together that the polygon through them looks round. i is the corner.
template <class Visit>
void each_drawn_point(const RoundedBody& body, Visit visit) {
  constexpr double most_turn = 7.5 * radians_per_degree<double>;
  for (std::size_t i = 0; i < body.count; ++i) {
    const Corner& corner = body.corners[i];
    if (!(corner.radius > 0.0)) {
      visit(i, corner.centre);
      continue;
    }
    const Vec from = body.corners[body.before(i)].normal;
    const double turn = body.is_disc()
                            ? 2.0 * pi<double>
                            : angle_of(cross(from, corner.normal), dot(from, corner.normal));
    const double parts = std::ceil(turn / most_turn);
    for (double k = body.is_disc() ? 1.0 : 0.0; k <= parts; k += 1.0) {
      const SinCos<double> by = sin_cos(turn * (k / parts));
      const Vec direction{from.x * by.cos - from.y * by.sin, from.x * by.sin + from.y * by.cos};
      visit(i, corner.centre + direction * corner.radius);
    }
  }
}

}  // namespace palmbots
