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
    if (a.radius != b.radius) return a.radius > b.radius ? 1 : -1;
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
  shapes.body = body_of(model.outline,
                        {{model.object.com_left, model.object.com_right}, model.object.com_height});
  constexpr Vec up{0.0, 1.0};
  for (const std::size_t side : {left, right}) {
    const Carrier palm = side == left ? Carrier::left_palm : Carrier::right_palm;
    const double half = double(model.half_length[side]);
    const std::size_t own = model.outline.contact[side];
    const double offset = double(model.offset[side]) - double(model.outline.vertices[own].radius);
    const double friction = double(model.friction[side]);
    shapes.reach[side] = double(model.reach[side]);
    shapes.own[side] = {PairKind::corner_on_face, static_cast<std::uint8_t>(shapes.surfaces.count),
                        static_cast<std::uint8_t>(own)};
    shapes.surfaces.add({palm, false, {0.0, offset}, up, {}, -half, half, friction});
    shapes.surfaces.add({palm, true, {-half, offset}, up, -up, 0.0, 0.0, friction});
    shapes.surfaces.add({palm, true, {half, offset}, -up, up, 0.0, 0.0, friction});
  }
  return shapes;
}

// Whether a surface that is a face, moved by `deep` into its carrier, lies in the body anywhere.
inline bool is_pierced(const RoundedBody& body, const Pose& pose, const Frame& frame,
                       const Surface& face, double deep) {
  std::array<Vec, 2> ends{};  // of the piece of the outline, seen from the face
  Vec first{};
  bool begun = false;
  bool pierced = false;
  bool is_inside = false;  // the inner end of the face
  const auto cross_over = [&](Vec a, Vec b) {
    if ((a.y > -deep) == (b.y > -deep)) return;
    const double x = a.x + (b.x - a.x) * ((-deep - a.y) / (b.y - a.y));
    pierced = pierced || (x > face.low && x < face.high);
    if (x >= face.high) is_inside = !is_inside;
  };
  each_drawn_point(body, [&](std::size_t, Vec point) {
    const Vec seen = frame.from_world((pose.at + pose.to_world(point)) - frame.origin) - face.at;
    ends = {ends[1], {cross(seen, face.normal), dot(seen, face.normal)}};
    if (begun) cross_over(ends[0], ends[1]);
    if (!begun) first = ends[1];
    begun = true;
  });
  cross_over(ends[1], first);
  return pierced || is_inside;
}

}  // namespace palmbots
