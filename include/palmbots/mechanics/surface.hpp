// SPDX-License-Identifier: Apache-2.0
// The surfaces that an object touches: faces and the tips between them, on a palm or on the ground.
//
// A carrier is what a surface belongs to: the left palm, the right palm, or the ground. Its frame
// is (outward, normal): for a palm the directions along its plate and across it from its pivot. So
// the two palms are described by the same numbers. On the ground they are x and y.
#pragma once

#include <cstddef>
#include <cstdint>

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

}  // namespace palmbots
