// SPDX-License-Identifier: Apache-2.0
// Poses and motions in the plane. Angles count anticlockwise [rad].
#pragma once

#include "palmbots/base/vec.hpp"

namespace palmbots {

// Where a body is: the position of its reference point [m], and its angle.
struct Pose {
  Vec at;
  double angle;
  double sin;
  double cos;

  static constexpr Pose of(Vec at, double angle) {
    const SinCos<double> turned = sin_cos(angle);
    return {at, angle, turned.sin, turned.cos};
  }
  constexpr Vec to_world(Vec v) const { return {v.x * cos - v.y * sin, v.x * sin + v.y * cos}; }
  constexpr Vec from_world(Vec v) const { return {v.x * cos + v.y * sin, v.y * cos - v.x * sin}; }
};

// How a body moves: the velocity of its reference point, and its angular velocity [rad/s].
struct RigidMotion {
  Vec velocity;
  double spin;

  // The velocity of the point at a place from the reference point [m].
  constexpr Vec velocity_at(Vec place) const {
    return {velocity.x - spin * place.y, velocity.y + spin * place.x};
  }
};

// A frame that moves, possibly a left-handed one: where it is, how it is turned, and how fast.
struct Frame {
  double sense;  // of its first axis: +1 towards +x, −1 towards −x
  Vec origin;
  double angle;  // by which its first axis rises
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
    return RigidMotion{velocity, sense * rate}.velocity_at(point - origin);
  }
};

}  // namespace palmbots
