// SPDX-License-Identifier: Apache-2.0
// Forces and margin of a contact mode, with any number of contacts.
//
// Frame: world x forward, y up, positions from the COM. Forces are in units of the weight. The
// forces that balance the weight in a contact mode are shares s ≥ 0 of the edges of the friction
// cones (mechanics/wrench_cone.hpp) with Σ s · wrench = load. These shares are a polyhedron. An
// extreme value of a force is at one of its corners, where at most three independent edges have
// shares, or grows without limit along one of its directions, in which at most four edges balance
// one another. Both are enumerated. For people only: no motion depends on these numbers, so libm
// may serve. Source: docs/theory/contacts.md.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

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

// The shares of the edges that balance the weight.
class EdgeShares {
 public:
  EdgeShares(const Supports& supports, const Motions& motions, double slope) {
    const double reach = supports.reach();
    for (std::size_t i = 0; i < supports.count; ++i) {
      const Support& s = supports.at[i];
      each_edge(motions[i], s.friction, [&](double along) {
        const double fx = s.nx + along * s.tx();
        const double fy = s.ny + along * s.ty();
        wrench_[count_] = {fx, fy, (s.x * fy - s.y * fx) / reach};
        contact_[count_] = i;
        along_[count_++] = -outward<double>(s.side) * along;
      });
    }
    wrench_[count_] = {-slope, -1.0, 0.0};
  }

  std::size_t count() const { return count_; }
  std::size_t contact(std::size_t edge) const { return contact_[edge]; }
  double along(std::size_t edge) const { return along_[edge]; }

  // The corners of the polyhedron. There are some: the mode is in balance up to rounding, which a
  // triple of nearly dependent edges magnifies.
  std::vector<Shares> corners() const {
    for (const double tolerance : {1e-8, 1e-6, 1e-4, 1e-2}) {
      std::vector<Shares> found = cancelling(tolerance, true);
      if (!found.empty()) return found;
    }
    return {Shares{}};
  }

  // The directions in which the polyhedron is endless.
  std::vector<Shares> directions() const { return cancelling(wrench_tolerance, false); }

 private:
  template <std::size_t n>
  using Edges = std::array<std::size_t, n>;

  // The shares ≥ 0 of as few edges as possible that cancel, with the load or by themselves. The last
  // column is the reversed load.
  std::vector<Shares> cancelling(double tolerance, bool with_load) const {
    std::vector<Shares> found;
    const auto try_these = [&]<std::size_t n>(const Edges<n>& edges) {
      std::array<double, n> shares{};
      std::array<Triple, n> wrenches;
      for (std::size_t k = 0; k < n; ++k) wrenches[k] = wrench_[edges[k]];
      if ((edges.back() == count_) != with_load || !cancels(wrenches, tolerance, shares)) return;
      double size = 0.0;
      for (const double share : shares) size += share * share;
      size = std::sqrt(size);
      const double whole = with_load ? shares.back() : 0.0;
      if (with_load && !(magnitude(whole) > wrench_tolerance * size)) return;
      double sum = 0.0;
      for (const double share : shares) sum += share;
      const double scale = with_load ? 1.0 / whole : (sum > 0.0 ? 1.0 : -1.0) / size;
      Shares all{};
      for (std::size_t k = 0; k < n; ++k) {
        if (!(shares[k] * scale >= -tolerance)) return;
        if (edges[k] < count_) all[edges[k]] = larger(shares[k] * scale, 0.0);
      }
      found.push_back(all);
    };
    for (std::size_t i = 0; i <= count_; ++i) {
      for (std::size_t j = i + 1; j <= count_; ++j) {
        try_these(Edges<2>{i, j});
        for (std::size_t k = j + 1; k <= count_; ++k) {
          try_these(Edges<3>{i, j, k});
          for (std::size_t l = k + 1; l <= count_; ++l) try_these(Edges<4>{i, j, k, l});
        }
      }
    }
    return found;
  }

  std::array<Triple, 2 * max_supports + 1> wrench_{};  // per unit of normal force, and the load
  std::array<std::size_t, 2 * max_supports> contact_{};
  std::array<double, 2 * max_supports> along_{};  // friction force, likewise
  std::size_t count_ = 0;
};

// The supports with other friction angles, kept from 0° to 89°.
inline Supports at_friction_angles(const Supports& supports,
                                   const std::array<double, max_supports>& changes) {
  constexpr double steepest = 89.0 * radians_per_degree<double>;
  Supports changed = supports;
  for (std::size_t i = 0; i < supports.count; ++i) {
    const double own = std::atan(supports.at[i].friction);
    changed.at[i].friction = std::tan(clamp(own + changes[i], 0.0, larger(steepest, own)));
  }
  return changed;
}

// The first change [rad] up to `most` at which something no longer holds; infinite: none.
template <class Holds>
double first_end(Holds holds, double most) {
  constexpr double step = 0.5 * radians_per_degree<double>;
  constexpr double exact = 1e-9;  // [rad]
  for (double low = 0.0; low < most;) {
    double high = smaller(low + step, most);
    if (holds(high)) {
      low = high;
      continue;
    }
    while (high - low > exact) {
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    return low;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace detail

// The ranges of the forces in a contact mode that is in balance.
inline std::array<ContactForce, max_supports> contact_forces(const Supports& supports,
                                                             const Motions& motions, double slope) {
  const detail::EdgeShares edges(supports, motions, slope);
  const auto corners = edges.corners();
  const auto directions = edges.directions();
  constexpr double grows = 1e-9;
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::array<ContactForce, max_supports> forces{};
  for (std::size_t i = 0; i < supports.count; ++i) {
    const auto extent = [&](bool is_normal) {
      const auto of = [&](const detail::Shares& shares) {
        double value = 0.0;
        for (std::size_t k = 0; k < edges.count(); ++k)
          if (edges.contact(k) == i) value += shares[k] * (is_normal ? 1.0 : edges.along(k));
        return value;
      };
      Interval<double> range{inf, -inf};
      for (const detail::Shares& corner : corners) {
        range = {smaller(range.low, of(corner)), larger(range.high, of(corner))};
      }
      for (const detail::Shares& direction : directions) {
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
  for (std::size_t i = 0; i < supports.count; ++i) {
    const std::uint32_t bit = std::uint32_t{1} << surfaces[i];
    if (motions[i] != Motion::leave) stay |= bit;
    if (motions[i] == Motion::up || motions[i] == Motion::down) slides |= bit;
  }
  ModeMargin found{std::numeric_limits<double>::infinity(), supports};
  for (std::uint32_t grow = 0;;
       grow = (grow - slides) & slides) {  // each subset of those that slide
    const auto changed = [&](double by) {
      std::array<double, max_supports> changes{};
      for (std::size_t i = 0; i < supports.count; ++i) {
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
  const detail::EdgeShares edges(supports, motions, slope);
  const auto corners = edges.corners();
  Motions found{};
  for (std::size_t i = 0; i < supports.count; ++i) {
    std::size_t count = 0;
    double along = 0.0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
      double share = 0.0;
      for (const detail::Shares& corner : corners) share = larger(share, corner[k]);
      if (edges.contact(k) != i || !(share > carries)) continue;
      if (count++ == 0) along = edges.along(k);
    }
    const bool slides_left = along < 0.0;
    if (count == 0) {
      found[i] = Motion::leave;
    } else if (motions[i] != Motion::stick || count == 2) {
      found[i] = motions[i];
    } else {
      found[i] = slides_left == (supports.at[i].side == left) ? Motion::up : Motion::down;
    }
  }
  return found;
}

}  // namespace palmbots
