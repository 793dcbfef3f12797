// SPDX-License-Identifier: Apache-2.0
// Kinematics of sliding: the rate at which the robots drive the contact points together or apart,
// and where one contact slides. mechanics/slip_rule.hpp states which one.
//
// Source: docs/theory/mechanics.md.
#pragma once

#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// Half the rate of change of |C_R − C_L|² with both contacts sticking: < 0 closes, > 0 opens.
// `change` and `turn` are the rates of the separation and of the palm angles.
template <class Real>
constexpr Real drive_rate(const PerSide<PalmAngle<Real>>& palms, const PerSide<Real>& contacts,
                          const PerSide<Real>& offset, ContactVector<Real> contact_vector,
                          Real change, const PerSide<Real>& turn) {
  PerSide<Real> along{};
  PerSide<Real> lift{};
  on_both_sides([&](std::size_t side) {
    const PalmAngle<Real>& palm = palms[side];
    const Real p = contacts[side];
    const Real o = offset[side];
    along[side] = (p * palm.sin + o * palm.cos) * turn[side];
    lift[side] = (p * palm.cos - o * palm.sin) * turn[side];
  });
  return contact_vector.dx * (change - (along[left] + along[right])) +
         contact_vector.dy * (lift[right] - lift[left]);
}

// The contact coordinates after one contact has slid, and the resulting contact vector.
template <class V>
struct Slipped {
  PerSide<V> contacts;
  ContactVector<V> contact_vector;
};

// Closes the loop by sliding one contact: the left one where `on_left`, else the right one. The result
// is not a number where the object cannot reach.
template <class V>
[[gnu::always_inline]] inline Slipped<V> slip(MaskOf<V> on_left, V separation,
                                              const PerSide<PalmAngle<V>>& palms,
                                              const PerSide<V>& contacts, const PerSide<V>& offset,
                                              V width) {
  // Everything is seen from the side of the contact that slides.
  ContactVector<V> base = feet(separation, palms, offset);
  base.dy = select(on_left, base.dy, -base.dy);
  const PalmAngle<V> own = select<V>(on_left, palms[left], palms[right]);
  const PalmAngle<V> partner = select<V>(on_left, palms[right], palms[left]);
  const V held = select(on_left, contacts[right], contacts[left]);
  // In the frame of the palm `own`, the normal part of the vector to the other contact does not
  // change while sliding. The inward part must become √(w² − normal²).
  const V dx = base.dx + held * partner.cos;
  const V rise = base.dy + held * partner.sin;
  const V inward = dx * own.cos - rise * own.sin;
  const V normal = dx * own.sin + rise * own.cos;
  const V contact = square_root((width - normal) * (width + normal)) - inward;
  const V dy = rise - contact * own.sin;
  return {{select(on_left, contact, contacts[left]), select(on_left, contacts[right], contact)},
          {dx + contact * own.cos, select(on_left, dy, -dy)}};
}

// Closes the loop by sliding both contacts such that the object takes the direction dy / dx =
// slope. This gives two linear equations. Between parallel palms sliding cannot choose the
// direction: only the sum of the two coordinates counts, and each contact takes half of the change.
template <class Real>
PerSide<Real> solve_slide_along(const Configuration<Real>& s, Real slope,
                                const PerSide<Real>& offset, Real width) {
  const auto& l = s.palms[left];
  const auto& r = s.palms[right];
  const Real turn = l.sin * r.cos + r.sin * l.cos;  // sin(θ_L + θ_R)
  constexpr Real parallel = Real(1e-6);
  if (turn < parallel && turn > -parallel) {
    PerSide<Real> alone{};
    for (const std::size_t side : {left, right}) {
      const Slipped<Real> slid =
          slip<Real>(side == left, s.separation, s.palms, s.contacts, offset, width);
      alone[side] = slid.contacts[side] - s.contacts[side];
    }
    const Real half = Real(0.25) * (alone[left] + alone[right]);
    return {s.contacts[left] + half, s.contacts[right] + half};
  }
  const ContactVector<Real> base = feet(s.separation, s.palms, offset);
  const Real target_dx = width / std::sqrt(Real(1) + slope * slope);
  const Real dx = target_dx - base.dx;
  const Real dy = target_dx * slope - base.dy;
  return {(dx * r.sin - dy * r.cos) / turn, (dx * l.sin + dy * l.cos) / turn};
}

}  // namespace palmbots
