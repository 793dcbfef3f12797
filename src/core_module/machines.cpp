// SPDX-License-Identifier: Apache-2.0
// Controllers whose table is data, made from Python and one step at a time.
#include "machines.hpp"

#include "palmbots/control/row_policy.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace palmbots::bindings {

namespace {

// A state: name of the case, palm, move, whether it waits, and for which message.
using StateTuple = std::tuple<std::string, std::string, std::string, bool, std::string>;
// A row: state, contact, message that it reads, whether the palm must have turned, next state, message
// sent.
using RowTuple = std::tuple<int, std::string, std::string, bool, int, std::string>;
using TableTuple = std::tuple<std::vector<StateTuple>, std::vector<RowTuple>>;

// The value of an enumeration, from 0 to `last`, that has this name.
template <class Enum>
Enum named(std::string_view name, Enum last) {
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    if (name == name_of(static_cast<Enum>(i))) return static_cast<Enum>(i);
  }
  throw std::invalid_argument("table: no value has the name " + std::string(name));
}

// A row of a policy: the palms and the drives of both robots, left first.
using PolicyRowTuple =
    std::tuple<std::pair<std::string, std::string>, std::pair<std::string, std::string>>;

RowPolicy row_policy_of(const std::vector<PolicyRowTuple>& given) {
  if (given.size() != RowPolicy::row_count) {
    throw std::invalid_argument("rows: one for each pair of signs");
  }
  RowPolicy::Rows rows{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [palms, drives] = given[i];
    rows[i] = {{named(palms.first, Palm::shallow), named(palms.second, Palm::shallow)},
               {named(drives.first, Move::closer), named(drives.second, Move::closer)}};
  }
  return RowPolicy(rows);
}

MachineTable table_of(const TableTuple& given) {
  MachineTable table;
  for (const auto& [name, palm, move, waits, awaits] : std::get<0>(given)) {
    if (name.size() != 1) throw std::invalid_argument("table: a case is one letter");
    if (!table.add(
            MachineTable::StateOutput{name[0],
                                      {named(palm, Palm::shallow), named(move, Move::closer)},
                                      waits,
                                      named(awaits, MessageKind::ack)})) {
      throw std::invalid_argument("table: too many states");
    }
  }
  if (table.states() == 0) throw std::invalid_argument("table: no state");
  const auto number = [&](int state) {
    if (state < 0 || state >= table.states()) {
      throw std::invalid_argument("table: a row names a state that does not exist");
    }
    return static_cast<std::uint8_t>(state);
  };
  for (const auto& [state, p, heard, turned, next, send] : std::get<1>(given)) {
    const MessageSet messages =
        heard.empty() ? any_message : MessageSet(named(heard, MessageKind::ack));
    table.add(MachineTable::Row{number(state), named(p, ContactCondition::zero), messages,
                                turned ? IfSet(If::turned) : IfSet{}, number(next),
                                named(send, MessageKind::ack)});
  }
  return table;
}

// One robot, which keeps the tables alive.
class Robot {
 public:
  Robot(nb::object machines, std::size_t side)
      : machines_(std::move(machines)),
        robot_(&nb::cast<const Machines&>(machines_).tables[side]) {}
  MachineRobot& operator*() { return robot_; }
  const MachineRobot* operator->() const { return &robot_; }

 private:
  nb::object machines_;
  MachineRobot robot_;
};

}  // namespace

void bind_machines(nb::module_& m) {
  nb::class_<Machines>(m, "Machines",
                       "The controllers of both robots as tables (control/machine_table.hpp).")
      .def(
          "__init__",
          [](Machines* self, const TableTuple& l, const TableTuple& r) {
            new (self) Machines{{table_of(l), table_of(r)}};
          },
          nb::arg("left"), nb::arg("right"),
          "Per robot the states (case, palm, move, waits, awaited message) and the rows (state, "
          "contact, message that it reads, palm must have turned, next state, message sent).")
      .def(
          "image",
          [](const Machines& self, std::size_t side) {
            // Every member is one byte wide, so a microcontroller lays the table out in the same way.
            static_assert(alignof(MachineTable) == 1);
            if (side > 1) throw std::out_of_range("side: 0 (left) or 1 (right)");
            return nb::bytes(&self.tables[side], sizeof(MachineTable));
          },
          nb::arg("side"), "The table of a robot as the firmware of a board has it in its memory.");

  nb::class_<RowPolicy>(m, "RowPolicy",
                        "The station's program as nine rows (control/row_policy.hpp).")
      .def(
          "__init__",
          [](RowPolicy* self, const std::vector<PolicyRowTuple>& rows) {
            new (self) RowPolicy(row_policy_of(rows));
          },
          nb::arg("rows"),
          "Rows ((palm, palm), (drive, drive)), left first, in the order (+, +), (+, 0), (+, -), "
          "(0, +) to (-, -).");

  nb::class_<Robot>(m, "MachineRobot", "One robot whose controller is a table.")
      .def(
          "__init__",
          [](Robot* self, const nb::object& machines, std::size_t side) {
            if (side > 1) throw std::out_of_range("side: 0 (left) or 1 (right)");
            new (self) Robot(machines, side);
          },
          nb::arg("machines"), nb::arg("side"))
      .def(
          "step",
          [](Robot& self, int sign, int message, bool palm_at_target) {
            return checked_step(*self, sign, message, palm_at_target);
          },
          nb::arg("sign"), nb::arg("message"), nb::arg("palm_at_target"),
          "One tick; returns (palm, move, message sent, message read).")
      .def("__copy__", [](const Robot& self) { return self; })
      .def_prop_ro(
          "memory",
          [](const Robot& self) {
            const auto state = static_cast<char>(self->state());
            return nb::bytes(&state, 1);
          },
          "All that it remembers.")
      .def_prop_ro("name", [](const Robot& self) { return std::string(1, self->name()); })
      .def_prop_ro("waits", [](const Robot& self) { return self->waits(); });
}

}  // namespace palmbots::bindings
