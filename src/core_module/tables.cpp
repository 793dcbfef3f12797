// SPDX-License-Identifier: Apache-2.0
// The controllers that are tables (control/table.hpp), as data and one step at a time.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>

#include "bindings.hpp"
#include "palmbots/sim/team_registry.hpp"

namespace palmbots::bindings {

namespace {

// A robot of any table.
class AnyTableRobot {
 public:
  virtual ~AnyTableRobot() = default;
  virtual nb::tuple step(Sign sign, bool palm_at_target, MessageKind message,
                         std::uint16_t age) = 0;
  virtual std::string state() const = 0;
};

template <class Table>
class OneTableRobot : public AnyTableRobot {
 public:
  OneTableRobot(const Spec& spec, bool leads)
      : robot_(table_robot_of<Table>(spec, leads ? leader_of(spec) : other(leader_of(spec)))) {}

  nb::tuple step(Sign sign, bool palm_at_target, MessageKind message, std::uint16_t age) override {
    const auto out = robot_.step({sign, palm_at_target, 1, message, false, false, age});
    return nb::make_tuple(name_of(out.command.palm), name_of(out.command.move), out.command.stop,
                          name_of(out.message), out.send);
  }
  std::string state() const override { return name_of(robot_.state()); }

 private:
  TableRobot<Table> robot_;
};

template <class Set>
nb::object states_in(const Set& set, int count) {
  using State = decltype([]<class S>(const EnumSet<S>&) { return S{}; }(set));
  nb::list names;
  for (int s = 0; s < count; ++s) {
    if (set.has(static_cast<State>(s))) names.append(name_of(static_cast<State>(s)));
  }
  return names;
}

template <class Table>
nb::dict described(const Spec& spec) {
  using State = typename Table::State;
  nb::list states;
  for (int s = 0; s < Table::states; ++s) {
    const TableOutput& output = Table::outputs[s];
    nb::dict d;
    d["name"] = name_of(static_cast<State>(s));
    d["case"] = std::string(1, output.name);
    d["palm"] = name_of(output.command.palm);
    d["move"] = name_of(output.brakes ? Move::hold : output.command.move);
    d["stop"] = output.command.stop || output.brakes;
    d["waits"] = output.waits;
    d["message"] = name_of(output.message);
    d["limit"] = "";
    if constexpr (Table::limits > 0) {
      if (output.limit >= 0) d["limit"] = name_of(static_cast<typename Table::Limit>(output.limit));
    }
    states.append(d);
  }
  nb::list rows;
  for (const auto& row : Table::rows) {
    nb::list heard;
    for (const MessageKind message : TableMessages<Table>::list) {
      if (row.heard.has(message))
        heard.append(message == MessageKind::none ? "" : name_of(message));
    }
    nb::list when;
    for (int i = 0; i < if_count; ++i) {
      if (row.when.has(static_cast<If>(i))) when.append(name_of(static_cast<If>(i)));
    }
    nb::dict d;
    d["states"] = states_in(row.from, Table::states);
    d["contact"] = name_of(row.p);
    d["heard"] = row.heard == any_message ? nb::object(nb::none()) : nb::object(heard);
    d["when"] = when;
    d["next"] = name_of(row.next);
    d["send"] = name_of(row.send);
    rows.append(d);
  }
  nb::dict d;
  d["initial"] = name_of(Table::initial);
  constexpr const char* mails[] = {"none", "queue", "beacons"};
  d["mail"] = mails[static_cast<int>(Table::mail)];
  d["starts_by_touch"] = requires { Table::started_by_touch(true); };
  d["states"] = states;
  d["rows"] = rows;
  nb::dict limits;
  if constexpr (TableRobot<Table>::has_clock) {
    const auto times = table_times_of<Table>(spec);
    for (std::size_t i = 0; i < Table::limits; ++i) {
      limits[name_of(static_cast<typename Table::Limit>(i))] = times.limits[i] * spec.period;
    }
    d["lease_s"] = times.lease * spec.period;
    // The bounds of a table that does without Table::seconds are in control/resilient_timing.hpp.
    if constexpr (Table::mail == Mail::beacons && requires { &Table::seconds; }) {
      d["shortest_lease_s"] = shortest_table_lease<Table>(spec);
    }
  }
  d["limits_s"] = limits;
  return d;
}

// Calls visit(maker) with the TableProgramMaker of this controller if it is a table.
template <class Visit>
void visit_table(const std::string& name, Visit&& visit) {
  visit_program(name, [&](auto maker) {
    if constexpr (requires { typename decltype(maker)::Table; }) visit(maker);
  });
}

}  // namespace

void bind_tables(nb::module_& m) {
  m.def(
      "transition_table",
      [](const std::string& name, const Spec& spec) {
        std::optional<nb::dict> found;
        visit_table(name,
                    [&](auto maker) { found = described<typename decltype(maker)::Table>(spec); });
        return found;
      },
      nb::arg("controller"), nb::arg("spec"),
      "The table of a controller as it runs, with its times in a scene [s]; None if it is not made "
      "of a table.");

  nb::class_<AnyTableRobot>(m, "TableRobot", "One robot whose program is a table.")
      .def(
          "step",
          [](AnyTableRobot& self, int sign, bool palm_at_target, int message, std::uint16_t age) {
            if (sign < -1 || sign > 1 || message < 0 || message >= message_kinds) {
              throw std::out_of_range("sign is -1, 0 or 1; message is a MessageKind");
            }
            return self.step(static_cast<Sign>(sign), palm_at_target,
                             static_cast<MessageKind>(message), age);
          },
          nb::arg("sign"), nb::arg("palm_at_target"), nb::arg("message"), nb::arg("age"),
          "One tick with a new message of the partner and how old it may be [ticks] (message 0: "
          "none "
          "came); returns (palm, move, stop, own message, whether it is sent now).")
      .def_prop_ro("state", &AnyTableRobot::state);
  m.def(
      "table_robot",
      [](const std::string& name, const Spec& spec, bool leads) {
        std::unique_ptr<AnyTableRobot> robot;
        visit_table(name, [&](auto maker) {
          robot = std::make_unique<OneTableRobot<typename decltype(maker)::Table>>(spec, leads);
        });
        if (!robot) throw std::invalid_argument("controller: not made of a table");
        return robot;
      },
      nb::arg("controller"), nb::arg("spec"), nb::arg("leads"),
      "A robot with the program of this controller.");
}

}  // namespace palmbots::bindings
