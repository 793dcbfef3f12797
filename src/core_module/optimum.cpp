// SPDX-License-Identifier: Apache-2.0
// The opening problem, its solution by value iteration, and the controller that follows it.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <stdexcept>

#include "bindings.hpp"
#include "palmbots/optimum/linear_team.hpp"
#include "palmbots/optimum/optimal_team.hpp"
#include "palmbots/optimum/standing_team.hpp"
#include "palmbots/optimum/value_iteration.hpp"

namespace palmbots::bindings {

namespace {

OpeningProblem problem_of(const Spec& spec, const std::string& speeds) {
  if (speeds == "corrections") return opening_problem_of(spec, AdmissibleSpeeds::corrections);
  if (speeds == "stopping") return opening_problem_of(spec, AdmissibleSpeeds::stopping);
  throw std::invalid_argument("speeds: corrections or stopping");
}

OpeningSolution solve_problem(const OpeningProblem& problem, std::size_t positions,
                              std::size_t noises, double speeds) {
  if (positions < 8 || noises < 8 || !(speeds > 0)) {
    throw std::invalid_argument("positions and noises: at least 8; speeds: positive");
  }
  const nb::gil_scoped_release release;
  std::uint32_t decisions = 0;
  return solve(problem, {positions, noises, speeds}, [&] {
    if (++decisions % 64 != 0) return;
    const nb::gil_scoped_acquire hold;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  });
}

}  // namespace

void bind_optimum(nb::module_& m) {
  nb::class_<OpeningProblem>(m, "OpeningProblem",
                             "The separation of the robots under noise, in SI units.")
      .def(nb::init<>())
      .def_rw("lowest", &OpeningProblem::lowest)
      .def_rw("highest", &OpeningProblem::highest)
      .def_rw("start", &OpeningProblem::start)
      .def_rw("slowest", &OpeningProblem::slowest)
      .def_rw("fastest", &OpeningProblem::fastest)
      .def_rw("change", &OpeningProblem::change)
      .def_rw("bias", &OpeningProblem::bias)
      .def_rw("noise", &OpeningProblem::noise)
      .def_rw("memory", &OpeningProblem::memory)
      .def_rw("period", &OpeningProblem::period)
      .def_rw("duration", &OpeningProblem::duration)
      .def_rw("distance", &OpeningProblem::distance)
      .def_rw("price", &OpeningProblem::price)
      .def_prop_rw(
          "most", [](const OpeningProblem& p) { return std::pair(p.most[0], p.most[1]); },
          [](OpeningProblem& p, std::pair<double, double> most) {
            p.most = {most.first, most.second};
          },
          "Largest commanded speed of the follower and of the leader.");

  nb::class_<OptimalController>(m, "OptimalController",
                                "A reference with full information, for one scene.")
      .def(
          "__init__",
          [](OptimalController* self, const nb::bytes& policy, bool may_stop) {
            const std::string_view bytes(policy.c_str(), policy.size());
            new (self) OptimalController{OpeningPolicy::from_bytes(bytes), may_stop};
          },
          nb::arg("policy"), nb::arg("may_stop"));

  nb::class_<LinearFeedback>(m, "LinearFeedback",
                             "A reference with linear feedback of the contact coordinates.")
      .def(
          "__init__",
          [](LinearFeedback* self, bool exact, bool may_stop, double time_s,
             const std::array<double, 2>& targets_m) {
            new (self) LinearFeedback{exact, may_stop, time_s, {targets_m[left], targets_m[right]}};
          },
          nb::arg("exact"), nb::arg("may_stop"), nb::arg("time_s") = LinearFeedback{}.time_s,
          nb::arg("targets_m") = std::array<double, 2>{},
          "exact: it reads the coordinates; otherwise a Kalman filter estimates them from signs.\n"
          "targets_m: where the left and the right contact are to be, outward of the pivot.")
      .def_ro("time_s", &LinearFeedback::time_s,
              "In which the sum of the contact coordinates is to vanish.");

  nb::class_<StandingFeedback>(m, "StandingFeedback",
                               "A reference that lets the robots stand in unfavourable noise.")
      .def(
          "__init__",
          [](StandingFeedback* self, bool creeps) { new (self) StandingFeedback{creeps}; },
          nb::arg("creeps"), "creeps: moved by noise alone, the robots stand within a tick.");

  nb::class_<OpeningSolution>(m, "OpeningSolution", "What value iteration found, in SI units.")
      .def_ro("drop", &OpeningSolution::drop, "Probability of a drop in a carry.")
      .def_ro("hazard", &OpeningSolution::hazard, "Probability of a drop per second.")
      .def_ro("speed", &OpeningSolution::speed, "Of the midpoint; 0: progress does not count.")
      .def_ro("duration", &OpeningSolution::duration, "Of the carry.")
      .def_ro("decisions", &OpeningSolution::decisions, "After which the hazard was constant.")
      .def_prop_ro(
          "policy",
          [](const OpeningSolution& s) {
            const std::string bytes = s.policy.to_bytes();
            return nb::bytes(bytes.data(), bytes.size());
          },
          "The table of costs, for OptimalController.");

  m.def("opening_problem", &problem_of, nb::arg("spec"), nb::arg("speeds"),
        "The opening problem of a carry; speeds: corrections or stopping.");
  m.def("solve_opening", &solve_problem, nb::arg("problem"), nb::arg("positions"),
        nb::arg("noises"), nb::arg("speeds"), "Solves it on a grid (OpeningGrid).");
}

}  // namespace palmbots::bindings
