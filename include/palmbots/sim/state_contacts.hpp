// SPDX-License-Identifier: Apache-2.0
// All contacts of a state that is given by palm angles and contact coordinates.
// Source: docs/theory/contacts.md.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/problem_text.hpp"
#include "palmbots/world/quasistatic_world.hpp"

namespace palmbots {

struct StateContact : Touched {
  Vec point;  // in the frame of the object
};

// All contacts of a state.
struct StateContacts {
  std::vector<StateContact> touched;   // the left palm's first; a palm's own vertex first
  std::optional<std::size_t> pierced;  // a palm that lies in the object
  PerSide<Vec> pivots{};               // from the COM [m]
};

namespace detail {

// Whether this contact is on the face of a palm and others enclose it there. Such a contact adds
// nothing: its forces and velocities lie between theirs.
inline bool is_enclosed(const StateContact& one, const std::vector<StateContact>& all) {
  const auto on_face = [](const Touched& c) {
    return c.kind == std::string_view("vertex") || c.kind == std::string_view("flush");
  };
  bool low = false;
  bool high = false;
  for (const StateContact& other : all) {
    if (other.carrier != one.carrier || !on_face(other)) continue;
    low = low || other.place < one.place;
    high = high || other.place > one.place;
  }
  return on_face(one) && low && high;
}

}  // namespace detail

// The distance of the contact vertices, or the diameter of a pipe, which has no such distance [m].
inline double size_of_object(const Spec& spec) {
  return spec.width > 0 ? spec.width : 2 * spec.outline.vertices[0].radius;
}

// All contacts of the object of a spec, at palm angles [rad] and contact coordinates [m] at which it
// reaches from palm to palm.
inline StateContacts contacts_of_state(const Spec& spec, const PerSide<double>& angles,
                                       const PerSide<double>& places) {
  const Model<double> model = model_of<double>(spec);
  const PerSide<double> radius = contact_radii(spec.outline);
  const double near = contact_tolerance<double> * size_of_object(spec);
  Configuration<double> at{
      0.0, {PalmAngle<double>::at(angles[left]), PalmAngle<double>::at(angles[right])}, places};
  at.separation = closing_separation(at, model.offset, model.object.width);
  const World<double> world(model, at);
  const Pose pose = world.pose();
  StateContacts found;
  std::vector<StateContact> all;  // both contact vertices first
  for (const std::size_t side : {left, right}) {
    found.pivots[side] = world.pivot(side) - pose.at;
    const Vec normal{-outward<double>(side) * at.palms[side].sin, at.palms[side].cos};
    const Vec point = pose.to_world(vertex_of(model, side)) - normal * radius[side];
    const Vec from_centre = pose.from_world(normal * -radius[side]);
    all.push_back(
        {{"vertex", side, places[side], Support::at(side, point, normal, model.friction[side])},
         from_centre + Vec{side == left ? 0.0 : spec.width, 0.0}});
  }
  found.pierced = world.pierced_palm(near);
  for (const Touched& one : world.touched_in(near)) {
    const Vec from_com = one.support.point;
    const auto known = std::find_if(all.begin(), all.end(), [&](const Touched& other) {
      return other.carrier == one.carrier && length(other.support.point - from_com) <= 4 * near;
    });
    if (known == all.end()) {
      all.push_back({one, pose.from_world(from_com) + Vec{spec.com_left, spec.com_height}});
    } else if (one.kind == std::string_view("flush")) {
      known->kind = one.kind;
    }
  }
  for (const std::size_t side : {left, right}) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].carrier == side && (k == side || !detail::is_enclosed(all[k], all)))
        found.touched.push_back(all[k]);
    }
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
  if (found.pierced) {
    const std::string name = *found.pierced == left ? "left" : "right";
    return sentence(
        "theta_{}_deg: value is {}, which puts the {} palm inside the object's outline; allowed: "
        "angles and contacts at which they overlap by at most {} mm",
        {name, short_text(angles[*found.pierced] / radians_per_degree<double>), name,
         short_text(1e3 * contact_tolerance<double> * size_of_object(spec), 2)});
  }
  const std::size_t count = found.touched.size();
  if (count <= max_supports) return "";
  return sentence("object.vertices_m: the outline touches the palms in {} points; allowed: {}",
                  {short_text(double(count)), short_text(double(max_supports))});
}

}  // namespace palmbots
