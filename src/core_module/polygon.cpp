// SPDX-License-Identifier: Apache-2.0
// Polygons, and an object in the frame of its contacts.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <tuple>

#include "bindings.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/polygon.hpp"

namespace palmbots::bindings {

namespace {

using Pair = std::pair<double, double>;
using Pairs = std::vector<Pair>;
using Index = std::size_t;

std::vector<Point> points_of(const Pairs& pairs) {
  std::vector<Point> points;
  for (const auto& [x, y] : pairs) points.push_back({x, y});
  if (points.size() < 3) throw std::invalid_argument("a polygon has at least three vertices");
  return points;
}

Point point_of(const Pair& pair) { return {pair.first, pair.second}; }

}  // namespace

void bind_polygon(nb::module_& m) {
  m.def(
      "crossing_edges", [](const Pairs& polygon) { return crossing_edges(points_of(polygon)); },
      nb::arg("polygon"));
  m.def(
      "turn",
      [](const Pair& a, const Pair& b, const Pair& c) {
        return turn(point_of(a), point_of(b), point_of(c));
      },
      nb::arg("a"), nb::arg("b"), nb::arg("c"));
  m.def(
      "winding", [](const Pairs& polygon) { return winding(points_of(polygon)); },
      nb::arg("polygon"));
  m.def("hull", [](const Pairs& points) { return hull(points_of(points)); }, nb::arg("points"));
  m.def(
      "lower_vertices",
      [](const Pairs& polygon, Index l, Index r) {
        const std::vector<bool> is_lower = lower_vertices(points_of(polygon), l, r);
        std::vector<Index> found;
        for (Index k = 0; k < is_lower.size(); ++k) {
          if (is_lower[k]) found.push_back(k);
        }
        return found;
      },
      nb::arg("polygon"), nb::arg("left"), nb::arg("right"));
  m.def(
      "is_in_hull",
      [](const Pair& point, const Pairs& polygon) {
        return is_in_hull(point_of(point), points_of(polygon));
      },
      nb::arg("point"), nb::arg("polygon"));
  m.def(
      "object_frame",
      [](const Pairs& vertices, std::pair<Index, Index> contacts, const Pair& com) {
        const std::vector<Point> points = points_of(vertices);
        if (points.size() > max_outline) throw std::invalid_argument("vertices: too many");
        if (contacts.first >= points.size() || contacts.second >= points.size()) {
          throw std::invalid_argument("contacts: vertices of the polygon");
        }
        const std::vector<double> sharp(points.size());
        const ObjectSpec object =
            object_frame({{points, sharp}, {contacts.first, contacts.second}, point_of(com)});
        std::vector<std::tuple<double, double, double>> outline;
        for (Index k = 0; k < object.outline.count; ++k) {
          const Vertex<double>& v = object.outline.vertices[k];
          outline.emplace_back(v.along[left], v.along[right], v.height);
        }
        return std::tuple(object.width,
                          std::tuple(object.com_left, object.com_right, object.com_height), outline,
                          object.outline.contact[right]);
      },
      nb::arg("vertices"), nb::arg("contacts"), nb::arg("com"),
      "Width, centre of mass and outline (each from the left contact, from the right one, height), "
      "and the index of the right contact.");
}

}  // namespace palmbots::bindings
