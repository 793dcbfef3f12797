// SPDX-License-Identifier: Apache-2.0
// The scene `paper` as a Spec, for programs that know no scenes.
#pragma once

#include <limits>

#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/spec.hpp"

inline palmbots::Spec paper_spec() {
  constexpr double width = 0.25;
  constexpr double height = 0.16;
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double degree = palmbots::radians_per_degree<double>;
  palmbots::Spec spec;
  spec.width = width;
  spec.com_left = 0.125;
  spec.com_right = 0.125;
  spec.com_height = 0.04;
  spec.outline.vertices[0] = {{0, width}, 0};
  spec.outline.vertices[1] = {{width, 0}, 0};
  spec.outline.vertices[2] = {{width, 0}, height};
  spec.outline.vertices[3] = {{0, width}, height};
  spec.outline.count = 4;
  spec.outline.contact = {0, 1};
  for (auto& palm : spec.palms) {
    palm.shallow = 5 * degree;
    palm.steep = 15 * degree;
    palm.rate = 50 * degree;
  }
  spec.zones[0] = {-1, -inf, -0.005};
  spec.zones[1] = {0, -0.005, 0.005};
  spec.zones[2] = {1, 0.005, inf};
  spec.zone_count = 3;
  return spec;
}
