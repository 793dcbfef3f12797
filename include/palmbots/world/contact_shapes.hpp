// SPDX-License-Identifier: Apache-2.0
// The object and the palms of a model, as shapes that can touch anywhere.
#pragma once

#include "palmbots/mechanics/model.hpp"
#include "palmbots/world/contact_regime.hpp"

namespace palmbots {

namespace detail {

// Which way left and right differ, or 0 if they are mirror images.
template <class Real>
int lopsided(const Model<Real>& model) {
  const auto palm = [&](std::size_t side) {
    return std::array<Real, 5>{model.friction[side], model.offset[side], model.half_length[side],
                               model.reach[side],
                               side == left ? model.object.com_left : model.object.com_right};
  };
  const auto of_left = palm(left);
  const auto of_right = palm(right);
  if (of_left != of_right) return of_left > of_right ? 1 : -1;
  const Outline<Real>& outline = model.outline;
  for (std::size_t i = 0; i < outline.count; ++i) {
    const Vertex<Real>& a = outline.vertices[outline.walked(left, i)];
    const Vertex<Real>& b = outline.vertices[outline.walked(right, i)];
    if (a.along[left] != b.along[right]) return a.along[left] > b.along[right] ? 1 : -1;
    if (a.height != b.height) return a.height > b.height ? 1 : -1;
  }
  return 0;
}

}  // namespace detail

// Each palm is one face, thin and open at its ends.
template <class Real>
ContactShapes shapes_of(const Model<Real>& model) {
  ContactShapes shapes{};
  shapes.size = double(model.object.width);
  shapes.lopsided = detail::lopsided(model);
  shapes.body = body_of(model, {});
  constexpr Vec up{0.0, 1.0};
  for (const std::size_t side : {left, right}) {
    const Carrier palm = side == left ? Carrier::left_palm : Carrier::right_palm;
    const double half = double(model.half_length[side]);
    const double offset = double(model.offset[side]);
    const double friction = double(model.friction[side]);
    shapes.reach[side] = double(model.reach[side]);
    shapes.own[side] = {PairKind::corner_on_face, static_cast<std::uint8_t>(shapes.surfaces.count),
                        static_cast<std::uint8_t>(model.outline.contact[side])};
    shapes.surfaces.add({palm, false, {0.0, offset}, up, {}, -half, half, friction});
    shapes.surfaces.add({palm, true, {-half, offset}, up, -up, 0.0, 0.0, friction});
    shapes.surfaces.add({palm, true, {half, offset}, -up, up, 0.0, 0.0, friction});
  }
  return shapes;
}

}  // namespace palmbots
