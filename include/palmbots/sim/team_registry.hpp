// SPDX-License-Identifier: Apache-2.0
// The teams of the controllers in carries: one for each kind of program
// (runtime/program_maker.hpp), not for each controller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "palmbots/runtime/controller_registry.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/no_controller.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

// Makes the team of a carry, from what makes the program of a robot.
template <class ProgramMaker>
struct TeamMaker;

template <>
struct TeamMaker<runtime::NoProgramMaker> {
  NoController operator()(const Spec&, std::uint64_t) const { return {}; }
};

template <>
struct TeamMaker<runtime::ReportProgramMaker> {
  CentralizedTeam operator()(const Spec& spec, std::uint64_t seed) const {
    return CentralizedTeam(channel_of(spec), seed, leader_of(spec), Faults::of(spec, seed));
  }
};

template <class Table>
struct TeamMaker<runtime::TableProgramMaker<Table>> : TableTeamMaker<Table> {};

// The names of all controllers, separated by commas.
inline std::string controller_list() {
  std::string names;
  for (const ControllerInfo& info : controller_infos) {
    names += names.empty() ? "" : ", ";
    names += info.name;
  }
  return names;
}

constexpr bool is_controller(std::string_view name) {
  for (const ControllerInfo& info : controller_infos) {
    if (info.name == name) return true;
  }
  return false;
}

// Calls visit(make), where make(spec, seed) is the team of a carry. The name is one of the above.
template <std::size_t Row = 0, class Visit>
auto visit_team(std::string_view name, Visit&& visit) {
  const auto& row = std::get<Row>(controller_rows);
  if constexpr (Row + 1 < controller_infos.size()) {
    if (row.info.name != name) return visit_team<Row + 1>(name, std::forward<Visit>(visit));
  }
  return visit(TeamMaker<std::remove_cvref_t<decltype(row.program)>>{});
}

// The times of a controller in a scene [ticks], in the order of its struct Times; empty if it has none.
template <class ProgramMaker>
std::vector<std::uint16_t> program_times(const ProgramMaker&, const Spec&) {
  return {};
}

template <class Table>
std::vector<std::uint16_t> program_times(const runtime::TableProgramMaker<Table>&,
                                         const Spec& spec) {
  std::vector<std::uint16_t> list;
  if constexpr (runtime::TableProgramMaker<Table>::times > 0) {
    const TableTimes<Table> times = table_times_of<Table>(spec);
    list = {times.beacon, times.lease};
    list.insert(list.end(), times.limits.begin(), times.limits.end());
  }
  return list;
}

}  // namespace palmbots
