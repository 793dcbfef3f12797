// SPDX-License-Identifier: Apache-2.0
// Forces and margin of a contact mode, with any number of contacts.
//
// Frame: world x forward, y up, positions from the COM. Forces are in units of the weight. The
// forces that balance the weight in a contact mode are shares s ≥ 0 of the edges of the friction
// cones (mechanics/wrench_cone.hpp) with Σ s · wrench = load. These shares are a polyhedron. An
// extreme value of a force is at one of its corners, where a minimal set of edges balances the load, or
// grows without limit along one of its directions, in which such a set balances another edge. For
// people only: no motion depends on these numbers, so libm may serve.
// Source: docs/theory/contacts.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/equilibrium.hpp"
#include "palmbots/mechanics/wrench_cone.hpp"

namespace palmbots {

// The force of one contact on the object: ranges, because several forces may balance the weight. An
// end is infinite where contacts can press against each other without limit.
struct ContactForce {
  Interval<double> normal;
  Interval<double> friction;  // along the surface, > 0 to the left for someone who stands on it
};

// Where a contact mode ends.
struct ModeMargin {
  // The mode stays consistent as long as the friction angle of each surface changes by less, each
  // in its own direction [rad]; infinite: no change ends it.
  double angle;
  Supports supports;  // with the friction at its end
};

// The surface of each contact, as a number below 32: contacts of one surface have one friction.
using SurfaceNumbers = std::array<std::size_t, max_supports>;

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

// The supports with other friction angles, kept from 0° to 89°.
inline Supports at_friction_angles(Supports supports,
                                   const std::array<double, max_supports>& changes) {
  constexpr double steepest = 89.0 * radians_per_degree<double>;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const double own = std::atan(supports[i].friction);
    supports[i].friction = std::tan(clamp(own + changes[i], 0.0, larger(steepest, own)));
  }
  return supports;
}

// The first change [rad] up to `most` at which something no longer holds; infinite: none.
template <class Holds>
double first_end(Holds holds, double most) {
  constexpr double step = 0.5 * radians_per_degree<double>;
  for (double low = 0.0; low < most;) {
    const double high = smaller(low + step, most);
    if (!holds(high)) return bisect_last_true(low, high, holds);
    low = high;
  }
  return std::numeric_limits<double>::infinity();
}

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

// The margin of a contact mode.
inline ModeMargin margin_of(const Supports& supports, const Motions& motions, double slope,
                            const SurfaceNumbers& surfaces) {
  constexpr double most = 89.0 * radians_per_degree<double>;
  // More friction permits all forces that less of it does, so where all contacts of a surface stick,
  // only less of it can end the mode.
  std::uint32_t stay = 0;    // bits of the surfaces with contacts that stay
  std::uint32_t slides = 0;  // those of them with a contact that slides
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const std::uint32_t bit = std::uint32_t{1} << surfaces[i];
    if (motions[i] != Motion::leave) stay |= bit;
    if (motions[i] == Motion::up || motions[i] == Motion::down) slides |= bit;
  }
  ModeMargin found{std::numeric_limits<double>::infinity(), supports};
  for (std::uint32_t grow = 0;;
       grow = (grow - slides) & slides) {  // each subset of those that slide
    const auto changed = [&](double by) {
      std::array<double, max_supports> changes{};
      for (std::size_t i = 0; i < supports.size(); ++i) {
        if ((stay >> surfaces[i] & 1) != 0) changes[i] = (grow >> surfaces[i] & 1) != 0 ? by : -by;
      }
      return detail::at_friction_angles(supports, changes);
    };
    const auto holds = [&](double by) { return balances(changed(by), motions, slope); };
    const double end = detail::first_end(holds, smaller(found.angle, most));
    if (end < found.angle) found = {end, changed(end)};
    if (grow == slides) break;
  }
  return found;
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
