// SPDX-License-Identifier: Apache-2.0
// Wrench cone: whether the forces at several frictional contacts can balance a body's weight.
//
// Frame: world x forward, y up, positions from the COM. Forces are in units of the weight. Under a
// sideways specific force s (towards −x, as in mechanics/equilibrium.hpp) the supports must
// together push with (s, 1) through the COM. Each support adds rays to a cone of wrenches (force,
// moment about the COM): both edges of its friction cone where it sticks, the edge that opposes the
// slip where it slides, none where it leaves. With one point on each palm,
// mechanics/contact_modes.hpp gives the same result in closed form.
//
// No linear program is needed. By Carathéodory's theorem a wrench lies in a cone in three
// dimensions iff it lies in the cone of at most three of its rays. The point of the cone nearest to
// a wrench outside it lies on one ray or between two. So the distance from the cone is the least
// over all pairs and single rays. Parallel, opposed and dependent rays need no special treatment: a
// degenerate triple is covered by its pairs, and a degenerate pair by its single rays.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "palmbots/base/scalar.hpp"
#include "palmbots/base/side.hpp"

namespace palmbots {

// The largest number of points at which the palms support a body.
inline constexpr std::size_t max_supports = 8;

// How a contact moves on its palm: as `SlipDirection` (up is outward), or it leaves the palm.
enum class Motion : std::int8_t { down = -1, stick = 0, up = 1, leave = 2 };

// A point at which a palm supports the body.
template <class Real>
struct Support {
  std::size_t side;
  Real x;  // from the COM [m]
  Real y;
  Real nx;  // unit normal, into the body
  Real ny;
  Real friction;

  // Unit tangent: the direction in which the body moves along the palm where it slides up, that is
  // outward.
  constexpr Real tx() const { return outward<Real>(side) * ny; }
  constexpr Real ty() const { return -outward<Real>(side) * nx; }
};

// The points at which the palms support a body, in a fixed order.
template <class Real>
struct Supports {
  std::array<Support<Real>, max_supports> at{};
  std::size_t count = 0;

  // The largest distance of a support from the COM [m], by which moments are divided; 1 if it is
  // zero.
  constexpr Real reach() const {
    Real most = Real(0);
    for (std::size_t i = 0; i < count; ++i) {
      const Real square = at[i].x * at[i].x + at[i].y * at[i].y;
      if (square > most) most = square;
    }
    return most > Real(0) ? std::sqrt(most) : Real(1);
  }
};

// How each support moves, in the order of Supports.
using Motions = std::array<Motion, max_supports>;

// Three numbers: a wrench (force, moment / reach), or the row of a condition on a twist.
template <class Real>
struct Triple {
  Real x;
  Real y;
  Real z;

