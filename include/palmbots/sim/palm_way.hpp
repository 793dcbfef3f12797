// SPDX-License-Identifier: Apache-2.0
// Palms that are driven by hand over a floor: whether they pass through the floor, a wall or a stand.
//
// The world of an object knows what touches the object, and lets palms and ground overlap.
// Frame: x forward from the COM of the object at its start, y up from the floor [m].
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "palmbots/mechanics/carry_ends.hpp"
#include "palmbots/sim/ground_blocks.hpp"
#include "palmbots/sim/plate_section.hpp"
#include "palmbots/world/travel.hpp"

namespace palmbots {

// Whether the line from a to b is anywhere deeper than `deep` in a block [m].
inline bool crosses(const GroundBlock& block, Vec a, Vec b, double deep) {
  double begin = 0.0;
  double end = 1.0;
  const auto cut = [&](double p, double q, double low, double high) {
    if (p == q && !(low < p && p < high)) end = -1.0;
    if (p == q) return;
    const double one = (low - p) / (q - p);
    const double two = (high - p) / (q - p);
    begin = larger(begin, smaller(one, two));
    end = smaller(end, larger(one, two));
  };
  cut(a.x, b.x, block.low + deep, block.high - deep);
  cut(a.y, b.y, -std::numeric_limits<double>::infinity(), block.height - deep);
  return begin < end;
}

// Why an object cannot begin where it stands among walls and stands; empty: it can. `found`: what
// ends its motion there.
inline std::string refusal_of_start(DropReason found) {
  if (found == DropReason::none) return "";
  const char* what = found == DropReason::flush     ? "would be in a wall or in a stand"
                     : found == DropReason::sliding ? "slides away"
                                                    : "falls over";
  return sentence(
      "floor: the object {} where it starts; allowed: walls beside it, and stands beside it or "
      "under its COM",
      {what});
}

// Why palms may not travel like this; empty: they may. `when` begins the refusal. It looks at short
// distances on the way.
inline std::string refusal_of_way(const FloorSpec& floor, const PalmSpec (&palms)[2],
                                  const Travel& travel, const PerSide<bool>& is_there,
                                  std::string_view when) {
  constexpr double longest = 0.005;  // [m]
  // A palm that follows the floor in pieces of 1° is exactly there at the ends of each, and at most
  // this share of its length below in between.
  constexpr double dips = 2e-5;
  double most = 0.0;
  for (const std::size_t side : {left, right}) {
    const PalmTravel& palm = travel.palms[side];
    most = larger(most, larger(length(palm.by), magnitude(palm.turn) * palms[side].length));
  }
  const double looks = larger(1.0, std::ceil(most / longest));
  const std::vector<GroundBlock> blocks = ground_blocks(floor);
  for (double k = 1.0; k <= looks; k += 1.0) {
    const Frames frames = travel.frames(k / looks);
    for (const std::size_t side : {left, right}) {
      if (!is_there[side]) continue;
      PlateSection plate = plate_section(palms[side], palms[side].thickness);
      for (Vec& corner : plate) corner = frames[side].origin + frames[side].to_world(corner);
      for (const GroundBlock& block : blocks) {
        if (block.gap > 0.0) continue;  // palms pass between its halves
        for (std::size_t i = 0; i < plate.size(); ++i) {
          const Vec next = plate[(i + 1) % plate.size()];
          if (!crosses(block, plate[i], next, dips * palms[side].length)) continue;
          return sentence("{}: {}, the {} palm would be in the {}; allowed: places outside it",
                          {block.key, std::string(when), side == left ? "left" : "right",
                           name_of(block.ground)});
        }
      }
    }
  }
  return "";
}

}  // namespace palmbots
