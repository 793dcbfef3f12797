// SPDX-License-Identifier: Apache-2.0
// The team of a controller that Python passes: a name, Machines, RemoteControllers, or a pair of
// Python step functions.
#pragma once

#include <nanobind/stl/string.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "carry.hpp"
#include "machines.hpp"
#include "palmbots/sim/any_team.hpp"
#include "palmbots/sim/team_registry.hpp"
#include "remote.hpp"

namespace palmbots::bindings {

// True if the robots of a team call Python, so that a carry needs the interpreter's lock.
template <class Team>
inline constexpr bool calls_python = false;
template <>
inline constexpr bool calls_python<RobotTeam<PythonController>> = true;
template <bool has_station>
inline constexpr bool calls_python<RemoteTeam<PythonExchange, has_station>> = true;

template <class Team>
inline constexpr bool is_remote = false;
template <bool has_station>
inline constexpr bool is_remote<RemoteTeam<PythonExchange, has_station>> = true;

// The team of a job on the floor. Programs that run elsewhere also run its table
// (sim/remote_team.hpp).
template <class Team>
auto team_of_job(Team team) {
  if constexpr (is_remote<Team>) {
    return team;
  } else {
    return AnyTeam(std::move(team));
  }
}

// Throws std::invalid_argument unless there is a controller of this name.
inline void check_name(const std::string& name) {
  if (is_controller(name)) return;
  throw std::invalid_argument("controller: one of " + controller_list());
}

// Calls use(team) with the team of a carry, which the controller must outlive.
template <class Use>
auto with_given_team(const nb::object& controller, const Spec& spec, std::uint64_t seed,
                     Use&& use) {
  if (nb::isinstance<nb::str>(controller)) {
    const auto name = nb::cast<std::string>(controller);
    check_name(name);
    return visit_team(name, [&](auto make) { return use(make(spec, seed)); });
  }
  if (nb::isinstance<Machines>(controller)) {
    return use(machine_team(nb::cast<const Machines&>(controller), spec, seed));
  }
  if (nb::isinstance<RemoteControllers>(controller)) {
    return with_remote_team(nb::cast<const RemoteControllers&>(controller), spec, seed, use);
  }
  return use(robot_team_of(python_controllers(controller, spec), spec, seed));
}

}  // namespace palmbots::bindings
