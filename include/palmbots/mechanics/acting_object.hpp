// SPDX-License-Identifier: Apache-2.0
// The object as it acts in a state: with its contacts at the points that touch the palms.
//
// A sharp contact vertex is that point itself. A rounded one touches `radius` below the centre of
// its arc, along the normal of the palm. In each state the object acts like a sharp one with its
// contacts at these points. Source: docs/theory/stability.md, Rounded contact vertices.
#pragma once

#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// The object and the vector between its contacts, from the points that touch the palms.
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
