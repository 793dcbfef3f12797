// SPDX-License-Identifier: Apache-2.0
// What a commanded opening speed costs in each state of the opening problem, as a table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "palmbots/base/scalar.hpp"

namespace palmbots {

// Equally spaced numbers.
struct GridAxis {
  double first = 0;
  double cell = 1;
  std::uint64_t count = 0;
};

// The cost of the next commanded speed, by separation, noise and that speed. Costs are
// probabilities of a drop, less what the progress is worth; only their differences count.
struct OpeningPolicy {
  GridAxis positions;        // separation [m]
  GridAxis noises;           // of the opening speed [m/s]
  GridAxis speeds;           // commanded opening speed [m/s]
  std::vector<float> costs;  // the position varies fastest, the speed slowest

  // By linear interpolation; outside the table, its nearest value.
  double cost(double separation, double noise, double speed) const {
    const Place x = place(positions, separation);
    const Place n = place(noises, noise);
    const Place c = place(speeds, speed);
    const auto along_x = [&](std::size_t i, std::size_t j) {
      const float* row = costs.data() + (j * noises.count + i) * positions.count + x.below;
      return (1 - x.above) * double(row[0]) + x.above * double(row[1]);
    };
    const auto along_n = [&](std::size_t j) {
      return (1 - n.above) * along_x(n.below, j) + n.above * along_x(n.below + 1, j);
    };
    return (1 - c.above) * along_n(c.below) + c.above * along_n(c.below + 1);
  }

  // As bytes, for modules that share nothing else.
  std::string to_bytes() const {
    std::string bytes(sizeof(GridAxis) * 3 + costs.size() * sizeof(float), '\0');
    const GridAxis axes[] = {positions, noises, speeds};
    std::memcpy(bytes.data(), axes, sizeof axes);
    std::memcpy(bytes.data() + sizeof axes, costs.data(), costs.size() * sizeof(float));
    return bytes;
  }
  static OpeningPolicy from_bytes(std::string_view bytes) {
    GridAxis axes[3];
    if (bytes.size() < sizeof axes) throw std::invalid_argument("policy: not a table of costs");
    std::memcpy(axes, bytes.data(), sizeof axes);
    const std::size_t count = axes[0].count * axes[1].count * axes[2].count;
    if (axes[0].count < 2 || axes[1].count < 2 || axes[2].count < 2 ||
        bytes.size() != sizeof axes + count * sizeof(float)) {
      throw std::invalid_argument("policy: not a table of costs");
    }
    OpeningPolicy policy{axes[0], axes[1], axes[2], std::vector<float>(count)};
    std::memcpy(policy.costs.data(), bytes.data() + sizeof axes, count * sizeof(float));
    return policy;
  }

 private:
  struct Place {
    std::size_t below;
    double above;  // weight of the next one
  };
  static Place place(const GridAxis& axis, double value) {
    const double last = double(axis.count - 1);
    const double at = axis.cell > 0 ? clamp((value - axis.first) / axis.cell, 0.0, last) : 0;
    const auto below = static_cast<std::size_t>(smaller(std::floor(at), last - 1));
    return {below, at - double(below)};
  }
};

}  // namespace palmbots