  constexpr Triple operator+(Triple o) const { return {x + o.x, y + o.y, z + o.z}; }
  constexpr Triple operator-(Triple o) const { return {x - o.x, y - o.y, z - o.z}; }
  constexpr Triple operator*(Real k) const { return {k * x, k * y, k * z}; }
};

template <class Real>
constexpr Real dot(Triple<Real> p, Triple<Real> q) {
  return (p.x * q.x + p.y * q.y) + p.z * q.z;
}

template <class Real>
constexpr Triple<Real> cross(Triple<Real> p, Triple<Real> q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

template <class Real>
constexpr Real size(Triple<Real> p) {
  return std::sqrt(dot(p, p));
}

// Tolerance below which unit vectors, wrenches [weights] and rates count as equal.
template <class Real>
inline constexpr Real wrench_tolerance = sizeof(Real) == 8 ? Real(1e-9) : Real(1e-4);

// The extreme rays of a wrench cone, with unit size.
template <class Real>
struct Rays {
  std::array<Triple<Real>, 2 * max_supports> ray;  // up to `count`
  std::size_t count = 0;
};

// The edges of a contact's friction cone on which its force can lie, as bits: 1 up, 2 down.
constexpr std::uint32_t edges_of(Motion motion) {
  constexpr std::array<std::uint32_t, 4> edges{2, 3, 1, 0};
  return edges[static_cast<std::size_t>(static_cast<int>(motion) + 1)];
}

// The rays that the supports add to the wrench cone while they move in this way.
template <class Real>
constexpr Rays<Real> rays_of(const Supports<Real>& supports, const Motions& motions) {
  const Real reach = supports.reach();
  Rays<Real> rays{};
  for (std::size_t i = 0; i < supports.count; ++i) {
    const Support<Real>& s = supports.at[i];
    for (const Motion edge : {Motion::up, Motion::down}) {
      if (motions[i] != edge && motions[i] != Motion::stick) continue;
      const Real friction = edge == Motion::up ? -s.friction : s.friction;
      const Real fx = s.nx + friction * s.tx();
      const Real fy = s.ny + friction * s.ty();
      const Triple<Real> wrench{fx, fy, (s.x * fy - s.y * fx) / reach};
      rays.ray[rays.count++] = wrench * (Real(1) / size(wrench));
    }
  }
  return rays;
}

// The share of each of up to three rays in a wrench; negative where a ray would have to pull.
template <class Real>
struct RayShares {
  std::array<std::size_t, 3> ray;
  std::array<Real, 3> share;
  std::size_t count;

  Real least() const {
    const Real two = smaller(share[0], share[1]);
    return count == 2 ? two : smaller(two, share[2]);
  }
};

// Calls `each` with the shares in a wrench of every three rays that span the space. Two rays alone,
// whose balance is an equation of the regime: the shares in their plane.
template <class Real, class Each>
void for_each_combination(const Rays<Real>& rays, Triple<Real> wrench, Each&& each) {
  if (rays.count == 2) {
    const Triple<Real> n = cross(rays.ray[0], rays.ray[1]);
    const Real area = dot(n, n);
    each(RayShares<Real>{
        {0, 1},
        {dot(cross(wrench, rays.ray[1]), n) / area, dot(cross(rays.ray[0], wrench), n) / area},
        2});
    return;
  }
  for (std::size_t i = 0; i < rays.count; ++i) {
    for (std::size_t j = i + 1; j < rays.count; ++j) {
      const Triple<Real> ij = cross(rays.ray[i], rays.ray[j]);
      for (std::size_t k = j + 1; k < rays.count; ++k) {
        const Triple<Real> jk = cross(rays.ray[j], rays.ray[k]);
        const Real volume = dot(rays.ray[i], jk);
        if (!(magnitude(volume) > wrench_tolerance<Real>)) continue;
        each(RayShares<Real>{
            {i, j, k},
            {dot(wrench, jk) / volume, dot(wrench, cross(rays.ray[k], rays.ray[i])) / volume,
             dot(wrench, ij) / volume},
            3});
      }
    }
  }
}

// How far a wrench is inside a cone: the distance from its nearest face. Negative outside, and
// nowhere positive if the cone is flat.
template <class Real>
constexpr Real depth_in(const Rays<Real>& rays, Triple<Real> wrench) {
  constexpr Real tolerance = wrench_tolerance<Real>;
  Real depth = std::numeric_limits<Real>::infinity();
  bool spans = false;
  for (std::size_t i = 0; i < rays.count; ++i) {
    for (std::size_t j = i + 1; j < rays.count; ++j) {
      Triple<Real> normal = cross(rays.ray[i], rays.ray[j]);
      const Real area = size(normal);
      if (!(area > tolerance)) continue;
      spans = true;
      normal = normal * (Real(1) / area);
      Real low = Real(0);
      Real high = Real(0);
      for (std::size_t k = 0; k < rays.count; ++k) {
        const Real above = dot(normal, rays.ray[k]);
        low = smaller(low, above);
        high = larger(high, above);
      }
      // A face has all rays on one side of it.
      if (low >= -tolerance) depth = smaller(depth, dot(normal, wrench));
      if (high <= tolerance) depth = smaller(depth, -dot(normal, wrench));
    }
  }
  return spans ? depth : Real(-1);
}

namespace detail {

// True if the wrench lies in the cone of three clearly independent rays. Cramer's rule.
template <class Real>
constexpr bool in_triple(Triple<Real> a, Triple<Real> b, Triple<Real> c, Triple<Real> wrench) {
  const Triple<Real> bc = cross(b, c);
  const Triple<Real> ca = cross(c, a);
  const Triple<Real> ab = cross(a, b);
  const Real volume = dot(a, bc);
  const Real least = wrench_tolerance<Real>;
  const Real known = volume < Real(0) ? -volume : volume;
  if (!(known > least * size(bc) && known > least * size(ca) && known > least * size(ab))) {
    return false;
  }
  const Real sign = volume < Real(0) ? Real(-1) : Real(1);
  return sign * dot(wrench, bc) >= Real(0) && sign * dot(wrench, ca) >= Real(0) &&
         sign * dot(wrench, ab) >= Real(0);
}

// Distance of the wrench from the cone of two rays if its projection falls between them. Otherwise
// the distance from the first ray, or from the origin.
template <class Real>
constexpr Real distance_from_pair(Triple<Real> a, Triple<Real> b, Triple<Real> wrench) {
  const Real along = dot(wrench, a);
  const Triple<Real> beside = along > Real(0) ? wrench - a * along : wrench;
  const Real single = size(beside);
  const Triple<Real> across = b - a * dot(a, b);
  const Real width = size(across);
  if (!(width > wrench_tolerance<Real>)) return single;
  const Triple<Real> unit = across * (Real(1) / width);
  const Real share_b = dot(wrench, unit) / width;
  const Real share_a = along - share_b * dot(a, b);
  if (!(share_a >= Real(0) && share_b >= Real(0))) return single;
  const Real pair = size((wrench - a * along) - unit * dot(wrench, unit));
  return pair < single ? pair : single;
}

}  // namespace detail

// Distance of the wrench from the cone of the rays; 0 inside.
template <class Real>
constexpr Real distance_from_cone(const Rays<Real>& rays, Triple<Real> wrench) {
  Real nearest = size(wrench);
  for (std::size_t i = 0; i < rays.count; ++i) {
    for (std::size_t j = 0; j < rays.count; ++j) {
      const Real distance = detail::distance_from_pair(rays.ray[i], rays.ray[j], wrench);
      if (distance < nearest) nearest = distance;
    }
  }
  if (nearest <= wrench_tolerance<Real>) return nearest;
  for (std::size_t i = 0; i < rays.count; ++i) {
    for (std::size_t j = i + 1; j < rays.count; ++j) {
      for (std::size_t k = j + 1; k < rays.count; ++k) {
        if (detail::in_triple(rays.ray[i], rays.ray[j], rays.ray[k], wrench)) return Real(0);
      }
    }
  }
  return nearest;
}

// Which rays balance a wrench, for many selections of the same rays: all least sets of them whose cone
// contains it. The same answers as by `distance_from_cone`.
template <class Real>
class BalancingRays {
 public:
  BalancingRays(const Rays<Real>& rays, Triple<Real> wrench) {
    constexpr Real tolerance = wrench_tolerance<Real>;
    const auto& ray = rays.ray;
    const auto bit = [](std::size_t i) { return std::uint32_t{1} << i; };
    // The volume that two rays span with the wrench; it is no larger than its distance from them.
    std::array<std::array<Real, n>, n> volume;
    for (std::size_t i = 0; i < rays.count; ++i) {
      if (detail::distance_from_pair(ray[i], ray[i], wrench) <= tolerance) add(bit(i));
      for (std::size_t j = 0; j < i; ++j) {
        volume[j][i] = dot(wrench, cross(ray[j], ray[i]));
        if (magnitude(volume[j][i]) > Real(2) * tolerance) continue;
        const Real distance = smaller(detail::distance_from_pair(ray[i], ray[j], wrench),
                                      detail::distance_from_pair(ray[j], ray[i], wrench));
        if (distance <= tolerance) add(bit(i) | bit(j));
      }
    }
    for (std::size_t i = 0; i < rays.count; ++i) {
      for (std::size_t j = i + 1; j < rays.count; ++j) {
        for (std::size_t k = j + 1; k < rays.count; ++k) {
          const Real least = smaller(smaller(volume[i][j], volume[j][k]), -volume[i][k]);
          const Real most = larger(larger(volume[i][j], volume[j][k]), -volume[i][k]);
          if (least < Real(0) && most > Real(0)) continue;  // shares of both signs
          if (detail::in_triple(ray[i], ray[j], ray[k], wrench)) add(bit(i) | bit(j) | bit(k));
        }
      }
    }
  }

  // Whether rays balance the wrench that are among these, as bits.
  bool any_of(std::uint32_t rays) const {
    for (std::size_t i = 0; i < count_; ++i)
      if ((sets_[i] & ~rays) == 0) return true;
    return false;
  }

 private:
  static constexpr std::size_t n = 2 * max_supports;

  void add(std::uint32_t set) {
    if (!any_of(set)) sets_[count_++] = set;
  }

  std::array<std::uint32_t, n*(n - 1) * (n - 2) / 6> sets_;  // up to `count_`
  std::size_t count_ = 0;
};

// The least wrench [weights, moment / reach] that would have to be added for balance. It is 0 up to
// rounding where the contacts in these motions hold the body.
template <class Real>
constexpr Real imbalance(const Supports<Real>& supports, const Motions& motions, Real slope) {
  return distance_from_cone(rays_of(supports, motions), {slope, Real(1), Real(0)});
}

// True if the contacts in these motions balance the body.
template <class Real>
constexpr bool balances(const Supports<Real>& supports, const Motions& motions, Real slope) {
  return imbalance(supports, motions, slope) <= wrench_tolerance<Real>;
}

}  // namespace palmbots
