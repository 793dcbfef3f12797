// SPDX-License-Identifier: Apache-2.0
// The quasistatic world, step by step.
#include "palmbots/base/gravity.hpp"
#include "palmbots/sim/palm_way.hpp"
#include "palmbots/sim/pivot_rises.hpp"
#include "palmbots/sim/standing_start.hpp"
#include "palmbots/world/quasistatic_world.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>

#include "bindings.hpp"

namespace palmbots::bindings {

namespace {

using Numbers2 = std::pair<double, double>;

Numbers2 pair_of(const PerSide<double>& p) { return {p[left], p[right]}; }
PerSide<Vec> vectors_of(const std::pair<Numbers2, Numbers2>& given) {
  return {Vec{given.first.first, given.first.second}, {given.second.first, given.second.second}};
}

std::tuple<std::string, double, int, int, int> result_of(const Advance<double>& a) {
  return {name_of(a.reason), a.fraction, static_cast<int>(a.motion[left]),
          static_cast<int>(a.motion[right]), a.segments};
}

using SupportTuple = std::tuple<std::size_t, double, double, double, double, double>;

std::vector<std::tuple<std::string, std::size_t, double, SupportTuple>> touching(
    const World<double>& w, double within) {
  std::vector<std::tuple<std::string, std::size_t, double, SupportTuple>> found;
  for (const Touched& one : w.touched_in(within)) {
    const Support& s = one.support;
    found.emplace_back(
        one.kind, one.carrier, one.place,
        SupportTuple{s.side, s.point.x, s.point.y, s.normal.x, s.normal.y, s.friction});
  }
  return found;
}

}  // namespace

void bind_world(nb::module_& m) {
  m.attr("standard_gravity") = standard_gravity;
  using Inertia = InertiaFilter<double>;
  nb::class_<Inertia>(m, "InertiaFilter", "The push of the inertia of a pair that was at rest.")
      .def(
          "__init__",
          [](Inertia* self, const Spec& spec) { new (self) Inertia(inertia_of<double>(spec)); },
          nb::arg("spec"))
      .def("step", &Inertia::step, nb::arg("speeds"),
           "The push [1] over a tick in which both robots' speeds towards +x have this sum [m/s].");
  using W = World<double>;
  nb::class_<W>(m, "World", "Two palms and an object: exact motion under given robot motions.")
      .def(
          "__init__",
          [](W* self, const Spec& spec, bool has_floor) {
            Model<double> model = model_of<double>(spec);
            model.safe_reach = -1;  // the palms may be turned to any angles
            if (has_floor) model.surroundings = surroundings_of(spec);
            new (self) W(model, configuration_of(spec, model));
          },
          nb::arg("spec"), nb::arg("has_floor") = false,
          "has_floor: among the floor, the walls and the stands of the spec.")
      .def_prop_ro("contacts", [](const W& w) { return pair_of(w.configuration().contacts); })
      .def_prop_ro("separation", [](const W& w) { return w.configuration().separation; })
      .def_prop_ro("palms",
                   [](const W& w) {
                     return std::pair(w.configuration().palms[left].angle,
                                      w.configuration().palms[right].angle);
                   })
      .def_prop_ro(
          "contact_vector",
          [](const W& w) { return std::pair(w.contact_vector().dx, w.contact_vector().dy); })
      .def_prop_ro("lift", [](const W& w) { return pair_of(w.configuration().lift); })
      .def_prop_ro(
          "constraints",
          [](const W& w) {
            std::vector<std::tuple<std::size_t, bool, std::size_t, double>> contacts;
            for (const ActivePair& active : w.regime().active) {
              const Surface& surface = w.shapes().surfaces[active.pair.surface];
              contacts.emplace_back(static_cast<std::size_t>(surface.carrier), surface.tip,
                                    active.pair.feature, surface.tip ? surface.at.x : 0.0);
            }
            std::ranges::sort(contacts);
            return contacts;
          },
          "Contacts as (side, tip, vertex or edge, p of the tip); empty: the two vertices alone.")
      .def_prop_ro("contact_events", [](const W& w) { return w.contact_events().count; })
      .def_prop_ro("ambiguous_events", &W::ambiguous_events,
                   "Events so far after which several motions were as good.")
      .def(
          "copy", [](const W& w) { return w; }, "A world that goes on from here by itself.")
      .def(
          "check", [](const W& w) { return name_of(w.check()); },
          "Why the object is not held here; empty if it is.")
      .def(
          "start_refusal", [](const W& w) { return refusal_of_start(w.check()); },
          "Why the object cannot begin here among walls and stands; empty if it can.")
      .def(
          "shift",
          [](W& w, std::size_t side, double by) {
            if (side > 1) throw std::out_of_range("side is 0 or 1");
            PerSide<double> shifts{};
            shifts[side] = by;
            return name_of(w.shift(shifts));
          },
          nb::arg("side"), nb::arg("by"), "A bump: shifts one contact [m]; the robots give way.")
      .def(
          "advance",
          [](W& w, double change, std::pair<double, double> palms, double push) {
            return result_of(w.advance(change, {palms.first, palms.second}, push));
          },
          nb::arg("change"), nb::arg("palms"), nb::arg("push") = 0.0,
          "Changes the separation [m] and turns the palms to the given angles [rad], both at "
          "constant rates. Returns (reason, fraction done, motion left, motion right, segments).")
      .def(
          "move",
          [](W& w, std::pair<Numbers2, Numbers2> by, Numbers2 palms, double push) {
            return result_of(w.advance(vectors_of(by), {palms.first, palms.second}, push));
          },
          nb::arg("by"), nb::arg("palms"), nb::arg("push") = 0.0,
          "The same, with the way (x, y) of each pivot [m]. A robot that stalls covers less of it.")
      .def_prop_ro(
          "is_limited", [](const W& w) { return w.is_limited(); }, "Whether a robot may stall.")
      .def(
          "put",
          [](W& w, std::pair<Numbers2, Numbers2> pivots, Numbers2 palms, Numbers2 at,
             double angle) {
            w.put(vectors_of(pivots), {palms.first, palms.second},
                  Pose::of({at.first, at.second}, angle));
          },
          nb::arg("pivots"), nb::arg("palms"), nb::arg("at"), nb::arg("angle"),
          "Puts pivots and the object's COM at these places (x, y) [m].")
      .def("touching", &touching, nb::arg("within"),
           "Contacts with at most this gap [m]: (vertex, tip, nose, heel, floor, wall or stand; "
           "palm, or 2: the ground; place on it [m]; support), points from the COM.")
      .def_prop_ro(
          "grounds",
          [](const W& w) {
            std::set<std::string> names;
            for (const ActivePair& active : w.regime().active) {
              const Surface& surface = w.shapes().surfaces[active.pair.surface];
              if (surface.carrier == Carrier::ground) names.insert(name_of(surface));
            }
            return std::vector(names.begin(), names.end());
          },
          "Which of floor, wall and stand are among the contacts.")
      .def_prop_ro(
          "run_off",
          [](const W& w) {
            std::vector<std::pair<std::size_t, std::string>> found;
            for (const FeaturePair pair : w.run_off())
              found.emplace_back(pair.carrier, name_of(w.shapes().surfaces[pair.surface]));
            return found;
          },
          "(palm, or 2: the ground; vertex, tip, nose, heel, floor, wall or stand) of each contact "
          "that ran off the end of its feature in the last step that was not fast.")
      .def("pierced", &W::pierced_palm, nb::arg("deep"),
           "The palm that is in the object by more than this [m]; None: neither is.")
      .def(
          "set_phase",
          [](W& w, const std::string& name, double most_fall) {
            for (std::size_t k = 0; k < carry_phases; ++k) {
              if (name == carry_phase_words[k][0])
                return w.set_phase(static_cast<CarryPhase>(k), most_fall);
            }
            throw std::invalid_argument("phase: no such phase");
          },
          nb::arg("phase"), nb::arg("most_fall") = 0.0,
          "The phase of the task, which decides what ends a step, and how far a contact vertex may "
          "fall [m].")
      .def_prop_ro(
          "fall",
          [](const W& w) -> std::optional<Numbers2> {
            if (!w.fall()) return std::nullopt;
            return Numbers2{w.fall()->height, w.fall()->com};
          },
          "How far a contact vertex fell, and the COM [m], if that ended the last step.")
      .def_prop_ro(
          "pose",
          [](const W& w) {
            const Pose pose = w.pose();
            return std::tuple(pose.at.x, pose.at.y, pose.angle);
          },
          "Position of the COM [m], and angle.")
      .def_prop_ro("pivots",
                   [](const W& w) {
                     const Vec l = w.pivot(left);
                     const Vec r = w.pivot(right);
                     return std::pair(Numbers2{l.x, l.y}, Numbers2{r.x, r.y});
                   })
      .def_prop_ro(
          "touched",
          [](const W& w) {
            const auto place = [&](std::size_t side) -> std::optional<double> {
              if (!w.is_touched(side)) return std::nullopt;
              return w.touched()[side];
            };
            return std::pair(place(left), place(right));
          },
          "Where each palm is touched [m]; None: nowhere.");
  m.def(
      "ground_blocks",
      [](const Spec& spec) {
        std::vector<std::tuple<std::string, std::string, Numbers2, double, double, double>> found;
        for (const GroundBlock& b : ground_blocks(spec))
          found.emplace_back(b.key, name_of(b.ground), Numbers2{b.low, b.high}, b.height,
                             b.friction, b.gap);
        return found;
      },
      nb::arg("spec"),
      "Floor, walls and stands: (key, kind, (from, to), height, friction, gap) [m].");
  m.def(
      "refusal_of_way",
      [](const Spec& spec, std::pair<bool, bool> is_there, std::pair<Numbers2, Numbers2> pivots,
         Numbers2 angles, std::pair<Numbers2, Numbers2> by, Numbers2 goals,
         const std::string& when) {
        const Travel travel = Travel::of(vectors_of(pivots), {angles.first, angles.second},
                                         vectors_of(by), {goals.first, goals.second});
        return refusal_of_way(spec, spec.palms, travel, {is_there.first, is_there.second}, when);
      },
      nb::arg("spec"), nb::arg("is_there"), nb::arg("pivots"), nb::arg("angles"), nb::arg("by"),
      nb::arg("goals"), nb::arg("when"),
      "Why palms may not travel like this among floor, walls and stands; empty: they may.");
  m.def(
      "stand_heights",
      [](const Spec& spec, std::size_t side, double top) {
        const StandHeights heights = StandHeights::of(spec, side, top);
        return Numbers2{heights.low, heights.clear};
      },
      nb::arg("spec"), nb::arg("side"), nb::arg("top"),
      "Heights of the pivot of a steep palm below an object on a stand of this height: at which it "
      "touches the object nowhere, and at which it touches it with its inner end at the latest "
      "[m].");
  m.def(
      "way_below",
      [](const Spec& spec, std::size_t side) {
        return StandingStart::of(spec).way_below(spec, side);
      },
      nb::arg("spec"), nb::arg("side"),
      "How far a robot drives from the start of a job until its steep palm is below the object on "
      "a "
      "stand, where it touches at the contact coordinate of the scene's start [m].");
  const auto bits_of = [](const std::vector<int>& numbers) {
    unsigned bits = 0;
    for (const int number : numbers) bits |= property_bit(number);
    return bits;
  };
  nb::class_<PivotRises>(m, "PivotRises",
                         "The properties of a scene's palms for a rise of the right pivot over the "
                         "left one, with contacts on an inner share of the usable palms.")
      .def(nb::init<Spec, double>(), nb::arg("spec"), nb::arg("share") = 1.0)
      .def(
          "holding",
          [](const PivotRises& self, double rise, bool on_floor, bool clear) {
            const unsigned hold = self.holding({rise, rise}, on_floor, clear);
            std::vector<int> numbers;
            for (const int number : {0, 1, 2}) {
              if ((hold & property_bit(number)) != 0) numbers.push_back(number);
            }
            return nb::tuple(nb::cast(numbers));
          },
          nb::arg("rise") = 0.0, nb::arg("on_floor") = false, nb::arg("clear") = true,
          "The properties that hold with the right pivot this much higher [m], or with both inner "
          "ends on the floor and the right pivot higher by a further length. `clear`: they demand "
          "clearance.")
      .def(
          "permitted_m",
          [bits_of](const PivotRises& self, const std::vector<int>& wanted, bool on_floor,
                    bool clear) { return self.permitted(bits_of(wanted), on_floor, clear); },
          nb::arg("properties"), nb::arg("on_floor") = false, nb::arg("clear") = true,
          "The largest height difference with which these properties hold, as with all smaller "
          "ones "
          "of either sign; 0: they do not hold without one.");
  m.def(
      "arms_differ",
      [](const Spec& spec, bool level_only) {
        const ArmsDiffer found = ArmsDiffer::of(spec, level_only);
        return std::tuple(found.at_rest, found.late, found.moving);
      },
      nb::arg("spec"), nb::arg("level_only"),
      "The largest height difference of two arms that begin to move [m], how long one may move "
      "while "
      "the other one stands [s], and the largest difference while they move [m].");
  m.def("corrects_level_only", &corrects_level_only, nb::arg("spec"),
        "Whether a pair may correct its contacts at level pivots only.");
  m.attr("centred_share") = centred_share;
  m.def(
      "rise_clear_of_noses", &rise_clear_of_noses, nb::arg("spec"),
      "The height difference of the pivots up to which an object that has just been docked touches "
      "steep palms at its contact vertices only [m].");
  m.def("first_angle", &first_angle, nb::arg("spec"), nb::arg("side"),
        "The angle of a palm where a job begins [rad].");
  m.def("standing_level", &standing_level, nb::arg("spec"), nb::arg("moved") = 0.0,
        "Height of what is under the object at its start, or after it moved so far [m].");
  m.def("standing_refusal", &standing_refusal, nb::arg("spec"),
        "Why the object does not stand on its two contact vertices; empty: it does.");
  m.def(
      "standing_start",
      [](const Spec& spec, Numbers2 angles, Numbers2 gaps) {
        const StandingStart start =
            StandingStart::of(spec, {angles.first, angles.second}, {gaps.first, gaps.second});
        const auto [l, r] = std::pair(start.pivots[left], start.pivots[right]);
        return std::pair(std::pair(Numbers2{l.x, l.y}, Numbers2{r.x, r.y}),
                         Numbers2{start.com.x, start.com.y});
      },
      nb::arg("spec"), nb::arg("angles"), nb::arg("gaps"),
      "Pivots and COM of an object that stands between palms at these angles [rad], whose inner "
      "ends "
      "are at these distances from it, at the height of what it stands on [m].");
  m.def(
      "first_angles",
      [](const Spec& spec) { return Numbers2{first_angle(spec, left), first_angle(spec, right)}; },
      nb::arg("spec"), "Angles of the palms where a job begins [rad].");
  m.def(
      "takes_single_steps",
      [](const Spec& spec) { return takes_single_steps(model_of<double>(spec)); }, nb::arg("spec"),
      "Whether lanes take the steps of a carry one by one: a contact vertex is rounded, a nose or "
      "a "
      "heel may touch the object within reach, or a robot may stall.");
}

}  // namespace palmbots::bindings
