// SPDX-License-Identifier: Apache-2.0
// The nine contact modes of one state: which of them balance, which can move, and which one occurs.
//
// Closing drives the contact points together. The squeeze rises to the upper end of I_L ∩ I_R, and
// the contact whose cone ends there slides up. Opening lowers the squeeze to the lower end, and the
// contact whose cone ends there slides down. Source: docs/theory/mechanics.md; paper, section 3.1
// ("9, 3, 5, one").
#pragma once

#include <array>

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/equilibrium.hpp"

namespace palmbots {

// All slip directions, in the order in which contact modes are numbered.
inline constexpr std::array<SlipDirection, 3> slip_directions{
    SlipDirection::stick, SlipDirection::up, SlipDirection::down};

// A contact mode of the pair: how the left and the right contact move.
using ContactMode = PerSide<SlipDirection>;

// Relative tolerance for equal ends of squeeze intervals. It covers rounding of a few hundred ulp.
template <class Real>
inline constexpr Real squeeze_tolerance = Real(256) * std::numeric_limits<Real>::epsilon();

// The statics of one state: moments, friction cones, and the vector (dx, dy) [m] from the left
// contact to the right one.
template <class Real>
struct Contacts {
  Moments<Real> moments;
  PerSide<FrictionCone<Real>> cones;
  Real dx;
  Real dy;
};

// The squeezes [weights] at which one contact is in the given mode: an interval for sticking, one
// point or nothing for sliding.
template <class Real>
constexpr Interval<Real> squeeze_in(const Contacts<Real>& at, std::size_t side,
                                    SlipDirection slide) {
  const Interval<Real> all = squeeze(at.moments, side, at.cones[side], at.dx, at.dy);
  if (slide == SlipDirection::stick || all.empty()) return all;
  const ConeEdge<Real> edge = slide == SlipDirection::up ? at.cones[side].up : at.cones[side].down;
  const Bound<Real> limit = bound(at.moments, side, edge, at.dx, at.dy);
  constexpr Interval<Real> none{Real(1), Real(-1)};
  if (limit.a == Real(0)) return none;
  const Real h = limit.b / (limit.a * at.moments.width);
  return h == all.low || h == all.high ? Interval<Real>{h, h} : none;
}

// True if some squeeze balances the object with both contacts in this mode.
template <class Real>
constexpr bool feasible(const Contacts<Real>& at, ContactMode mode) {
  const Interval<Real> l = squeeze_in(at, left, mode[left]);
  const Interval<Real> r = squeeze_in(at, right, mode[right]);
  if (l.empty() || r.empty()) return false;
  const Interval<Real> both = intersect(l, r);
  if (mode[left] == SlipDirection::stick || mode[right] == SlipDirection::stick)
    return !both.empty();
  return both.low - both.high <= squeeze_tolerance<Real> * (magnitude(l.low) + magnitude(r.low));
}

// True if the contact mode can occur in this direction: closing needs a contact that slides up,
// opening one that slides down.
constexpr bool consistent(ContactMode mode, SlipDirection direction) {
  return mode[left] == direction || mode[right] == direction;
}

// The contact mode that occurs when the contact points are driven together (direction up) or apart
// (direction down).
struct SelectedMode {
  bool balanced;     // false: no squeeze holds the object; it slides on both palms
  bool jammed;       // no squeeze makes a contact slide in that direction
  ContactMode mode;  // valid if balanced and not jammed
};

// Finds the contact mode that occurs in this direction (docs/theory/mechanics.md).
template <class Real>
constexpr SelectedMode selected_mode(const Contacts<Real>& at, SlipDirection direction) {
  const PerSide<Interval<Real>> ends{squeeze_in(at, left, SlipDirection::stick),
                                     squeeze_in(at, right, SlipDirection::stick)};
  const Interval<Real> both = intersect(ends[left], ends[right]);
  if (both.empty()) return {false, false, {}};
  const bool closing = direction == SlipDirection::up;
  const Real end = closing ? both.high : both.low;
  ContactMode mode{SlipDirection::stick, SlipDirection::stick};
  for (const std::size_t side : {left, right}) {
    const Real own = closing ? ends[side].high : ends[side].low;
    if (own == end || magnitude(own - end) <= squeeze_tolerance<Real> * magnitude(end)) {
      // The end that binds must be the edge that slides in this direction. If the COM lies beyond a
      // contact it can be the other edge; then no contact can slide.
      const Interval<Real> slide = squeeze_in(at, side, direction);
      if (!slide.empty() && slide.low == own) mode[side] = direction;
    }
  }
  return {true, !consistent(mode, direction), mode};
}

// The largest angle [rad] by which both friction cones could shrink with the object still held. It
// is negative where they would have to grow. Bisects to the last bit of the answer.
template <class Real>
Real friction_margin(const Moments<Real>& moments, PerSide<SinCos<Real>> palm,
                     PerSide<Real> friction_angle, Real dx, Real dy) {
  const auto held = [&](Real shrink) {
    Interval<Real> both{-std::numeric_limits<Real>::infinity(),
                        std::numeric_limits<Real>::infinity()};
    for (const std::size_t side : {left, right}) {
      const FrictionCone<Real> cone =
          friction_cone(palm[side], tangent(friction_angle[side] - shrink));
      both = intersect(both, squeeze(moments, side, cone, dx, dy));
    }
    return !both.empty();
  };
  // A cone shrinks to nothing at φ and grows to a half plane at φ − π/2.
  const Real widest =
      larger(friction_angle[left], friction_angle[right]) - Real(0.5) * pi<Real> + Real(1e-6);
  if (!held(widest)) return widest;
  return bisect_last_true(widest, smaller(friction_angle[left], friction_angle[right]), held);
}

}  // namespace palmbots
