// The controllers and their tables, one step at a time.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "bindings.hpp"
#include "palmbots/resilient_bounds.hpp"

namespace palmbots::bindings {

namespace {

// Names for what the tables hold, in the order of the enumerations.
constexpr const char* palms[] = {"steep", "shallow"};
constexpr const char* moves[] = {"hold", "away", "closer"};
constexpr const char* letters[] = {"none", "tilt_up", "tilt_down", "ack", "closing", "raised"};
constexpr const char* who[] = {"left", "right", "either", "none"};
constexpr const char* until[] = {"le_zero", "ge_zero"};
constexpr const char* contact[] = {"any", "positive", "not_positive", "negative", "not_negative"};
constexpr const char* got[] = {"any", "tilt_up", "tilt_down", "ack"};
constexpr const char* tilt[] = {"any", "done"};
constexpr const char* states[] = {"idle",      "a_or_b_request", "a_move",      "b_wait_ack",
                                  "b_move",    "b_tilt_up",      "b_wait_down", "b_tilt_down",
                                  "c_tilt_up", "c_wait_down",    "c_tilt_down", "d_tilt_up",
                                  "d_move",    "d_tilt_down"};
static_assert(std::size(states) == Distributed::states);
constexpr const char* resilient_states[] = {"idle",        "a_request", "a_move",  "a_stop",
                                            "b_tilt_up",   "c_tilt_up", "c_grant", "c_withdraw",
                                            "c_tilt_down", "d_tilt_up", "d_move",  "d_tilt_down"};
static_assert(std::size(resilient_states) == Resilient::states);
constexpr const char* heard[] = {"any",   "tilt_up", "not_tilt_up", "ack",    "not_ack",
                                 "other", "steep",   "not_steep",   "silence"};
constexpr const char* conditions[] = {"any", "settled", "released", "yields", "held"};

template <class Enum, std::size_t n>
std::string named(const char* const (&names)[n], Enum value) {
  return names[static_cast<std::size_t>(value)];
}

// All that a controller remembers, to tell its states apart. Where the compiler cannot clear padding,
// one state may show as several, never several as one.
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
  return {named(moves, a.move), named(who, a.who), named(until, a.until)};
}

}  // namespace

