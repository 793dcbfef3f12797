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
// a wrench outside it lies on one ray or between two. Parallel, opposed and dependent rays need no
// special treatment: a degenerate triple is covered by its pairs, and a degenerate pair by its single
// rays.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "palmbots/base/fixed_list.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/base/vec.hpp"

namespace palmbots {

// The largest number of points at which the palms support a body.
inline constexpr std::size_t max_supports = 8;

// How a contact moves on its palm: as `SlipDirection` (up is outward), or it leaves the palm.
enum class Motion : std::int8_t { down = -1, stick = 0, up = 1, leave = 2 };

// +1 of a contact that slides up, −1 of one that slides down, 0 of one that sticks.
constexpr double way_of(Motion motion) { return double(static_cast<int>(motion)); }

// The tangent at a normal; `sense` is +1 where outward is towards +x, −1 where it is towards −x.
constexpr Vec tangent_of(double sense, Vec normal) {
  return {sense * normal.y, -(sense * normal.x)};
}

// A point at which a surface supports the body.
struct Support {
  std::size_t side;  // whose outward direction is that of the tangent
  Vec point;         // from the COM [m]
  Vec normal;        // of unit size, into the body
  Vec tangent;       // in which the body moves where it slides up, that is outward
  double friction;

  static constexpr Support at(std::size_t side, Vec point, Vec normal, double friction) {
    return {side, point, normal, tangent_of(outward<double>(side), normal), friction};
  }
  // The wrench (force, moment / reach) of a force at the point; also the row of a condition on its
  // motion in a direction.
  constexpr Triple row(Vec direction, double reach) const {
    return {direction.x, direction.y, cross(point, direction) / reach};
  }
};

// The points at which the palms support a body, in a fixed order.
using Supports = FixedList<Support, max_supports>;

// The largest distance of a support from the COM [m], by which moments are divided; 1 if it is zero.
inline double reach_of(const Supports& supports) {
  double most = 0.0;
  for (const Support& s : supports) most = larger(most, dot(s.point, s.point));
  return most > 0.0 ? square_root(most) : 1.0;
}

// How each support moves, in the order of Supports.
using Motions = std::array<Motion, max_supports>;

// Tolerance below which unit vectors, wrenches [weights] and rates count as equal.
inline constexpr double wrench_tolerance = 1e-9;

// The shares with which two, three or four vectors of unit size cancel, in any scale: Σ share v = 0.
// False where they do not span exactly one dimension less than there are of them, up to rounding.
inline bool cancels(const std::array<Triple, 2>& v, std::array<double, 2>& shares) {
  const Triple across = cross(v[0], v[1]);
  if (dot(across, across) > wrench_tolerance) return false;  // clearly; mostly
  shares = {size(v[1]), dot(v[0], v[1]) < 0.0 ? size(v[0]) : -size(v[0])};
  return size(across) <= wrench_tolerance * larger(size(v[0]), size(v[1]));
}
inline bool cancels(const std::array<Triple, 3>& v, std::array<double, 3>& shares) {
  const std::array<Triple, 3> across{cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])};
  if (magnitude(dot(v[0], across[0])) > 2.0 * wrench_tolerance) return false;  // clearly; mostly
  const std::array<double, 3> areas{dot(across[0], across[0]), dot(across[1], across[1]),
                                    dot(across[2], across[2])};
  std::size_t widest = areas[1] > areas[0] ? 1 : 0;
  if (areas[2] > areas[widest]) widest = 2;
  const double area = square_root(areas[widest]);
  if (!(area > wrench_tolerance && magnitude(dot(v[0], across[0])) <= wrench_tolerance * area))
    return false;
  for (std::size_t k = 0; k < 3; ++k) shares[k] = dot(across[k], across[widest]);
  return true;
}
inline bool cancels(const std::array<Triple, 4>& v, std::array<double, 4>& shares) {
  const Triple ab = cross(v[0], v[1]);
  const Triple cd = cross(v[2], v[3]);
  shares = {dot(v[1], cd), -dot(v[0], cd), dot(ab, v[3]), -dot(ab, v[2])};
  double most = 0.0;
  for (const double share : shares) most = larger(most, magnitude(share));
  return most > wrench_tolerance;
}

// The extreme rays of a wrench cone, with unit size.
using Rays = FixedList<Triple, 2 * max_supports>;

// The edges of a contact's friction cone on which its force can lie, as bits: 1 up, 2 down.
constexpr std::uint32_t edges_of(Motion motion) {
  constexpr std::array<std::uint32_t, 4> edges{2, 3, 1, 0};
  return edges[static_cast<std::size_t>(static_cast<int>(motion) + 1)];
}

