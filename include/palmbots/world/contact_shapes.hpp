// SPDX-License-Identifier: Apache-2.0
// The object and the palms of a model, as shapes that can touch anywhere.
#pragma once

#include <optional>
#include <vector>

#include "palmbots/mechanics/model.hpp"
#include "palmbots/world/contact_regime.hpp"

namespace palmbots {

// Adds the surfaces of a palm: top face (at the distance `offset` from the pivot), nose and heel.
inline void add_palm(Surfaces& surfaces, Carrier palm, double offset, double half, double friction,
                     const PalmProfile& profile) {
  constexpr Vec up{0.0, 1.0};
  constexpr Vec inward{-1.0, 0.0};
  const Vec under{profile.under_along, profile.under_across};
  const auto face = [&](Vec at, Vec normal, double low, double high) {
    surfaces.push_back({palm, false, at, normal, {}, low, high, friction});
  };
  const auto tip = [&](Vec at, Vec from, Vec to) {
    surfaces.push_back({palm, true, at, from, to, 0.0, 0.0, friction});
  };
  face({0.0, offset}, up, -half, half);
  if (profile.nose > 0.0) {
    tip({-half, offset}, up, inward);
    face({-half, offset}, inward, -profile.nose, 0.0);
    tip({-half, offset - profile.nose}, inward, under);
  } else {
    tip({-half, offset}, up, under);
  }
  if (profile.heel > 0.0) {
    face({half, offset}, inward, -profile.heel, profile.heel);  // no corner slips under it
    tip({half, offset + profile.heel}, -inward, inward);
  } else {
    tip({half, offset}, -up, up);
  }
}

// Which way left and right differ, or 0 if they are mirror images.
template <class Real>
int lopsided(const Model<Real>& model) {
  const auto seen_from = [&](std::size_t side) {
    const PalmProfile& profile = model.profile[side];
    std::vector<double> seen{double(model.friction[side]),
                             double(model.offset[side]),
                             double(model.half_length[side]),
                             double(model.reach[side]),
                             double(side == left ? model.object.com_left : model.object.com_right),
                             profile.nose,
                             profile.heel,
                             profile.under_along};
    for (std::size_t i = 0; i < model.outline.count; ++i) {
      const Vertex<Real>& v = model.outline.vertices[model.outline.walked(side, i)];
      seen.insert(seen.end(), {double(v.along[side]), double(v.height), double(v.radius)});
    }
    const Surroundings& around = model.surroundings;
    for (std::size_t i = around.ordered; i < around.size(); ++i) {
      const Surface& s = around[side == left ? i : around.size() - i];
      seen.insert(seen.end(), {outward<double>(side) * s.at.x, s.at.y, s.friction});
    }
    return seen;
  };
  const auto from_left = seen_from(left);
  const auto from_right = seen_from(right);
  return from_left == from_right ? 0 : (from_left > from_right ? 1 : -1);
}

template <class Real>
ContactShapes shapes_of(const Model<Real>& model) {
  ContactShapes shapes{};
  shapes.body = body_of(model.outline,
                        {{model.object.com_left, model.object.com_right}, model.object.com_height});
  const bool is_disc = shapes.body.is_disc();
  shapes.size = is_disc ? shapes.body.corners[0].radius : double(model.object.width);
  for (const std::size_t side : {left, right}) {
    const std::size_t own = is_disc ? 0 : model.outline.contact[side];
    const bool stops = model.profile[side].stops;
    shapes.reach[side] = double(stops ? model.half_length[side] : model.reach[side]);
    shapes.stops[side] = stops;
    shapes.own[side] = {PairKind::corner_on_face, std::uint8_t(side),
                        std::uint8_t(shapes.surfaces.size()), std::uint8_t(own)};
    add_palm(shapes.surfaces, side == left ? Carrier::left_palm : Carrier::right_palm,
             double(model.offset[side]) - shapes.body.corners[own].radius,
             double(model.half_length[side]), double(model.friction[side]), model.profile[side]);
  }
  const Surroundings& around = model.surroundings;
  shapes.surfaces.ordered = shapes.surfaces.size() + around.ordered;
  for (const Surface& surface : around) shapes.surfaces.push_back(surface);
  shapes.lopsided = lopsided(model);
  return shapes;
}

// Whether a surface that is a face, moved by `deep` into its carrier, lies in the body anywhere. Its
// ends move by as much: otherwise a body that only touches the next face would count.
inline bool is_pierced(const Instant& at, const Surface& face, double deep) {
  const Frame& frame = at.frames[static_cast<std::size_t>(face.carrier)];
  const double low = face.low + deep, high = face.high - deep;
  std::optional<Vec> before;  // the last point of the outline, seen from the face
  Vec first{};
  bool pierced = false;
  bool is_inside = false;  // the inner end of the face
  const auto cross_over = [&](Vec a, Vec b) {
    if ((a.y > -deep) == (b.y > -deep)) return;
    const double x = a.x + (b.x - a.x) * ((-deep - a.y) / (b.y - a.y));
    pierced = pierced || (x > low && x < high);
    if (x >= high) is_inside = !is_inside;
  };
  each_drawn_point(at.problem.shapes.body, [&](std::size_t, Vec point) {
    const Vec seen =
        frame.from_world((at.pose.at + at.pose.to_world(point)) - frame.origin) - face.at;
    const Vec place{cross(seen, face.normal), dot(seen, face.normal)};
    if (before) cross_over(*before, place);
    if (!before) first = place;
    before = place;
  });
  cross_over(*before, first);
  return pierced || is_inside;
}

// The carrier of a face that, moved by `deep` into it, lies in the object anywhere; palms come first.
inline std::optional<std::size_t> pierced_carrier(const Instant& at, double deep) {
  for (const Surface& face : at.problem.shapes.surfaces)
    if (!face.tip && is_pierced(at, face, deep)) return static_cast<std::size_t>(face.carrier);
  return std::nullopt;
}

}  // namespace palmbots
