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
  Supports<double> supports;  // with the friction at its end
};

// The surface of each contact, as a number below 32: contacts of one surface have one friction.
using SurfaceNumbers = std::array<std::size_t, max_supports>;

namespace detail {

using Shares = std::array<double, 2 * max_supports>;  // of the edges

// The shares of the edges that balance the weight.
class EdgeShares {
 public:
  EdgeShares(const Supports<double>& supports, const Motions& motions, double slope)
      : load_{slope, 1.0, 0.0} {
    const double reach = supports.reach();
    for (std::size_t i = 0; i < supports.count; ++i) {
      const Support<double>& s = supports.at[i];
      const double up = s.side == left ? 1.0 : -1.0;  // whether that is to the left
      for (const Motion edge : {Motion::up, Motion::down}) {
        if (motions[i] != edge && motions[i] != Motion::stick) continue;
        const double along = (edge == Motion::up ? -up : up) * s.friction;
        const double fx = s.nx - along * s.ny;
        const double fy = s.ny + along * s.nx;
        wrench_[count_] = {fx, fy, (s.x * fy - s.y * fx) / reach};
        contact_[count_] = i;
        along_[count_++] = along;
      }
    }
  }

  std::size_t count() const { return count_; }
  std::size_t contact(std::size_t edge) const { return contact_[edge]; }
  double along(std::size_t edge) const { return along_[edge]; }

  // The corners of the polyhedron. There are some: the mode is in balance up to rounding, which a
  // triple of nearly dependent edges magnifies.
  std::vector<Shares> corners() const {
    for (const double tolerance : {1e-8, 1e-6, 1e-4, 1e-2}) {
      std::vector<Shares> found;
      for (std::size_t i = 0; i < count_; ++i) {
        add_corner<1>({i}, tolerance, found);
        for (std::size_t j = i + 1; j < count_; ++j) {
          add_corner<2>({i, j}, tolerance, found);
          for (std::size_t k = j + 1; k < count_; ++k) add_corner<3>({i, j, k}, tolerance, found);
        }
      }
      if (!found.empty()) return found;
    }
    return {Shares{}};
  }

