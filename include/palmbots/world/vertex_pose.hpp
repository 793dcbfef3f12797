// SPDX-License-Identifier: Apache-2.0
// Where the object is: the coordinates of its two contact vertices on the palms, and its pose. Each
// follows from the other.
#pragma once

#include "palmbots/mechanics/model.hpp"
#include "palmbots/world/state.hpp"
#include "palmbots/world/travel.hpp"

namespace palmbots {

// A contact vertex of the object, from its COM.
template <class Real>
Vec vertex_of(const Model<Real>& model, std::size_t side) {
  const Real along = side == left ? model.object.com_left : model.object.com_right;
  return {outward<double>(side) * double(along), -double(model.object.com_height)};
}

// The pose of the object that rests on its two contact vertices.
template <class Real>
Pose pose_on_vertices(const Model<Real>& model, const Kinematics<Real>& state,
                      const Frames& frames) {
  const ContactVector<Real> across = state.contact_vector;
  const bool is_level = is_pipe(model.object);  // until it rolls
  const double angle = is_level ? 0.0 : angle_of(double(across.dy), double(across.dx));
  const Pose turned = Pose::of({0.0, 0.0}, angle);
  PerSide<Vec> com{};
  for (const std::size_t side : {left, right}) {
    const Vec place{double(state.configuration.contacts[side]), double(model.offset[side])};
    com[side] = (frames[side].origin + frames[side].to_world(place)) -
                turned.to_world(vertex_of(model, side));
  }
  return Pose::of((com[left] + com[right]) * 0.5, turned.angle);
}

// The moving state of palms and object, from their frames and its pose. `held`: whether the vertex
// rests on its palm. Such a contact keeps every bit of its coordinate if it sticks, which means that
// it moves by no more than `slack`.
template <class Real>
void place_vertices(const Model<Real>& model, const Frames& frames, const Pose& pose,
                    const PerSide<bool>& held, Real slack, WorldState<Real>& state) {
  Configuration<Real>& now = state.configuration;
  now.separation = Real(frames[right].origin.x - frames[left].origin.x);
  for (const std::size_t side : {left, right}) {
    now.palms[side] = PalmAngle<Real>::at(Real(frames[side].angle));
    const Vec vertex = pose.at + pose.to_world(vertex_of(model, side));
    const Vec seen = frames[side].from_world(vertex - frames[side].origin);
    const Real place = Real(seen.x);
    if (!held[side] || magnitude(place - now.contacts[side]) > slack) now.contacts[side] = place;
    now.lift[side] = held[side] ? Real(0) : Real(seen.y) - model.offset[side];
  }
  state.tied = Real(0);
  state.contact_vector = contact_vector(
      now, {model.offset[left] + now.lift[left], model.offset[right] + now.lift[right]});
}

}  // namespace palmbots
