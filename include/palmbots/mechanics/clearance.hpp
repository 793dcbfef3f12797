// SPDX-License-Identifier: Apache-2.0
// Clearance: whether a palm touches the object's outline anywhere besides the contact vertex.
//
// Seen from a contact, the palm is a segment along the x axis of its own frame (inward, normal),
// and the object is turned by the angle α between palm and object. Two events can end clearance:
// another vertex of the outline comes down on the palm (an edge lies flush), or an end of the palm
// meets an edge of the object (a tip contact). Source: docs/theory/contacts.md.
#pragma once

#include <cstdint>
#include <limits>

#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// How a palm touches the object: a vertex stands on the plate, an edge lies flush on it, or an end
// of the palm meets an edge.
enum class ContactKind : std::uint8_t { none, vertex, flush, tip };

constexpr const char* name_of(ContactKind kind) {
  constexpr const char* names[] = {"", "vertex", "flush", "tip"};
  return names[static_cast<int>(kind)];
}

// The largest number of vertices of an outline.
inline constexpr std::size_t max_outline = 32;

// A vertex of the outline [m]: its distance along the line of contacts from each contact, and its
// height above that line. The two distances sum to w. Both are stored so that mirroring swaps them
// and rounds nothing. A vertex with a radius is where the straight edges beside the arc would meet.
template <class Real>
struct Vertex {
  PerSide<Real> along;
  Real height;
  Real radius{};
};

// The object's outline, and which of its vertices rest on the palms.
template <class Real>
struct Outline {
  std::array<Vertex<Real>, max_outline> vertices{};
  std::size_t count = 0;
  PerSide<std::size_t> contact{};  // the vertices that rest on the palms

  // The i-th vertex counted from a side's contact vertex, inward along the bottom. The count is the
  // same in a mirrored outline.
  constexpr std::size_t walked(std::size_t side, std::size_t i) const {
    return (contact[side] + (side == left ? i : count - i)) % count;
  }

  // True if the point (along, height) is strictly inside. Crossing-number test.
  constexpr bool contains(std::size_t side, Real along, Real height) const {
    bool in = false;
    for (std::size_t i = 0, j = count - 1; i < count; j = i++) {
      const Vertex<Real>& a = vertices[i];
      const Vertex<Real>& b = vertices[j];
      if ((a.height > height) == (b.height > height)) continue;
      // The lower end comes first: the mirrored outline runs the other way round and must round
      // alike.
      const Vertex<Real>& low = a.height < b.height ? a : b;
      const Vertex<Real>& high = a.height < b.height ? b : a;
      const Real share = (height - low.height) / (high.height - low.height);
      const Real crossing = low.along[side] + share * (high.along[side] - low.along[side]);
      if (along < crossing) in = !in;
    }
    return in;
  }
};

// Radii of the arcs that round the contact vertices [m].
template <class Real>
constexpr PerSide<Real> contact_radii(const Outline<Real>& outline) {
  return {outline.vertices[outline.contact[left]].radius,
          outline.vertices[outline.contact[right]].radius};
}

// The directions of a palm that touch nothing, however long the palm is: all vertices lie above its
// line. The bounds are those of tan α, for |α| < 90°.
template <class Real>
struct ClearCone {
  Real low;
  Real high;

  constexpr MaskOf<Real> contains(PalmFrameVector<Real> r) const {
    return (r.inward > Real(0)) & (r.normal > low * r.inward) & (r.normal < high * r.inward);
  }
};

// The clear cone of one side's contact vertex. Empty (low > high) where another vertex lies below
// that contact.
//
// Rounded contact vertices: the palm's line is the radius below the centre of the arc. Other rounded
// vertices count as sharp: the edges beside them are the same, and the sharp ones contain the arcs.
template <class Real>
constexpr ClearCone<Real> clear_cone(const Outline<Real>& outline, std::size_t side) {
  constexpr Real inf = std::numeric_limits<Real>::infinity();
  // How far a vertex may be below the parallel to the palm through the centre.
  const Real spare = contact_radii(outline)[side];
  ClearCone<Real> cone{-inf, inf};
  for (std::size_t i = 0; i < outline.count; ++i) {
    if (i == outline.contact[side]) continue;
    const Vertex<Real>& v = outline.vertices[i];
    const Real along = v.along[side];
    const Real away = along < Real(0) ? -along : along;
    const Real far = spare == Real(0) ? Real(1) : square_root(away * away + v.height * v.height);
    if (away == Real(0) && !(v.height > -spare)) return {inf, -inf};
    if (away == Real(0) || spare >= far) continue;
    // Tangent of the vertex's direction, turned by the angle with the sine spare / far.
    const Real sine = spare / far;
    const Real cosine =
        spare == Real(0) ? Real(1) : square_root((Real(1) - sine) * (Real(1) + sine));
    const Real across = away * cosine - v.height * sine;
    if (!(across > Real(0))) continue;
    const Real bound = (v.height * cosine + away * sine) / across;
    if (along > Real(0)) {
      if (-bound > cone.low) cone.low = -bound;
    } else if (bound < cone.high) {
      cone.high = bound;
    }
  }
  return cone;
}

// What the palm touches besides its contact vertex. `vector` points to the other contact, in the
// palm's frame; `contact` is p [m]. The palm reaches from p = −half_length to +half_length.
template <class Real>
[[gnu::noinline]] constexpr ContactKind further_contact(const Outline<Real>& outline,
                                                        std::size_t side,
                                                        PalmFrameVector<Real> vector, Real width,
                                                        Real contact, Real half_length) {
  const Real cos = vector.inward / width;
  const Real sin = vector.normal / width;
  const std::size_t own = outline.contact[side];
  for (std::size_t i = 0; i < outline.count; ++i) {
    if (i == own) continue;
    const Vertex<Real>& v = outline.vertices[i];
    const Real inward = v.along[side] * cos - v.height * sin;
    const Real above = v.along[side] * sin + v.height * cos;
    if (above > Real(0)) continue;
    const Real place = contact - inward;
    const bool on_palm = place >= -half_length && place <= half_length;
    // An edge that starts at the contact lies on the palm, however long it is.
    const bool own_edge = i == (own + 1) % outline.count || own == (i + 1) % outline.count;
    const bool palm_goes_on = inward > Real(0) ? contact > -half_length : contact < half_length;
    if (on_palm || (own_edge && palm_goes_on)) return ContactKind::flush;
  }
  for (const Real end : {-half_length, half_length}) {
    const Real inward = contact - end;
    if (outline.contains(side, inward * cos, -inward * sin)) return ContactKind::tip;
  }
  return ContactKind::none;
}

}  // namespace palmbots
