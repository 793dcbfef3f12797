// SPDX-License-Identifier: Apache-2.0
// The controllers of the core: one row each, with what the rest of the toolkit needs to know of it.
//
// A new controller is one header in control/ and one row here. `_core.controllers()` exports the
// rows; commands, figures, docs and tests iterate over them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/sim/beacon_team.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/distributed_team.hpp"
#include "palmbots/sim/no_controller.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

// Who decides: no program, one station for both robots, or each robot.
enum class Decider : std::uint8_t { none, station, robots };

// What a case letter in the trace means.
struct CaseMeaning {
  std::string_view code;
  std::string_view meaning;
};

struct ControllerInfo {
  std::string_view name;
  std::string_view description;  // one line
  Decider decider = Decider::robots;
  bool uses_radio = true;
  // Robots repeat what they have to say at fixed intervals. A message is news only if it differs
  // from the one before.
  bool is_periodic = false;
  bool stops_in_silence = false;  // a robot that hears nothing stops
  // The wheels of both robots follow both signs, so that a motion ends a radio delay late.
  bool drives_by_both_signs = false;
  bool has_time_bounds = false;  // resilient_timing_of must find no problem in the scene
  std::span<const std::string_view> messages = {};  // the kinds that it sends
  std::span<const CaseMeaning> cases = {};
  // Cases in which a robot asks its partner for assistance and may get no answer.
  std::span<const std::string_view> assisted_cases = {};
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
inline constexpr std::string_view station_messages[] = {"report", "command"};
inline constexpr std::string_view table2_messages[] = {"TiltUp", "TiltDown", "Ack"};
inline constexpr std::string_view table2_assisted[] = {"a", "b"};
inline constexpr std::string_view beacons[] = {"beacon"};
inline constexpr std::string_view signs[] = {"sign"};
inline constexpr CaseMeaning silent_cases[] = {
    {"a", "own p > 0"},
    {"d", "own p < 0"},
};
inline constexpr CaseMeaning shared_sign_cases[] = {
    {"a", "own p > 0, the partner's is not"},
    {"b", "both p > 0"},
    {"d", "own p < 0"},
};

// A row: what is known of a controller, and make(spec, seed), the team of a carry.
template <class Make>
struct ControllerRow {
  ControllerInfo info;
  Make make;
};

template <class Make>
ControllerRow(ControllerInfo, Make) -> ControllerRow<Make>;

inline constexpr std::tuple controller_rows{
    ControllerRow{
        ControllerInfo{
            .name = "none",
            .description = "both robots drive at their nominal speed and correct nothing",
            .decider = Decider::none,
            .uses_radio = false,
        },
        [](const Spec&, std::uint64_t) { return NoController{}; },
    },
    ControllerRow{
        ControllerInfo{
            .name = "centralized",
            .description =
                "a station that hears both robots decides for them (Table 1 of the paper)",
            .decider = Decider::station,
            .messages = station_messages,
            .cases = table1_cases,
        },
        [](const Spec& spec, std::uint64_t seed) {
          return CentralizedTeam(channel_of(spec), seed, leader_of(spec), Faults::of(spec, seed));
        },
    },
    ControllerRow{
        ControllerInfo{
            .name = "distributed",
            .description =
                "each robot decides and asks its partner by message (Table 2 of the paper)",
            .messages = table2_messages,
            .cases = table2_cases,
            .assisted_cases = table2_assisted,
        },
        [](const Spec& spec, std::uint64_t seed) {
          return DistributedTeam<Distributed>({}, channel_of(spec), seed, leader_of(spec),
                                              Faults::of(spec, seed));
        },
    },
    ControllerRow{
        ControllerInfo{
            .name = "resilient",
            .description =
                "each robot decides; periodic beacons and leases tolerate lost messages and "
                "reboots",
            .is_periodic = true,
            .stops_in_silence = true,
            .has_time_bounds = true,
            .messages = beacons,
            .cases = table2_cases,
        },
        [](const Spec& spec, std::uint64_t seed) {
          const PerSide<double> drift{spec.robots[left].clock_drift,
                                      spec.robots[right].clock_drift};
          return ResilientTeam(resilient_timing_of(spec).times, drift, channel_of(spec), seed,
                               leader_of(spec), Faults::of(spec, seed));
        },
    },
    ControllerRow{
        ControllerInfo{
            .name = "silent",
            .description = "each robot corrects by the sign of its own contact, without messages",
            .uses_radio = false,
            .cases = silent_cases,
        },
        TableTeamMaker<Silent>{},
    },
    ControllerRow{
        ControllerInfo{
            .name = "shared-sign",
            .description =
                "each robot sends the sign of its contact; both correct by both signs, and one may "
                "stop",
            .is_periodic = true,
            .drives_by_both_signs = true,
            .messages = signs,
            .cases = shared_sign_cases,
        },
        TableTeamMaker<SharedSign>{},
    },
};

}  // namespace detail

// All controllers, in the order in which they are listed.
inline constexpr auto controller_infos =
    std::apply([](const auto&... row) { return std::array{row.info...}; }, detail::controller_rows);

// Their names, separated by commas.
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
  const auto& row = std::get<Row>(detail::controller_rows);
  if constexpr (Row + 1 < controller_infos.size()) {
    if (row.info.name != name) return visit_team<Row + 1>(name, std::forward<Visit>(visit));
  }
  return visit(row.make);
}

}  // namespace palmbots
