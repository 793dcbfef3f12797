// SPDX-License-Identifier: Apache-2.0
// Operating envelope: the conditions under which the properties have to hold, and the COMs for
// which they do.
//
// An envelope is a box: the COM's height, each palm's friction, the slope and the contacts each lie
// in an interval. The result is the interval of c_x that is permitted everywhere in the box, at
// exactly given palm angles. Its bounds are monotone or linear in each quantity alone
// (stability/com_bounds.hpp), so the corners of the box decide. Errors of the palm angles are not
// part of the box; they are treated as further pairs of angles.
//
// The operating region: with one palm tilted to shallow, either its own contact is to be corrected
// (property 1's region) or the partner's (property 2's). With both palms at the same angle, the
// contacts may be anywhere. Sources: docs/theory/stability.md; paper, sections 3.3 and 3.4.
#pragma once

#include "palmbots/stability/com_bounds.hpp"

namespace palmbots {

// The envelope: intervals of all quantities, and the geometry that is exactly known.
template <class Real>
struct OperatingEnvelope {
  Real width;            // w [m]
  PerSide<Real> offset;  // of the palms' surfaces from their pivots [m]
  Interval<Real> com_y;  // [m]
  Friction<Real> friction;
  Interval<Real> slope;  // s [1]
  Region<Real> contacts;
  Real beyond;                     // how far past p = 0 a correction continues [m]
  PerSide<ClearCone<Real>> clear;  // of the object's outline, for each palm
  PerSide<Real> radius{};          // of the arcs that round the contact vertices [m]

