// SPDX-License-Identifier: Apache-2.0
// The team of a carry whose programs run elsewhere, reached through a Python function.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "bindings.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/remote_team.hpp"
#include "palmbots/sim/standing_start.hpp"

namespace palmbots::bindings {

// A key and a packet from Python.
inline wire::Key key_of(const nb::bytes& bytes) {
  wire::Key key{};
  if (bytes.size() != key.size()) throw std::out_of_range("a key has 16 bytes");
  std::copy_n(static_cast<const std::uint8_t*>(bytes.data()), key.size(), key.begin());
  return key;
}

inline wire::Bytes packet_of(const nb::bytes& bytes) {
  wire::Bytes packet{};
  if (bytes.size() != packet.size()) throw std::out_of_range("a packet has 32 bytes");
  std::copy_n(static_cast<const std::uint8_t*>(bytes.data()), packet.size(), packet.begin());
  return packet;
}

using PacketTuple = std::tuple<int, nb::bytes, int>;  // receiver, bytes, message
// Of the table of a job on the floor: its state, its packets rejected and late.
using Phases = std::tuple<int, std::uint32_t, std::uint32_t>;
// Palm, move, stop, packets, case, waits, awaits, rejected, late, phases, assists.
using Answer = std::tuple<int, int, bool, std::vector<PacketTuple>, int, bool, int, std::uint32_t,
                          std::uint32_t, Phases, bool>;

void bind_remote(nb::module_& m);

// Calls exchange(tick, left, right, station) in Python.
struct PythonExchange {
  nb::object exchange;

  ProgramOutputs operator()(std::uint32_t tick, const ProgramInputs& inputs) const;
};

struct RemoteControllers {
  PythonExchange exchange;
  // Programs learn how many ticks of their own clock have passed, and robots rest until their
  // program has run.
  bool has_clocks;
  bool has_station;  // a station decides for both robots
};

// Calls use(team) with the team of a carry.
template <class Use>
auto with_remote_team(const RemoteControllers& remote, const Spec& spec, std::uint64_t seed,
                      Use&& use) {
  PerSide<double> drift{0, 0};
  const bool idle = on_one_palm(spec);  // its controllers do nothing, as in sim/no_controller.hpp
  if (remote.has_clocks && !idle)
    drift = {spec.robots[left].clock_drift, spec.robots[right].clock_drift};
  const Command first{Palm::steep, Move::hold, remote.has_clocks || idle};
  const auto team = [&]<bool has_station>() {
    return RemoteTeam<PythonExchange, has_station>(remote.exchange, first, drift, channel_of(spec),
                                                   seed, leader_of(spec), Faults::of(spec, seed));
  };
  return remote.has_station && !idle ? use(team.template operator()<true>())
                                     : use(team.template operator()<false>());
}

}  // namespace palmbots::bindings
