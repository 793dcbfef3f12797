// SPDX-License-Identifier: Apache-2.0
// The sections of a scene whose values the core takes. Besides those of a spec, these are keys that
// no spec holds, because other values follow from them (a box gives vertices) or because no carry of
// the core reads them (ridges, and what limits the load). The core checks them so that every host
// refuses the same scenes in the same words.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "palmbots/sim/scene_key.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// Length and height of a box, in place of an outline.
inline constexpr Key box_keys[] = {
    source_number("box_m[0]", Unit::m, 0.001, 10),
    source_number("box_m[1]", Unit::m, 0.001, 10),
};

// What carries the load (sim/load_states.hpp). All numbers are assumed.
inline constexpr Key load_keys[] = {
    source_number("body_kg", Unit::kg, 0.001, 1000, 3.0),
    source_number("arm_kg", Unit::kg, 0.001, 1000, 0.2),
    source_number("palm_kg", Unit::kg, 0.001, 1000, 0.1),
    source_number("wheel_radius_m", Unit::m, 0.001, 10, 0.04),
    source_number("axle_m", Unit::m, 0, 0.25),
    source_number("floor_friction", Unit::none, 0.001, 100, 0.8),
    source_number("palm_torque_n_m", Unit::newton_m, 0.001, 1000, 0.43),
};

// A rounded ridge across the floor.
inline constexpr Key ridge_keys[] = {
    source_number("at_m", Unit::m, -10, 10, 0),
    source_number("height_m", Unit::m, 0.0001, 0.05, 0.0001),
    source_number("length_m", Unit::m, 0.001, 10, 0.05),
};
inline constexpr RecordList mujoco_lists[] = {source_list("ridges", 32, ridge_keys)};

inline constexpr auto scene_sections = [] {
  constexpr std::size_t count = std::size(sections);
  std::array<Section, count + 2> all{};
  std::copy_n(sections, count, all.begin());
  all[count] = detail::section<Spec>("object", box_keys);
  all[count + 1] = detail::section<Spec>("mujoco", load_keys, mujoco_lists);
  return all;
}();

}  // namespace palmbots
