// SPDX-License-Identifier: Apache-2.0
// What stands still around object and palms: fixed surfaces on the ground. x forward, y up [m].
#pragma once

#include "palmbots/base/few_sorted.hpp"
#include "palmbots/mechanics/surface.hpp"

namespace palmbots {

// First the floor; then the other surfaces, from left to right.
struct Surroundings : FixedList<Surface, max_surfaces - 2 * max_palm_surfaces> {
  static constexpr std::size_t ordered = 1;  // the first one after the floor
  static constexpr double endless = 1e6;     // [m]

  // An endless level floor at height 0. It comes first.
  static constexpr Surroundings on_floor(double friction) {
    Surroundings made;
    made.add(
        {Carrier::ground, false, {0.0, 0.0}, up, {}, -endless, endless, friction, Ground::floor});
    return made;
  }

  // Solid ground from x to x up to a height: its level top, its vertical sides and the edges between
  // them. It may be endless on one side, and upward.
  constexpr void add_block(double from, double to, double height, double friction, Ground ground) {
    constexpr Vec to_left{-1.0, 0.0};
    constexpr Vec to_right{1.0, 0.0};
    const bool begins = from > -endless;
    const bool ends = to < endless;
    const bool has_top = height < endless;
    const double high = has_top ? height : endless;
    const auto face = [&](Vec place, Vec normal, double low, double end) {
      add({Carrier::ground, false, place, normal, {}, low, end, friction, ground});
    };
    const auto edge = [&](Vec place, Vec first, Vec second) {
      if (has_top) add({Carrier::ground, true, place, first, second, 0.0, 0.0, friction, ground});
    };
    // Sides reach below the floor: it ends nowhere, so no contact can slip between the two.
    if (begins) {
      face({from, 0.0}, to_left, -endless, high);  // places count upward
      edge({from, high}, up, to_left);
    }
    const double half = 0.5 * (to - from);
    if (has_top && begins && ends) face({0.5 * (from + to), high}, up, -half, half);
    if (has_top && !ends) face({from, high}, up, 0.0, endless);
    if (has_top && !begins) face({to, high}, up, -endless, 0.0);
    if (ends) {
      edge({to, high}, to_right, up);
      face({to, 0.0}, to_right, -high, endless);
    }
  }

 private:
  static constexpr Vec up{0.0, 1.0};

  // Behind the surfaces that are not farther right.
  constexpr void add(const Surface& surface) {
    if (full()) return;  // scenes with more of them are refused
    push_back(surface);
    sort_few(begin() + ordered, size() - ordered, [](const Surface& one) { return one.at.x; });
  }
};

}  // namespace palmbots
