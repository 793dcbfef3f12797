// SPDX-License-Identifier: Apache-2.0
// Registry of the teams, by the name of their controller.
#pragma once

#include <optional>
#include <string_view>
#include <utility>

#include "palmbots/sim/build.hpp"
#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/distributed_team.hpp"
#include "palmbots/sim/no_controller.hpp"
#include "palmbots/sim/resilient_team.hpp"

namespace palmbots {

// The names of the controllers.
inline constexpr std::string_view controller_names[] = {"none", "centralized", "distributed",
                                                        "resilient"};

constexpr bool is_controller(std::string_view name) {
  for (const std::string_view one : controller_names) {
    if (one == name) return true;
  }
  return false;
}

// Calls visit(make), where make(spec, seed) returns the team of a carry. The name must be one of
// controller_names.
template <class Visit>
auto visit_team(std::string_view name, Visit&& visit) {
  if (name == "none") {
    return visit([](const Spec&, std::uint64_t) { return NoController{}; });
  }
  if (name == "centralized") {
    return visit([](const Spec& spec, std::uint64_t seed) {
      return CentralizedTeam(channel_of(spec), seed, leader_of(spec), Faults::of(spec, seed));
    });
  }
  if (name == "distributed") {
    return visit([](const Spec& spec, std::uint64_t seed) {
      return DistributedTeam<Distributed>({}, channel_of(spec), seed, leader_of(spec),
                                          Faults::of(spec, seed));
    });
  }
  return visit([](const Spec& spec, std::uint64_t seed) {
    const PerSide<double> drift{spec.robots[left].clock_drift, spec.robots[right].clock_drift};
    return ResilientTeam(resilient_timing_of(spec).times, drift, channel_of(spec), seed,
                         leader_of(spec), Faults::of(spec, seed));
  });
}

}  // namespace palmbots
