// SPDX-License-Identifier: Apache-2.0
// Whether the walls and stands of a scene can be beside the object and beside each other.
#pragma once

#include <cstddef>

#include "palmbots/mechanics/surface.hpp"
#include "palmbots/sim/scene_problem.hpp"
#include "palmbots/sim/scene_values.hpp"

namespace palmbots::detail {

inline void check_surroundings(const SceneValues& scene, Problems& problems) {
  const auto& walls = scene.list<"floor.walls">();
  const auto& stands = scene.list<"floor.stands">();
  const auto wall = [&](std::size_t k) {
    return walls[k][SceneValues::place_in_record<"floor.walls", "at_m">];
  };
  const auto from = [&](std::size_t k) {
    return stands[k][SceneValues::place_in_record<"floor.stands", "from_m">];
  };
  const auto to = [&](std::size_t k) {
    return stands[k][SceneValues::place_in_record<"floor.stands", "to_m">];
  };
  std::size_t surfaces = 1;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const double height = walls[k][SceneValues::place_in_record<"floor.walls", "height_m">];
    surfaces += height == height ? 3 : 1;
    if (wall(k) == 0) {
      report(problems, "floor.walls[].at_m", k, "is where the object stands",
             "another number, counted from the COM of the object at its start");
    }
    for (std::size_t i = 0; i < k; ++i) {
      if ((wall(i) < 0) != (wall(k) < 0)) continue;
      report(problems, "floor.walls[].at_m", k, "is on the same side as the wall at {0} m",
             "one wall on each side of the object", {wall(i)});
    }
  }
  for (std::size_t k = 0; k < stands.size(); ++k) {
    surfaces += 5;
    if (!(to(k) > from(k))) {
      report(problems, "floor.stands[].to_m", k, "is not more than from_m, which is {0}",
             "more than {0}", {from(k)});
    }
    for (std::size_t i = 0; i < k; ++i) {
      if (from(k) > to(i) || to(k) < from(i)) continue;
      report(problems, "floor.stands[].from_m", k,
             "makes a stand that overlaps or touches the one from {0} to {1} m",
             "stands apart from each other", {from(i), to(i)});
    }
    for (std::size_t i = 0; i < walls.size(); ++i) {
      if (wall(i) < 0 ? from(k) > wall(i) : to(k) < wall(i)) continue;
      report(problems, wall(i) < 0 ? "floor.stands[].from_m" : "floor.stands[].to_m", k,
             "makes a stand that reaches the wall at {0} m", "a stand in front of the wall",
             {wall(i)});
    }
  }
  if (surfaces > Surroundings::capacity) {
    report(problems, "floor.stands[]", stands.size() - 1,
           "makes {0} surfaces of floor, walls and stands",
           "at most {1} (the floor 1, an endless wall 1, any other wall 3, a stand 5)",
           {double(surfaces), double(Surroundings::capacity)});
  }
}

}  // namespace palmbots::detail
