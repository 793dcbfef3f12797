// The quasistatic world, step by step.
#include "palmbots/world.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"

namespace palmbots::bindings {

namespace {

std::pair<double, double> pair_of(const PerSide<double>& p) { return {p[left], p[right]}; }

}  // namespace

void bind_world(nb::module_& m) {
  using W = World<double>;
  nb::class_<W>(m, "World", "Two palms and an object: exact motion under given robot motions.")
      .def(
          "__init__",
          [](W* self, const Spec& spec) {
            Rig<double> rig = rig_of<double>(spec);
            rig.safe_reach = -1;  // the palms may be turned to any angles
            new (self) W(rig, stance_of(spec, rig));
          },
          nb::arg("spec"))
      .def_prop_ro("contacts", [](const W& w) { return pair_of(w.stance().contacts); })
      .def_prop_ro("separation", [](const W& w) { return w.stance().separation; })
      .def_prop_ro("palms",
                   [](const W& w) {
                     return std::pair(w.stance().palms[left].angle, w.stance().palms[right].angle);
                   })
      .def_prop_ro("span", [](const W& w) { return std::pair(w.span().dx, w.span().dy); })
      .def_prop_ro("lift", [](const W& w) { return pair_of(w.stance().lift); })
      .def_prop_ro(
          "grip",
          [](const W& w) {
            std::vector<std::tuple<std::size_t, bool, std::size_t, double>> holds;
            for (std::size_t i = 0; i < w.grip().count; ++i) {
              const Hold<double>& h = w.grip().holds[i];
              holds.emplace_back(h.side, h.tip, h.feature, h.end);
            }
            return holds;
          },
          "Contacts as (side, tip, vertex or edge, p of the tip); empty: the two vertices alone.")
      .def_prop_ro("touches", [](const W& w) { return w.touches().count; })
      .def(
          "check", [](const W& w) { return end_names[static_cast<int>(w.check())]; },
          "Why the object is not held here; empty if it is.")
      .def(
          "shift",
          [](W& w, std::size_t side, double by) {
            if (side > 1) throw std::out_of_range("side is 0 or 1");
            PerSide<double> shifts{};
            shifts[side] = by;
            return end_names[static_cast<int>(w.shift(shifts))];
          },
          nb::arg("side"), nb::arg("by"), "A bump: shifts one contact [m]; the robots give way.")
      .def(
          "advance",
          [](W& w, double change, std::pair<double, double> palms, double push) {
            const Advance<double> a = w.advance(change, {palms.first, palms.second}, push);
            return std::tuple(end_names[static_cast<int>(a.end)], a.fraction,
                              static_cast<int>(a.motion[left]), static_cast<int>(a.motion[right]),
                              a.pieces);
          },
          nb::arg("change"), nb::arg("palms"), nb::arg("push") = 0.0,
          "Changes the separation [m] and turns the palms to the given angles [rad], both at "
          "constant rates. Returns (end, fraction done, motion left, motion right, pieces).");
}

}  // namespace palmbots::bindings
