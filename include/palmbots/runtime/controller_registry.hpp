// SPDX-License-Identifier: Apache-2.0
// The controllers: one row each, with everything that distinguishes one from another.
//
// A new controller is one header in control/ and one row here. The simulator (sim/team_registry.hpp),
// robots and boards make their programs from the rows, and `_core.controllers()` exports them.
// Commands, figures, docs and tests iterate over the rows. This header is freestanding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>

#include "palmbots/control/centralized.hpp"
#include "palmbots/control/distributed.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/runtime/program_maker.hpp"

namespace palmbots {

// Who decides: no program, one station for both robots, or each robot.
enum class Decider : std::uint8_t { none, station, robots };

constexpr const char* name_of(Decider decider) {
  constexpr const char* names[] = {"none", "station", "robots"};
  return names[static_cast<int>(decider)];
}

// What a case letter in the trace means.
struct CaseMeaning {
  const char* code;
  const char* meaning;
};

// The number of a board's controller whose table is in the settings of the board (MachineTable).
inline constexpr int policy_board_number = 4;

struct ControllerInfo {
  const char* name;
  const char* description;  // one line
  // The number in the settings of a board, which never changes; −1: no board runs it.
  int board_number = -1;
  Decider decider = Decider::robots;
  // Robots repeat what they have to say at fixed intervals. A message is news only if it differs
  // from the one before.
  bool is_periodic = false;
  bool stops_in_silence = false;  // a robot that hears nothing stops
  // The wheels of both robots follow both signs, so that a motion ends a radio delay late.
  bool drives_by_both_signs = false;
  bool has_time_bounds = false;  // resilient_timing_of must find no problem in the scene
  std::span<const char* const> messages = {};  // the kinds that it sends; none: needs no radio
  std::span<const CaseMeaning> cases = {};
  // Cases in which a robot asks its partner for assistance and may get no answer.
  std::span<const char* const> assisted_cases = {};
  std::span<const StateMeaning> states = {};  // what its states mean, if they have names
};

// A row: what is known of a controller, and what makes its program (runtime/program_maker.hpp).
template <class Maker>
struct ControllerRow {
  ControllerInfo info;
  Maker program;
};

namespace detail {

inline constexpr CaseMeaning table1_cases[] = {
    {"1", "p_L > 0"},  {"2", "p_R > 0"},  {"3", "p_L < 0"},          {"4", "p_R < 0"},
    {"5", "both > 0"}, {"6", "both < 0"}, {"7", "p_L > 0, p_R < 0"}, {"8", "p_L < 0, p_R > 0"},
};
inline constexpr CaseMeaning table2_cases[] = {
    {"a", "own p > 0, partner assists (c)"},
    {"b", "both p > 0"},
    {"c", "assists: palm up"},
    {"d", "own p < 0"},
};
inline constexpr const char* station_messages[] = {"report", "command"};
inline constexpr const char* table2_messages[] = {"TiltUp", "TiltDown", "Ack"};
inline constexpr const char* table2_assisted[] = {"a", "b"};
inline constexpr const char* beacons[] = {"beacon"};
inline constexpr const char* signs[] = {"sign"};
inline constexpr CaseMeaning silent_cases[] = {
    {"a", "own p > 0"},
    {"d", "own p < 0"},
};
inline constexpr CaseMeaning shared_sign_cases[] = {
    {"a", "own p > 0, the partner's is not"},
    {"b", "both p > 0"},
    {"d", "own p < 0"},
};

template <class Maker>
constexpr ControllerRow<Maker> row(const ControllerInfo& info, Maker maker) {
  return {info, maker};
}

}  // namespace detail

inline constexpr std::tuple controller_rows{
    detail::row(
        {
            .name = "none",
            .description = "both robots drive at their nominal speed and correct nothing",
            .decider = Decider::none,
        },
        runtime::NoProgramMaker{}),
    detail::row(
        {
            .name = "centralized",
            .description =
                "a station that hears both robots decides for them (Table 1 of the paper)",
            .board_number = 5,
            .decider = Decider::station,
            .messages = detail::station_messages,
            .cases = detail::table1_cases,
        },
        runtime::ReportProgramMaker{}),
    detail::row(
        {
            .name = "distributed",
            .description =
                "each robot decides and asks its partner by message (Table 2 of the paper)",
            .board_number = 3,
            .messages = detail::table2_messages,
            .cases = detail::table2_cases,
            .assisted_cases = detail::table2_assisted,
            .states = Distributed::meanings,
        },
        runtime::TableProgramMaker<Distributed>{}),
    detail::row(
        {
            .name = "resilient",
            .description =
                "each robot decides; periodic beacons and leases tolerate lost messages and "
                "reboots",
            .board_number = 0,
            .is_periodic = true,
            .stops_in_silence = true,
            .has_time_bounds = true,
            .messages = detail::beacons,
            .cases = detail::table2_cases,
            .states = Resilient::meanings,
        },
        runtime::TableProgramMaker<Resilient>{}),
    detail::row(
        {
            .name = "silent",
            .description = "each robot corrects by the sign of its own contact, without messages",
            .board_number = 1,
            .cases = detail::silent_cases,
            .states = Silent::meanings,
        },
        runtime::TableProgramMaker<Silent>{}),
    detail::row(
        {
            .name = "shared-sign",
            .description =
                "each robot sends the sign of its contact; both correct by both signs, and one may "
                "stop",
            .board_number = 2,
            .is_periodic = true,
            .drives_by_both_signs = true,
            .messages = detail::signs,
            .cases = detail::shared_sign_cases,
            .states = SharedSign::meanings,
        },
        runtime::TableProgramMaker<SharedSign>{}),
};

// All controllers, in the order in which they are listed.
inline constexpr auto controller_infos =
    std::apply([](const auto&... row) { return std::array{row.info...}; }, controller_rows);

// Each number on boards means one controller.
static_assert([] {
  std::uint64_t used = std::uint64_t{1} << policy_board_number;
  for (const ControllerInfo& info : controller_infos) {
    if (info.board_number < 0) continue;
    const std::uint64_t bit = std::uint64_t{1} << info.board_number;
    if (info.board_number > 63 || (used & bit) != 0) return false;
    used |= bit;
  }
  return true;
}());

// Calls visit(maker) with what makes the program of the first row for which fits(info) is true.
// Returns false if there is none.
template <class Fits, class Visit>
constexpr bool visit_program_where(Fits&& fits, Visit&& visit) {
  return std::apply(
      [&](const auto&... row) { return ((fits(row.info) && (visit(row.program), true)) || ...); },
      controller_rows);
}

// The same for the controller of this name.
template <class Visit>
constexpr bool visit_program(std::string_view name, Visit&& visit) {
  return visit_program_where([name](const ControllerInfo& info) { return info.name == name; },
                             visit);
}

}  // namespace palmbots