void bind_controllers(nb::module_& m) {
  m.def(
      "table1",
      [] {
        std::vector<std::tuple<std::array<int, 2>, std::string, Action, Action>> rows;
        for (const auto& row : Centralized::table) {
          rows.push_back({{static_cast<int>(row.sign[0]), static_cast<int>(row.sign[1])},
                          named(who, row.tilt),
                          action(row.first),
                          action(row.second)});
        }
        return rows;
      },
      "Table 1 as it runs: per case the signs, the palm to tilt up, and two actions (move, whose "
      "contact, until).");
  m.def(
      "table2",
      [] {
        std::vector<std::tuple<std::string, std::string, std::string, std::string, bool>> doing;
        for (int i = 0; i < Distributed::states; ++i) {
          const auto& d = Distributed::doing[i];
          doing.push_back({states[i], std::string(1, d.name), named(palms, d.command.palm),
                           named(moves, d.command.move), d.waits});
        }
        std::vector<std::array<std::string, 6>> rows;
        for (const auto& row : Distributed::table) {
          rows.push_back({named(states, row.state), named(contact, row.p), named(got, row.got),
                          named(tilt, row.tilt), named(states, row.next),
                          named(letters, row.send)});
        }
        return std::pair(doing, rows);
      },
      "Table 2 as it runs: per state (name, case, palm, move, waits), and the rows (state, "
      "contact, "
      "letter, palm turned, next state, letter sent).");

  m.def(
      "resilient_table",
      [] {
        std::vector<std::tuple<std::string, std::string, std::string, std::string, std::string>>
            doing;
        for (int i = 0; i < Resilient::states; ++i) {
          const auto& d = Resilient::doing[i];
          doing.push_back({resilient_states[i], std::string(1, d.name),
                           named(palms, d.command.palm), named(moves, d.command.move),
                           named(letters, d.letter)});
        }
        std::vector<std::array<std::string, 5>> rows;
        for (const auto& row : Resilient::table) {
          rows.push_back({named(resilient_states, row.state), named(contact, row.p),
                          named(heard, row.heard), named(conditions, row.when),
                          named(resilient_states, row.next)});
        }
        return std::pair(doing, rows);
      },
      "The resilient algorithm as it runs: per state (name, case, palm, move, letter), and the "
      "rows "
      "(state, contact, letter heard, condition, next state).");
  m.def(
      "resilient_bounds",
      [](const Spec& spec) {
        const Bounds b = Bounds::of(spec);
        const double tick = spec.period;
        nb::dict d;
        d["beacon_s"] = b.times.beacon * tick;
        d["delay_s"] = b.delay * tick;
        d["lease_s"] = b.times.lease * tick;
        d["shortest_lease_s"] = b.shortest_lease * tick;
        d["longest_lease_s"] = b.longest_lease * tick;
        d["losses"] = static_cast<int>(b.losses);
        d["hold_s"] = b.times.hold * tick;
        d["alone_s"] = b.alone * tick;
        d["skew_m"] = b.skew;
        d["room_m"] = b.room;
        constexpr const char* problems[] = {"", "beacon", "short", "long"};
        d["problem"] = problems[static_cast<int>(b.problem)];
        return d;
      },
      nb::arg("spec"), "The time bounds of the resilient algorithm (resilient_bounds.hpp).");

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
      .def("__copy__", [](const Distributed& self) { return self; })
      .def_prop_ro("memory", &memory<Distributed>, "All that it remembers.")
      .def_prop_ro("state", [](const Distributed& self) { return static_cast<int>(self.state()); })
      .def_prop_ro("name", [](const Distributed& self) { return nb::str(&self.now().name, 1); })
      .def_prop_ro("waits", [](const Distributed& self) { return self.now().waits; });

  nb::class_<Resilient>(m, "Resilient", "The resilient distributed algorithm, one robot.")
      .def(
          "__init__",
          [](Resilient* self, std::uint16_t lease, std::uint16_t hold, std::uint16_t join,
             bool yields) { new (self) Resilient({1, lease, hold, 0, join}, yields); },
          nb::arg("lease"), nb::arg("hold"), nb::arg("join"), nb::arg("yields"),
          "Times in ticks; a beacon goes out every tick, and wheels stop at once.")
      .def(
          "step",
          [](Resilient& self, int sign, bool turned, int letter, bool rests, bool ready,
             std::uint16_t age) {
            if (sign < -1 || sign > 1 || letter < 0 || letter > 5) {
              throw std::out_of_range("sign is -1, 0 or 1; letter is 0 to 5");
            }
            const auto out = self.step({static_cast<Sign>(sign), turned, 1,
                                        static_cast<Letter>(letter), rests, ready, age});
            return std::tuple(static_cast<int>(out.command.palm),
                              static_cast<int>(out.command.move), static_cast<int>(out.letter),
                              out.command.rest, out.ready);
          },
          nb::arg("sign"), nb::arg("turned"), nb::arg("letter"), nb::arg("rests"), nb::arg("ready"),
          nb::arg("age"),
          "One tick with what a new beacon said and how old it may be (letter 0: none came); "
          "returns (palm, move, letter, rest, ready).")
      .def("__copy__", [](const Resilient& self) { return self; })
      .def_prop_ro("memory", &memory<Resilient>, "All that it remembers.")
      .def_prop_ro("name", [](const Resilient& self) { return nb::str(&self.now().name, 1); });

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
      .def("__copy__", [](const Centralized& self) { return self; })
      .def_prop_ro("memory", &memory<Centralized>, "All that it remembers.")
      .def_prop_ro("case_number", &Centralized::current)
      .def_prop_ro("stage", [](const Centralized& self) { return static_cast<int>(self.stage()); });
}

}  // namespace palmbots::bindings
