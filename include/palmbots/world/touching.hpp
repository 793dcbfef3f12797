// SPDX-License-Identifier: Apache-2.0
// What the object touches in one position: the contacts of the quasistatic world as supports, and
// all contacts of a state that is given by palm angles and contact coordinates.
//
// Source: docs/theory/contacts.md.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/world/quasistatic_world.hpp"

namespace palmbots {

// A contact with a palm (by its side) or with something that stands still.
struct Touched {
  const char* kind;     // what touches: a vertex on a face, or what of the surface
  std::size_t carrier;  // as in Carrier
  double place;         // on the surface [m]
  Support<double> support;
};

inline const char* name_of(const Surface& surface) {
  if (surface.tip) return "tip";
  if (surface.carrier == Carrier::ground) return "floor";
  if (surface.normal.y > 0.5) return "vertex";
  return surface.at.x < 0.0 ? "nose" : "heel";
}

namespace detail {

// Whether an earlier pair is the same contact: a feature and its neighbour, where one hands over to
// the other.
inline bool is_known(const ClosedPairs& closed, std::size_t i, double near) {
  const FeatureContact& own = closed.at[i].contact;
  for (std::size_t k = 0; k < i; ++k) {
    const FeatureContact& other = closed.at[k].contact;
    if (length(other.point - own.point) <= near && length(other.normal - own.normal) <= 1e-4)
      return true;
  }
  return false;
}

}  // namespace detail

// The contacts whose gap is at most `within` [m].
inline std::vector<Touched> touched_in(const World<double>& world, double within) {
  const ClosedPairs closed = world.touching(within);
  std::vector<Touched> found;
  for (std::size_t i = 0; i < closed.count; ++i) {
    if (detail::is_known(closed, i, 2.0 * within)) continue;
    const auto& [pair, c] = closed.at[i];
    const Surface& surface = world.shapes().surfaces.at[pair.surface];
    const auto carrier = static_cast<std::size_t>(surface.carrier);
    found.push_back({name_of(surface),
                     carrier,
                     surface.tip ? surface.at.x : c.place,
                     {carrier == left ? left : right, c.point.x, c.point.y, c.normal.x, c.normal.y,
                      surface.friction}});
  }
  return found;
}

// The palm whose faces, moved by `deep` into it, still lie in the object.
inline std::optional<std::size_t> pierced_palm(const World<double>& world, double deep) {
  Travel still{};
  for (const std::size_t side : {left, right}) {
    const double angle = world.configuration().palms[side].angle;
    still.palms[side] = {world.pivot(side), {}, angle, 0.0, angle};
  }
  const Frames frames = still.frames(0.0);
  const Surfaces& surfaces = world.shapes().surfaces;
  for (std::size_t i = 0; i < surfaces.count; ++i) {
    const Surface& face = surfaces.at[i];
    const auto carrier = static_cast<std::size_t>(face.carrier);
    if (face.tip || carrier > right) continue;
    if (is_pierced(world.shapes().body, world.pose(), frames[carrier], face, deep)) return carrier;
  }
  return std::nullopt;
}

struct StateContact : Touched {
  Vec point;  // in the frame of the object
};

// All contacts of a state.
struct StateContacts {
  std::vector<StateContact> touched;  // the left palm's first; a palm's own vertex first
  std::size_t count = 0;              // may exceed what `touched` holds
  PerSide<double> sunk{};  // how deep a palm lies in an object with sharp contact vertices [m]
  std::optional<std::size_t> pierced;  // the palm in the object, where only the world notices that
  PerSide<Vec> pivots{};               // from the COM [m]
  Pose pose{};                         // of the object, seen from the left pivot
};

namespace detail {

// Palms and object with their contacts at these places.
template <class Real>
Pose pose_at(const Model<Real>& model, const PerSide<PalmAngle<double>>& palms,
             const PerSide<double>& places, PerSide<Vec>& pivots) {
  PerSide<Vec> feet{};  // of what counts as the contact vertices, from the pivots
  for (const std::size_t side : {left, right}) {
    const double away = outward<double>(side);
    const Vec along{away * palms[side].cos, palms[side].sin};
    const Vec across{-away * palms[side].sin, palms[side].cos};
    feet[side] = along * places[side] + across * double(model.offset[side]);
  }
  const double width = model.object.width;
  const double sine = (feet[right].y - feet[left].y) / width;
  const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
  const Pose turned{{}, angle_of(sine, cosine), sine, cosine};
  const Vec com = feet[left] + turned.to_world({model.object.com_left, model.object.com_height});
  pivots[right] = feet[left] + turned.to_world({width, 0.0}) - feet[right];
  return {com, turned.angle, sine, cosine};
}

}  // namespace detail

// All contacts of the object of a spec, at palm angles [rad] and contact coordinates [m] at which it
// reaches from palm to palm.
inline StateContacts contacts_of_state(const Spec& spec, const PerSide<double>& angles,
                                       const PerSide<double>& places) {
  const Model<double> model = model_of<double>(spec);
  const PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(angles[left]),
                                         PalmAngle<double>::at(angles[right])};
  const double near = contact_tolerance<double> * spec.width;
  const PerSide<double> radius = contact_radii(spec.outline);
  StateContacts found;
  PerSide<Vec> pivots{};
  found.pose = detail::pose_at(model, palms, places, pivots);
  for (const std::size_t side : {left, right}) found.pivots[side] = pivots[side] - found.pose.at;
  const bool is_rounded = radius[left] > 0 || radius[right] > 0;
  if (is_rounded) {
    for (const std::size_t side : {left, right}) {
      const double away = outward<double>(side);
      const Vec normal{-away * palms[side].sin, palms[side].cos};
      const Vec centre = found.pose.to_world(vertex_of(model, side));
      const Vec point = centre - normal * radius[side];
      const Vec from_centre = found.pose.from_world(normal * -radius[side]);
      found.touched.push_back({{"vertex",
                                side,
                                places[side],
                                {side, point.x, point.y, normal.x, normal.y, model.friction[side]}},
                               from_centre + Vec{side == left ? 0.0 : spec.width, 0.0}});
    }
    found.count = 2;
  } else {
    const ContactSet<double> sharp = detect_contacts<double>(model, {0.0, palms, places});
    found.count = sharp.count;
    found.sunk = sharp.sunk;
    for (std::size_t i = 0; i < sharp.count && i < max_supports; ++i) {
      const ContactPoint<double>& c = sharp.points[i];
      found.touched.push_back(
          {{name_of(c.kind), c.support.side, c.place, c.support}, {c.along[left], c.height}});
    }
  }
  const auto has_end = [&](std::size_t side) {
    return model.profile[side].nose > 0 || model.profile[side].heel > 0;
  };
  if (!is_rounded && !has_end(left) && !has_end(right)) return found;
  // Only the world knows arcs, noses and heels.
  World<double> world(model, {0.0, palms, places});
  world.put(pivots, angles, found.pose);
  found.pierced = pierced_palm(world, near);
  for (const Touched& one : touched_in(world, near)) {
    const auto is_same = [&](const Touched& other) {
      const Vec apart = Vec{other.support.x, other.support.y} - Vec{one.support.x, one.support.y};
      return other.support.side == one.support.side && length(apart) <= 4 * near;
    };
    if (std::any_of(found.touched.begin(), found.touched.end(), is_same)) continue;
    const Vec from_com = found.pose.from_world({one.support.x, one.support.y});
    const auto first_of_right =
        std::find_if(found.touched.begin(), found.touched.end(),
                     [&](const StateContact& other) { return other.carrier > one.carrier; });
    ++found.count;
    found.touched.insert(first_of_right, {one, from_com + Vec{spec.com_left, spec.com_height}});
  }
  return found;
}

