// SPDX-License-Identifier: Apache-2.0
// The mode machine of a robot, as data for the docs.
#include "palmbots/runtime/mode_machine.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"

namespace palmbots::bindings {

void bind_mode_machine(nb::module_& m) {
  m.def(
      "mode_table",
      [] {
        using Row = std::tuple<std::vector<std::string>, std::string, std::string, std::string,
                               std::string>;
        std::vector<Row> rows;
        for (const runtime::ModeRow& row : runtime::mode_table.rows) {
          std::vector<std::string> from;
          for (unsigned i = 0; i < wire::robot_modes; ++i) {
            const auto mode = static_cast<wire::RobotMode>(i);
            if (row.from.has(mode)) from.emplace_back(name_of(mode));
          }
          rows.emplace_back(from, name_of(row.when), name_of(row.next), name_of(row.change),
                            name_of(row.code));
        }
        return rows;
      },
      "The mode machine of a robot as it runs: per row the modes in which it starts, what happens, "
      "the next mode, what becomes of the fault code (keep, set, refusal), and the code.");
}

}  // namespace palmbots::bindings
