// SPDX-License-Identifier: Apache-2.0
// Where palms and object touch, and what several contacts can do.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <optional>
#include <tuple>

#include "bindings.hpp"
#include "palmbots/mechanics/mode_forces.hpp"
#include "palmbots/mechanics/mode_margin.hpp"
#include "palmbots/sim/state_contacts.hpp"

namespace palmbots::bindings {

namespace {

using Numbers2 = std::pair<double, double>;
// side, x, y from the COM, unit normal into the body, friction
using SupportTuple = std::tuple<std::size_t, double, double, double, double, double>;
using PalmTuple = std::tuple<double, double, double>;  // vx, vy, spin

Supports supports_of(const std::vector<SupportTuple>& given) {
  if (given.size() > max_supports) throw std::invalid_argument("at most 8 supports");
  Supports supports;
  for (const auto& [side, x, y, nx, ny, friction] : given) {
    if (side > 1) throw std::out_of_range("side is 0 or 1");
    supports.push_back(Support::at(side, {x, y}, {nx, ny}, friction));
  }
  return supports;
}

Motions motions_of(const std::vector<int>& given, std::size_t count) {
  if (given.size() != count) throw std::invalid_argument("one motion for each support");
  Motions motions{};
  for (std::size_t i = 0; i < count; ++i) {
    if (given[i] < -1 || given[i] > 2) throw std::out_of_range("a motion is -1, 0, 1 or 2");
    motions[i] = static_cast<Motion>(given[i]);
  }
  return motions;
}

Velocities velocities_of(const std::vector<Numbers2>& given, std::size_t count) {
  if (given.size() != count) throw std::invalid_argument("one velocity for each support");
  Velocities velocities{};
  for (std::size_t i = 0; i < count; ++i) velocities[i] = {given[i].first, given[i].second};
  return velocities;
}

std::vector<int> listed(const Motions& motions, std::size_t count) {
  std::vector<int> found;
  for (std::size_t i = 0; i < count; ++i) found.push_back(static_cast<int>(motions[i]));
  return found;
}

nb::tuple contacts_of(const Spec& spec, Numbers2 angles, Numbers2 places) {
  const StateContacts found =
      contacts_of_state(spec, {angles.first, angles.second}, {places.first, places.second});
  std::vector<std::tuple<std::string, std::size_t, double, double, double, SupportTuple>> points;
  for (const StateContact& t : found.touched) {
    const Support& s = t.support;
    points.emplace_back(
        t.kind, t.carrier, t.place, t.point.x, t.point.y,
        SupportTuple{s.side, s.point.x, s.point.y, s.normal.x, s.normal.y, s.friction});
  }
  const auto pivot = [&](std::size_t side) {
    return Numbers2{found.pivots[side].x, found.pivots[side].y};
  };
  return nb::make_tuple(points, found.pierced, std::pair(pivot(left), pivot(right)),
                        refusal_of(found, spec, {angles.first, angles.second}));
}

std::vector<Numbers2> palm_velocities(const std::vector<SupportTuple>& given,
                                      std::pair<Numbers2, Numbers2> pivots,
                                      std::pair<PalmTuple, PalmTuple> palms) {
  const Supports supports = supports_of(given);
  std::vector<Numbers2> found;
  for (const Support& s : supports) {
    const Numbers2 pivot = s.side == left ? pivots.first : pivots.second;
    const auto [vx, vy, spin] = s.side == left ? palms.first : palms.second;
    const Vec v = RigidMotion{{vx, vy}, spin}.velocity_at(s.point - Vec{pivot.first, pivot.second});
    found.emplace_back(v.x, v.y);
  }
  return found;
}

std::vector<std::vector<int>> possible(const std::vector<SupportTuple>& given,
                                       const std::vector<Numbers2>& velocities) {
  const Supports supports = supports_of(given);
  std::vector<std::vector<int>> found;
  Twists(supports, velocities_of(velocities, supports.size()))
      .each({0}, ContainingCones(),
            [&](const Motions& m, std::size_t) { found.push_back(listed(m, supports.size())); });
  return found;
}

std::vector<std::vector<int>> outcomes(const std::vector<SupportTuple>& given,
                                       const std::vector<Numbers2>& velocities, double slope) {
  const Supports supports = supports_of(given);
  std::vector<std::vector<int>> found;
  each_outcome(supports, velocities_of(velocities, supports.size()), slope,
               [&](const Motions& m) { found.push_back(listed(m, supports.size())); });
  return found;
}

using Ends = std::pair<double, double>;

std::tuple<std::vector<std::pair<Ends, Ends>>, double, std::optional<std::vector<int>>> mode_forces(
    const std::vector<SupportTuple>& given, const std::vector<int>& codes, double slope,
    const std::vector<std::size_t>& surfaces) {
  const Supports supports = supports_of(given);
  const Motions motions = motions_of(codes, supports.size());
  if (surfaces.size() != supports.size())
    throw std::invalid_argument("one surface for each support");
  SurfaceNumbers numbers{};
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i] >= max_supports) throw std::out_of_range("a surface is a number from 0 to 7");
    numbers[i] = surfaces[i];
  }
  std::vector<std::pair<Ends, Ends>> forces;
  const auto found = contact_forces(supports, motions, slope);
  for (std::size_t i = 0; i < supports.size(); ++i) {
    forces.emplace_back(Ends{found[i].normal.low, found[i].normal.high},
                        Ends{found[i].friction.low, found[i].friction.high});
  }
  const ModeMargin margin = margin_of(supports, motions, slope, numbers);
  std::optional<std::vector<int>> at_limit;
  if (std::isfinite(margin.angle)) {
    at_limit = listed(loaded_edges(margin.supports, motions, slope), supports.size());
  }
  return {forces, margin.angle, at_limit};
}

}  // namespace

