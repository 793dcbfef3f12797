// SPDX-License-Identifier: Apache-2.0
// One pair of features, one of the object and one of a surface: their gap, the place where they
// touch, and whether they can touch at all.
//
//   corner on face   The centre of the arc is its radius away from the face. The contact rolls: it
//                    sticks if the arc length run along the corner equals that along the face, so
//                    that place + radius × (angle of the body − angle of the carrier) is constant.
//   tip on edge      A sharp tip slides along a straight edge of the object.
//   tip on arc       A sharp tip on a rounded corner. It sticks at one point of the arc: a sharp
//                    tip does not roll.
//
// All three are functions of the pose alone; nothing is integrated.
#pragma once

#include "palmbots/mechanics/rounded_body.hpp"
#include "palmbots/mechanics/surface.hpp"
#include "palmbots/mechanics/wrench_cone.hpp"

namespace palmbots {

enum class PairKind : std::uint8_t { corner_on_face, tip_on_edge, tip_on_arc };

// A pair of features.
struct FeaturePair {
  PairKind kind;
  std::uint8_t carrier;  // of the surface, as in Carrier
  std::uint8_t surface;
  std::uint8_t feature;  // the corner of the body, or the one at which an edge begins

  constexpr bool operator==(const FeaturePair&) const = default;
};

// A pair in one pose, as a support. World coordinates.
struct FeatureContact : Support {
  FeaturePair pair;
  double gap;     // [m]; negative where they overlap
  double run;     // how far it has slid: constant while it sticks [m]
  double place;   // of the contact on the face; of the tip from the middle of the edge [m]
  Vec on_body;    // the outward normal of the object there, in its own frame
  double inside;  // ≥ 0 where the pair is that of nearest points: distance to where it ends,
                  // divided by the size of the object, or the sine of an angle
};

// By how much a normal into the object lies between those of the two faces beside a tip.
constexpr double within_tip(const Surface& tip, Vec normal) {
  return smaller(cross(tip.normal, normal), cross(normal, tip.normal2));
}

// A pair in a pose. `reference` is, for a tip that sticks on an arc, the direction of the tip from
// the centre in the frame of the body.
inline FeatureContact contact_of(const RoundedBody& body, const Surface& surface,
                                 const Frame& frame, const Pose& pose, FeaturePair pair,
                                 Vec reference = {}) {
  const Corner& corner = body.corners[pair.feature];
  FeatureContact c;
  c.side = frame.sense < 0.0 ? left : right;
  c.friction = surface.friction;
  c.pair = pair;
  if (pair.kind == PairKind::corner_on_face) {
    const Vec centre = pose.to_world(corner.centre);
    const Vec seen = frame.from_world((pose.at + centre) - frame.origin) - surface.at;
    c.gap = dot(surface.normal, seen) - corner.radius;
    c.normal = frame.to_world(surface.normal);
    c.tangent = tangent_of(frame.sense, c.normal);
    c.point = centre - c.normal * corner.radius;
    c.place = surface.normal.y * seen.x - surface.normal.x * seen.y;
    c.run = c.place + frame.sense * corner.radius * (pose.angle - frame.sense * frame.angle);
    c.on_body = -pose.from_world(c.normal);
    c.inside = smaller(smaller(c.place - surface.low, surface.high - c.place),
                       body.within_arc(pair.feature, c.on_body));
    return c;
  }
  const Vec tip = frame.origin + frame.to_world(surface.at);
  c.point = tip - pose.at;
  const Vec seen = pose.from_world(c.point);
  if (pair.kind == PairKind::tip_on_edge) {
    const Vec from = seen - corner.middle;
    c.on_body = corner.normal;
    c.gap = dot(corner.normal, from);
    c.place = cross(corner.normal, from);
    c.inside = corner.half_length - magnitude(c.place);
  } else {
    const Vec from = seen - corner.centre;
    const double distance = length(from);
    c.on_body = from * (1.0 / distance);
    c.gap = distance - corner.radius;
    c.place = corner.radius * cross(reference, c.on_body);
    c.inside = body.within_arc(pair.feature, c.on_body);
  }
  c.normal = -pose.to_world(c.on_body);
  c.tangent = tangent_of(frame.sense, c.normal);
  c.run = -(frame.sense * c.place);
  c.inside = smaller(c.inside, within_tip(surface, frame.from_world(c.normal)));
  return c;
}

}  // namespace palmbots