  // The directions in which the polyhedron is endless.
  std::vector<Shares> directions() const {
    std::vector<Shares> found;
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = i + 1; j < count_; ++j) {
        add_direction<2>({i, j}, found);
        for (std::size_t k = j + 1; k < count_; ++k) {
          add_direction<3>({i, j, k}, found);
          for (std::size_t l = k + 1; l < count_; ++l) add_direction<4>({i, j, k, l}, found);
        }
      }
    }
    return found;
  }

 private:
  static constexpr double independent = 1e-9;  // least distance of an edge from the span of others

  template <std::size_t n>
  using Edges = std::array<std::size_t, n>;

  // The shares of independent edges whose sum is nearest to the load. False: they are dependent.
  template <std::size_t n>
  bool solve(const Edges<n>& edges, std::array<double, n>& shares) const {
    const Triple<double>& a = wrench_[edges[0]];
    if constexpr (n == 1) {
      shares[0] = dot(a, load_) / dot(a, a);
      return size(a) > independent;
    } else if constexpr (n == 2) {
      const Triple<double>& b = wrench_[edges[1]];
      const Triple<double> normal = cross(a, b);
      const double area = dot(normal, normal);
      if (!(std::sqrt(area) > independent * larger(size(a), size(b)))) return false;
      shares = {dot(cross(load_, b), normal) / area, dot(cross(a, load_), normal) / area};
      return true;
    } else {
      const Triple<double>& b = wrench_[edges[1]];
      const Triple<double>& c = wrench_[edges[2]];
      const Triple<double> bc = cross(b, c);
      const Triple<double> ca = cross(c, a);
      const Triple<double> ab = cross(a, b);
      const double volume = dot(a, bc);
      const double widest = larger(size(bc), larger(size(ca), size(ab)));
      if (!(magnitude(volume) > independent * widest)) return false;
      shares = {dot(load_, bc) / volume, dot(load_, ca) / volume, dot(load_, ab) / volume};
      return true;
    }
  }

  template <std::size_t n>
  void add_corner(const Edges<n>& edges, double tolerance, std::vector<Shares>& found) const {
    std::array<double, n> shares{};
    if (!solve(edges, shares)) return;
    Triple<double> off = load_ * -1.0;
    double least = 0.0;
    double most = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      off = off + wrench_[edges[k]] * shares[k];
      least = smaller(least, shares[k]);
      most = larger(most, magnitude(shares[k]));
    }
    const double missing = larger(magnitude(off.x), larger(magnitude(off.y), magnitude(off.z)));
    if (!(missing <= tolerance * (1.0 + most) && least >= -tolerance)) return;
    put(edges, shares, found);
  }

  // The shares with which edges of one dimension too many add up to nothing. False: they have other
  // dimensions.
  bool null_of(const Edges<2>& edges, std::array<double, 2>& shares) const {
    const Triple<double>& a = wrench_[edges[0]];
    const Triple<double>& b = wrench_[edges[1]];
    shares = {size(b), dot(a, b) < 0.0 ? size(a) : -size(a)};
    return size(cross(a, b)) <= independent * larger(size(a), size(b));
  }
  bool null_of(const Edges<3>& edges, std::array<double, 3>& shares) const {
    const Triple<double> bc = cross(wrench_[edges[1]], wrench_[edges[2]]);
    const Triple<double> ca = cross(wrench_[edges[2]], wrench_[edges[0]]);
    const Triple<double> ab = cross(wrench_[edges[0]], wrench_[edges[1]]);
    const double bc_size = size(bc);
    const double widest = larger(bc_size, larger(size(ca), size(ab)));
    if (!(widest > independent)) return false;
    if (magnitude(dot(wrench_[edges[0]], bc)) > independent * widest) return false;
    const Triple<double>& plane = bc_size == widest ? bc : size(ca) == widest ? ca : ab;
    shares = {dot(bc, plane), dot(ca, plane), dot(ab, plane)};
    return true;
  }
  bool null_of(const Edges<4>& edges, std::array<double, 4>& shares) const {
    const Triple<double>& a = wrench_[edges[0]];
    const Triple<double>& b = wrench_[edges[1]];
    const Triple<double>& c = wrench_[edges[2]];
    const Triple<double>& d = wrench_[edges[3]];
    shares = {dot(b, cross(c, d)), -dot(a, cross(c, d)), dot(a, cross(b, d)), -dot(a, cross(b, c))};
    double most = 0.0;
    for (const double share : shares) most = larger(most, magnitude(share));
    return most > independent;
  }

  template <std::size_t n>
  void add_direction(const Edges<n>& edges, std::vector<Shares>& found) const {
    std::array<double, n> shares{};
    if (!null_of(edges, shares)) return;
    double sum = 0.0;
    double square = 0.0;
    for (const double share : shares) {
      sum += share;
      square += share * share;
    }
    const double scale = (sum > 0.0 ? 1.0 : -1.0) / std::sqrt(square);
    for (double& share : shares) {
      share *= scale;
      if (!(share >= -independent)) return;
    }
    put(edges, shares, found);
  }

  template <std::size_t n>
  static void put(const Edges<n>& edges, const std::array<double, n>& shares,
                  std::vector<Shares>& found) {
    Shares all{};
    for (std::size_t k = 0; k < n; ++k) all[edges[k]] = larger(shares[k], 0.0);
    found.push_back(all);
  }

  Triple<double> load_;
  std::array<Triple<double>, 2 * max_supports> wrench_{};  // per unit of normal force
  std::array<std::size_t, 2 * max_supports> contact_{};
  std::array<double, 2 * max_supports> along_{};  // friction force, likewise
  std::size_t count_ = 0;
};

// The supports with other friction angles, kept from 0° to 89°.
inline Supports<double> at_friction_angles(const Supports<double>& supports,
                                           const std::array<double, max_supports>& changes) {
  constexpr double steepest = 89.0 * radians_per_degree<double>;
  Supports<double> changed = supports;
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
inline std::array<ContactForce, max_supports> contact_forces(const Supports<double>& supports,
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
inline ModeMargin margin_of(const Supports<double>& supports, const Motions& motions, double slope,
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
inline Motions loaded_edges(const Supports<double>& supports, const Motions& motions,
                            double slope) {
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
