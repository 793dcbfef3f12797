// How far from the middle of their palms both contacts may be without a look at what ends a carry.
//
// Found once per scene, so that the world need not check its ends in every tick: |p| up to the safe
// reach on both palms, at any pair of angles between shallow and steep, is certain to be held. For
// then every height difference of the contacts lies within those of the extreme angles, and over all
// of these the sufficient conditions of envelope.hpp hold.
#pragma once

#include "palmbots/envelope.hpp"
#include "palmbots/setup.hpp"

namespace palmbots {

namespace detail {

// Is the object certainly held with both |p| ≤ extent?
inline bool held_within(const Rig<double>& rig, const PerSide<AnglePair<double>>& angles,
                        double extent) {
  for (const std::size_t side : {left, right}) {
    // A contact near the pivot of a palm with an offset is not highest or lowest at an extreme angle.
    const PalmAngle<double>& steep = angles[side].steep;
    if (extent * steep.cos < std::abs(rig.offset[side]) * steep.sin) return false;
  }
  const Interval<double> both{-extent, extent};
  const Interval<double> com_y{rig.load.com_height, rig.load.com_height};
  const auto just = [](double x) { return Interval<double>{x, x}; };
  const Friction<double> friction{{just(rig.friction[left]), just(rig.friction[right])}, false};
  const Envelope<double> envelope{rig.load.width,       rig.offset,   com_y, friction,
                                  just(rig.load.slope), {both, both}, 0,     rig.clear};
  const Interval<double> permitted = com_x_held_surely(envelope, angles);
  if (!(permitted.low <= rig.load.com_left && rig.load.com_left <= permitted.high)) return false;
  const Interval<double> rise = rise_at_any_angles(envelope, angles);
  for (const double dy : {rise.low, rise.high}) {
    const Span<double> span = span_at(dy, rig.load.width);
    for (const std::size_t side : {left, right}) {
      for (const PalmAngle<double>& palm : {angles[side].shallow, angles[side].steep}) {
        if (!rig.clear[side].contains(reach(span, side, palm))) return false;
      }
    }
  }
  return true;
}

}  // namespace detail

// The safe reach of a scene [m], with a hundredth to spare for rounding; −1: none.
inline double safe_reach(const Spec& spec) {
  const Rig<double> rig = rig_of<double>(spec);
  PerSide<AnglePair<double>> angles{};
  for (const std::size_t side : {left, right}) {
    const PalmSpec& palm = spec.palms[side];
    // Squeezes and heights grow with the angle from level on only.
    if (!(palm.shallow >= 0 && palm.shallow < palm.steep)) return -1;
    angles[side] = {PalmAngle<double>::at(palm.shallow), PalmAngle<double>::at(palm.steep)};
  }
  const double longest = rig.half_length[left] < rig.half_length[right] ? rig.half_length[left]
                                                                        : rig.half_length[right];
  constexpr int steps = 16;
  for (int i = steps; i > 0; --i) {
    const double extent = longest * i / steps;
    if (detail::held_within(rig, angles, extent)) return 0.99 * extent;
  }
  return -1;
}

}  // namespace palmbots
