// SPDX-License-Identifier: Apache-2.0
// Loop closure: positions of the two palms and the object, and the constraint between them.
//
// P are the pivots (at equal heights, `separation` apart), u is the unit vector outward along a
// palm, and n is its normal. o is the offset of the palm's surface from its pivot along n, and p
// the contact coordinate along u. A contact is at C = P + p u + o n. The object is rigid: |C_R −
// C_L| = w. Source: docs/theory/mechanics.md; for o = 0 the height difference dy is the paper's z,
// equation (1).
#pragma once

#include "palmbots/mechanics/equilibrium.hpp"

namespace palmbots {

// A palm's angle [rad], positive where the palm rises outward, with its sine and cosine.
template <class Real>
struct PalmAngle {
  Real angle;
  Real sin;
  Real cos;

  static constexpr PalmAngle at(Real angle) {
    const SinCos<Real> value = sin_cos(angle);
    return {angle, value.sin, value.cos};
  }
};

template <class V>
constexpr PalmAngle<V> select(MaskOf<V> mask, const PalmAngle<V>& yes, const PalmAngle<V>& no) {
  return {select(mask, yes.angle, no.angle), select(mask, yes.sin, no.sin),
          select(mask, yes.cos, no.cos)};
}

// Positions of the palms and of the contacts on them.
template <class Real>
struct Configuration {
  Real separation;                 // of the pivots [m]
  PerSide<PalmAngle<Real>> palms;  // [rad]
  PerSide<Real> contacts;          // p, from the foot of the pivot, outward [m]
  PerSide<Real> lift{};  // of the contact vertices above their palms (world/contact_step.hpp) [m]
};

// The vector from the left palm's foot to the right one's [m]: the contact vector at p = 0.
template <class Real>
constexpr ContactVector<Real> feet(Real separation, const PerSide<PalmAngle<Real>>& palms,
                                   const PerSide<Real>& offset) {
  return {separation - (offset[left] * palms[left].sin + offset[right] * palms[right].sin),
          offset[right] * palms[right].cos - offset[left] * palms[left].cos};
}

// The vector from the left contact to the right one [m].
template <class Real>
constexpr ContactVector<Real> contact_vector(const Configuration<Real>& s,
                                             const PerSide<Real>& offset) {
  const ContactVector<Real> base = feet(s.separation, s.palms, offset);
  const auto& p = s.contacts;
  return {base.dx + (p[left] * s.palms[left].cos + p[right] * s.palms[right].cos),
          base.dy + (p[right] * s.palms[right].sin - p[left] * s.palms[left].sin)};
}

// The vector from one contact to the other in a palm's frame [m]: inward along the palm, and along
// its normal. Divided by w they are cosine and sine of the angle between palm and object.
template <class Real>
struct PalmFrameVector {
  Real inward;
  Real normal;
};

// The contact vector in the frame of one side's palm [m].
template <class Real>
constexpr PalmFrameVector<Real> palm_frame_vector(ContactVector<Real> contact_vector,
                                                  std::size_t side, const PalmAngle<Real>& palm) {
  const Real rise = mirrored(side, contact_vector.dy);
  return {contact_vector.dx * palm.cos - rise * palm.sin,
          contact_vector.dx * palm.sin + rise * palm.cos};
}

// Closes the loop by placing the robots: the separation [m] at which the contacts have the given
// coordinates. Not a number where the object cannot reach; a pipe always can, at one height.
template <class Real>
Real closing_separation(const Configuration<Real>& s, const PerSide<Real>& offset, Real width) {
  const Configuration<Real> together{Real(0), s.palms, s.contacts};
  const ContactVector<Real> gap = contact_vector(together, offset);
  if (width == Real(0)) return -gap.dx;
  return std::sqrt((width - gap.dy) * (width + gap.dy)) - gap.dx;
}

// The object as it acts in a state: with its contacts at the points that touch the palms.
//
// A sharp contact vertex is that point itself. A rounded one touches `radius` below the centre of
// its arc, along the normal of the palm (docs/theory/stability.md, Rounded contact vertices).
template <class Real>
struct ActingObject {
  ObjectParams<Real> object;
  ContactVector<Real> contact_vector;
};

// `centres`: from the centre of the left arc to that of the right one; the lengths of `object` are
// measured from the centres.
template <class Real>
ActingObject<Real> acting_object(const ObjectParams<Real>& object, const PerSide<Real>& radius,
                                 const PerSide<PalmAngle<Real>>& palms,
                                 ContactVector<Real> centres) {
  if (radius[left] == Real(0) && radius[right] == Real(0)) return {object, centres};
  // A pipe has one centre, and may be turned in any way; here it is not.
  const ContactVector<Real> axis = is_pipe(object) ? ContactVector<Real>{1, 0} : centres;
  const Real size = is_pipe(object) ? Real(1) : object.width;
  const Real dx = centres.dx + (radius[left] * palms[left].sin + radius[right] * palms[right].sin);
  const Real dy = centres.dy + (radius[left] * palms[left].cos - radius[right] * palms[right].cos);
  const Real width = square_root(dx * dx + dy * dy);
  // The COM seen from both points, so that the mirrored state has mirrored numbers to the last bit.
  PerSide<Real> along{};
  PerSide<Real> height{};
  for (const std::size_t side : {left, right}) {
    const Real com = side == left ? object.com_left : object.com_right;
    const Real rise = mirrored(side, axis.dy);
    // Level, inward, and up.
    const Real x =
        (com * axis.dx - object.com_height * rise) / size + radius[side] * palms[side].sin;
    const Real y =
        (com * rise + object.com_height * axis.dx) / size + radius[side] * palms[side].cos;
    along[side] = (x * dx + y * mirrored(side, dy)) / width;
    height[side] = (y * dx - x * mirrored(side, dy)) / width;
  }
  const Real up = Real(0.5) * (height[left] + height[right]);
  return {{width, along[left], along[right], up, object.slope}, {dx, dy}};
}

}  // namespace palmbots
