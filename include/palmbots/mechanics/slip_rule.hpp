// SPDX-License-Identifier: Apache-2.0
// Slip rule: which contact slides while the contact points are driven together or apart, and when
// both do (properties 1 and 2 of the paper). docs/theory/mechanics.md states it: the squeeze goes to
// an end of the overlap of I_L and I_R, the contact whose interval ends there slides, and where both
// end, the regions into which sliding leads decide. An end beyond a wedged edge is unbounded: such a
// contact does not slide, and the robots are jammed if both are.
//
// The fast step (world/fast_step.hpp) and the general step (world/general_step.hpp) follow this rule,
// for one carry or for several side by side. In all functions, `way` is +1 where the contacts slide up
// and −1 where they slide down.
#pragma once

#include <cstdint>

#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// The direction in which contacts slide while the squared distance of the contact points changes at
// this rate: up while closing, down while opening.
template <class Real>
constexpr SlipDirection direction_of(Real rate) {
  return rate < Real(0) ? SlipDirection::up
                        : (rate > Real(0) ? SlipDirection::down : SlipDirection::stick);
}

// The moments that decide. They include the push, a further sideways specific force
// (acceleration / g).
template <class V>
constexpr Moments<V> moments_under(const ObjectParams<V>& object, V push) {
  return Moments<V>::of(object, object.slope + push);
}

// The cone edges of contacts that slide that way.
template <class V>
constexpr PerSide<ConeEdge<V>> edges_at(const PerSide<V>& friction,
                                        const PerSide<PalmAngle<V>>& palms, V way) {
  PerSide<ConeEdge<V>> edges{};
  on_both_sides([&](std::size_t side) {
    edges[side] = friction_cone<V>({palms[side].sin, palms[side].cos}, way * friction[side]).up;
  });
  return edges;
}

// By how much the left contact slips before the right one, in units that only the sign is used of:
// > 0: the left contact slips first; < 0: the right one; 0: a tie. Valid where neither is wedged.
template <class V>
constexpr V left_lead(const SlipOrder<V>& order, ContactVector<V> contact_vector, V way) {
  return -(order.at(contact_vector) * way);
}

// The same for the left contact where `on_left`, for the right one elsewhere.
template <class V>
constexpr V lead_of(MaskOf<V> on_left, V lead_of_left) {
  return select(on_left, lead_of_left, -lead_of_left);
}

// The slope dy / dx of the contact vector at which both ends are equal; it stays as it is where
// every slope is a tie. Both contacts slide along it.
template <class Real>
constexpr Real tied_slope(const SlipOrder<Real>& order, ContactVector<Real> contact_vector) {
  return order.tilt != Real(0) ? -order.level / order.tilt : contact_vector.dy / contact_vector.dx;
}

// What the rule needs to know of one instant.
template <class V>
struct SlipOnset {
  PerSide<MaskOf<V>> wedged;
  V left_lead;

  static constexpr SlipOnset at(const Moments<V>& moments, const PerSide<ConeEdge<V>>& edges,
                                ContactVector<V> contact_vector, V way) {
    SlipOnset onset{
        {},
        palmbots::left_lead(slip_order(moments, edges[left], edges[right]), contact_vector, way)};
    on_both_sides([&](std::size_t side) {
      onset.wedged[side] =
          palmbots::wedged(side, edges[side], contact_vector.dx, contact_vector.dy);
    });
    return onset;
  }

  // > 0 in the own region of the contact, < 0 in that of the other one; 0 where an edge is wedged.
  constexpr V own_lead(MaskOf<V> on_left) const {
    V lead = lead_of(on_left, left_lead);
    on_both_sides([&](std::size_t side) { lead = select(wedged[side], V(0), lead); });
    return lead;
  }
};

// Which contacts slide. At a tie, what happens next decides (`slides_at_tie`).
enum class SlidingContact : std::uint8_t { on_left = 0, on_right = 1, both = 2, none = 3, tie = 4 };

// Which contact slides; `none`: the robots are jammed. `tied`: both slide along their tie until now.
template <class Real>
constexpr SlidingContact first_to_slip(const SlipOnset<Real>& onset, bool tied) {
  if (onset.wedged[left] && onset.wedged[right]) return SlidingContact::none;
  if (onset.wedged[left]) return SlidingContact::on_right;
  if (onset.wedged[right]) return SlidingContact::on_left;
  if (tied || onset.left_lead == Real(0)) return SlidingContact::tie;
  return onset.left_lead > Real(0) ? SlidingContact::on_left : SlidingContact::on_right;
}

// Which contacts slide on from a tie. Each argument is true if that contact, sliding alone, leads
// into its own region.
constexpr SlidingContact slides_at_tie(bool left_goes_on, bool right_goes_on) {
  if (left_goes_on == right_goes_on) return SlidingContact::both;
  return left_goes_on ? SlidingContact::on_left : SlidingContact::on_right;
}

}  // namespace palmbots
