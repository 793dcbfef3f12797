// Both robots without their world, tick by tick.
#include "palmbots/crew.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <memory>

#include "palmbots/teams.hpp"
#include "run.hpp"

namespace palmbots::bindings {

namespace {

// A crew whatever its controllers are.
class AnyCrew {
 public:
  virtual ~AnyCrew() = default;
  virtual Actuation<double> command() = 0;
  virtual void observe(const Sight& sight) = 0;
  virtual bool done() const = 0;
  virtual const PerSide<double>& speeds() const = 0;
  virtual Run run() = 0;
};

template <class Team>
class CrewOf : public AnyCrew {
 public:
  CrewOf(const Spec& spec, std::uint64_t seed, Team team, double slack, const Sight& first)
      : crew_(spec, seed, std::move(team), slack, first) {}
  Actuation<double> command() override { return crew_.command(); }
  void observe(const Sight& sight) override { crew_.observe(sight); }
  bool done() const override { return crew_.done(); }
  const PerSide<double>& speeds() const override { return crew_.speeds(); }
  Run run() override {
    Run run = run_of(crew_);
    run.hash = crew_.recorder().hash();
    run.rows = crew_.recorder().take_rows();
    run.posted = crew_.recorder().take_posted();
    return run;
  }

 private:
  Crew<Team> crew_;
};

std::unique_ptr<AnyCrew> crew_with(const Spec& spec, const nb::object& controller,
                                   std::uint64_t seed, double slack, const Sight& first) {
  const auto make = [&](auto team) -> std::unique_ptr<AnyCrew> {
    using Team = decltype(team);
    return std::make_unique<CrewOf<Team>>(spec, seed, std::move(team), slack, first);
  };
  if (nb::isinstance<nb::str>(controller)) {
    const auto name = nb::cast<std::string>(controller);
    if (!is_controller(name)) {
      throw std::invalid_argument("controller: none, centralized, distributed or resilient");
    }
    return with_team(name, [&](auto team) { return make(team(spec, seed)); });
  }
  const auto pair = nb::cast<std::tuple<nb::object, nb::object>>(controller);
  return make(Pair<PythonController>(
      {PythonController(std::get<0>(pair)), PythonController(std::get<1>(pair))}, channel_of(spec),
      seed, leader_of(spec), Faults::of(spec, seed)));
}

template <class T>
PerSide<T> sides(std::pair<T, T> pair) {
  return {pair.first, pair.second};
}
template <class T>
std::pair<T, T> pair_of(const PerSide<T>& both) {
  return {both[left], both[right]};
}
using Two = std::pair<double, double>;

// Owns a crew; a class of its own, since nanobind makes objects in place.
struct CrewHandle {
  std::unique_ptr<AnyCrew> crew;
};

}  // namespace

void bind_crew(nb::module_& m) {
  nb::class_<Sight>(m, "Sight", "What is seen of a world at the end of a tick (crew.hpp).")
      .def(
          "__init__",
          [](Sight* self, Two contacts, Two lift, Two touched, std::pair<bool, bool> pressed,
             Two palms, Two wrists, double separation, double midpoint, double rise,
             std::pair<int, int> motion, const std::string& end, double fraction) {
            const auto* found = std::find(std::begin(end_names), std::end(end_names), end);
            if (found == std::end(end_names)) throw std::invalid_argument("end: no such reason");
            for (const int one : {motion.first, motion.second}) {
              if (one < -1 || one > 1) throw std::out_of_range("motion is -1, 0 or 1");
            }
            new (self) Sight{sides(contacts),
                             sides(lift),
                             sides(touched),
                             sides(pressed),
                             sides(palms),
                             sides(wrists),
                             separation,
                             midpoint,
                             rise,
                             sides(motion),
                             static_cast<End>(found - end_names),
                             fraction};
          },
          nb::arg("contacts"), nb::arg("lift"), nb::arg("touched"), nb::arg("pressed"),
          nb::arg("palms"), nb::arg("wrists"), nb::arg("separation"), nb::arg("midpoint"),
          nb::arg("rise"), nb::arg("motion"), nb::arg("end") = "", nb::arg("fraction") = 1.0)
      .def_prop_ro("contacts", [](const Sight& s) { return pair_of(s.contacts); })
      .def_prop_ro("lift", [](const Sight& s) { return pair_of(s.lift); })
      .def_prop_ro("palms", [](const Sight& s) { return pair_of(s.palms); })
      .def_prop_ro("motion", [](const Sight& s) { return pair_of(s.motion); })
      .def_ro("separation", &Sight::separation)
      .def_ro("midpoint", &Sight::midpoint)
      .def_ro("rise", &Sight::rise);

  nb::class_<CrewHandle>(m, "Crew", "Both robots without their world: command, move, observe.")
      .def(
          "__init__",
          [](CrewHandle* self, const Spec& spec, const nb::object& controller, std::uint64_t seed,
             const Sight& first, double slack) {
            new (self) CrewHandle{crew_with(spec, controller, seed, slack, first)};
          },
          nb::arg("spec"), nb::arg("controller"), nb::arg("seed"), nb::arg("first"),
          nb::arg("slack") = 0.0,
          "controller: a name, or a pair of Python step functions; slack: how far from the angle "
          "commanded [rad] a wrist counts as turned.")
      .def_prop_ro("done", [](const CrewHandle& c) { return c.crew->done(); })
      .def(
          "command",
          [](CrewHandle& c) {
            if (c.crew->done()) throw std::runtime_error("the carry is over");
            const Actuation<double> act = c.crew->command();
            const PerSide<double>& v = c.crew->speeds();
            return std::tuple(Two{v[left], v[right]}, Two{act.angles[left], act.angles[right]},
                              act.change, act.push, act.travel);
          },
          "Decides: (speeds [m/s] towards +x, palm angles [rad] at the end of the tick, change of "
          "the separation [m], push [1], travel of the midpoint [m]).")
      .def(
          "observe", [](CrewHandle& c, const Sight& sight) { c.crew->observe(sight); },
          nb::arg("sight"), "What became of it, once for each command.")
      .def(
          "run", [](CrewHandle& c) { return c.crew->run(); },
          "The finished carry; takes the trace with it.");
}

}  // namespace palmbots::bindings