  constexpr bool is_rounded() const { return radius[left] > Real(0) || radius[right] > Real(0); }
};

// The envelope at exactly this model's friction, COM height and slope.
template <class Real>
OperatingEnvelope<Real> envelope_of(const Model<Real>& model, const Region<Real>& contacts) {
  const auto just = [](Real x) { return Interval<Real>{x, x}; };
  const Friction<Real> friction{{just(model.friction[left]), just(model.friction[right])}, false};
  return {model.object.width,
          model.offset,
          just(model.object.com_height),
          friction,
          just(model.object.slope),
          contacts,
          Real(0),
          model.clear,
          contact_radii(model.outline)};
}

// The two angles between which each palm is switched.
template <class Real>
struct AnglePair {
  PalmAngle<Real> shallow;
  PalmAngle<Real> steep;
};

namespace detail {

inline constexpr int turn_steps = 8;  // number of angles at which a turning palm is evaluated

// The factors by which to multiply radii at a height difference, so that the comparisons hold for
// all height differences in an interval: if 1 / cos ϑ counts as an independent number between
// its extremes, they are linear, and the worst case is at a corner.
template <class Real>
PerSide<Real> radius_factors(Interval<Real> rise, Real dy, Real width) {
  const auto cosine = [&](Real z) { return contact_vector_at(z, width).dx / width; };
  const Real low = cosine(rise.low);
  const Real high = cosine(rise.high);
  const bool level = rise.low < Real(0) && rise.high > Real(0);
  const Real here = cosine(dy);
  return {here / (level ? Real(1) : (low > high ? low : high)), here / (low < high ? low : high)};
}

// The c_x [m] that a property permits at two extreme height differences.
template <class Real>
Interval<Real> com_x_at(const OperatingEnvelope<Real>& envelope, const Property& property,
                        std::size_t shallow, const PerSide<PalmAngle<Real>>& palms,
                        Interval<Real> rise) {
  Interval<Real> permitted{-std::numeric_limits<Real>::infinity(),
                           std::numeric_limits<Real>::infinity()};
  for (const Real slope : {envelope.slope.low, envelope.slope.high}) {
    for (const Real dy : {rise.low, rise.high}) {
      for (const Real factor : radius_factors(rise, dy, envelope.width)) {
        const ComInterval<Real> interval = com_interval(
            property, shallow, palms, envelope.friction, envelope.width, slope,
            contact_vector_at(dy, envelope.width),
            PerSide<Real>{factor * envelope.radius[left], factor * envelope.radius[right]});
        for (const Real com_y : {envelope.com_y.low, envelope.com_y.high}) {
          permitted = intersect(permitted, interval.com_x(com_y));
        }
        if (!envelope.is_rounded()) break;
      }
    }
    if (envelope.slope.low == envelope.slope.high) break;
  }
  return permitted;
}

template <class Real>
Interval<Real> operating_rise(const OperatingEnvelope<Real>& envelope, std::size_t shallow,
                              const PerSide<PalmAngle<Real>>& palms) {
  const auto rise = [&](int property) {
    return rise_over(region_of(property, shallow, envelope.contacts, envelope.beyond), palms,
                     envelope.offset);
  };
  return hull(rise(1), rise(2));
}

}  // namespace detail

// The c_x [m] that property 1 or 2 permits everywhere, with the given palm shallow.
template <class Real>
Interval<Real> com_x_of(const OperatingEnvelope<Real>& envelope, int property, std::size_t shallow,
                        const PerSide<AnglePair<Real>>& angles) {
  PerSide<PalmAngle<Real>> palms{};
  palms[shallow] = angles[shallow].shallow;
  palms[other(shallow)] = angles[other(shallow)].steep;
  const Interval<Real> rise = rise_over(
      region_of(property, shallow, envelope.contacts, envelope.beyond), palms, envelope.offset);
  return detail::com_x_at(envelope, properties[property], shallow, palms, rise);
}

namespace detail {

// True if the envelope is its own mirror image.
template <class Real>
constexpr bool symmetric(const OperatingEnvelope<Real>& e, const PerSide<AnglePair<Real>>& angles) {
  const auto same = [](Interval<Real> p, Interval<Real> q) {
    return p.low == q.low && p.high == q.high;
  };
  return e.slope.low == Real(0) && e.slope.high == Real(0) && e.offset[left] == e.offset[right] &&
         e.radius[left] == e.radius[right] &&
         same(e.friction.palms[left], e.friction.palms[right]) &&
         same(e.contacts[left], e.contacts[right]) &&
         angles[left].shallow.angle == angles[right].shallow.angle &&
         angles[left].steep.angle == angles[right].steep.angle;
}

// For a symmetric envelope: intersects the interval of one side with its mirror image, which is
// that of the other side.
template <class Real>
constexpr Interval<Real> and_mirrored(const OperatingEnvelope<Real>& e, Interval<Real> com_x,
                                      bool mirror) {
  return mirror ? intersect(com_x, {e.width - com_x.high, e.width - com_x.low}) : com_x;
}

// True if `part` lies inside `all`.
template <class Real>
constexpr bool contains(Interval<Real> all, Interval<Real> part) {
  return all.low <= part.low && part.high <= all.high;
}

}  // namespace detail

// The c_x [m] for which the object is held (property 0) while one palm turns between its angles and
// the other one is steep, and with both palms shallow.
template <class Real>
Interval<Real> com_x_held(const OperatingEnvelope<Real>& envelope,
                          const PerSide<AnglePair<Real>>& angles) {
  const auto held = [&](const PerSide<PalmAngle<Real>>& palms, std::size_t shallow,
                        Interval<Real> rise) {
    return detail::com_x_at(envelope, properties[0], shallow, palms, rise);
  };
  const bool mirror = detail::symmetric(envelope, angles);
  const PerSide<PalmAngle<Real>> steep{angles[left].steep, angles[right].steep};
  const PerSide<PalmAngle<Real>> flat{angles[left].shallow, angles[right].shallow};
  Interval<Real> permitted =
      intersect(held(steep, left, rise_over(envelope.contacts, steep, envelope.offset)),
                held(flat, left, rise_over(envelope.contacts, flat, envelope.offset)));
  for (const std::size_t turning : {left, right}) {
    PerSide<PalmAngle<Real>> palms = steep;
    const Real from = angles[turning].shallow.angle;
    const Real turn = angles[turning].steep.angle - from;
    for (int i = 0; i < detail::turn_steps; ++i) {
      palms[turning] = i == 0 ? angles[turning].shallow
                              : PalmAngle<Real>::at(from + turn * Real(i) / detail::turn_steps);
      permitted = intersect(permitted,
                            held(palms, turning, detail::operating_rise(envelope, turning, palms)));
    }
    if (mirror) break;
  }
  return detail::and_mirrored(envelope, permitted, mirror);
}

// The height differences [m] over all contacts and all pairs of angles between shallow and steep.
template <class Real>
Interval<Real> rise_at_any_angles(const OperatingEnvelope<Real>& envelope,
                                  const PerSide<AnglePair<Real>>& angles) {
  constexpr Real inf = std::numeric_limits<Real>::infinity();
  Interval<Real> rise{inf, -inf};
  for (const PalmAngle<Real>& l : {angles[left].shallow, angles[left].steep}) {
    for (const PalmAngle<Real>& r : {angles[right].shallow, angles[right].steep}) {
      rise = hull(rise, rise_over(envelope.contacts, {l, r}, envelope.offset));
    }
  }
  return rise;
}

// A sufficient test for the same: an interval that is never wider, and much faster to compute. The
// squeeze at an edge grows with the palm's angle. So the worst case is the shallow palm's edges
// against the steep one's, over all heights that any pair of angles reaches. For most angles this
// test is enough. It is not valid for rounded contact
// vertices, because their lever arms change with the palm angles.
template <class Real>
Interval<Real> com_x_held_surely(const OperatingEnvelope<Real>& envelope,
                                 const PerSide<AnglePair<Real>>& angles) {
  const Interval<Real> rise = rise_at_any_angles(envelope, angles);
  Interval<Real> permitted{-std::numeric_limits<Real>::infinity(),
                           std::numeric_limits<Real>::infinity()};
  for (const std::size_t shallow : {left, right}) {
    PerSide<PalmAngle<Real>> palms{angles[left].steep, angles[right].steep};
    palms[shallow] = angles[shallow].shallow;
    permitted =
        intersect(permitted, detail::com_x_at(envelope, properties[0], shallow, palms, rise));
  }
  return permitted;
}

// The c_x [m] for which both properties hold with either palm as the shallow one, and the object is
// held throughout. Where `wanted` is not inside it, the result may be wider than the exact
// interval, which saves work.
template <class Real>
Interval<Real> com_x_all(const OperatingEnvelope<Real>& envelope,
                         const PerSide<AnglePair<Real>>& angles, Interval<Real> wanted) {
  const bool mirror = detail::symmetric(envelope, angles);
  Interval<Real> permitted{-std::numeric_limits<Real>::infinity(),
                           std::numeric_limits<Real>::infinity()};
  for (const std::size_t shallow : {left, right}) {
    for (const int property : {1, 2}) {
      permitted = intersect(
          permitted,
          detail::and_mirrored(envelope, com_x_of(envelope, property, shallow, angles), mirror));
      if (!detail::contains(permitted, wanted)) return permitted;
    }
    if (mirror) break;
  }
  if (!envelope.is_rounded()) {
    const Interval<Real> surely = intersect(permitted, com_x_held_surely(envelope, angles));
    if (surely.low == permitted.low && surely.high == permitted.high) return permitted;
  }
  return intersect(permitted, com_x_held(envelope, angles));
}

// The clearance of the outline from both palms in some poses [rad]: the least angle by which object or
// palm would have to turn until an edge lies on a palm's line. The palms count as infinitely long.
template <class Real>
class Clearance {
 public:
  explicit Clearance(const OperatingEnvelope<Real>& envelope) : envelope_(envelope) {}

