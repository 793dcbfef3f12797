// SPDX-License-Identifier: Apache-2.0
// COM bounds: the properties on which the algorithms rely, and the centres of mass for which they
// hold.
//
//   property 1: driven together, the contact on the shallow palm slides up, the steep one sticks;
//   property 2: driven apart, the contact on the steep palm slides down, the shallow one sticks;
//   property 0: both stick (ST–ST), at every pair of angles the palms pass through.
//
// Each property consists of two comparisons of the squeezes at which contacts start to slip on cone
// edges. Two forces along cone edges meet in a point, and a comparison states on which side of that
// point the line of gravity passes. This is Erdmann's construction, with the points B, D, L₁, R₁,
// R₂ of the paper's Figure 4. Compared as squeezes, they need no special case for φ > θ. So at one
// object angle all comparisons bound the same number, the COM's position across the line of
// gravity:
//
//     ξ = (c_x (dx − s dy) − c_y (dy + s dx)) / (w √(1 + s²))   [m]
//
// With l, r the edges (lateral, vertical) and A = l.lat r.vert, B = l.vert r.lat, C = l.vert
// r.vert, D = l.lat r.lat, the squeeze at l exceeds that at r iff
//
//     (A + B) √(1 + s²) ξ < dx (A − s C) + dy (D − s B)
//
// This is `slip_order` of mechanics/equilibrium.hpp solved for the COM. It is linear in tan ϑ, so
// over a region of contacts only the two extreme object angles matter.
//
// Rounded contact vertices: dx and dy lead from the centre of the left arc to that of the right one. An object acts
// like a sharp one with its contacts where the arcs touch the palms, `radius` along the normals from
// the centres. At given palm angles this only adds constants to dx, dy and ξ. Each comparison is
// then linear in tan ϑ and 1 / cos ϑ.
//
// Uncertain friction: H at an edge grows with the edge's lean (while the COM is between the
// contacts). So the worst pair of frictions of each comparison is known beforehand. Sources:
// docs/theory/stability.md; paper, sections 2 and 3, equations (2)–(8), Figures 4–6.
#pragma once

#include "palmbots/mechanics/drop_reason.hpp"

namespace palmbots {

// One comparison: the squeeze at the shallow palm's edge is at most that at the steep one's
// (shallow_first), or at least that (otherwise).
struct Comparison {
  SlipDirection shallow;
  SlipDirection steep;
  bool shallow_first;
};

// A property as two comparisons, and which edges must bound the squeeze.
struct Property {
  Comparison needs[2];
  bool shallow_lets_go;  // the edge that slides must bound the squeeze, or nothing slides
  bool steep_lets_go;
};

// clang-format off
inline constexpr Property properties[3] = {
    //  shallow              steep                shallow first; with the left palm shallow
    {{{SlipDirection::up,   SlipDirection::down, false},  // 0: ST–ST
      {SlipDirection::down, SlipDirection::up,   true }}, false, false},
    {{{SlipDirection::up,   SlipDirection::up,   true },  // 1: closing, SL–ST
      {SlipDirection::up,   SlipDirection::down, false}}, true,  false},
    {{{SlipDirection::down, SlipDirection::down, true },  // 2: opening, ST–SL
      {SlipDirection::up,   SlipDirection::down, false}}, false, true },
};
// clang-format on

// The known bounds of friction: an interval for each palm. If `common`, both palms have the same
// coefficient, which may lie anywhere in the interval.
template <class Real>
struct Friction {
  PerSide<Interval<Real>> palms;
  bool common;
};

// The edge of the friction cone on which a contact slides in this direction.
template <class Real>
constexpr ConeEdge<Real> edge_of(const PalmAngle<Real>& palm, SlipDirection slide, Real friction) {
  const FrictionCone<Real> cone = friction_cone<Real>({palm.sin, palm.cos}, friction);
  return slide == SlipDirection::up ? cone.up : cone.down;
}

// The constraint that binds at an end of an interval: one of the property's two comparisons, a
// vertical force that would become negative, or an edge that is wedged and never slides.
enum class BindingConstraint : std::uint8_t {
  nothing,
  first,
  second,
  lift_left,
  lift_right,
  wedged
};

// The permitted COMs at one object angle [m]: low ≤ x c_x + y c_y ≤ high, with (x, y) of length 1.
template <class Real>
struct ComInterval {
  Real x;
  Real y;
  Real low;
  Real high;
  BindingConstraint low_by;
  BindingConstraint high_by;

  // The distance of a COM from the nearer bound [m]; negative outside.
  constexpr Real slack(Real com_x, Real com_y) const {
    const Real place = x * com_x + y * com_y;
    return place - low < high - place ? place - low : high - place;
  }

  // The permitted c_x [m] at this c_y.
  constexpr Interval<Real> com_x(Real com_y) const {
    return {(low - y * com_y) / x, (high - y * com_y) / x};
  }
};

namespace detail {

// Frictions, up to `count`.
template <class Real>
struct Frictions {
  Real at[10] = {};
  int count = 0;