void bind_multi_contact(nb::module_& m) {
  m.attr("contact_kinds") = names_to(ContactKind::tip);
  m.attr("contact_tolerance") = contact_tolerance<double>;
  m.attr("wrench_tolerance") = unit_tolerance;
  m.def(
      "contacts", &contacts_of, nb::arg("spec"), nb::arg("angles"), nb::arg("places"),
      "All contacts as (kind, palm, place, object x, object y, support), the palm that lies in the "
      "object, the pivots from the COM [m], and why the state is refused.");
  m.def("palm_velocities", &palm_velocities, nb::arg("supports"), nb::arg("pivots"),
        nb::arg("palms"), "Of the palms at the supports; a palm moves by (vx, vy, spin).");
  m.def(
      "balances",
      [](const std::vector<SupportTuple>& given, const std::vector<int>& motions, double slope) {
        const Supports supports = supports_of(given);
        return balances(supports, motions_of(motions, supports.size()), slope);
      },
      nb::arg("supports"), nb::arg("motions"), nb::arg("slope") = 0.0,
      "Whether these contacts hold the object. A motion is 0 stick, 1 up, -1 down, 2 leave.");
  m.def("possible_motions", &possible, nb::arg("supports"), nb::arg("velocities"),
        "Every way in which a rigid body can move on palms with these velocities.");
  m.def("outcomes", &outcomes, nb::arg("supports"), nb::arg("velocities"), nb::arg("slope") = 0.0,
        "Those of them that balance.");
  m.def("pipe_refusal", &pipe_refusal, nb::arg("spec"), nb::arg("what"),
        "Why this (`what`) refuses a pipe; empty: the object is none.");
  m.def(
      "mode_forces", &mode_forces, nb::arg("supports"), nb::arg("motions"), nb::arg("slope"),
      nb::arg("surfaces"),
      "Of a mode in balance: the least and the greatest normal and friction force of each contact "
      "[weights], the margin of the mode [rad], and how each contact is loaded at its end, as a "
      "motion (None: it has no end). `surfaces` numbers the surface of each contact.");
}

}  // namespace palmbots::bindings
