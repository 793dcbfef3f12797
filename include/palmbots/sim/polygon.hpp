// SPDX-License-Identifier: Apache-2.0
// Simple polygons: simplicity, points inside, convex hull, supporting vertices, area.
//
// A polygon is the list of its vertices, clockwise or counter-clockwise, without repetition of the
// first one. Predicates are exact: where rounding could change the sign of a cross product, it is
// computed in integers. No tolerance decides whether an outline crosses itself.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palmbots {

struct Point {
  double x = 0;
  double y = 0;

  friend constexpr auto operator<=>(const Point&, const Point&) = default;
};

using Points = std::span<const Point>;

namespace detail {

// The difference of two numbers, without rounding: its sign, and its size as a multiple of 2⁻¹⁰⁷⁴.
class ExactDifference {
 public:
  static constexpr std::size_t limb_count = 36;  // numbers below 2⁷⁷
  using Limbs = std::array<std::uint32_t, limb_count>;

  constexpr ExactDifference(double b, double a) {
    std::array<std::int64_t, limb_count> sums{};
    add(sums, b, 1);
    add(sums, a, -1);
    if (!normalize(sums, 1)) {
      sign_ = -1;
      normalize(sums, -1);
    }
    bool is_zero = true;
    for (const std::uint32_t limb : limbs_) is_zero = is_zero && limb == 0;
    if (is_zero) sign_ = 0;
  }
  constexpr int sign() const { return sign_; }
  constexpr const Limbs& limbs() const { return limbs_; }

 private:
  using Sums = std::array<std::int64_t, limb_count>;

  static constexpr void add(Sums& sums, double value, int sense) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const std::uint64_t exponent = bits >> 52 & 0x7ff;
    const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
    const std::uint64_t digits = exponent > 0 ? fraction | std::uint64_t{1} << 52 : fraction;
    const std::uint64_t shift = exponent > 0 ? exponent - 1 : 0;
    const std::int64_t sign = (bits >> 63) != 0 ? -sense : sense;
    const std::size_t at = shift / 32;
    if (at + 2 >= limb_count) return;  // larger than any coordinate
    const std::uint64_t low = (digits & 0xffffffff) << (shift % 32);
    const std::uint64_t high = (digits >> 32) << (shift % 32);
    sums[at] += sign * std::int64_t(low & 0xffffffff);
    sums[at + 1] += sign * std::int64_t((low >> 32) + (high & 0xffffffff));
    sums[at + 2] += sign * std::int64_t(high >> 32);
  }

  // Carries from limb to limb; false: the sum is negative.
  constexpr bool normalize(const Sums& sums, int sense) {
    std::int64_t carry = 0;
    for (std::size_t i = 0; i < limb_count; ++i) {
      carry += sense * sums[i];
      limbs_[i] = static_cast<std::uint32_t>(carry & 0xffffffff);
      carry >>= 32;
    }
    return carry >= 0;
  }

  Limbs limbs_{};
  int sign_ = 1;
};

// The product of two sizes.
constexpr auto product_of(const ExactDifference& a, const ExactDifference& b) {
  constexpr std::size_t n = ExactDifference::limb_count;
  std::array<std::uint32_t, 2 * n> product{};
  for (std::size_t i = 0; i < n; ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < n; ++j) {
      carry += product[i + j] + std::uint64_t{a.limbs()[i]} * b.limbs()[j];
      product[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    product[i + n] = static_cast<std::uint32_t>(carry);
  }
  return product;
}

}  // namespace detail

// Sign of (q − p) × (s − r).
constexpr int sign_of_cross(const Point& p, const Point& q, const Point& r, const Point& s) {
  const double one = (q.x - p.x) * (s.y - r.y);
  const double two = (q.y - p.y) * (s.x - r.x);
  const double cross = one - two;
  const double size = (one < 0 ? -one : one) + (two < 0 ? -two : two);
  // Three roundings in each product and one in their difference; the second number covers products
  // that underflow.
  const double error = 1e-15 * size + 1e-300;
  if (cross > error || -cross > error) return cross > 0 ? 1 : -1;
  const detail::ExactDifference qx(q.x, p.x);
  const detail::ExactDifference sy(s.y, r.y);
  const detail::ExactDifference qy(q.y, p.y);
  const detail::ExactDifference sx(s.x, r.x);
  const int first = qx.sign() * sy.sign();
  const int second = qy.sign() * sx.sign();
  if (first != second) return first > second ? 1 : -1;
  const auto one_way = detail::product_of(qx, sy);
  const auto other = detail::product_of(qy, sx);
  for (std::size_t i = one_way.size(); i-- > 0;) {
    if (one_way[i] != other[i]) return one_way[i] > other[i] ? first : -first;
  }
  return 0;
}

// Sign of (q − p) · (s − r): a cross product with r and s turned by 90°.
constexpr int sign_of_dot(const Point& p, const Point& q, const Point& r, const Point& s) {
  return sign_of_cross(p, q, {-r.y, r.x}, {-s.y, s.x});
}

// +1 where a → b → c turns left (counter-clockwise), −1 right, 0 on one line.
constexpr int turn(const Point& a, const Point& b, const Point& c) {
  return sign_of_cross(a, b, a, c);
}

