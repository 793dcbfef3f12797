// SPDX-License-Identifier: Apache-2.0
// What touches in a position: as supports, and what it means for each palm, namely where it is touched
// and how its contact moves.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/world/regime_choice.hpp"

namespace palmbots {

// All pairs whose gap is at most `closed` [m].
inline ClosedPairs touching(const Instant& at, double closed) {
  return closed_among(at, Neighbourhood{}.near(at, left, closed, closed), closed, closed);
}

// A contact with a palm (by its side) or with something that stands still.
struct Touched {
  // What touches: a vertex on a palm, an edge flush on it, or what of the surface.
  const char* kind;
  std::size_t carrier;  // as in Carrier
  double place;         // on the surface [m]
  Support support;
};

inline const char* name_of(const Surface& surface) {
  if (surface.carrier == Carrier::ground) return name_of(surface.ground);
  if (surface.tip) return "tip";
  if (surface.normal.y > 0.5) return "vertex";
  return surface.at.x < 0.0 ? "nose" : "heel";
}

namespace detail {

// Whether an earlier pair is the same contact: a feature and its neighbour, where one hands over to
// the other.
inline bool is_known(const ClosedPairs& closed, const FeatureContact& own, double near) {
  return std::any_of(closed.begin(), &own, [&](const FeatureContact& other) {
    return length(other.point - own.point) <= near && length(other.normal - own.normal) <= 1e-4;
  });
}

// Whether an edge of the object joins two pairs.
inline bool share_edge(const RoundedBody& body, const FeaturePair& a, const FeaturePair& b) {
  const auto edges = [&](const FeaturePair& pair) {
    const std::size_t own = pair.feature;
    return std::pair(own, pair.kind == PairKind::corner_on_face ? body.before(own) : own);
  };
  const auto [a1, a2] = edges(a);
  const auto [b1, b2] = edges(b);
  return a1 == b1 || a1 == b2 || a2 == b1 || a2 == b2;
}

// Whether a contact with a palm is an end of an edge that lies flush on it.
inline bool is_flush(const RoundedBody& body, const ClosedPairs& closed,
                     const FeatureContact& own) {
  constexpr double parallel = 0.01;  // an edge that leans on a heel slants more
  return own.pair.carrier <= right && std::ranges::any_of(closed, [&](const FeatureContact& other) {
           return &other != &own && other.pair.carrier == own.pair.carrier &&
                  length(other.normal - own.normal) <= parallel &&
                  share_edge(body, own.pair, other.pair);
         });
}

}  // namespace detail

// The contacts of closed pairs whose gap is at most `within` [m]. Source: docs/theory/contacts.md.
inline std::vector<Touched> touched_by(const ContactShapes& shapes, const ClosedPairs& closed,
                                       double within) {
  std::vector<Touched> found;
  for (const FeatureContact& c : closed) {
    if (detail::is_known(closed, c, 2.0 * within)) continue;
    const Surface& surface = shapes.surfaces[c.pair.surface];
    found.push_back({detail::is_flush(shapes.body, closed, c) ? "flush" : name_of(surface),
                     c.pair.carrier, surface.tip ? surface.at.x : c.place, c});
  }
  return found;
}

// The coordinates at which the palms are touched, in place of those of the contact vertices [m].
inline PerSide<double> touched_places(const Instant& at, const Regime& regime,
                                      PerSide<double> places) {
  const PerSide<const ActivePair*> first = regime.first_on_palms();
  for (const std::size_t side : {left, right}) {
    if (first[side] == nullptr || first[side]->pair == at.problem.shapes.own[side]) continue;
    const Surface& surface = at.problem.surface(first[side]->pair);
    places[side] = surface.tip ? surface.at.x : at.contact(first[side]->pair).place;
  }
  return places;
}

// The motion of each palm's first contact.
inline ContactMode motion_on_palms(const Regime& regime) {
  ContactMode motion{};
  const PerSide<const ActivePair*> first = regime.first_on_palms();
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
inline std::optional<FurtherContact> first_further(const Instant& at, const Regime& regime) {
  const PerSide<FeaturePair>& own = at.problem.shapes.own;
  for (const ActivePair& a : regime.active) {
    if (a.pair == own[left] || a.pair == own[right]) continue;
    const Surface& surface = at.problem.surface(a.pair);
    const FeatureContact c = at.contact(a.pair);
    const Vec normal = at.frames[c.pair.carrier].from_world(c.normal);
    const bool slants = magnitude(within_tip(surface, normal)) > contact_tolerance<double>;
    return FurtherContact{surface.tip && slants ? ContactKind::tip : ContactKind::flush,
                          c.pair.carrier};
  }
  return std::nullopt;
}

}  // namespace palmbots
