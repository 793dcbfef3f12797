// SPDX-License-Identifier: Apache-2.0
// The cone of a few rays in three dimensions: whether it contains a vector, and with which shares of
// the rays.
//
// No linear program is needed. By Carathéodory's theorem a vector lies in a cone in three dimensions
// iff it lies in the cone of at most three of its rays. The point of the cone nearest to a vector
// outside it lies on one ray or between two. Parallel, opposed and dependent rays need no special
// treatment: a degenerate triple is covered by its pairs, and a degenerate pair by its single rays.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "palmbots/base/fixed_list.hpp"
#include "palmbots/base/vec.hpp"

namespace palmbots {

inline constexpr std::size_t max_rays = 16;

// Rays from the origin, of unit size.
using Rays = FixedList<Triple, max_rays>;

// The share of each of up to three rays in a vector; negative where it would have to point backwards.
struct RayShares {
  std::array<std::size_t, 3> ray;
  std::array<double, 3> share;
  std::size_t count;

  double least() const {
    const double two = smaller(share[0], share[1]);
    return count == 2 ? two : smaller(two, share[2]);
  }
};

// Calls `each` with the shares in a vector of every three rays that span the space. Of two rays alone,
// the shares in the part of the vector that is in their plane.
template <class Each>
void for_each_combination(const Rays& rays, Triple vector, Each&& each) {
  if (rays.size() == 2) {
    const Triple n = cross(rays[0], rays[1]);
    const double area = dot(n, n);
    each(RayShares{
        {0, 1}, {dot(cross(vector, rays[1]), n) / area, dot(cross(rays[0], vector), n) / area}, 2});
    return;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      for (std::size_t k = j + 1; k < rays.size(); ++k) {
        const std::array<Triple, 3> ray{rays[i], rays[j], rays[k]};
        if (magnitude(dot(ray[0], cross(ray[1], ray[2]))) > unit_tolerance)
          each(RayShares{{i, j, k}, parts_along(ray, vector), 3});
      }
    }
  }
}

// The shares in a vector of rays whose cone contains it (as bits), up to three that do not depend on
// each other. None is negative.
inline RayShares shares_of(std::uint32_t set, const Rays& rays, Triple vector) {
  RayShares found{{}, {}, 0};
  std::array<Triple, 3> own{};
  for (; set != 0; set &= set - 1) {
    const auto k = std::size_t(std::countr_zero(set));
    own[found.count] = rays[k];
    found.ray[found.count++] = k;
  }
  // What is at right angles to fewer than three rays has no share.
  if (found.count == 1) own[1] = Triple{-own[0].y, own[0].x, 0.0};
  if (found.count < 3) own[2] = cross(own[0], own[1]);
  found.share = parts_along(own, vector);
  for (double& share : found.share) share = larger(share, 0.0);
  return found;
}

// The largest least share of a ray in a vector, over all combinations: ≥ 0 iff the cone contains it. It
// is −1 if no rays span the space.
inline double best_least_share(const Rays& rays, Triple vector) {
  double best = -1.0;
  for_each_combination(rays, vector,
                       [&](const RayShares& shares) { best = larger(best, shares.least()); });
  return best;
}

// How far a vector is inside a cone: the distance from its nearest face. Negative outside, and
// nowhere positive if the cone is flat.
inline double depth_in(const Rays& rays, Triple vector) {
  double depth = std::numeric_limits<double>::infinity();
  bool spans = false;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      Triple normal = cross(rays[i], rays[j]);
      const double area = size(normal);
      if (!(area > unit_tolerance)) continue;
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
      if (low >= -unit_tolerance) depth = smaller(depth, dot(normal, vector));
      if (high <= unit_tolerance) depth = smaller(depth, -dot(normal, vector));
    }
  }
  return spans ? depth : -1.0;
}

// All minimal sets of rays whose cone contains a vector, up to rounding. They are found once and then
// answer for any selection of the rays whether its cone contains the vector.
class ContainingCones {
  static constexpr std::size_t n = max_rays;
  static constexpr std::size_t capacity = n * (n - 1) * (n - 2) / 6;

 public:
  // For the vector 0, which the empty set contains.
  ContainingCones() { add(0); }

  ContainingCones(const Rays& ray, Triple vector) {
    const auto bit = [](std::size_t i) { return std::uint32_t{1} << i; };
    // The volume that two rays span with the vector; it is no larger than its distance from them.
    std::array<std::array<double, n>, n> volume;
    std::array<std::uint32_t, n> with;  // of each ray: those with which its cone contains it
    std::uint32_t alone = 0;            // rays along the vector
    for (std::size_t i = 0; i < ray.size(); ++i) {
      with[i] = 0;
      if (distance_from_pair(ray[i], ray[i], vector) <= unit_tolerance) {
        alone |= bit(i);
        add(bit(i));
      }
      for (std::size_t j = 0; j < i; ++j) {
        volume[j][i] = dot(vector, cross(ray[j], ray[i]));
        if (((bit(i) | bit(j)) & alone) != 0) {
          with[j] |= bit(i);
          continue;
        }
        if (magnitude(volume[j][i]) > 2.0 * unit_tolerance) continue;
        const double distance = smaller(distance_from_pair(ray[i], ray[j], vector),
                                        distance_from_pair(ray[j], ray[i], vector));
        if (distance > unit_tolerance) continue;
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
          if (in_triple(ray[i], ray[j], ray[k], vector)) add(bit(i) | bit(j) | bit(k));
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
  // True if the vector lies in the cone of three clearly independent rays. Cramer's rule.
  static bool in_triple(Triple a, Triple b, Triple c, Triple vector) {
    const Triple bc = cross(b, c);
    const Triple ca = cross(c, a);
    const Triple ab = cross(a, b);
    const double volume = dot(a, bc);
    const double areas[] = {size(bc), size(ca), size(ab)};
    const double narrowest = smaller(areas[0], smaller(areas[1], areas[2]));
    const double widest = larger(areas[0], larger(areas[1], areas[2]));
    // Rays that are equal but for rounding would pass the second test alone.
    if (!(narrowest > unit_tolerance && magnitude(volume) > unit_tolerance * widest)) return false;
    const double sign = volume < 0.0 ? -1.0 : 1.0;
    return sign * dot(vector, bc) >= 0.0 && sign * dot(vector, ca) >= 0.0 &&
           sign * dot(vector, ab) >= 0.0;
  }

  // Distance of the vector from the cone of two rays if its projection falls between them. Otherwise
  // the distance from the first ray, or from the origin.
  static double distance_from_pair(Triple a, Triple b, Triple vector) {
    const double along = dot(vector, a);
    const Triple beside = along > 0.0 ? vector - a * along : vector;
    const double single = size(beside);
    const Triple across = b - a * dot(a, b);
    const double width = size(across);
    if (!(width > unit_tolerance)) return single;
    const Triple unit = across * (1.0 / width);
    const double share_b = dot(vector, unit) / width;
    const double share_a = along - share_b * dot(a, b);
    if (!(share_a >= 0.0 && share_b >= 0.0)) return single;
    const double pair = size((vector - a * along) - unit * dot(vector, unit));
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

}  // namespace palmbots
