// SPDX-License-Identifier: Apache-2.0
// Safe reach: how far from the middle of their palms both contacts may be without evaluating the
// conditions that end a carry.
//
// It is computed once per scene, so that the world need not check those conditions in every tick.
// With |p| up to the safe reach on both palms the object is held at any pair of angles between
// shallow and steep. The reason is that every height difference of the contacts lies within those
// of the extreme angles, and over all of these the sufficient conditions of
// stability/operating_envelope.hpp hold.
#pragma once

#include <cmath>

#include "palmbots/mechanics/model.hpp"
#include "palmbots/stability/operating_envelope.hpp"

namespace palmbots {

namespace detail {

// Sufficient test that the object is held with both |p| ≤ extent [m].
inline bool held_within(const Model<double>& model, const PerSide<AnglePair<double>>& angles,
                        double extent) {
  for (const std::size_t side : {left, right}) {
    // On a palm with an offset, a contact near the pivot is not highest or lowest at an extreme
    // angle.
    const PalmAngle<double>& steep = angles[side].steep;
    if (extent * steep.cos < std::abs(model.offset[side]) * steep.sin) return false;
  }
  const Interval<double> both{-extent, extent};
  const OperatingEnvelope<double> envelope = envelope_of(model, {both, both});
  const Interval<double> permitted = com_x_held_surely(envelope, angles);
  if (!(permitted.low <= model.object.com_left && model.object.com_left <= permitted.high))
    return false;
  const Interval<double> rise = rise_at_any_angles(envelope, angles);
  for (const double dy : {rise.low, rise.high}) {
    const ContactVector<double> contact_vector = contact_vector_at(dy, model.object.width);
    for (const std::size_t side : {left, right}) {
      for (const PalmAngle<double>& palm : {angles[side].shallow, angles[side].steep}) {
        if (!model.clear[side].contains(palm_frame_vector(contact_vector, side, palm)))
          return false;
      }
    }
  }
  return true;
}

}  // namespace detail

// The safe reach at any angles between the given ones [m], reduced by one percent as a margin for
// rounding. −1 if there is none.
inline double safe_reach(const Model<double>& model, const PerSide<AnglePair<double>>& angles) {
  for (const double radius : contact_radii(model.outline)) {
    if (radius > 0) return -1;  // the world takes its general steps
  }
  for (const AnglePair<double>& palm : angles) {
    // Squeezes and heights grow with the angle only from the horizontal on.
    if (!(palm.shallow.angle >= 0 && palm.shallow.angle < palm.steep.angle)) return -1;
  }
  const double longest =
      model.reach[left] < model.reach[right] ? model.reach[left] : model.reach[right];
  constexpr int steps = 16;
  for (int i = steps; i > 0; --i) {
    const double extent = longest * i / steps;
    if (detail::held_within(model, angles, extent)) return 0.99 * extent;
  }
  return -1;
}

}  // namespace palmbots
