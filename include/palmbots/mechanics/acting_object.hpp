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
  const Real dx = centres.dx + (radius[left] * palms[left].sin + radius[right] * palms[right].sin);
  const Real dy = centres.dy + (radius[left] * palms[left].cos - radius[right] * palms[right].cos);
  // The COM from the left point, level and up.
  const Real x = (object.com_left * centres.dx - object.com_height * centres.dy) / object.width +
                 radius[left] * palms[left].sin;
  const Real y = (object.com_left * centres.dy + object.com_height * centres.dx) / object.width +
                 radius[left] * palms[left].cos;
  const Real width = square_root(dx * dx + dy * dy);
  const Real com_left = (x * dx + y * dy) / width;
  return {{width, com_left, width - com_left, (y * dx - x * dy) / width, object.slope}, {dx, dy}};
}

}  // namespace palmbots
