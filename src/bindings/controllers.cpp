// The controllers and their tables, one step at a time.
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"

namespace palmbots::bindings {

void bind_controllers(nb::module_& m) {
  nb::class_<Distributed>(m, "Distributed", "Table 2 of the paper, one robot.")
      .def(nb::init<>())
      .def(
          "step",
          [](Distributed& self, int sign, int letter, bool turned) {
            if (sign < -1 || sign > 1 || letter < 0 || letter > 3) {
              throw std::out_of_range("sign is -1, 0 or 1; letter is 0 to 3");
            }
            const auto out =
                self.step({static_cast<Sign>(sign), static_cast<Letter>(letter), turned});
            return std::tuple(static_cast<int>(out.command.palm),
                              static_cast<int>(out.command.move), static_cast<int>(out.send),
                              out.read);
          },
          nb::arg("sign"), nb::arg("letter"), nb::arg("turned"),
          "One tick; returns (palm, move, letter sent, letter read).")
      .def_prop_ro("state", [](const Distributed& self) { return static_cast<int>(self.state()); })
      .def_prop_ro("name", [](const Distributed& self) { return nb::str(&self.now().name, 1); })
      .def_prop_ro("waits", [](const Distributed& self) { return self.now().waits; });

  nb::class_<Centralized>(m, "Centralized", "Table 1 of the paper, the station.")
      .def(nb::init<>())
      .def(
          "step",
          [](Centralized& self, std::tuple<int, int, bool> l, std::tuple<int, int, bool> r) {
            const auto report = [](const std::tuple<int, int, bool>& t) {
              return Centralized::Report{static_cast<Sign>(std::get<0>(t)),
                                         static_cast<Palm>(std::get<1>(t)), std::get<2>(t)};
            };
            const Centralized::Report reports[2] = {report(l), report(r)};
            const auto out = self.step(reports);
            return std::tuple(
                static_cast<int>(out.command[0].palm), static_cast<int>(out.command[0].move),
                static_cast<int>(out.command[1].palm), static_cast<int>(out.command[1].move));
          },
          nb::arg("left"), nb::arg("right"),
          "One tick with each robot's (sign, palm commanded, turned); returns (palm, move) of "
          "both.")
      .def_prop_ro("case_number", &Centralized::current)
      .def_prop_ro("stage", [](const Centralized& self) { return static_cast<int>(self.stage()); });
}

}  // namespace palmbots::bindings