namespace detail {

// Whether a point on the line through a and b lies on the closed segment a b.
constexpr bool is_on_segment(const Point& point, const Point& a, const Point& b) {
  return std::min(a.x, b.x) <= point.x && point.x <= std::max(a.x, b.x) &&
         std::min(a.y, b.y) <= point.y && point.y <= std::max(a.y, b.y);
}

// Whether the closed segments a b and c d have a point in common.
constexpr bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int abc = turn(a, b, c);
  const int abd = turn(a, b, d);
  const int cda = turn(c, d, a);
  const int cdb = turn(c, d, b);
  if (abc != abd && cda != cdb && abc * abd * cda * cdb != 0) return true;
  return (abc == 0 && is_on_segment(c, a, b)) || (abd == 0 && is_on_segment(d, a, b)) ||
         (cda == 0 && is_on_segment(a, c, d)) || (cdb == 0 && is_on_segment(b, c, d));
}

}  // namespace detail

// The first two edges that keep the polygon (3 vertices or more) from being simple. Edge k runs from
// vertex k to the next one. Neighbouring edges may share their common vertex and nothing else. An
// edge without length is returned twice, so that a polygon without faults has an area.
inline std::optional<std::pair<std::size_t, std::size_t>> crossing_edges(Points polygon) {
  const std::size_t n = polygon.size();
  const auto end = [&](std::size_t k) { return polygon[(k + 1) % n]; };
  for (std::size_t k = 0; k < n; ++k) {
    if (polygon[k] == end(k)) return std::pair(k, k);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Point a = polygon[i];
    const Point b = end(i);
    for (std::size_t j = i + 1; j < n; ++j) {
      const Point c = polygon[j];
      const Point d = end(j);
      bool is_bad = false;
      if (j == i + 1) {
        is_bad = turn(a, b, d) == 0 && sign_of_dot(a, b, c, d) < 0;
      } else if (i == 0 && j == n - 1) {
        is_bad = turn(c, d, b) == 0 && sign_of_dot(c, d, a, b) < 0;
      } else {
        is_bad = detail::meet(a, b, c, d);
      }
      if (is_bad) return std::pair(i, j);
    }
  }
  return std::nullopt;
}

// +1 for a simple polygon given counter-clockwise, −1 for one given clockwise.
inline int winding(Points polygon) {
  const std::size_t n = polygon.size();
  const auto first = std::min_element(polygon.begin(), polygon.end());  // a corner of the hull
  const auto k = static_cast<std::size_t>(first - polygon.begin());
  return turn(polygon[(k + n - 1) % n], polygon[k], polygon[(k + 1) % n]);
}

// The area of a simple polygon, and the centroid of a body of even thickness and density.
inline std::pair<double, Point> area_and_centroid(Points polygon) {
  const Point o = polygon[0];  // seen from it, a polygon far from the origin loses no digits
  double area = 0;
  double mx = 0;
  double my = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& next = polygon[(k + 1) % polygon.size()];
    const Point a{polygon[k].x - o.x, polygon[k].y - o.y};
    const Point b{next.x - o.x, next.y - o.y};
    const double cross = a.x * b.y - b.x * a.y;
    area += cross / 2;
    mx += cross * (a.x + b.x) / 6;
    my += cross * (a.y + b.y) / 6;
  }
  return {area < 0 ? -area : area, {o.x + mx / area, o.y + my / area}};
}

// The leftmost and the rightmost of the lowest vertices, those at most `tolerance` above the lowest
// one; equal where a single vertex is lowest.
inline std::pair<std::size_t, std::size_t> bottom_ends(Points polygon, double tolerance) {
  std::size_t lowest = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    if (polygon[k].y < polygon[lowest].y) lowest = k;
  }
  const double low = polygon[lowest].y + tolerance;
  std::optional<std::pair<std::size_t, std::size_t>> ends;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    if (polygon[k].y > low) continue;
    if (!ends) ends = std::pair(k, k);
    if (polygon[k].x < polygon[ends->first].x) ends->first = k;
    if (polygon[k].x > polygon[ends->second].x) ends->second = k;
  }
  return *ends;
}

// The corners of the convex hull as indices, counter-clockwise (Andrew's monotone chain). Points on
// a side of the hull are not corners. The points must not all lie on one line.
inline std::vector<std::size_t> hull(Points points) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  for (std::size_t k = 1; k < order.size(); ++k) {  // an outline has few points
    for (std::size_t i = k; i > 0 && points[order[i]] < points[order[i - 1]]; --i) {
      std::swap(order[i], order[i - 1]);
    }
  }
  std::vector<std::size_t> corners;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = corners.size();
    for (const std::size_t i : order) {
      while (corners.size() > start + 1 &&
             turn(points[corners[corners.size() - 2]], points[corners.back()], points[i]) <= 0) {
        corners.pop_back();
      }
      corners.push_back(i);
    }
    corners.pop_back();
    std::reverse(order.begin(), order.end());
  }
  return corners;
}

// Whether a point lies in the convex hull of a polygon or on its boundary.
inline bool is_in_hull(const Point& point, Points polygon) {
  const auto corners = hull(polygon);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point& next = polygon[corners[(k + 1) % corners.size()]];
    if (turn(polygon[corners[k]], next, point) < 0) return false;
  }
  return true;
}

// Whether the polygon can rest on a level floor at each vertex, turned so that the vertices `left`
// and `right` are level, the first one on the left: the ends of all sides of its convex hull that
// face down.
inline std::vector<bool> lower_vertices(Points polygon, std::size_t left_vertex,
                                        std::size_t right_vertex) {
  std::vector<bool> is_end(polygon.size());
  const auto corners = hull(polygon);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t i = corners[k];
    const std::size_t next = corners[(k + 1) % corners.size()];
    // Counter-clockwise, a side with the interior above it runs from left to right.
    if (sign_of_dot(polygon[i], polygon[next], polygon[left_vertex], polygon[right_vertex]) > 0) {
      is_end[i] = is_end[next] = true;
    }
  }
  return is_end;
}

}  // namespace palmbots
