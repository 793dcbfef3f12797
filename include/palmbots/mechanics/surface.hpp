// SPDX-License-Identifier: Apache-2.0
// The surfaces that an object touches: faces and the tips between them, on a palm or on the ground.
//
// A carrier is what a surface belongs to: the left palm, the right palm, or the ground. Its frame
// is (outward, normal): for a palm the directions along its plate and across it from its pivot. So
// the two palms are described by the same numbers. On the ground they are x and y.
#pragma once

#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/mechanics/rounded_body.hpp"

namespace palmbots {

enum class Carrier : std::uint8_t { left_palm, right_palm, ground };

// A frame that moves: where it is, how it is turned, and how fast.
struct Frame {
  double sense;  // of its first axis: +1 towards +x, −1 towards −x
  Vec origin;
  double angle;  // by which its first axis rises [rad]
  double sin;
  double cos;
  Vec velocity;
  double rate;  // of the angle

  // A direction of the frame in the world, and the reverse.
  constexpr Vec to_world(Vec v) const {
    return {sense * (v.x * cos - v.y * sin), v.x * sin + v.y * cos};
  }
  constexpr Vec from_world(Vec v) const {
    const double out = sense * v.x;
    return {out * cos + v.y * sin, v.y * cos - out * sin};
  }
  // The velocity of the point of the frame at a position in the world.
  constexpr Vec velocity_at(Vec point) const {
    const Vec r = point - origin;
    const double spin = sense * rate;
    return {velocity.x - spin * r.y, velocity.y + spin * r.x};
  }
};

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
};

inline constexpr std::size_t max_surfaces = 24;

struct Surfaces {
  std::array<Surface, max_surfaces> at{};
  std::size_t count = 0;

  constexpr void add(const Surface& surface) { at[count++] = surface; }
};

}  // namespace palmbots
