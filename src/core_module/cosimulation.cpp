// SPDX-License-Identifier: Apache-2.0
// Both robots without their world, tick by tick.
#include "palmbots/sim/cosimulation.hpp"

#include "palmbots/sim/lift_cosimulation.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <memory>

#include "given_team.hpp"

namespace palmbots::bindings {

namespace {

// A co-simulation whatever its controllers are.
class AnyCoSimulation {
 public:
  virtual ~AnyCoSimulation() = default;
  virtual Actuation<double> step_controllers() = 0;
  virtual void observe(const WorldObservation& observation) = 0;
  virtual bool done() const = 0;
  virtual const PerSide<double>& speeds() const = 0;
  // Where the arms are at the end of the tick [m], whether a nose is on the floor or the object may
  // touch a stand, and whether they follow the floor.
  virtual PerSide<double> heights() const = 0;
  virtual PerSide<bool> are_low() const = 0;
  virtual PerSide<bool> follow_floor() const = 0;
  virtual Run run() = 0;
};

// `Job` is a CoSimulation, or a LiftCoSimulation where the job begins or ends on the floor.
template <class Job>
class CoSimulationOf : public AnyCoSimulation {
 public:
  template <class Team>
  CoSimulationOf(const Spec& spec, std::uint64_t seed, Team team, double slack,
                 const WorldObservation& first)
      : job_(spec, seed, std::move(team), slack, first) {}
  Actuation<double> step_controllers() override { return job_.step_controllers(); }
  void observe(const WorldObservation& observation) override { job_.observe(observation); }
  bool done() const override { return job_.done(); }
  const PerSide<double>& speeds() const override { return job_.speeds(); }
  PerSide<double> heights() const override {
    if constexpr (has_arms) return job_.heights();
    return {};
  }
  PerSide<bool> are_low() const override {
    if constexpr (has_arms) return {job_.is_low(left), job_.is_low(right)};
    return {};
  }
  PerSide<bool> follow_floor() const override {
    if constexpr (has_arms) return {job_.follows_floor(left), job_.follows_floor(right)};
    return {};
  }
  Run run() override {
    if constexpr (has_arms) {
      return run_of_lift(job_);
    } else {
      Run run = run_of(job_);
      run.hash = job_.recorder().hash();
      run.rows = job_.recorder().take_rows();
      run.sent_messages = job_.recorder().take_sent_messages();
      return run;
    }
  }

