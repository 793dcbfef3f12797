// SPDX-License-Identifier: Apache-2.0
// Whether an object can rest on its two contact vertices.
//
// The outline must be a simple polygon. With both contact vertices level, each must be a corner of
// the lower side of the convex hull, so that it can touch a floor. The centre of mass must lie inside
// the convex hull (the centroid of an L or a U lies outside its outline), above the line between the
// contacts and between them.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/polygon.hpp"
#include "palmbots/sim/scene_object.hpp"
#include "palmbots/sim/scene_problem.hpp"
#include "palmbots/sim/scene_values.hpp"

namespace palmbots {

inline constexpr double least_width = 0.001;  // between the contacts [m]

namespace detail {

// Reports the first fault of the rounded corners. True if there is one.
inline bool check_radii(const SceneValues& scene, const SceneObject& object, Problems& problems) {
  const auto& radii = scene.list<"object.edge_radius_m">();
  const std::size_t count = object.vertices.size();
  constexpr const char* key = "object.edge_radius_m";
  if (radii.size() > 1 && radii.size() != count) {
    report(problems, key, common, "has {0} numbers, but the outline has {1} vertices",
           "one number in m for all convex corners, or one for each vertex",
           {double(radii.size()), double(count)});
    return true;
  }
  for (std::size_t k = 0; k < radii.size() && radii.size() > 1; ++k) {
    if (!(radii[k][0] > 0) || detail::turn_at(object.vertices, k).convex) continue;
    report(problems, key, common, "rounds vertex {0}, which is no convex corner",
           "0 at that vertex", {double(k)});
    return true;
  }
  const auto bad = overlapping_arcs(object);
  if (!bad) {
    if (const auto crossed = crossed_arc(object)) {
      const auto& [k, i] = *crossed;
      report(problems, key, common,
             "makes an arc at vertex {0} that crosses the notch at vertex {1}",
             "a smaller radius at vertex {0}", {double(k), double(i)});
      return true;
    }
    const ObjectSpec frame = object_frame(object);
    if (frame.width >= least_width || body_of(frame).is_disc()) return false;
    report(problems, key, common, "rounds both contact vertices about one centre",
           "arcs whose centres are at least {0} m apart, or all arcs about one centre (a pipe)",
           {least_width});
    return true;
  }
  const auto& [k, taken] = *bad;
  const Point& a = object.vertices[k];
  const Point& b = object.vertices[(k + 1) % count];
  report(problems, key, common, "takes {0} m of the edge from vertex {1} to {2}",
         "arcs that take no more than its length, {3} m",
         {taken, double(k), double((k + 1) % count),
          std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y))});
  return true;
}

// Reports the first fault of the object only: the others may follow from it.
inline void check_object(const SceneValues& scene, Problems& problems) {
  if (scene.has<"object.box_m[0]">() && scene.has_list<"object.vertices_m">()) {
    report(problems, "object.box_m", common, "is given beside vertices_m", "one of the two", {},
           {scene.of<"object.box_m[0]">(), scene.of<"object.box_m[1]">()});
    return;
  }
  const SceneObject object = object_of(scene);
  const std::size_t count = object.vertices.size();
  if (const auto bad = crossing_edges(object.vertices)) {
    const auto& [i, j] = *bad;
    report(problems, "object.vertices_m", common,
           i == j
               ? "repeats vertex {0} as the next one"
               : "crosses itself: the edge from vertex {0} to {1} meets the edge from vertex {2} "
                 "to {3}",
           "a simple polygon, whose edges share nothing but the vertices between them",
           {double(i), double((i + 1) % count), double(j), double((j + 1) % count)});
    return;
  }
  if (!object.has_contacts) {
    report(problems, "object.contacts", common,
           "is not set, and the outline has no level lower side: vertex {0} alone is "
           "lowest",
           "[left, right], two indices into object.vertices_m", {double(object.contacts[left])});
    return;
  }
  for (const double k : {scene.of<"object.contacts[0]">(), scene.of<"object.contacts[1]">()}) {
    if (k < double(count) || !scene.has<"object.contacts[0]">()) continue;
    report(problems, "object.contacts", common, "names vertex {0}, but there are {1}",
           "two different whole numbers from 0 to {2}", {k, double(count), double(count - 1)});
    return;
  }
  const auto& [l, r] = object.contacts;
  const double dx = object.vertices[r].x - object.vertices[l].x;
  const double dy = object.vertices[r].y - object.vertices[l].y;
  if (dx * dx + dy * dy < least_width * least_width) {
    report(problems, "object.contacts", common, "names contacts at the same place",
           "two vertices at least {0} m apart", {least_width});
    return;
  }
  if (check_radii(scene, object, problems)) return;
  const std::vector<bool> lower = lower_vertices(object.vertices, l, r);
  for (const std::size_t side : {left, right}) {
    if (lower[object.contacts[side]]) continue;
    constexpr std::array<const char*, 2> texts = {
        "cannot support the object: with both level and the left one on the left, vertex {0} "
        "(left) "
        "is not a corner of its lower side",
        "cannot support the object: with both level and the left one on the left, vertex {0} "
        "(right) is not a corner of its lower side"};
    report(problems, "object.contacts", common, texts[side],
           "[left, right], two lower corners of the outline's convex hull",
           {double(object.contacts[side])});
    return;
  }
  if (!is_in_hull(object.com, object.vertices)) {
    report(problems, "object.com_m", common, "is outside the convex hull of the outline",
           "a point inside it");
    return;
  }
  const ObjectSpec frame = object_frame(object);
  const double radius = smaller(object.radii[l], object.radii[r]);
  const bool is_between = frame.width == 0 || (frame.com_left > 0 && frame.com_right > 0);
  if (!(is_between && frame.com_height + radius > 0)) {
    report(problems, "object.com_m", common,
           object.is_centroid
               ? "is the centroid of the outline, which is not above the line between "
                 "the contact vertices"
               : "is not above the line between the contact vertices",
           "a point above that line and between its ends", {}, {object.com.x, object.com.y});
  }
  const Key& mass = key_at(find_key("object.mass_kg"));
  if (object.is_default_mass && !mass.allows(object.mass)) {
    report(problems, "object.mass_kg", common,
           "is not set, and the outline at {0} kg/m³ has {1} kg", "a number in kg, from {2} to {3}",
           {default_density, object.mass, mass.least, mass.most});
  }
}

}  // namespace detail

}  // namespace palmbots