// Why something refuses a pipe, whose two contacts move together; empty: the object is none.
inline std::string pipe_refusal(const Spec& spec, std::string what = "this analysis") {
  if (spec.width > 0) return "";
  return sentence(
      "object.edge_radius_m: {} makes the object a pipe, but {} assumes contacts that move one by "
      "one; allowed: contact vertices whose arcs have two centres; carry, compare and drop-rate "
      "take "
      "pipes",
      {short_text(spec.outline.vertices[0].radius), std::move(what)});
}

// Why a state is refused: a palm lies in the object, or there are too many contacts; empty: it is not.
inline std::string refusal_of(const StateContacts& found, const Spec& spec,
                              const PerSide<double>& angles) {
  const double near = contact_tolerance<double> * spec.width;
  for (const std::size_t side : {left, right}) {
    const bool is_deep = found.sunk[side] > near;
    if (!is_deep && found.pierced != side) continue;
    const std::string name = side == left ? "left" : "right";
    return sentence(
        "theta_{}_deg: value is {}, which puts the {} palm{} inside the object's outline; allowed: "
        "angles and contacts at which they overlap by at most {} mm",
        {name, short_text(angles[side] / radians_per_degree<double>), name,
         is_deep ? " " + short_text(1e3 * found.sunk[side], 3) + " mm" : "",
         short_text(1e3 * near, 2)});
  }
  if (found.count <= max_supports) return "";
  return sentence("object.vertices_m: the outline touches the palms in {} points; allowed: {}",
                  {short_text(double(found.count)), short_text(double(max_supports))});
}

}  // namespace palmbots
