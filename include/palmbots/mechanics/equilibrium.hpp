// SPDX-License-Identifier: Apache-2.0
// Static equilibrium of an object on two contacts: the friction cones, the interval of squeezes, and
// which contact slips first.
//
// Frame: world x forward, y up; forces in units of the weight. A palm pushes the object inward with
// the horizontal force H and upward with V, with the same signs on either side. Coulomb friction
// bounds the lean of the force from the vertical, atan(H / V), to [θ − φ, θ + φ], φ = atan μ.
// docs/theory/mechanics.md derives why balance leaves one unknown, the squeeze, and why a cone edge
// bounds it linearly, a H ≤ b for `up` and a H ≥ b for `down`. With the vector (dx, dy) from the left
// contact to the right one, the horizontal distances x_L and x_R of the COM from them, its mean height
// y above them and a sideways specific force s towards −x:
//
//     left : a = vertical dx − lateral dy      b = lateral (x_R + s y) − ½ s vertical dx
//     right: a = vertical dx + lateral dy      b = lateral (x_L − s y) + ½ s vertical dx
//
// H is the mean of both squeezes, so that the mirrored problem has mirrored numbers to the last bit.
#pragma once

#include <cstdint>
#include <limits>

#include "palmbots/base/interval.hpp"
#include "palmbots/base/side.hpp"

namespace palmbots {

// How a contact moves on its palm: down is inward (towards the partner), up is outward.
// The paper's names: on the left palm up = SL and down = SR, on the right palm up = SR, down = SL.
enum class SlipDirection : std::int8_t { down = -1, stick = 0, up = 1 };

// One edge of a friction cone, as the direction (lateral, vertical) of the force on it, so that
// tan(lean) = lateral / vertical. Not normalized: with T = tan θ it is cos θ · (T ± μ, 1 ∓ μT).
template <class Real>
struct ConeEdge {
  Real lateral;
  Real vertical;
};

// The two edges of a friction cone. The force on a contact that slides up lies on `up` (lean θ +
// φ), the force on one that slides down lies on `down` (lean θ − φ).
template <class Real>
struct FrictionCone {
  ConeEdge<Real> up;
  ConeEdge<Real> down;
};

// The friction cone of a palm at this angle; `friction` is μ. With −μ, the edges change places.
template <class Real>
constexpr FrictionCone<Real> friction_cone(SinCos<Real> palm, Real friction) {
  return {{palm.sin + friction * palm.cos, palm.cos - friction * palm.sin},
          {palm.sin - friction * palm.cos, palm.cos + friction * palm.sin}};
}

// The vector from the left contact to the right one [m].
template <class Real>
struct ContactVector {
  Real dx;
  Real dy;
};

// The object as statics sees it. The COM is given from both contacts (com_left + com_right = w), so
// that mirroring swaps two numbers and rounds nothing.
template <class Real>
struct ObjectParams {
  Real width;       // w, distance between the contacts [m]
  Real com_left;    // COM from the left contact, along the line of contacts [m]
  Real com_right;   // COM from the right contact, along the line of contacts [m]
  Real com_height;  // COM above the line of contacts [m]
  Real slope;       // s, sideways specific force towards −x [1]
};

// Whether the object touches both palms with one arc: its contacts have one centre.
template <class Object>
constexpr bool is_pipe(const Object& object) {
  return object.width == 0;
}

// The moment arms of the weight and of the sideways force, from which the bounds below are
// computed. Multiplied by w: w (x_R + s y) = level[left] dx + tilt dy, and its mirror image on the
// right.
template <class Real>
struct Moments {
  Real width;           // w [m]
  PerSide<Real> level;  // [m]
  Real tilt;            // [m]
  PerSide<Real> lift;   // replaces `tilt` in moment_arm() [m]
  Real slope;           // s [1]

  static constexpr Moments of(const ObjectParams<Real>& object) { return of(object, object.slope); }

  // The moments under another sideways specific force s.
  static constexpr Moments of(const ObjectParams<Real>& object, Real s) {
    return {object.width,
            {object.com_right + s * object.com_height, object.com_left - s * object.com_height},
            object.com_height + s * (Real(0.5) * (object.com_left - object.com_right)),
            {object.com_height - s * object.com_right, object.com_height + s * object.com_left},
            s};
  }

  // w (x_R + s y_R) on the left and w (x_L − s y_L) on the right, where y_L and y_R are the heights
  // of the COM above that contact. Negative where no force presses on this side's palm: the object
  // tips.
  constexpr Real moment_arm(std::size_t side, Real dx, Real rise) const {
    return level[side] * dx + lift[side] * rise;
  }

