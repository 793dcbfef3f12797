// SPDX-License-Identifier: Apache-2.0
// Vectors in the plane, and vectors of three numbers.
#pragma once

#include <array>

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

// Three numbers, such as a force and its moment.
struct Triple {
  double x;
  double y;
  double z;

  constexpr Triple operator+(Triple o) const { return {x + o.x, y + o.y, z + o.z}; }
  constexpr Triple operator-(Triple o) const { return {x - o.x, y - o.y, z - o.z}; }
  constexpr Triple operator*(double k) const { return {k * x, k * y, k * z}; }
};
constexpr double dot(Triple p, Triple q) { return (p.x * q.x + p.y * q.y) + p.z * q.z; }
constexpr Triple cross(Triple p, Triple q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
inline double size(Triple p) { return square_root(dot(p, p)); }

// What is smaller than this counts as zero beside vectors of unit size.
inline constexpr double unit_tolerance = 1e-9;

// The parts of a vector along three others that span the space. Cramer's rule.
inline std::array<double, 3> parts_along(const std::array<Triple, 3>& v, Triple of) {
  const Triple across = cross(v[1], v[2]);
  const double volume = dot(v[0], across);
  return {dot(of, across) / volume, dot(of, cross(v[2], v[0])) / volume,
          dot(of, cross(v[0], v[1])) / volume};
}

}  // namespace palmbots
