// SPDX-License-Identifier: Apache-2.0
// Margin of a contact mode: by how much friction may differ until the mode is no longer in balance.
// Source: docs/theory/contacts.md.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "palmbots/base/root_finding.hpp"
#include "palmbots/base/scalar.hpp"
#include "palmbots/mechanics/wrench_cone.hpp"

namespace palmbots {

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

// The margin of a contact mode. Friction angles are kept from 0° to 89°.
inline ModeMargin margin_of(const Supports& supports, const Motions& motions, double slope,
                            const SurfaceNumbers& surfaces) {
  constexpr double steepest = 89.0 * radians_per_degree<double>;
  // More friction permits all forces that less of it does, so where all contacts of a surface stick,
  // only less of it can end the mode.
  std::uint32_t stay = 0;    // bits of the surfaces with contacts that stay
  std::uint32_t slides = 0;  // those of them with a contact that slides
  std::array<double, max_supports> angles{};
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const std::uint32_t bit = std::uint32_t{1} << surfaces[i];
    if (motions[i] != Motion::leave) stay |= bit;
    if (motions[i] == Motion::up || motions[i] == Motion::down) slides |= bit;
    angles[i] = angle_of(supports[i].friction, 1.0);
  }
  ModeMargin found{std::numeric_limits<double>::infinity(), supports};
  for (std::uint32_t grow = 0;;
       grow = (grow - slides) & slides) {  // each subset of those that slide
    const auto is_in = [&](std::uint32_t bits, std::size_t i) {
      return (bits >> surfaces[i] & 1) != 0;
    };
    double most = 0.0;  // larger changes have no further effect
    for (std::size_t i = 0; i < supports.size(); ++i)
      if (is_in(stay, i)) most = larger(most, is_in(grow, i) ? steepest - angles[i] : angles[i]);
    const auto changed = [&](double by) {
      Supports other = supports;
      for (std::size_t i = 0; i < supports.size(); ++i) {
        const double angle = angles[i] + (is_in(grow, i) ? by : -by);
        if (is_in(stay, i))
          other[i].friction = tangent(clamp(angle, 0.0, larger(steepest, angles[i])));
      }
      return other;
    };
    const auto holds = [&](double by) { return balances(changed(by), motions, slope); };
    const double end = detail::first_end(holds, smaller(found.angle, most));
    if (end < found.angle) found = {end, changed(end)};
    if (grow == slides) break;
  }
  return found;
}

}  // namespace palmbots