  // Adds the poses with these palm angles and height differences.
  void look(const PerSide<PalmAngle<Real>>& palms, Interval<Real> rise) {
    for (const Real dy : {rise.low, rise.high}) {
      const ContactVector<Real> contact_vector = contact_vector_at(dy, envelope_.width);
      for (const std::size_t side : {left, right}) {
        const PalmFrameVector<Real> r = palm_frame_vector(contact_vector, side, palms[side]);
        within_ = within_ && r.inward > Real(0);  // also false if the object cannot reach
        const Real tangent = r.normal / r.inward;
        seen_[side] = hull(seen_[side], {tangent, tangent});
      }
    }
  }
  Real least() const {
    if (!within_) return -pi<Real>;
    Real least = pi<Real>;
    for (const std::size_t side : {left, right}) {
      const ClearCone<Real>& clear = envelope_.clear[side];
      const Real low = std::atan(seen_[side].low) - std::atan(clear.low);
      const Real high = std::atan(clear.high) - std::atan(seen_[side].high);
      least = low < least ? low : least;
      least = high < least ? high : least;
    }
    return least;
  }

 private:
  static constexpr Real inf = std::numeric_limits<Real>::infinity();
  const OperatingEnvelope<Real>& envelope_;
  // The extremes of the tangent of the angle between palm and object.
  PerSide<Interval<Real>> seen_{Interval<Real>{inf, -inf}, Interval<Real>{inf, -inf}};
  bool within_ = true;
};

// The same anywhere in the operating region.
template <class Real>
Real clearance_margin(const OperatingEnvelope<Real>& envelope,
                      const PerSide<AnglePair<Real>>& angles) {
  Clearance<Real> clearance(envelope);
  const PerSide<PalmAngle<Real>> steep{angles[left].steep, angles[right].steep};
  const PerSide<PalmAngle<Real>> flat{angles[left].shallow, angles[right].shallow};
  clearance.look(steep, rise_over(envelope.contacts, steep, envelope.offset));
  clearance.look(flat, rise_over(envelope.contacts, flat, envelope.offset));
  for (const std::size_t shallow : {left, right}) {
    PerSide<PalmAngle<Real>> palms = steep;
    palms[shallow] = flat[shallow];
    clearance.look(palms, detail::operating_rise(envelope, shallow, palms));
  }
  return clearance.least();
}

}  // namespace palmbots
