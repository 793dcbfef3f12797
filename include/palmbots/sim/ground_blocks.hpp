// SPDX-License-Identifier: Apache-2.0
// The floor, the walls and the stands of a scene as blocks of solid ground, and as surfaces.
// Frame: x forward from the COM of the object at its start, y up from the floor [m].
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "palmbots/base/number_text.hpp"
#include "palmbots/mechanics/surface.hpp"
#include "palmbots/sim/task_keys.hpp"

namespace palmbots {

// Solid ground from x to x, up to a height.
struct GroundBlock {
  std::string key;  // of the scene
  Ground ground;
  double low;
  double high;
  double height;
  double friction;
  double gap = 0.0;  // between its two halves, across the path; 0: none
};

// The floor, then walls (endless behind their faces) and stands.
inline std::vector<GroundBlock> ground_blocks(const FloorSpec& spec) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::vector<GroundBlock> blocks{{"floor", Ground::floor, -inf, inf, 0.0, spec.floor_friction}};
  const auto add = [&](Ground ground, std::size_t k, double low, double high, double height,
                       double friction, double gap = 0.0) {
    blocks.push_back({sentence("floor.{}s[{}]", {name_of(ground), std::to_string(k)}), ground, low,
                      high, height, friction < 0 ? spec.floor_friction : friction, gap});
  };
  for (std::size_t k = 0; k < spec.wall_count; ++k) {
    const auto& [at, height, friction] = spec.walls[k];
    add(Ground::wall, k, at < 0 ? -inf : at, at < 0 ? at : inf, height, friction);
  }
  for (std::size_t k = 0; k < spec.stand_count; ++k) {
    const auto& [from, to, height, friction, gap] = spec.stands[k];
    add(Ground::stand, k, from, to, height, friction, gap < 0 ? 0.0 : gap);
  }
  return blocks;
}

// Their surfaces.
inline Surroundings surroundings_of(const FloorSpec& spec) {
  Surroundings made = Surroundings::on_floor(spec.floor_friction);
  for (const GroundBlock& b : ground_blocks(spec))
    if (b.ground != Ground::floor) made.add_block(b.low, b.high, b.height, b.friction, b.ground);
  return made;
}

}  // namespace palmbots