  constexpr void add(Real friction, Interval<Real> within) {
    if (friction > within.low && friction < within.high) at[count++] = friction;
  }
};

// Adds the roots of c[0] + c[1] x + c[2] x² strictly between the ends.
template <class Real>
constexpr void add_roots(const Real (&c)[3], Interval<Real> within, Frictions<Real>& found) {
  const auto add = [&](Real x) { found.add(x, within); };
  const Real discriminant = c[1] * c[1] - Real(4) * c[0] * c[2];
  if (!(discriminant >= Real(0))) return;
  const Real root = std::sqrt(discriminant);
  const Real q = Real(-0.5) * (c[1] + (c[1] < Real(0) ? -root : root));
  if (c[2] != Real(0)) add(q / c[2]);
  if (q != Real(0)) add(c[0] / q);
}

// The common frictions at which a comparison can be worst: where the bound N / S on ξ is extreme or
// changes sides (both N and S are quadratic in μ), and on both sides of where an edge becomes
// wedged, because a comparison with a wedged edge bounds nothing.
template <class Real>
constexpr Frictions<Real> worst_frictions(const PerSide<PalmAngle<Real>>& palms,
                                          SlipDirection slide_left, SlipDirection slide_right,
                                          Interval<Real> friction, Real slope, Real dx, Real dy) {
  Frictions<Real> found{{friction.low}, 1};
  if (friction.low == friction.high) return found;
  found.at[found.count++] = friction.high;
  const Real p = slide_left == SlipDirection::up ? Real(1) : Real(-1);
  const Real q = slide_right == SlipDirection::up ? Real(1) : Real(-1);
  const Real ss = palms[left].sin * palms[right].sin;
  const Real sc = palms[left].sin * palms[right].cos;
  const Real cs = palms[left].cos * palms[right].sin;
  const Real cc = palms[left].cos * palms[right].cos;
  const Real a[3] = {sc, p * cc - q * ss, -p * q * cs};
  const Real b[3] = {cs, q * cc - p * ss, -p * q * sc};
  const Real c[3] = {cc, -q * cs - p * sc, p * q * ss};
  const Real d[3] = {ss, q * sc + p * cs, p * q * cc};
  Real n[3] = {};
  Real s[3] = {};
  for (int k = 0; k < 3; ++k) {
    n[k] = dx * (a[k] - slope * c[k]) + dy * (d[k] - slope * b[k]);
    s[k] = a[k] + b[k];
  }
  const Real flat[3] = {n[1] * s[0] - n[0] * s[1], Real(2) * (n[2] * s[0] - n[0] * s[2]),
                        n[2] * s[1] - n[1] * s[2]};
  add_roots(flat, friction, found);
  add_roots(s, friction, found);
  for (const std::size_t side : {left, right}) {
    // `wedged` of mechanics/equilibrium.hpp is linear in μ.
    const Real rise = mirrored(side, dy);
    const Real grows = (side == left ? p : q) * (palms[side].sin * dx + palms[side].cos * rise);
    if (grows == Real(0)) continue;
    const Real begins = (palms[side].cos * dx - palms[side].sin * rise) / grows;
    const Real apart = Real(64) * std::numeric_limits<Real>::epsilon();
    found.add(begins * (Real(1) - apart), friction);
    found.add(begins * (Real(1) + apart), friction);
  }
  return found;
}

}  // namespace detail

// The COMs for which a property holds at these palm angles and this contact vector, with the palm
// of the side `shallow` as the shallow one. `radius`: of the arcs that round the contact vertices
// [m]; `contact_vector` and COM are then those from the centres.
template <class Real>
constexpr ComInterval<Real> com_interval(const Property& property, std::size_t shallow,
                                         const PerSide<PalmAngle<Real>>& palms,
                                         const Friction<Real>& friction, Real width, Real slope,
                                         ContactVector<Real> contact_vector,
                                         const PerSide<Real>& radius = {}) {
  constexpr Real inf = std::numeric_limits<Real>::infinity();
  const PerSide<Real> back{radius[left] * palms[left].sin, radius[right] * palms[right].sin};
  const PerSide<Real> down{radius[left] * palms[left].cos, radius[right] * palms[right].cos};
  // Between the points that touch the palms.
  const Real dx = contact_vector.dx + (back[left] + back[right]);
  const Real dy = contact_vector.dy + (down[left] - down[right]);
  const Real scale = slope == Real(0) ? Real(1) : Real(1) / std::sqrt(Real(1) + slope * slope);
  ComInterval<Real> interval{(contact_vector.dx - slope * contact_vector.dy) * scale / width,
                             -(contact_vector.dy + slope * contact_vector.dx) * scale / width,
                             Real(0),
                             (dx - slope * dy) * scale,
                             BindingConstraint::lift_right,
                             BindingConstraint::lift_left};
  bool possible = dx > Real(0);

  // One comparison at one pair of frictions.
  const auto compare = [&](const Comparison& need, BindingConstraint by, const PerSide<Real>& mu) {
    const PerSide<SlipDirection> slide = shallow == left
                                             ? PerSide<SlipDirection>{need.shallow, need.steep}
                                             : PerSide<SlipDirection>{need.steep, need.shallow};
    const ConeEdge<Real> l = edge_of(palms[left], slide[left], mu[left]);
    const ConeEdge<Real> r = edge_of(palms[right], slide[right], mu[right]);
    const bool left_wedged = wedged(left, l, dx, dy);
    const bool right_wedged = wedged(right, r, dx, dy);
    if (left_wedged || right_wedged) {
      const bool shallow_wedged = shallow == left ? left_wedged : right_wedged;
      const bool steep_wedged = shallow == left ? right_wedged : left_wedged;
      // An edge that has to slide must bound the squeeze. Another edge need not.
      possible = possible && !(shallow_wedged && property.shallow_lets_go) &&
                 !(steep_wedged && property.steep_lets_go);
      return;
    }
    const Real a = l.lateral * r.vertical;
    const Real b = l.vertical * r.lateral;
    const Real sum = a + b;
    const Real limit =
        (dx * (a - slope * (l.vertical * r.vertical)) + dy * (l.lateral * r.lateral - slope * b)) *
        scale;
    // left_higher: the squeeze at the left edge must be at least the right one's.
    const bool left_higher = need.shallow_first != (shallow == left);
    if (sum == Real(0)) {
      possible = possible && (left_higher ? limit >= Real(0) : limit <= Real(0));
      return;
    }
    const Real place = limit / sum;
    if (left_higher == (sum > Real(0))) {
      if (place < interval.high) {
        interval.high = place;
        interval.high_by = by;
      }
    } else if (place > interval.low) {
      interval.low = place;
      interval.low_by = by;
    }
  };

  for (const int i : {0, 1}) {
    const Comparison& need = property.needs[i];
    const BindingConstraint by = i == 0 ? BindingConstraint::first : BindingConstraint::second;
    if (friction.common) {
      const bool mirror = shallow == right;
      const auto worst = detail::worst_frictions(palms, mirror ? need.steep : need.shallow,
                                                 mirror ? need.shallow : need.steep,
                                                 friction.palms[left], slope, dx, dy);
      for (int k = 0; k < worst.count; ++k) compare(need, by, {worst.at[k], worst.at[k]});
    } else {
      // The squeeze at an edge grows with its lean. An up edge leans more with more friction, a
      // down edge with less. The worst case has the edge that should be lower at its highest.
      PerSide<Real> mu{};
      mu[shallow] = (need.shallow == SlipDirection::up) == need.shallow_first
                        ? friction.palms[shallow].high
                        : friction.palms[shallow].low;
      mu[other(shallow)] = (need.steep == SlipDirection::up) != need.shallow_first
                               ? friction.palms[other(shallow)].high
                               : friction.palms[other(shallow)].low;
      compare(need, by, mu);
    }
  }
  // ξ counts from the centre of the left arc.
  const Real centre = (back[left] - slope * down[left]) * scale;
  interval.low -= centre;
  interval.high -= centre;
  if (!possible) {
    interval.low = inf;
    interval.high = -inf;
    interval.low_by = interval.high_by = BindingConstraint::wedged;
  }
  return interval;
}

// The contact coordinates at which a property is needed, or the operating region as a whole.
template <class Real>
using Region = PerSide<Interval<Real>>;

// Property 1 is needed to correct a negative contact on the shallow palm, property 2 to correct a
// positive one on the steep palm. `beyond` is how far past p = 0 a correction continues [m].
template <class Real>
constexpr Region<Real> region_of(int property, std::size_t shallow, Region<Real> contacts,
                                 Real beyond) {
  if (property == 1) {
    Real& high = contacts[shallow].high;
    high = high < beyond ? high : beyond;
  }
  if (property == 2) {
    Real& low = contacts[other(shallow)].low;
    low = low > -beyond ? low : -beyond;
  }
  return contacts;
}

// The height differences dy of the contacts over a region [m] (the paper's z, equation 1).
template <class Real>
constexpr Interval<Real> rise_over(const Region<Real>& contacts,
                                   const PerSide<PalmAngle<Real>>& palms,
                                   const PerSide<Real>& offset) {
  PerSide<Interval<Real>> height{};
  for (const std::size_t side : {left, right}) {
    const PalmAngle<Real>& palm = palms[side];
    const Real base = offset[side] * palm.cos;
    const Real one = base + contacts[side].low * palm.sin;
    const Real two = base + contacts[side].high * palm.sin;
    height[side] = one < two ? Interval<Real>{one, two} : Interval<Real>{two, one};
  }
  return {height[right].low - height[left].high, height[right].high - height[left].low};
}

// The smallest interval that contains both.
template <class Real>
constexpr Interval<Real> hull(Interval<Real> p, Interval<Real> q) {
  return {p.low < q.low ? p.low : q.low, p.high > q.high ? p.high : q.high};
}

// The contact vector at a height difference [m]; not a number if the object cannot reach.
template <class Real>
ContactVector<Real> contact_vector_at(Real rise, Real width) {
  return {std::sqrt((width - rise) * (width + rise)), rise};
}

}  // namespace palmbots
