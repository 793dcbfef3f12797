// SPDX-License-Identifier: Apache-2.0
// Whether the robots hold the object of a scene: the refusal of a carry that cannot begin, and the
// warning of one that may fail. One sentence each, for the command line, Python and the page.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/load_states.hpp"
#include "palmbots/sim/spec_of_scene.hpp"

namespace palmbots {

// What happens beyond each limit, and the key that moves it, in the order of LoadKind.
struct LoadMeaning {
  const char* name;
  const char* happens;
  const char* key;
};
inline constexpr LoadMeaning load_meanings[load_kinds] = {
    {"tipping", "a robot tips over", "mujoco.body_kg"},
    {"servo", "a palm sags", "mujoco.palm_torque_n_m"},
    {"traction", "a wheel slips", "mujoco.floor_friction"},
    {"drive", "a motor is too weak", "robot.motor_force_n"},
};
// No carry can begin beyond the first two. Wheels that slip only end a squeeze.
inline constexpr std::size_t decisive_kinds = 2;

// A mass with three digits, rounded down, so that it is allowed itself.
inline std::string mass_text(double mass) {
  double unit = 1;
  if (mass > 0 && std::isfinite(mass)) {
    while (mass >= 1000 * unit) unit *= 10;
    while (mass < 100 * unit) unit /= 10;
  }
  return short_text(std::floor(mass / unit * (1 + 1e-12)) * unit, 3);
}

// The first of so many limits.
inline std::size_t first_of(const HeaviestLoads& loads, std::size_t count) {
  std::size_t first = 0;
  for (std::size_t k = 1; k < count; ++k) {
    if (loads[k].mass < loads[first].mass) first = k;
  }
  return first;
}

// Why no carry of the object can begin; empty: it can.
inline std::string load_refusal(const SceneValues& scene, const Spec& spec, bool is_curved) {
  const double mass = object_of(scene).mass;
  const HeaviestLoads loads = LoadStates(robot_body_of(scene, spec, is_curved), spec).at_start();
  const std::size_t first = first_of(loads, decisive_kinds);
  if (mass <= loads[first].mass) return "";
  return sentence(
      "object.mass_kg: value is {}, and {} where the carry starts; allowed: at most {} kg with "
      "these robots ({})",
      {short_text(mass), load_meanings[first].happens, mass_text(loads[first].mass),
       load_meanings[first].key});
}

// The limit that the object exceeds with contacts somewhere on the palms; empty: none.
inline std::string load_warning(const SceneValues& scene, const Spec& spec, bool is_curved) {
  const double mass = object_of(scene).mass;
  const HeaviestLoads loads = LoadStates(robot_body_of(scene, spec, is_curved), spec)
                                  .within(std::numeric_limits<double>::infinity());
  const std::size_t first = first_of(loads, load_kinds);
  const HeaviestLoad& most = loads[first];
  if (mass <= most.mass) return "";
  return sentence(
      "object.mass_kg is {}, but the robots certainly hold only {} kg with the {} contact at {}: "
      "beyond it {} ({})",
      {short_text(mass), mass_text(most.mass), most.side == left ? "left" : "right",
       millimetres(most.p[most.side]), load_meanings[first].happens, load_meanings[first].key});
}

}  // namespace palmbots
