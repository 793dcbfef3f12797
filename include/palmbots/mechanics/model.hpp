// SPDX-License-Identifier: Apache-2.0
// What does not change during a carry: the object, the palms, friction.
#pragma once

#include "palmbots/mechanics/clearance.hpp"

namespace palmbots {

// What does not change during a carry, in numbers.
template <class Real>
struct ModelParams {
  ObjectParams<Real> object;
  Moments<Real> moments;  // of the object
  PerSide<ClearCone<Real>> clear;
  PerSide<Real> offset;       // of the palm's surface from its pivot [m]
  PerSide<Real> half_length;  // of the palm [m]
  PerSide<Real> friction;
  // The object is held while both |p| are at most this [m], whatever angles of theirs the palms
  // have (stability/safe_reach.hpp); negative where nothing of the kind is known.
  Real safe_reach;
};

// The same with the object's outline.
template <class Real>
struct Model : ModelParams<Real> {
  Outline<Real> outline;
};

}  // namespace palmbots
