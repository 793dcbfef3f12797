// SPDX-License-Identifier: Apache-2.0
// The team of a carry whose programs run elsewhere, reached through a Python function.
#pragma once

#include "bindings.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/remote_team.hpp"

namespace palmbots::bindings {

// Calls exchange(tick, left, right, station) in Python.
struct PythonExchange {
  nb::object exchange;

  ProgramOutputs operator()(std::uint32_t tick, const ProgramInputs& inputs) const;
};

struct RemoteControllers {
  PythonExchange exchange;
  bool has_clocks;      // programs learn how many ticks of their own clock have passed
  bool starts_at_rest;  // robots rest until their program has run
};

// The team of a carry.
inline RemoteTeam<PythonExchange> remote_team(const RemoteControllers& remote, const Spec& spec,
                                              std::uint64_t seed) {
  PerSide<double> drift{0, 0};
  if (remote.has_clocks) drift = {spec.robots[left].clock_drift, spec.robots[right].clock_drift};
  return {remote.exchange,
          {Palm::steep, Move::hold, remote.starts_at_rest},
          drift,
          channel_of(spec),
          seed,
          leader_of(spec),
          Faults::of(spec, seed)};
}

}  // namespace palmbots::bindings
