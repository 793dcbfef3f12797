// SPDX-License-Identifier: Apache-2.0
// The places of robots and object, and what the numbers of a scene may be: the load of the robots, and what properties 1 and 2 allow.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "palmbots/sim/limit_warnings.hpp"
#include "palmbots/sim/placement.hpp"

namespace palmbots::bindings {

namespace {

using Ends = std::pair<double, double>;
using Contacts2 = std::array<Ends, 2>;

Region<double> region_of_ends(const Contacts2& ends) {
  return {Interval<double>{ends[left].first, ends[left].second},
          Interval<double>{ends[right].first, ends[right].second}};
}

// The heaviest objects as rows: mass, side, contacts, angles.
nb::list rows_of(const HeaviestLoads& loads) {
  nb::list rows;
  for (const HeaviestLoad& load : loads) {
    rows.append(nb::make_tuple(load.mass, load.side, nb::make_tuple(load.p[left], load.p[right]),
                               nb::make_tuple(load.theta[left], load.theta[right])));
  }
  return rows;
}

using PoseRows = nb::ndarray<const double, nb::shape<-1, 11>, nb::c_contig, nb::device::cpu>;

auto places_of(const Spec& spec, const PoseRows& rows) {
  auto* places = new std::vector<double>;
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    const double* row = rows.data() + 11 * i;
    PairPose pose{};
    pose.configuration.separation = row[0];
    pose.midpoint = row[1];
    const SinCos<double> turn = sin_cos(row[6]);
    pose.turn = {turn.cos, turn.sin};
    for (const std::size_t side : {left, right}) {
      pose.configuration.palms[side] = PalmAngle<double>::at(row[2 + side]);
      pose.configuration.contacts[side] = row[4 + side];
      pose.configuration.lift[side] = row[7 + side];
      pose.height[side] = row[9 + side];
    }
    append_places(spec, pose, *places);
  }
  const std::size_t points = places->size() / 2 / std::max<std::size_t>(1, rows.shape(0));
  return nb::ndarray<nb::numpy, double, nb::ndim<3>>(places->data(), {rows.shape(0), points, 2},
                                                     owner_of(places));
}

}  // namespace

void bind_scene_limits(nb::module_& m) {
  m.attr("BODY_SIZE") = body_size;
  m.attr("BODY_GAP") = body_gap;
  m.attr("GROUND_CLEARANCE") = ground_clearance;
  m.attr("PIVOT_HEIGHT") = pivot_height;
  m.attr("SHOULDER_INSET") = shoulder_inset;
  m.attr("USUAL_AXLE") = usual_axle;
  m.def(
      "chassis",
      [](double height, double axle) {
        const Chassis at = chassis_of(height, axle);
        const auto pair = [](Vec v) { return nb::make_tuple(v.x, v.y); };
        return nb::make_tuple(at.axle, at.caster, pair(at.com), pair(at.shoulder), pair(at.pivot));
      },
      nb::arg("height"), nb::arg("axle"),
      "Axle, caster, centre of mass, shoulder and pivot of a robot whose pivot is `height` above "
      "the "
      "floor and whose wheels are `axle` outward of it [m]. Outward and up from the middle of the "
      "body on the floor.");
  m.def(
      "axle_out",
      [](const nb::dict& table, bool is_curved) { return axle_of(values_of(table), is_curved); },
      nb::arg("scene"), nb::arg("is_curved"),
      "The distance of the wheels outward of the pivot [m].");
  m.def("wheel_kg", &wheel_mass, nb::arg("body_kg"),
        "The mass of one wheel, a part of that of the body.");
  m.def(
      "places", &places_of, nb::arg("spec"), nb::arg("rows"),
      "x and y [m] of the points of placement.hpp, one row for each of the rows of separation, "
      "midpoint, palm angles, contacts, turn of the object, heights of the contact vertices above "
      "the palms, and heights of the pivots.");
  m.def("floor_level", &floor_level, nb::arg("spec"),
        "The height of the floor over the pivots [m]: low enough for the robots and any object.");
  m.def("mass_text", &mass_text, nb::arg("mass_kg"),
        "A mass with three digits, rounded down, so that it is allowed itself.");
  m.attr("load_meanings") = [] {
    nb::list rows;
    for (const LoadMeaning& one : load_meanings) {
      rows.append(nb::make_tuple(one.name, one.happens, one.key));
    }
    return nb::tuple(rows);
  }();
  m.def(
      "heaviest_loads",
      [](const nb::dict& table, std::optional<double> reach, bool is_curved) {
        const SceneValues scene = values_of(table);
        const Spec spec = spec_of(scene);
        LoadStates states(robot_body_of(scene, spec, is_curved), spec);
        return rows_of(reach ? states.within(*reach) : states.at_start());
      },
      nb::arg("scene"), nb::arg("reach_m").none(), nb::arg("is_curved"),
      "For each of `load_meanings`, the heaviest object that it allows [kg], with side, contacts "
      "[m] "
      "and palm angles [rad]: with contacts up to `reach_m` from the pivots, or (None) at the "
      "start.");
  m.def(
      "push_of_robot",
      [](const nb::dict& table, std::size_t side, double p, double height) {
        const SceneValues scene = values_of(table);
        const auto [own, by_load] = push_of(robot_body_of(scene, height, false), spec_of(scene),
                                            side > 0 ? right : left, p);
        return nb::make_tuple(own, by_load);
      },
      nb::arg("scene"), nb::arg("side"), nb::arg("p_m"), nb::arg("height_m"),
      "How hard a robot's palm can push inward with the contact at `p_m` and the pivot `height_m` "
      "above the floor, while it carries V newton: at least a + b V [N], a pair (a, b).");
  m.def(
      "load_refusal",
      [](const nb::dict& table, bool is_curved) {
        const SceneValues scene = values_of(table);
        return load_refusal(scene, spec_of(scene), is_curved);
      },
      nb::arg("scene"), nb::arg("is_curved"),
      "Why no carry of the object can begin; empty: it can.");
  m.def(
      "load_warning",
      [](const nb::dict& table, bool is_curved) {
        const SceneValues scene = values_of(table);
        return load_warning(scene, spec_of(scene), is_curved);
      },
      nb::arg("scene"), nb::arg("is_curved"),
      "The limit that the object exceeds with contacts somewhere on the palms; empty: none.");
  m.def(
      "cannot_span",
      [](const Spec& spec, const Contacts2& contacts) {
        return cannot_span(spec, region_of_ends(contacts));
      },
      nb::arg("spec"), nb::arg("contacts"),
      "Why the object cannot span a region of contacts; empty: it can.");
  m.def(
      "limit_warnings",
      [](const nb::dict& table, const std::optional<Contacts2>& contacts) {
        const SceneValues scene = values_of(table);
        const Spec spec = spec_of(scene);
        return contacts ? limit_warnings(scene, spec, region_of_ends(*contacts), false)
                        : limit_warnings(scene, spec);
      },
      nb::arg("scene"), nb::arg("contacts").none(),
      "Numbers of a scene on a straight path that exceed what properties 1 and 2 allow for "
      "contacts "
      "in a region; None: anywhere on the palms.");
}

}  // namespace palmbots::bindings