  // The moment arm in the bounds below, at the mean height of the COM.
  constexpr Real arm(std::size_t side, Real dx, Real rise) const {
    return level[side] * dx + tilt * rise;
  }
};

// The bound a H ≤ b (up) or a H ≥ b (down) that one cone edge sets for the squeeze. b is multiplied
// by w.
template <class Real>
struct Bound {
  Real a;
  Real b;
};

// The bound that this cone edge of one side's contact sets for the squeeze.
template <class Real>
constexpr Bound<Real> bound(const Moments<Real>& moments, std::size_t side, ConeEdge<Real> edge,
                            Real dx, Real dy) {
  const Real rise = mirrored(side, dy);
  const Real push = mirrored(side, moments.slope);
  return {edge.vertical * dx - edge.lateral * rise,
          edge.lateral * moments.arm(side, dx, rise) -
              Real(0.5) * push * moments.width * edge.vertical * dx};
}

// The half line {H : a H ≤ b}.
template <class V>
constexpr Interval<V> half_line(V a, V b) {
  const V inf(std::numeric_limits<typename ScalarOf<V>::type>::infinity());
  const V end = b / a;
  const MaskOf<V> none = !((a < V(0)) | (a > V(0)) | (b >= V(0)));
  return {select(a < V(0), end, select(none, inf, -inf)),
          select(a > V(0), end, select(none, -inf, inf))};
}

// The squeezes H [weights] that one contact can carry: `all` is I_L or I_R, where its force lies in
// its cone; `up` and `down` are those at which it slides, an end of that interval or not a number.
// They are valid if the interval is not empty.
template <class V>
struct Squeezes {
  Interval<V> all;
  V up;
  V down;
};

template <class V>
[[gnu::always_inline]] constexpr Squeezes<V> squeezes(const Moments<V>& moments, std::size_t side,
                                                      const FrictionCone<V>& cone, V dx, V dy) {
  const Bound<V> up = bound(moments, side, cone.up, dx, dy);
  const Bound<V> down = bound(moments, side, cone.down, dx, dy);
  const V up_a = up.a * moments.width;
  const V down_a = down.a * moments.width;
  const V at_up = up.b / up_a;
  const V at_down = down.b / down_a;
  // Without friction the cone is one ray.
  const MaskOf<V> is_ray = cone.up.lateral == cone.down.lateral;
  // Usually every edge bounds the squeeze from its own side.
  if (all((up_a > V(0)) & (down_a > V(0)) & (at_up == at_up) & !is_ray))
    return {{at_down, at_up}, at_up, at_down};
  Interval<V> held = intersect(half_line(up_a, up.b), half_line(-down_a, -down.b));
  // The two bounds of a ray leave the line through it, on which the contact may have to pull.
  const MaskOf<V> pulls = is_ray & (up.a * moments.moment_arm(side, dx, mirrored(side, dy)) < V(0));
  held = {select(pulls, V(1), held.low), select(pulls, V(-1), held.high)};
  const auto end = [&](V a, V h) {
    const V none(std::numeric_limits<typename ScalarOf<V>::type>::quiet_NaN());
    return select((a != V(0)) & ((h == held.low) | (h == held.high)), h, none);
  };
  return {held, end(up_a, at_up), end(down_a, at_down)};
}

// The line in (dx, dy) on which the squeezes at one edge of the left cone and one edge of the right
// cone are equal. It is a line because the polynomial G of docs/theory/stability.md is linear in
// tan ϑ = dy / dx; its quadratic terms cancel, with s ≠ 0 too.
//
// at(dx, dy) > 0 ⇔ H at the left edge > H at the right edge, where neither edge is wedged.
template <class Real>
struct SlipOrder {
  Real level;
  Real tilt;

  constexpr Real at(ContactVector<Real> contact_vector) const {
    return level * contact_vector.dx + tilt * contact_vector.dy;
  }
};

// The slip order of an edge of the left cone and an edge of the right one.
template <class Real>
constexpr SlipOrder<Real> slip_order(const Moments<Real>& moments, ConeEdge<Real> l,
                                     ConeEdge<Real> r) {
  const Real half_push = Real(0.5) * moments.slope * moments.width;
  const Real lateral_left = l.lateral * r.vertical;
  const Real lateral_right = l.vertical * r.lateral;
  return {(lateral_left * moments.level[left] - lateral_right * moments.level[right]) -
              (half_push + half_push) * (l.vertical * r.vertical),
          ((l.lateral * r.lateral) * moments.width + half_push * (lateral_left - lateral_right)) +
              moments.tilt * (lateral_left + lateral_right)};
}

// True where an edge bounds no squeeze, because its cone contains the line to the other contact.
// Pushing along that line only wedges the object (docs/theory/mechanics.md).
template <class Real>
constexpr MaskOf<Real> wedged(std::size_t side, ConeEdge<Real> edge, Real dx, Real dy) {
  const Real rise = mirrored(side, dy);
  return !(edge.vertical * dx - edge.lateral * rise > Real(0));
}

}  // namespace palmbots
