// SPDX-License-Identifier: Apache-2.0
// The surfaces that an object touches: faces and the tips between them, on a palm or on the ground.
//
// A carrier is what a surface belongs to: the left palm, the right palm, or the ground. Its frame
// is (outward, normal): for a palm the directions along its plate and across it from its pivot. So
// the two palms are described by the same numbers. On the ground they are x and y.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/base/few_sorted.hpp"
#include "palmbots/base/fixed_list.hpp"
#include "palmbots/base/frame.hpp"
#include "palmbots/base/side.hpp"

namespace palmbots {

enum class Carrier : std::uint8_t { left_palm, right_palm, ground };

// What a surface on the ground is a part of.
enum class Ground : std::uint8_t { none, floor, wall, stand };

constexpr const char* name_of(Ground ground) {
  constexpr const char* names[] = {"", "floor", "wall", "stand"};
  return names[static_cast<int>(ground)];
}

// A flat piece of a surface, or (`tip`) a convex corner between two of them.
struct Surface {
  Carrier carrier;
  bool tip;
  Vec at;       // a tip, or the point of a face from which places are counted
  Vec normal;   // of a face, or of the face on one side of a tip
  Vec normal2;  // of a tip: of the face on its other side, anticlockwise from `normal`
  double low;   // the places on a face
  double high;
  double friction;
  Ground ground = Ground::none;
};

inline constexpr std::size_t max_surfaces = 24;
inline constexpr std::size_t max_palm_surfaces = 6;  // with a nose and a heel

struct Surfaces : FixedList<Surface, max_surfaces> {
  std::size_t ordered = max_surfaces;  // from this one on, they are listed from left to right

  // The i-th of them if the ordered ones are walked from this side: in the mirror it is the same walk.
  constexpr std::size_t walked(std::size_t side, std::size_t i) const {
    return side == left || i < ordered ? i : ordered + (size() - 1 - i);
  }
};

// What stands still around object and palms: first the floor; then the other surfaces, from left to
// right. x forward, y up [m].
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
