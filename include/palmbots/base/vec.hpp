// SPDX-License-Identifier: Apache-2.0
// Vectors in the plane.
#pragma once

#include "palmbots/base/scalar.hpp"

namespace palmbots {

// A vector in the plane, or the position of a point [m].
struct Vec {
  double x;
  double y;

  constexpr Vec operator+(Vec o) const { return {x + o.x, y + o.y}; }
  constexpr Vec operator-(Vec o) const { return {x - o.x, y - o.y}; }
  constexpr Vec operator*(double k) const { return {x * k, y * k}; }
  constexpr Vec operator-() const { return {-x, -y}; }
};

constexpr double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }

// > 0 where b is anticlockwise from a.
constexpr double cross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }

inline double length(Vec a) { return square_root(dot(a, a)); }

}  // namespace palmbots
