// SPDX-License-Identifier: Apache-2.0
// The object of a scene. An outline that is given without contacts, centre of mass or mass brings its
// own: the ends of its level lower side, its centroid, and the mass at the density of the paper's box.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/scene_values.hpp"

namespace palmbots {

inline constexpr double default_density = 125;  // of the paper's box [kg/m³]

struct SceneObject : GivenObject {
  double mass = 0;  // [kg]
  bool is_simple = true;
  bool has_contacts = true;  // false: a single vertex is lowest, the left contact
  bool is_centroid = false;  // the centre of mass
  bool is_default_mass = false;
};

namespace detail {

// Hides rounding, so that the COM of a 0.6 m box is 0.3.
inline double to_picometre(double value) { return std::nearbyint(value * 1e12) / 1e12; }

}  // namespace detail

// The outline that a scene gives: its vertices, or those of its box. A first vertex that is repeated
// at the end is left out, because an outline closes itself.
inline std::vector<Point> outline_of(const SceneValues& scene) {
  if (scene.has<"object.box_m[0]">()) {
    const double length = scene.of<"object.box_m[0]">();
    const double height = scene.of<"object.box_m[1]">();
    return {{0, 0}, {length, 0}, {length, height}, {0, height}};
  }
  std::vector<Point> points;
  for (const auto& vertex : scene.list<"object.vertices_m">()) {
    points.push_back({vertex[0], vertex[1]});
  }
  const bool is_closed = points.size() > 3 && points.front().x == points.back().x &&
                         points.front().y == points.back().y;
  if (is_closed) points.pop_back();
  return points;
}

// The object of a scene. Contacts that are no vertices become others.
inline SceneObject object_of(const SceneValues& scene) {
  constexpr double level = 1e-9;  // vertices at most this far above the lowest one are level [m]
  SceneObject object;
  object.vertices = outline_of(scene);
  const std::size_t n = object.vertices.size();
  object.contacts = {static_cast<std::size_t>(scene.of<"object.contacts[0]">()) % n,
                     static_cast<std::size_t>(scene.of<"object.contacts[1]">()) % n};
  object.com = {scene.of<"object.com_m[0]">(), scene.of<"object.com_m[1]">()};
  object.mass = scene.of<"object.mass_kg">();
  object.is_simple = !crossing_edges(object.vertices);
  object.radii.assign(n, 0);
  const auto& radii = scene.list<"object.edge_radius_m">();
  for (std::size_t k = 0; object.is_simple && k < n; ++k) {
    const bool is_one = radii.size() == 1;
    if (k >= radii.size() && !is_one) continue;
    if (detail::turn_at(object.vertices, k).convex) object.radii[k] = radii[is_one ? 0 : k][0];
  }
  const bool is_own = scene.has_list<"object.vertices_m">() || scene.has<"object.box_m[0]">();
  if (!object.is_simple || !is_own) return object;
  if (!scene.has<"object.contacts[0]">()) {
    const auto [l, r] = bottom_ends(object.vertices, level);
    object.contacts = {l, r};
    object.has_contacts = l != r;
  }
  const auto [area, centroid] = area_and_centroid(static_cast<const RoundedPolygon&>(object));
  if (!scene.has<"object.com_m[0]">()) {
    object.com = {detail::to_picometre(centroid.x), detail::to_picometre(centroid.y)};
    object.is_centroid = true;
  }
  if (!scene.has<"object.mass_kg">()) {
    object.mass = detail::to_picometre(default_density * area * scene.of<"object.depth_m">());
    object.is_default_mass = true;
  }
  return object;
}

}  // namespace palmbots
