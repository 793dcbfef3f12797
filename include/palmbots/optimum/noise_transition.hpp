// SPDX-License-Identifier: Apache-2.0
// The noise of a robot's speed on a grid of standard deviations, for value iteration
// (optimum/value_iteration.hpp): with which weights each node follows each other one in a decision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "palmbots/base/scalar.hpp"

namespace palmbots::detail {

inline constexpr double most_deviations = 5;  // of the noise

// Weights of four neighbouring nodes, at −1, 0, 1 and 2, for the cubic through them at f.
constexpr std::array<double, 4> cubic_weights(double f) {
  return {-f * (f - 1) * (f - 2) / 6, (f + 1) * (f - 1) * (f - 2) / 2, -(f + 1) * f * (f - 2) / 2,
          (f + 1) * f * (f - 1) / 6};
}

// Where the cubic interpolation at a place (in cells, 0 to `cells`) reads: four nodes from `first`.
struct CubicStencil {
  std::size_t first;
  std::array<double, 4> weights;

  static CubicStencil at(double place, std::size_t cells) {
    const double floored = clamp(std::floor(place), 1.0, double(cells) - 2);
    return {static_cast<std::size_t>(floored) - 1, cubic_weights(place - floored)};
  }
};

// The weights of n' for each n, on a grid of standard deviations.
//
// Where the noise of a decision spreads over at least this many cells, the weights are the normal
// density at the nodes: the trapezoidal rule, whose error is then below 1e-5. Where it spreads over
// less, they are those of Gauss–Hermite quadrature with five nodes, read by cubic interpolation.
struct NoiseTransition {
  static constexpr double enough_cells = 0.75;

  struct Row {
    std::size_t first = 0;
    std::vector<double> weights;
  };
  std::vector<double> deviations;
  std::vector<double> stationary;
  std::vector<Row> rows;

  NoiseTransition(std::size_t cells, double memory) {
    const double cell = 2 * most_deviations / double(cells);
    const double spread = std::sqrt(1 - memory * memory);
    for (std::size_t i = 0; i <= cells; ++i) {
      deviations.push_back(double(i) * cell - most_deviations);
    }
    stationary = density(0, 1);
    for (const double z : deviations) {
      const bool is_smooth = spread >= enough_cells * cell;
      rows.push_back(
          row_of(is_smooth ? density(memory * z, spread) : quadrature(memory * z, spread, cell)));
    }
  }

 private:
  std::vector<double> density(double mean, double spread) const {
    std::vector<double> weights;
    double total = 0;
    for (const double z : deviations) {
      const double away = (z - mean) / spread;
      weights.push_back(magnitude(away) > most_deviations ? 0 : exp_minus(0.5 * away * away));
      total += weights.back();
    }
    for (double& weight : weights) weight /= total;
    return weights;
  }

  std::vector<double> quadrature(double mean, double spread, double cell) const {
    constexpr std::array nodes{0.0, 1.3556261799742659, 2.8569700138728056};
    constexpr std::array shares{0.53333333333333333, 0.22207592200561266, 0.011257411327720689};
    std::vector<double> weights(deviations.size());
    for (int node = -2; node <= 2; ++node) {
      const auto k = static_cast<std::size_t>(node < 0 ? -node : node);
      const double away = (node < 0 ? -nodes[k] : nodes[k]) * spread;
      const double to = clamp(mean + away, -most_deviations, most_deviations);
      const auto stencil = CubicStencil::at((to + most_deviations) / cell, deviations.size() - 1);
      for (std::size_t j = 0; j < 4; ++j) {
        weights[stencil.first + j] += shares[k] * stencil.weights[j];
      }
    }
    return weights;
  }

  // The weights from the first to the last that is not 0.
  static Row row_of(const std::vector<double>& weights) {
    const auto is_used = [](double weight) { return weight != 0; };
    const auto from = std::ranges::find_if(weights, is_used);
    auto to = weights.end();
    while (!is_used(*(to - 1))) --to;
    return {static_cast<std::size_t>(from - weights.begin()), {from, to}};
  }
};

}  // namespace palmbots::detail