// Calls visit(along) for each of these edges: on it, `along` is the friction force per unit of normal
// force, in the direction of a slide up.
template <class Visit>
void each_edge(Motion motion, double friction, Visit visit) {
  if ((edges_of(motion) & 1) != 0) visit(-friction);
  if ((edges_of(motion) & 2) != 0) visit(friction);
}

// Adds the forces of a contact that moves in this way, as rays of unit size.
inline void add_rays(Rays& rays, const Support& s, Motion motion, double reach) {
  each_edge(motion, s.friction, [&](double along) {
    const Triple wrench = s.row(s.normal + s.tangent * along, reach);
    rays.push_back(wrench * (1.0 / size(wrench)));
  });
}

// The rays that the supports add to the wrench cone while they move in this way.
inline Rays rays_of(const Supports& supports, const Motions& motions) {
  const double reach = reach_of(supports);
  Rays rays;
  for (std::size_t i = 0; i < supports.size(); ++i) add_rays(rays, supports[i], motions[i], reach);
  return rays;
}

// The share of each of up to three rays in a wrench; negative where a ray would have to pull.
struct RayShares {
  std::array<std::size_t, 3> ray;
  std::array<double, 3> share;
  std::size_t count;

  double least() const {
    const double two = smaller(share[0], share[1]);
    return count == 2 ? two : smaller(two, share[2]);
  }
};

// Calls `each` with the shares in a wrench of every three rays that span the space. Two rays alone,
// whose balance is an equation of the regime: the shares in their plane.
template <class Each>
void for_each_combination(const Rays& rays, Triple wrench, Each&& each) {
  if (rays.size() == 2) {
    const Triple n = cross(rays[0], rays[1]);
    const double area = dot(n, n);
    each(RayShares{
        {0, 1}, {dot(cross(wrench, rays[1]), n) / area, dot(cross(rays[0], wrench), n) / area}, 2});
    return;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      for (std::size_t k = j + 1; k < rays.size(); ++k) {
        const std::array<Triple, 3> ray{rays[i], rays[j], rays[k]};
        if (magnitude(dot(ray[0], cross(ray[1], ray[2]))) > wrench_tolerance)
          each(RayShares{{i, j, k}, parts_along(ray, wrench), 3});
      }
    }
  }
}

// How far a wrench is inside a cone: the distance from its nearest face. Negative outside, and
// nowhere positive if the cone is flat.
inline double depth_in(const Rays& rays, Triple wrench) {
  double depth = std::numeric_limits<double>::infinity();
  bool spans = false;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      Triple normal = cross(rays[i], rays[j]);
      const double area = size(normal);
      if (!(area > wrench_tolerance)) continue;
      spans = true;
      normal = normal * (1.0 / area);
      double low = 0.0;
      double high = 0.0;
      for (const Triple& ray : rays) {
        const double above = dot(normal, ray);
        low = smaller(low, above);
        high = larger(high, above);
      }
      // A face has all rays on one side of it.
      if (low >= -wrench_tolerance) depth = smaller(depth, dot(normal, wrench));
      if (high <= wrench_tolerance) depth = smaller(depth, -dot(normal, wrench));
    }
  }
  return spans ? depth : -1.0;
}

// Which rays balance a wrench, for many selections of the same rays: all minimal sets of rays whose
// cone contains the wrench, up to rounding.
class BalancingRays {
  static constexpr std::size_t n = 2 * max_supports;
  static constexpr std::size_t capacity = n * (n - 1) * (n - 2) / 6;

 public:
  // No wrench: nothing has to balance it.
  BalancingRays() { add(0); }

