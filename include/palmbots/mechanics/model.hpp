// SPDX-License-Identifier: Apache-2.0
// The model: everything that stays constant during a carry, namely object, palms, friction and
// surroundings.
#pragma once

#include <limits>

#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/mechanics/surface.hpp"

namespace palmbots {

// The constants of a carry, without the outline.
template <class Real>
struct ModelParams {
  ObjectParams<Real> object;
  Moments<Real> moments;  // of the object
  PerSide<ClearCone<Real>> clear;
  // From the pivot to what counts as the contact vertex, across the palm: a vertex on the palm's
  // surface, or the centre of the arc that rounds it [m].
  PerSide<Real> offset;
  PerSide<Real> half_length;  // of the palm [m]
  PerSide<Real> reach;        // how far from the foot of the pivot a contact may be [m]
  PerSide<Real> friction;
  // The object is held while both |p| are at most this [m], at every pair of angles that the palms
  // can take (stability/safe_reach.hpp). Negative where no such bound is known.
  Real safe_reach;
};

// The shape of a palm, apart from its top face [m].
struct PalmProfile {
  double nose = 0.0;   // thickness at the inner end; 0: infinitely thin
  double heel = 0.0;   // height of the stop at the outer end, above the top face; 0: none
  bool stops = false;  // whether only the inner end and the heel limit where a contact may be
  // The normal of the lower side at the inner end, in the frame of the palm.
  double under_along = 0.0;
  double under_across = -1.0;

  // Whether the nose or the heel may touch the object although both contacts are within `reach` and
  // both palms are at angles that the scene permits.
  bool touches_within_reach = false;
};

// Robots that push as hard as necessary.
template <class Real>
inline constexpr PerSide<Real> no_limits{std::numeric_limits<Real>::infinity(),
                                         std::numeric_limits<Real>::infinity()};

// The constants of a carry, with the object's outline.
template <class Real>
struct Model : ModelParams<Real> {
  Outline<Real> outline;
  PerSide<PalmProfile> profile{};
  Surroundings surroundings{};
  PerSide<double> limit =
      no_limits<double>;  // of the force of each robot along the floor [weights]
};

// Whether a contact vertex is rounded and rolls.
template <class Real>
constexpr bool rolls(const Model<Real>& model) {
  const PerSide<Real> radius = contact_radii(model.outline);
  return radius[left] > Real(0) || radius[right] > Real(0);
}

// Whether every step looks for further contacts, or for robots that stall.
template <class Real>
constexpr bool is_general(const Model<Real>& model) {
  return model.limit != no_limits<double> || model.profile[left].touches_within_reach ||
         model.profile[right].touches_within_reach || is_pipe(model.object);
}

// Whether no step can be one of lanes.
template <class Real>
constexpr bool takes_single_steps(const Model<Real>& model) {
  return is_general(model) || rolls(model);
}

}  // namespace palmbots