 private:
  static constexpr bool has_arms = requires(const Job& job) { job.heights(); };
  Job job_;
};

std::unique_ptr<AnyCoSimulation> cosimulation_with(const Spec& spec, const nb::object& controller,
                                                   std::uint64_t seed, double slack,
                                                   const WorldObservation& first) {
  const auto with = [&]<class Team>(Team team) -> std::unique_ptr<AnyCoSimulation> {
    if (!uses_floor(spec))
      return std::make_unique<CoSimulationOf<CoSimulation<AnyTeam>>>(
          spec, seed, AnyTeam(std::move(team)), slack, first);
    auto own = team_of_job(std::move(team));
    return with_job_table(spec, [&]<class Table>(Table) -> std::unique_ptr<AnyCoSimulation> {
      return std::make_unique<CoSimulationOf<LiftCoSimulation<decltype(own), Table>>>(
          spec, seed, std::move(own), slack, first);
    });
  };
  if (on_one_palm(spec) && !nb::isinstance<RemoteControllers>(controller))
    return with(NoController{});
  return with_given_team(controller, spec, seed, with);
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

// Owns a co-simulation; a class of its own, since nanobind makes objects in place.
struct CoSimulationHandle {
  std::unique_ptr<AnyCoSimulation> cosimulation;
};

DropReason reason_of(const std::string& name) {
  for (std::size_t i = 0; i < drop_reasons; ++i) {
    if (name == carry_ends[i].name) return static_cast<DropReason>(i);
  }
  throw std::invalid_argument("reason: no such reason");
}

}  // namespace

void bind_cosimulation(nb::module_& m) {
  nb::class_<WorldObservation>(
      m, "WorldObservation", "What is seen of a world at the end of a tick (sim/cosimulation.hpp).")
      .def(
          "__init__",
          [](WorldObservation* self, Two contacts, Two lift, Two touched,
             std::pair<bool, bool> pressed, Two palms, Two wrists, double separation,
             double midpoint, double rise, std::pair<int, int> motion, const std::string& reason,
             double fraction, Two heights, Two rolled, double moved, double object_sine,
             bool stands, std::pair<bool, bool> stalls, double turn) {
            const DropReason why = reason_of(reason);
            for (const int one : {motion.first, motion.second}) {
              if (one < -1 || one > 1) throw std::out_of_range("motion is -1, 0 or 1");
            }
            new (self) WorldObservation{sides(contacts),
                                        sides(lift),
                                        sides(touched),
                                        sides(pressed),
                                        sides(palms),
                                        sides(wrists),
                                        separation,
                                        midpoint,
                                        rise,
                                        sides(motion),
                                        why,
                                        fraction,
                                        sides(heights),
                                        sides(rolled),
                                        moved,
                                        object_sine,
                                        stands,
                                        sides(stalls),
                                        turn};
          },
          nb::arg("contacts"), nb::arg("lift"), nb::arg("touched"), nb::arg("pressed"),
          nb::arg("palms"), nb::arg("wrists"), nb::arg("separation"), nb::arg("midpoint"),
          nb::arg("rise"), nb::arg("motion"), nb::arg("reason") = "", nb::arg("fraction") = 1.0,
          nb::arg("heights") = Two{}, nb::arg("rolled") = Two{}, nb::arg("moved") = 0.0,
          nb::arg("object_sine") = 0.0, nb::arg("stands") = false,
          nb::arg("stalls") = std::pair(false, false), nb::arg("turn") = 0.0)
      .def_prop_ro("contacts", [](const WorldObservation& s) { return pair_of(s.contacts); })
      .def_prop_ro("lift", [](const WorldObservation& s) { return pair_of(s.lift); })
      .def_prop_ro("palms", [](const WorldObservation& s) { return pair_of(s.palms); })
      .def_prop_ro("motion", [](const WorldObservation& s) { return pair_of(s.motion); })
      .def_ro("separation", &WorldObservation::separation)
      .def_ro("midpoint", &WorldObservation::midpoint)
      .def_ro("rise", &WorldObservation::rise)
      .def_ro("turn", &WorldObservation::turn);

  m.def(
      "standing_start",
      [](const Spec& spec) {
        const StandingStart start = StandingStart::of(spec);
        const auto two = [](Vec v) { return Two{v.x, v.y}; };
        return std::pair(std::pair(two(start.pivots[left]), two(start.pivots[right])),
                         two(start.com));
      },
      nb::arg("spec"),
      "Where a job begins whose object stands on the floor: ((x, height) of both pivots, (x, "
      "height) "
      "of the COM) [m].");

  nb::class_<CoSimulationHandle>(
      m, "CoSimulation", "Both robots without their world: step_controllers, move, observe.")
      .def(
          "__init__",
          [](CoSimulationHandle* self, const Spec& spec, const nb::object& controller,
             std::uint64_t seed, const WorldObservation& first, double slack) {
            new (self) CoSimulationHandle{cosimulation_with(spec, controller, seed, slack, first)};
          },
          nb::arg("spec"), nb::arg("controller"), nb::arg("seed"), nb::arg("first"),
          nb::arg("slack") = 0.0, nb::keep_alive<1, 3>(),  // machines
          "controller: a name, Machines, or a pair of Python step functions; slack: how far from "
          "the angle "
          "commanded [rad] a wrist counts as turned.")
      .def_prop_ro("done", [](const CoSimulationHandle& c) { return c.cosimulation->done(); })
      .def(
          "step_controllers",
          [](CoSimulationHandle& c) {
            if (c.cosimulation->done()) throw std::runtime_error("the carry is over");
            const Actuation<double> act = c.cosimulation->step_controllers();
            const PerSide<double>& v = c.cosimulation->speeds();
            return std::tuple(Two{v[left], v[right]}, Two{act.angles[left], act.angles[right]},
                              act.change, act.push, act.travel);
          },
          "Decides: (speeds [m/s] towards +x, palm angles [rad] at the end of the tick, change of "
          "the separation [m], push [1], travel of the midpoint [m]).")
      .def_prop_ro(
          "arms",
          [](const CoSimulationHandle& c) {
            return std::tuple(pair_of(c.cosimulation->heights()),
                              pair_of(c.cosimulation->are_low()),
                              pair_of(c.cosimulation->follow_floor()));
          },
          "Of a job on the floor or on a stand, after step_controllers(): (heights of the pivots "
          "[m] at the end of the tick, whether a nose is on the floor or the object may touch a "
          "stand, whether each arm follows the floor).")
      .def(
          "observe",
          [](CoSimulationHandle& c, const WorldObservation& observation) {
            c.cosimulation->observe(observation);
          },
          nb::arg("sight"), "What became of it, once for each step_controllers().")
      .def(
          "run", [](CoSimulationHandle& c) { return c.cosimulation->run(); },
          "The finished carry; takes the trace with it.");
}

}  // namespace palmbots::bindings
