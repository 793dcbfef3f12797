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

// The squeezes of both contacts.
template <class V>
[[gnu::always_inline]] constexpr PerSide<Squeezes<V>> squeezes(const Contacts<V>& at) {
  return {squeezes(at.moments, left, at.cones[left], at.dx, at.dy),
          squeezes(at.moments, right, at.cones[right], at.dx, at.dy)};
}

// Which of the nine contact modes some squeeze balances. The left contact counts first, and both
// follow the order of `slip_directions`.
template <class V>
[[gnu::always_inline]] constexpr std::array<MaskOf<V>, 9> balanced_modes(
    const PerSide<Squeezes<V>>& of) {
  const auto& [l, r] = of;
  const MaskOf<V> held = (l.all.low <= l.all.high) & (r.all.low <= r.all.high);
  const MaskOf<V> stick = held & (l.all.low <= r.all.high) & (r.all.low <= l.all.high);
  const auto in = [&](const Interval<V>& all, V h) -> MaskOf<V> {
    return held & (all.low <= h) & (h <= all.high);
  };
  const auto meet = [&](V p, V q) -> MaskOf<V> {
    const V size = magnitude(p) + magnitude(q);
    return held & (magnitude(p - q) <= V(squeeze_tolerance<typename ScalarOf<V>::type>) * size);
  };
  return {stick,
          in(l.all, r.up),
          in(l.all, r.down),
          in(r.all, l.up),
          meet(l.up, r.up),
          meet(l.up, r.down),
          in(r.all, l.down),
          meet(l.down, r.up),
          meet(l.down, r.down)};
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
constexpr SelectedMode selected_mode(const PerSide<Squeezes<Real>>& of, SlipDirection direction) {
  const Interval<Real> both = intersect(of[left].all, of[right].all);
  if (both.empty()) return {false, false, {}};
  const bool closing = direction == SlipDirection::up;
  const Real end = closing ? both.high : both.low;
  ContactMode mode{SlipDirection::stick, SlipDirection::stick};
  for (const std::size_t side : {left, right}) {
    const Real own = closing ? of[side].all.high : of[side].all.low;
    if (own == end || magnitude(own - end) <= squeeze_tolerance<Real> * magnitude(end)) {
      // The end that binds must be the edge that slides in this direction. If the COM lies beyond a
      // contact it can be the other edge; then no contact can slide.
      if ((closing ? of[side].up : of[side].down) == own) mode[side] = direction;
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
      both = intersect(both, squeezes(moments, side, cone, dx, dy).all);
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