  BalancingRays(const Rays& ray, Triple wrench) {
    const auto bit = [](std::size_t i) { return std::uint32_t{1} << i; };
    // The volume that two rays span with the wrench; it is no larger than its distance from them.
    std::array<std::array<double, n>, n> volume;
    std::array<std::uint32_t, n> with;  // of each ray: those with which it balances the wrench
    std::uint32_t alone = 0;            // rays that balance it alone
    for (std::size_t i = 0; i < ray.size(); ++i) {
      with[i] = 0;
      if (distance_from_pair(ray[i], ray[i], wrench) <= wrench_tolerance) {
        alone |= bit(i);
        add(bit(i));
      }
      for (std::size_t j = 0; j < i; ++j) {
        volume[j][i] = dot(wrench, cross(ray[j], ray[i]));
        if (((bit(i) | bit(j)) & alone) != 0) {
          with[j] |= bit(i);
          continue;
        }
        if (magnitude(volume[j][i]) > 2.0 * wrench_tolerance) continue;
        const double distance = smaller(distance_from_pair(ray[i], ray[j], wrench),
                                        distance_from_pair(ray[j], ray[i], wrench));
        if (distance > wrench_tolerance) continue;
        with[j] |= bit(i);
        add(bit(i) | bit(j));
      }
    }
    for (std::size_t i = 0; i < ray.size(); ++i) {
      for (std::size_t j = i + 1; j < ray.size(); ++j) {
        if ((with[i] & bit(j)) != 0) continue;
        for (std::size_t k = j + 1; k < ray.size(); ++k) {
          if (((with[i] | with[j]) & bit(k)) != 0) continue;
          const double least = smaller(smaller(volume[i][j], volume[j][k]), -volume[i][k]);
          const double most = larger(larger(volume[i][j], volume[j][k]), -volume[i][k]);
          if (least < 0.0 && most > 0.0) continue;  // shares of both signs
          if (in_triple(ray[i], ray[j], ray[k], wrench)) add(bit(i) | bit(j) | bit(k));
        }
      }
    }
  }

  // Some of the sets, as bits.
  using Some = std::array<std::uint64_t, (capacity + 63) / 64>;

  // Those that need none of these rays (as bits).
  Some without(std::uint32_t rays) const { return without(rays, all_); }
  Some without(std::uint32_t rays, Some sets) const {
    for (; rays != 0; rays &= rays - 1) {
      const Some& with = with_[std::size_t(std::countr_zero(rays))];
      for (std::size_t w = 0; 64 * w < sets_.size(); ++w) sets[w] &= ~with[w];
    }
    return sets;
  }
  bool any(const Some& sets) const {
    std::uint64_t found = 0;
    for (std::size_t w = 0; 64 * w < sets_.size(); ++w) found |= sets[w];
    return found != 0;
  }
  const FixedList<std::uint32_t, capacity>& sets() const { return sets_; }

 private:
  // True if the wrench lies in the cone of three clearly independent rays. Cramer's rule.
  static bool in_triple(Triple a, Triple b, Triple c, Triple wrench) {
    const Triple bc = cross(b, c);
    const Triple ca = cross(c, a);
    const Triple ab = cross(a, b);
    const double volume = dot(a, bc);
    const double areas[] = {size(bc), size(ca), size(ab)};
    const double narrowest = smaller(areas[0], smaller(areas[1], areas[2]));
    const double widest = larger(areas[0], larger(areas[1], areas[2]));
    // Rays that are equal but for rounding would pass the second test alone.
    if (!(narrowest > wrench_tolerance && magnitude(volume) > wrench_tolerance * widest))
      return false;
    const double sign = volume < 0.0 ? -1.0 : 1.0;
    return sign * dot(wrench, bc) >= 0.0 && sign * dot(wrench, ca) >= 0.0 &&
           sign * dot(wrench, ab) >= 0.0;
  }

  // Distance of the wrench from the cone of two rays if its projection falls between them. Otherwise
  // the distance from the first ray, or from the origin.
  static double distance_from_pair(Triple a, Triple b, Triple wrench) {
    const double along = dot(wrench, a);
    const Triple beside = along > 0.0 ? wrench - a * along : wrench;
    const double single = size(beside);
    const Triple across = b - a * dot(a, b);
    const double width = size(across);
    if (!(width > wrench_tolerance)) return single;
    const Triple unit = across * (1.0 / width);
    const double share_b = dot(wrench, unit) / width;
    const double share_a = along - share_b * dot(a, b);
    if (!(share_a >= 0.0 && share_b >= 0.0)) return single;
    const double pair = size((wrench - a * along) - unit * dot(wrench, unit));
    return pair < single ? pair : single;
  }

  void add(std::uint32_t set) {
    const std::size_t word = sets_.size() / 64;
    const std::uint64_t bit = std::uint64_t{1} << sets_.size() % 64;
    all_[word] |= bit;
    for (std::uint32_t rays = set; rays != 0; rays &= rays - 1)
      with_[std::size_t(std::countr_zero(rays))][word] |= bit;
    sets_.push_back(set);
  }

  FixedList<std::uint32_t, capacity> sets_;
  Some all_{};
  std::array<Some, n> with_{};  // of each ray: the sets that need it
};

// Whether the contacts in these motions balance the body, up to rounding.
inline bool balances(const Supports& supports, const Motions& motions, double slope) {
  return !BalancingRays(rays_of(supports, motions), {slope, 1.0, 0.0}).sets().empty();
}

}  // namespace palmbots
