// SPDX-License-Identifier: Apache-2.0
// Drop reason: the criterion by which a carry ends with a drop. The conditions are those under which
// two palms hold an object at one instant. The first one that fails is the reason for the drop.
//
// Source: docs/theory/contacts.md.
#pragma once

#include "palmbots/mechanics/carry_ends.hpp"
#include "palmbots/mechanics/model.hpp"

namespace palmbots {

// The friction cones of both palms at one pair of angles.
template <class V>
constexpr PerSide<FrictionCone<V>> cones_at(const PerSide<V>& friction,
                                            const PerSide<PalmAngle<V>>& palms) {
  PerSide<FrictionCone<V>> cones{};
  on_both_sides([&](std::size_t side) {
    cones[side] = friction_cone<V>({palms[side].sin, palms[side].cos}, friction[side]);
  });
  return cones;
}

// ≥ 0 while the squeeze at the lower cone end of this side does not exceed that at the other side's
// upper end.
template <class V>
constexpr V overlap(const Moments<V>& moments, const PerSide<FrictionCone<V>>& cones,
                    std::size_t lower, ContactVector<V> contact_vector) {
  if (lower == right)
    return slip_order(moments, cones[left].up, cones[right].down).at(contact_vector);
  return -slip_order(moments, cones[left].down, cones[right].up).at(contact_vector);
}

// Sufficient test, without a branch, that the object is held; it settles almost every tick. It may
// return false although the object is held, because of a wedged edge or a palm that passes below an
// overhang. `moments` and `touching` are about the points that touch the palms; `contact_vector` is
// about the centres of the arcs if contact vertices are rounded (mechanics/loop_closure.hpp).
template <class Real>
[[gnu::always_inline]] inline MaskOf<Real> certainly_held(
    const ModelParams<Real>& params, const Moments<Real>& moments, ContactVector<Real> touching,
    const PerSide<FrictionCone<Real>>& cones, const PerSide<PalmAngle<Real>>& palms,
    const PerSide<Real>& contacts, ContactVector<Real> contact_vector) {
  const Real left_holds = overlap(moments, cones, right, touching);
  const Real right_holds = overlap(moments, cones, left, touching);
  MaskOf<Real> held = (left_holds >= Real(0)) & (right_holds >= Real(0));
  on_both_sides([&](std::size_t side) {
    const MaskOf<Real> on_palm = within(contacts[side], params.reach[side]);
    const Real arm = moments.moment_arm(side, touching.dx, mirrored(side, touching.dy));
    const MaskOf<Real> clear =
        params.clear[side].contains(palm_frame_vector(contact_vector, side, palms[side]));
    held = held & on_palm & (arm >= Real(0)) & clear;
  });
  return held;
}

// The first reason, in a fixed order, why the object is not held, or `none`.
template <class Real>
[[gnu::noinline]] DropReason drop_reason(const Model<Real>& model,
                                         const PerSide<PalmAngle<Real>>& palms,
                                         const PerSide<Real>& contacts,
                                         ContactVector<Real> contact_vector) {
  for (const std::size_t side : {left, right})
    if (!within(contacts[side], model.reach[side])) return DropReason::off_palm;
  bool at_tip = false;
  for (const std::size_t side : {left, right}) {
    const PalmFrameVector<Real> r = palm_frame_vector(contact_vector, side, palms[side]);
    if (model.clear[side].contains(r)) continue;
    const ContactKind t = further_contact(model.outline, side, r, model.object.width,
                                          contacts[side], model.half_length[side]);
    if (t == ContactKind::flush) return DropReason::flush;
    at_tip = at_tip || t == ContactKind::tip;
  }
  if (at_tip) return DropReason::tip;
  for (const std::size_t side : {left, right}) {
    const Real arm =
        model.moments.moment_arm(side, contact_vector.dx, mirrored(side, contact_vector.dy));
    if (!(arm >= Real(0))) return DropReason::tipping;
  }
  const auto cones = cones_at(model.friction, palms);
  const auto is_wedged = [&](std::size_t side, ConeEdge<Real> edge) {
    return wedged(side, edge, contact_vector.dx, contact_vector.dy);
  };
  const auto holds = [&](std::size_t side) {
    return overlap(model.moments, cones, other(side), contact_vector) >= Real(0) ||
           is_wedged(side, cones[side].up) || is_wedged(other(side), cones[other(side)].down);
  };
  return holds(left) && holds(right) ? DropReason::none : DropReason::sliding;
}

}  // namespace palmbots
