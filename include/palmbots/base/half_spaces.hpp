// SPDX-License-Identifier: Apache-2.0
// Linear equations and strict inequalities for three unknowns: whether some numbers satisfy them all.
//
// No linear program is needed. The equations leave a space of three dimensions or fewer. By
// Motzkin's theorem strict inequalities g · z > h have no solution there iff some of them
// contradict each other: positive shares with Σ share g = 0 and Σ share h ≥ 0. The extreme sets of
// such inequalities have at most one member more than the space has dimensions. It is therefore
// sufficient to test pairs, triples and quadruples.
#pragma once

#include <array>
#include <limits>

#include "palmbots/base/fixed_list.hpp"
#include "palmbots/base/vec.hpp"

namespace palmbots {

// The shares with which two, three or four vectors of unit size cancel, in any scale: Σ share v = 0.
// False where they do not span exactly one dimension less than there are of them, up to rounding.
inline bool cancels(const std::array<Triple, 2>& v, std::array<double, 2>& shares) {
  const Triple across = cross(v[0], v[1]);
  if (dot(across, across) > unit_tolerance) return false;  // clearly; mostly
  shares = {size(v[1]), dot(v[0], v[1]) < 0.0 ? size(v[0]) : -size(v[0])};
  return size(across) <= unit_tolerance * larger(size(v[0]), size(v[1]));
}
inline bool cancels(const std::array<Triple, 3>& v, std::array<double, 3>& shares) {
  const std::array<Triple, 3> across{cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])};
  if (magnitude(dot(v[0], across[0])) > 2.0 * unit_tolerance) return false;  // clearly; mostly
  const std::array<double, 3> areas{dot(across[0], across[0]), dot(across[1], across[1]),
                                    dot(across[2], across[2])};
  std::size_t widest = areas[1] > areas[0] ? 1 : 0;
  if (areas[2] > areas[widest]) widest = 2;
  const double area = square_root(areas[widest]);
  if (!(area > unit_tolerance && magnitude(dot(v[0], across[0])) <= unit_tolerance * area))
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
  return most > unit_tolerance;
}

// A condition row · x = value, or row · x > value. The row has unit size.
struct LinearCondition {
  Triple row;
  double value;
};

// The solutions of a set of equations: origin + Σ z_k basis_k.
struct SolutionSpace {
  Triple origin{};
  std::array<Triple, 3> basis{{{1.0, 0, 0}, {0, 1.0, 0}, {0, 0, 1.0}}};
  std::size_t dimension = 3;
  double error = 0.0;  // bound of that of the origin, by rounding

  // Adds an equation. Returns false if it contradicts the earlier ones.
  bool restrict(const LinearCondition& to) {
    const double missing = to.value - dot(to.row, origin);
    std::array<double, 3> along{};
    Triple within{};
    for (std::size_t k = 0; k < dimension; ++k) {
      along[k] = dot(to.row, basis[k]);
      within = within + basis[k] * along[k];
    }
    const double part = size(within);
    if (!(part > unit_tolerance)) {
      // Wider than what an inequality must be met by (HalfSpaces): a quantity that passes through 0
      // meets one of the two at every instant, in whichever order and scale conditions are added.
      const double within_rounding = 4.0 * unit_tolerance + error;
      return missing <= within_rounding && -missing <= within_rounding;
    }
    const Triple unit = within * (1.0 / part);
    origin = origin + unit * (missing / part);
    // Equations that nearly depend on each other magnify rounding.
    error = (error + 4.0 * std::numeric_limits<double>::epsilon()) / part;
    // What remains is at right angles to `unit`.
    if (dimension == 3) {
      const Triple beside =
          magnitude(unit.x) < 0.7 ? Triple{0.0, unit.z, -unit.y} : Triple{-unit.z, 0.0, unit.x};
      basis[0] = beside * (1.0 / size(beside));
      basis[1] = cross(unit, basis[0]);
    } else if (dimension == 2) {
      basis[0] = (basis[0] * along[1] - basis[1] * along[0]) * (1.0 / part);
    }
    --dimension;
    return true;
  }
};

inline constexpr std::size_t max_half_spaces = 8;

// Strict inequalities in such a space, as half spaces g · z > h with |g| = 1.
class HalfSpaces : public FixedList<LinearCondition, max_half_spaces> {
 public:
  // Adds an inequality. It may hold nowhere, everywhere or in a half space. Returns false if it holds
  // nowhere where the earlier ones hold.
  bool add(const SolutionSpace& space, const LinearCondition& above) {
    const double h = above.value - dot(above.row, space.origin);
    Triple g{};
    const std::size_t n = space.dimension;
    g.x = n > 0 ? dot(above.row, space.basis[0]) : 0.0;
    g.y = n > 1 ? dot(above.row, space.basis[1]) : 0.0;
    g.z = n > 2 ? dot(above.row, space.basis[2]) : 0.0;
    const double part = palmbots::size(g);
    if (!(part > unit_tolerance)) return h < -unit_tolerance;
    const LinearCondition last{g * (1.0 / part), h / part};
    for (const LinearCondition* a = begin(); a != end(); ++a) {
      if (contradict(*a, last)) return false;
      for (const LinearCondition* b = a + 1; b != end() && n > 1; ++b) {
        if (contradict(*a, *b, last)) return false;
        for (const LinearCondition* c = b + 1; c != end() && n > 2; ++c)
          if (contradict(*a, *b, *c, last)) return false;
      }
    }
    push_back(last);
    return true;
  }

 private:
  // Whether Σ share g = 0 and, up to rounding, Σ share h ≥ 0 for some shares > 0. If one share is
  // (almost) zero, fewer inequalities decide.
  template <class... Sides>
  static bool contradict(const Sides&... sides) {
    constexpr std::size_t n = sizeof...(Sides);
    const std::array<double, n> values{sides.value...};
    std::array<double, n> shares;
    if (!cancels({sides.row...}, shares)) return false;
    double total = 0.0;
    for (const double share : shares) total += share;
    const double sign = total < 0.0 ? -1.0 : 1.0;
    double value = 0.0;
    double sizes = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      const double share = sign * shares[k];
      if (!(share > 0.0 && share > unit_tolerance * (sign * total))) return false;
      value += share * values[k];
      sizes += share * magnitude(values[k]);
    }
    return value >= -unit_tolerance * (sign * total + sizes);
  }
};

}  // namespace palmbots
