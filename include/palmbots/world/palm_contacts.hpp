// SPDX-License-Identifier: Apache-2.0
// What touches in a position, and what that means for each palm: where it is touched, and how its
// contact moves.
#pragma once

#include <optional>

#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/world/regime_choice.hpp"

namespace palmbots {

// All pairs whose gap is at most `closed` [m].
inline ClosedPairs touching(const ContactProblem& problem, const Frames& frames, const Pose& pose,
                            double closed) {
  const NearPairs near = Neighbourhood{}.near(problem, left, frames, pose, closed, closed);
  return closed_among(problem, frames, pose, near, closed, closed);
}

// The coordinates at which the palms are touched, in place of those of the contact vertices [m].
inline PerSide<double> touched_places(const ContactProblem& problem, const Regime& regime,
                                      const Frames& frames, const Pose& pose,
                                      PerSide<double> places) {
  const PerSide<const ActivePair*> first = problem.first_on_palms(regime);
  for (const std::size_t side : {left, right}) {
    if (first[side] == nullptr || first[side]->pair == problem.shapes.own[side]) continue;
    const Surface& surface = problem.surface(first[side]->pair);
    places[side] =
        surface.tip ? surface.at.x : problem.contact(frames, pose, first[side]->pair).place;
  }
  return places;
}

// The motion of each palm's first contact.
inline ContactMode motion_on_palms(const ContactProblem& problem, const Regime& regime) {
  ContactMode motion{};
  const PerSide<const ActivePair*> first = problem.first_on_palms(regime);
  for (const std::size_t side : {left, right})
    if (first[side] != nullptr) motion[side] = static_cast<SlipDirection>(first[side]->motion);
  return motion;
}

// A contact besides the two contact vertices.
struct FurtherContact {
  ContactKind kind;
  std::size_t side;
};

// The first one. A palm's tip at which an edge lies along the palm is an end of a flush contact.
inline std::optional<FurtherContact> first_further(const ContactProblem& problem,
                                                   const Regime& regime, const Frames& frames,
                                                   const Pose& pose) {
  for (std::size_t i = 0; i < regime.count; ++i) {
    const FeaturePair pair = regime.active[i].pair;
    if (problem.own_side(pair) < 2) continue;
    const std::size_t side = problem.carrier(pair);
    const Surface& surface = problem.surface(pair);
    const Vec normal = frames[side].from_world(problem.contact(frames, pose, pair).normal);
    const bool slants = magnitude(within_tip(surface, normal)) > contact_tolerance<double>;
    return FurtherContact{surface.tip && slants ? ContactKind::tip : ContactKind::flush, side};
  }
  return std::nullopt;
}

}  // namespace palmbots
