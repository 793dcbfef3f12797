// SPDX-License-Identifier: Apache-2.0
// The controllers and their tables, one step at a time.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "bindings.hpp"
#include "machines.hpp"
#include "palmbots/control/centralized.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/team_registry.hpp"

namespace palmbots::bindings {

namespace {

// All that a controller remembers, to distinguish its states. Where the compiler cannot clear
// padding, one state may show as several, never several as one.
template <class Controller>
nb::bytes memory(Controller controller) {
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&controller);
#endif
  char image[sizeof controller];
  std::memcpy(image, &controller, sizeof controller);
  return nb::bytes(image, sizeof image);
}

using Action = std::tuple<std::string, std::string, std::string>;
Action action(const Centralized::Action& a) {
  return {name_of(a.move), name_of(a.who), name_of(a.until)};
}

// An enumeration of consecutive values from `first` to `last`, with the names that the core gives
// them.
template <class Enum>
void bind_enum(nb::module_& m, const char* name, Enum first, Enum last, const char* about) {
  nb::enum_<Enum> names(m, name, nb::is_arithmetic(), about);
  for (int i = static_cast<int>(first); i <= static_cast<int>(last); ++i) {
    const auto value = static_cast<Enum>(i);
    names.value(*name_of(value) != 0 ? name_of(value) : "none", value);
  }
}

nb::tuple texts(std::span<const char* const> from) {
  nb::list list;
  for (const char* text : from) list.append(text);
  return nb::tuple(list);
}

nb::dict facts(const ControllerInfo& info, bool uses_clock) {
  nb::dict cases;
  for (const CaseMeaning& one : info.cases) cases[one.code] = one.meaning;
  nb::dict states;
  for (const StateMeaning& one : info.states) states[one.name] = one.meaning;
  nb::dict d;
  d["name"] = info.name;
  d["description"] = info.description;
  d["board_number"] = info.board_number < 0 ? nb::object(nb::none()) : nb::cast(info.board_number);
  d["team"] = name_of(info.decider);
  d["uses_radio"] = !info.messages.empty();
  d["uses_clock"] = uses_clock;
  d["is_periodic"] = info.is_periodic;
  d["stops_in_silence"] = info.stops_in_silence;
  d["drives_by_both_signs"] = info.drives_by_both_signs;
  d["has_time_bounds"] = info.has_time_bounds;
  d["messages"] = texts(info.messages);
  d["cases"] = cases;
  d["assisted_cases"] = texts(info.assisted_cases);
  d["states"] = states;
  return d;
}

}  // namespace

