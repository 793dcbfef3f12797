// SPDX-License-Identifier: Apache-2.0
// Drop reason: the criterion by which a carry ends with a drop. The conditions are those under which
// two palms hold an object at one instant. The first one that fails is the reason for the drop.
//
// Source: docs/theory/contacts.md.
#pragma once

#include "palmbots/mechanics/carry_ends.hpp"
#include "palmbots/mechanics/model.hpp"

namespace palmbots {

// The friction cones at one pair of palm angles.
template <class Real>
struct Statics {
  PerSide<FrictionCone<Real>> cones;

  static constexpr Statics at(const Model<Real>& model, const PerSide<PalmAngle<Real>>& palms) {
    Statics s{};
    for (const std::size_t side : {left, right}) {
      s.cones[side] = friction_cone<Real>({palms[side].sin, palms[side].cos}, model.friction[side]);
    }
    return s;
  }

  // ≥ 0 while the squeeze at `lower`'s lower cone end does not exceed that at the other side's
  // upper end.
  constexpr Real overlap(const Moments<Real>& moments, std::size_t lower,
                         ContactVector<Real> contact_vector) const {
    if (lower == right)
      return slip_order(moments, cones[left].up, cones[right].down).at(contact_vector);
    return -slip_order(moments, cones[left].down, cones[right].up).at(contact_vector);
  }

  // True if the edge on which this contact slides in this direction bounds no squeeze.
  constexpr bool wedged_in(std::size_t side, SlipDirection direction,
                           ContactVector<Real> contact_vector) const {
    const ConeEdge<Real> edge = direction == SlipDirection::up ? cones[side].up : cones[side].down;
    return wedged(side, edge, contact_vector.dx, contact_vector.dy);
  }
};

// Sufficient test, without a branch, that the object is held; it settles almost every tick. It may
// return false although the object is held, because of a wedged edge or a palm that passes below an
// overhang. `moments` and `touching` are about the points that touch the palms; `contact_vector` is
// about the centres of the arcs if contact vertices are rounded (mechanics/acting_object.hpp).
template <class Real>
[[gnu::always_inline]] inline MaskOf<Real> certainly_held(
    const ModelParams<Real>& params, const Moments<Real>& moments, ContactVector<Real> touching,
    const PerSide<FrictionCone<Real>>& cones, const PerSide<PalmAngle<Real>>& palms,
    const PerSide<Real>& contacts, ContactVector<Real> contact_vector) {
  const Real left_up = slip_order(moments, cones[left].up, cones[right].down).at(touching);
  const Real right_up = slip_order(moments, cones[left].down, cones[right].up).at(touching);
  MaskOf<Real> held = (left_up >= Real(0)) & (right_up <= Real(0));
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
[[gnu::noinline]] DropReason drop_reason(const Model<Real>& model, const Statics<Real>& statics,
                                         const PerSide<PalmAngle<Real>>& palms,
                                         const PerSide<Real>& contacts,
                                         ContactVector<Real> contact_vector) {
  for (const std::size_t side : {left, right}) {
    const Real p = contacts[side];
    if (!(p >= -model.reach[side] && p <= model.reach[side])) return DropReason::off_palm;
  }
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
  const bool left_holds = statics.overlap(model.moments, right, contact_vector) >= Real(0) ||
                          statics.wedged_in(left, SlipDirection::up, contact_vector) ||
                          statics.wedged_in(right, SlipDirection::down, contact_vector);
  const bool right_holds = statics.overlap(model.moments, left, contact_vector) >= Real(0) ||
                           statics.wedged_in(left, SlipDirection::down, contact_vector) ||
                           statics.wedged_in(right, SlipDirection::up, contact_vector);
  return left_holds && right_holds ? DropReason::none : DropReason::sliding;
}

}  // namespace palmbots
