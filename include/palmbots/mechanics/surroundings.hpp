// SPDX-License-Identifier: Apache-2.0
// What stands still around object and palms: fixed surfaces on the ground. x forward, y up [m].
#pragma once

#include "palmbots/mechanics/surface.hpp"

namespace palmbots {

// First the floor; then the other surfaces, from left to right.
struct Surroundings {
  static constexpr std::size_t most = max_surfaces - 2 * max_palm_surfaces;
  static constexpr std::size_t ordered = 1;  // the first one after the floor
  static constexpr double endless = 1e6;     // [m]

  std::array<Surface, most> at{};  // up to `count`
  std::size_t count = 0;
  bool fits = true;  // false: there were more surfaces than `most`

  constexpr bool none() const { return count == 0; }

  // An endless level floor at height 0. It comes first.
  static constexpr Surroundings on_floor(double friction) {
    Surroundings made;
    made.add(
        {Carrier::ground, false, {0.0, 0.0}, up, {}, -endless, endless, friction, Ground::floor});
    return made;
  }

  // A vertical face at x; behind it is solid ground, whose top is level at this height. If it is
  // infinite, the wall has no upper edge. `behind` is the side of the solid ground.
  constexpr void add_wall(std::size_t behind, double x, double height, double friction) {
    const bool has_top = height < endless;
    const double high = has_top ? height : endless;
    // Faces reach below the floor: it ends nowhere, so no contact can slip between the two.
    if (behind == right) {
      add(side_of(right, x, high, friction, Ground::wall));
      if (has_top) add(edge(right, {x, high}, friction, Ground::wall));
      if (has_top) add(top({x, high}, 0.0, endless, friction, Ground::wall));
    } else {
      if (has_top) add(top({x, high}, -endless, 0.0, friction, Ground::wall));
      if (has_top) add(edge(left, {x, high}, friction, Ground::wall));
      add(side_of(left, x, high, friction, Ground::wall));
    }
  }

  // A block on the floor: its level top, two edges and two vertical sides.
  constexpr void add_stand(double from, double to, double height, double friction) {
    const double half = 0.5 * (to - from);
    add(side_of(right, from, height, friction, Ground::stand));
    add(edge(right, {from, height}, friction, Ground::stand));
    add(top({0.5 * (from + to), height}, -half, half, friction, Ground::stand));
    add(edge(left, {to, height}, friction, Ground::stand));
    add(side_of(left, to, height, friction, Ground::stand));
  }

 private:
  static constexpr Vec up{0.0, 1.0};
  static constexpr Vec away(std::size_t behind) { return {behind == right ? -1.0 : 1.0, 0.0}; }

  static constexpr Surface side_of(std::size_t behind, double x, double height, double friction,
                                   Ground ground) {
    const bool faces_left = behind == right;  // places then count upward
    return {Carrier::ground,
            false,
            {x, 0.0},
            away(behind),
            {},
            faces_left ? -endless : -height,
            faces_left ? height : endless,
            friction,
            ground};
  }
  static constexpr Surface edge(std::size_t behind, Vec at, double friction, Ground ground) {
    return {Carrier::ground,
            true,
            at,
            behind == right ? up : away(behind),
            behind == right ? away(behind) : up,
            0.0,
            0.0,
            friction,
            ground};
  }
  static constexpr Surface top(Vec at, double low, double high, double friction, Ground ground) {
    return {Carrier::ground, false, at, up, {}, low, high, friction, ground};
  }

  // Behind the surfaces that are not farther right.
  constexpr void add(const Surface& surface) {
    if (count == most) {
      fits = false;
      return;
    }
    std::size_t i = count++;
    for (; i > ordered && at[i - 1].at.x > surface.at.x; --i) at[i] = at[i - 1];
    at[i] = surface;
  }
};

// Which way left and right differ, or 0 if they are mirror images.
inline int lopsided(const Surroundings& surroundings) {
  for (std::size_t i = surroundings.ordered; i < surroundings.count; ++i) {
    const Surface& a = surroundings.at[i];
    const Surface& b = surroundings.at[surroundings.count - i];
    const std::array<double, 3> of_left{-a.at.x, a.at.y, a.friction};
    const std::array<double, 3> of_right{b.at.x, b.at.y, b.friction};
    if (of_left != of_right) return of_left > of_right ? 1 : -1;
  }
  return 0;
}

}  // namespace palmbots