void bind_controllers(nb::module_& m) {
  bind_enum(m, "Palm", Palm::steep, Palm::shallow,
            "Which of its two angles a palm is commanded to.");
  bind_enum(m, "Move", Move::hold, Move::closer, "The speed a robot adds to its nominal one.");
  bind_enum(m, "MessageKind", MessageKind::none, MessageKind::minus_shallow,
            "What robots say to each other.");

  m.def(
      "controllers",
      [] {
        nb::list list;
        std::apply(
            [&](const auto&... row) { (list.append(facts(row.info, row.program.times > 0)), ...); },
            controller_rows);
        return list;
      },
      "The controllers of the core, in order: the rows of runtime/controller_registry.hpp.");

  m.def(
      "table1",
      [] {
        std::vector<std::tuple<std::array<int, 2>, std::string, Action, Action>> rows;
        for (const auto& row : Centralized::table) {
          rows.push_back({{static_cast<int>(row.sign[0]), static_cast<int>(row.sign[1])},
                          name_of(row.tilt),
                          action(row.first),
                          action(row.second)});
        }
        return rows;
      },
      "Table 1 as it runs: per case the signs, the palm to tilt up, and two actions (move, whose "
      "contact, until).");
  m.def(
      "resilient_timing",
      [](const Spec& spec) {
        const ResilientTiming b = resilient_timing_of(spec);
        const double tick = spec.period;
        nb::dict d;
        d["beacon_s"] = b.times.beacon * tick;
        d["delay_s"] = b.delay * tick;
        d["lease_s"] = b.times.lease * tick;
        d["shortest_lease_s"] = b.shortest_lease * tick;
        d["longest_lease_s"] = b.longest_lease * tick;
        d["losses"] = static_cast<int>(b.losses);
        d["hold_s"] = b.times.limits[static_cast<std::size_t>(ResilientLimit::hold)] * tick;
        d["alone_s"] = b.alone * tick;
        d["skew_m"] = b.skew;
        d["noise_m"] = b.noise;
        d["room_m"] = b.room;
        d["is_noisy"] = b.is_noisy;
        constexpr const char* problems[] = {"", "beacon", "short", "long"};
        d["problem"] = problems[static_cast<int>(b.problem)];
        return d;
      },
      nb::arg("spec"),
      "The time bounds of the resilient algorithm (control/resilient_timing.hpp).");

  using OneDistributed = TableRobot<Distributed>;
  nb::class_<OneDistributed>(m, "Distributed", "Table 2 of the paper, one robot.")
      .def(nb::init<>())
      .def("step", &checked_step<OneDistributed>, nb::arg("sign"), nb::arg("message"),
           nb::arg("palm_at_target"), "One tick; returns (palm, move, message sent, message read).")
      .def("__copy__", [](const OneDistributed& self) { return self; })
      .def_prop_ro("memory", &memory<OneDistributed>, "All that it remembers.")
      .def_prop_ro("state",
                   [](const OneDistributed& self) { return static_cast<int>(self.state()); })
      .def_prop_ro("name", [](const OneDistributed& self) { return std::string(1, self.name()); })
      .def_prop_ro("waits", &OneDistributed::waits);

  using OneResilient = TableRobot<Resilient>;
  nb::class_<OneResilient>(m, "Resilient", "The resilient distributed algorithm, one robot.")
      .def(
          "__init__",
          [](OneResilient* self, std::uint16_t lease, std::uint16_t hold, std::uint16_t join,
             bool leads) { new (self) OneResilient({1, lease, {hold, 0, join}}, {leads}); },
          nb::arg("lease"), nb::arg("hold"), nb::arg("join"), nb::arg("leads"),
          "Times in ticks; a beacon goes out every tick, and wheels stop at once.")
      .def(
          "step",
          [](OneResilient& self, int sign, bool palm_at_target, int message, bool stopped,
             bool ready, std::uint16_t age) {
            if (sign < -1 || sign > 1 || message < 0 || message > 5) {
              throw std::out_of_range("sign is -1, 0 or 1; message is 0 to 5");
            }
            const auto out = self.step({static_cast<Sign>(sign), palm_at_target, 1,
                                        static_cast<MessageKind>(message), stopped, ready, age});
            return std::tuple(static_cast<int>(out.command.palm),
                              static_cast<int>(out.command.move), static_cast<int>(out.message),
                              out.command.stop, out.ready);
          },
          nb::arg("sign"), nb::arg("palm_at_target"), nb::arg("message"), nb::arg("stopped"),
          nb::arg("ready"), nb::arg("age"),
          "One tick with what a new beacon said and how old it may be (message 0: none came); "
          "returns (palm, move, message, stop, ready).")
      .def("__copy__", [](const OneResilient& self) { return self; })
      .def_prop_ro("memory", &memory<OneResilient>, "All that it remembers.")
      .def_prop_ro("name", [](const OneResilient& self) { return std::string(1, self.name()); });

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
          "One tick with each robot's (sign, palm commanded, palm at target); returns (palm, move) "
          "of "
          "both.")
      .def("__copy__", [](const Centralized& self) { return self; })
      .def_prop_ro("memory", &memory<Centralized>, "All that it remembers.")
      .def_prop_ro("case_number", &Centralized::current)
      .def_prop_ro("stage", [](const Centralized& self) { return static_cast<int>(self.stage()); });
}

}  // namespace palmbots::bindings
