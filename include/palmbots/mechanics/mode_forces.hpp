// SPDX-License-Identifier: Apache-2.0
// Forces of a contact mode, with any number of contacts.
//
// Frame: world x forward, y up, positions from the COM. Forces are in units of the weight. The
// forces that balance the weight in a contact mode are shares s ≥ 0 of the edges of the friction
// cones (mechanics/wrench_cone.hpp) with Σ s · wrench = load. These shares are a polyhedron. An
// extreme value of a force is at one of its corners, where a minimal set of edges balances the load, or
// grows without limit along one of its directions, in which such a set balances another edge.
// Source: docs/theory/contacts.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "palmbots/mechanics/wrench_cone.hpp"

namespace palmbots {

// The force of one contact on the object: ranges, because several forces may balance the weight. An
// end is infinite where contacts can press against each other without limit.
struct ContactForce {
  Interval<double> normal;
  Interval<double> friction;  // along the surface, > 0 to the left for someone who stands on it
};

namespace detail {

using Shares = std::array<double, 2 * max_supports>;  // of the edges

// An edge of a friction cone on which a force can lie.
struct Edge {
  std::size_t contact;
  double along;   // friction force per unit of normal force
  double normal;  // normal force of its ray
};

// The edges, and the shares of them that balance the weight.
struct EdgeShares {
  std::vector<Edge> edges;
  std::vector<Shares> corners;     // of the polyhedron; there are some: the mode is in balance
  std::vector<Shares> directions;  // in which it is endless

  EdgeShares(const Supports& supports, const Motions& motions, double slope) {
    const Rays rays = rays_of(supports, motions);
    for (std::size_t i = 0; i < supports.size(); ++i) {
      const Support& s = supports[i];
      each_edge(motions[i], s.friction, [&](double along) {
        const Triple& ray = rays[edges.size()];
        edges.push_back({i, -outward<double>(s.side) * along, dot(s.normal, Vec{ray.x, ray.y})});
      });
    }
    corners = balancing(rays, {slope, 1.0, 0.0});
    for (std::size_t k = 0; k < edges.size(); ++k) {
      for (Shares& shares : balancing(rays, rays[k] * -1.0)) {
        shares[k] += edges[k].normal;
        directions.push_back(shares);
      }
    }
  }

 private:
  // The shares, as normal forces, of each minimal set of edges that balances a wrench.
  std::vector<Shares> balancing(const Rays& rays, Triple wrench) const {
    std::vector<Shares> found;
    const ContainingCones balancing(rays, wrench);
    for (const std::uint32_t set : balancing.sets()) {
      const RayShares parts = shares_of(set, rays, wrench);
      Shares& shares = found.emplace_back();
      for (std::size_t k = 0; k < parts.count; ++k)
        shares[parts.ray[k]] = parts.share[k] * edges[parts.ray[k]].normal;
    }
    return found;
  }
};

}  // namespace detail

// The ranges of the forces in a contact mode that is in balance.
inline std::array<ContactForce, max_supports> contact_forces(const Supports& supports,
                                                             const Motions& motions, double slope) {
  const detail::EdgeShares all(supports, motions, slope);
  constexpr double grows = 1e-9;
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::array<ContactForce, max_supports> forces{};
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const auto extent = [&](bool is_normal) {
      const auto of = [&](const detail::Shares& shares) {
        double value = 0.0;
        for (std::size_t k = 0; k < all.edges.size(); ++k)
          if (all.edges[k].contact == i)
            value += shares[k] * (is_normal ? 1.0 : all.edges[k].along);
        return value;
      };
      Interval<double> range{inf, -inf};
      for (const detail::Shares& corner : all.corners)
        range = {smaller(range.low, of(corner)), larger(range.high, of(corner))};
      for (const detail::Shares& direction : all.directions) {
        if (of(direction) < -grows) range.low = -inf;
        if (of(direction) > grows) range.high = inf;
      }
      return Interval<double>{range.low + 0.0, range.high + 0.0};
    };
    forces[i] = {extent(true), extent(false)};
  }
  return forces;
}

// How each contact can be loaded: as its motion would be if its force lies on one edge, and as if
// it left if it carries nothing.
inline Motions loaded_edges(const Supports& supports, const Motions& motions, double slope) {
  constexpr double carries = 1e-5;  // weights; a contact with less carries nothing
  const detail::EdgeShares all(supports, motions, slope);
  Motions found{};
  for (std::size_t i = 0; i < supports.size(); ++i) {
    std::size_t count = 0;
    double along = 0.0;  // of the first edge that is loaded
    for (std::size_t k = 0; k < all.edges.size(); ++k) {
      const auto is_loaded = [&](const detail::Shares& corner) { return corner[k] > carries; };
      if (all.edges[k].contact != i || std::ranges::none_of(all.corners, is_loaded)) continue;
      if (count++ == 0) along = all.edges[k].along;
    }
    found[i] = motions[i];
    if (count == 0) {
      found[i] = Motion::leave;
    } else if (motions[i] == Motion::stick && count == 1) {
      found[i] = (along < 0.0) == (supports[i].side == left) ? Motion::up : Motion::down;
    }
  }
  return found;
}

}  // namespace palmbots
