// SPDX-License-Identifier: Apache-2.0
// Random objects with rounded corners, on two palms with noses and heels or on the floor between
// them, and how deep they overlap: by geometry that shares nothing with the core.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "palmbots/world/contact_shapes.hpp"
#include "palmbots/world/contact_step.hpp"
#include "support/random_outline.hpp"

namespace contact_scenes {

using namespace palmbots;
using outlines::between;
using outlines::Point;
using outlines::Polygon;

inline constexpr double degree = radians_per_degree<double>;
inline constexpr double half_palm = 0.075;

inline bool chance_of(std::mt19937& chance, double share) { return between(chance, 0, 1) < share; }

// A polygon around the COM whose convex corners have one radius.
struct Rounded {
  struct Arc {
    Point centre;
    double radius;
    Point in;  // normals of the edges before and after it
    Point out;
  };
  Polygon sharp;
  std::vector<Arc> arcs;
};

inline double cross_of(Point a, Point b) { return a.x * b.y - a.y * b.x; }

inline Rounded rounded(const Polygon& sharp, double radius) {
  Rounded made{sharp, {}};
  const std::size_t n = sharp.size();
  const auto normal = [&](std::size_t i) {
    const Point& a = sharp[i % n];
    const Point& b = sharp[(i + 1) % n];
    const double size = std::hypot(b.x - a.x, b.y - a.y);
    return Point{(b.y - a.y) / size, (a.x - b.x) / size};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Point in = normal(i + n - 1);
    const Point out = normal(i);
    const bool convex = cross_of(in, out) > 0;
    const double r = convex ? radius : 0;
    const double back = r / (1 + in.x * out.x + in.y * out.y);
    made.arcs.push_back(
        {{sharp[i].x - back * (in.x + out.x), sharp[i].y - back * (in.y + out.y)}, r, in, out});
  }
  return made;
}

// How deep a point lies in the body: 0 outside. In the corner beyond an arc it is outside.
inline double depth(const Rounded& body, Point p) {
  double least = outlines::depth(body.sharp, p);
  if (least == 0) return 0;
  for (const Rounded::Arc& arc : body.arcs) {
    const Point from{p.x - arc.centre.x, p.y - arc.centre.y};
    if (arc.radius > 0 && cross_of(arc.in, from) > 0 && cross_of(from, arc.out) > 0)
      least = std::min(least, std::max(0.0, arc.radius - std::hypot(from.x, from.y)));
  }
  return least;
}

struct PalmPose {
  Point pivot;
  double angle;
};

struct Scene {
  Rounded shape;
  ContactShapes shapes;
  double friction[2];
  double ground_friction;
  double thickness;
  double heel;
  bool floor;
  bool wall;
  double wall_x;
  PalmPose palms[2];
  Pose pose;
  Neighbourhood around;
};

inline Point on_palm(const PalmPose& palm, std::size_t side, double along, double across) {
  const double out = side == left ? -1 : 1;
  const double c = std::cos(palm.angle);
  const double s = std::sin(palm.angle);
  return {palm.pivot.x + out * (along * c - across * s), palm.pivot.y + along * s + across * c};
}

// An object on two palms, or on the floor between them. It may overlap them.
inline Scene random_scene(std::mt19937& chance, bool on_floor) {
  Scene s{};
  const double w = between(chance, 0.1, 0.3);
  const double h = between(chance, 0.05, 0.2);
  const double r = chance_of(chance, 0.3) ? 0 : between(chance, 0.001, 0.02);
  Polygon outline{{0, 0}, {w, 0}, {w, h}, {0, h}};
  std::size_t second = 1;
  if (chance_of(chance, 0.3)) {  // a keel
    outline.insert(outline.begin() + 1,
                   {w * between(chance, 0.2, 0.8), -between(chance, 0.003, 0.015)});
    second = 2;
  } else if (chance_of(chance, 0.3)) {  // a lid
    outline = {{0, 0},        {w, 0},     {w, h * 0.4},     {w + 0.05, h * 0.4},
               {w + 0.05, h}, {-0.05, h}, {-0.05, h * 0.4}, {0, h * 0.4}};
  }
  const double com_left = w * between(chance, 0.35, 0.65);
  const double com_height = h * between(chance, 0.3, 0.6);
  Model<double> model{};
  model.object.com_left = com_left;
  model.object.com_right = w - com_left;
  model.object.com_height = com_height;
  Polygon around_com;
  for (const Point& p : outline) {
    model.outline.vertices[model.outline.count++] = {{p.x, w - p.x}, p.y, r};
    around_com.push_back({p.x - com_left, p.y - com_height});
  }
  s.shape = rounded(around_com, r);
  s.shapes.body = body_of(model.outline, {{com_left, w - com_left}, com_height});
  s.shapes.size = w;
  for (double& friction : s.friction) friction = between(chance, 0.1, 0.7);
  s.ground_friction = between(chance, 0.1, 0.8);
  s.thickness = chance_of(chance, 0.4) ? 0 : between(chance, 0.0003, 0.002);
  s.heel = chance_of(chance, 0.5) ? 0 : between(chance, 0.005, 0.03);
  s.floor = on_floor;
  s.wall = on_floor && chance_of(chance, 0.3);
  s.wall_x = 1.2 * w;
  Surfaces& surfaces = s.shapes.surfaces;
  const PalmProfile profile{s.thickness, s.heel};
  add_palm(surfaces, Carrier::left_palm, 0, half_palm, s.friction[left], profile);
  const auto right_face = static_cast<std::uint8_t>(surfaces.size());
  add_palm(surfaces, Carrier::right_palm, 0, half_palm, s.friction[right], profile);
  if (s.floor)
    surfaces.push_back({Carrier::ground, false, {0, 0}, {0, 1}, {}, -100, 100, s.ground_friction});
  if (s.wall)
    surfaces.push_back(
        {Carrier::ground, false, {s.wall_x, 0}, {-1, 0}, {}, -100, 100, s.ground_friction});
  s.shapes.own = {
      FeaturePair{PairKind::corner_on_face, left, 0, 0},
      FeaturePair{PairKind::corner_on_face, right, right_face, static_cast<std::uint8_t>(second)}};
  s.shapes.reach = {1.0, 1.0};
  for (PalmPose& palm : s.palms) palm.angle = between(chance, 3 * degree, 25 * degree);
  if (on_floor) {
    s.pose = Pose::of({0, com_height}, 0);
    for (const std::size_t side : {left, right}) {
      PalmPose& palm = s.palms[side];
      const double arm = (side == left ? com_left : w - com_left) + 0.012;
      const double out = side == left ? -1 : 1;
      palm.pivot = {out * (arm + half_palm * std::cos(palm.angle)),
                    half_palm * std::sin(palm.angle) + s.thickness * std::cos(palm.angle) + 1e-6};
    }
    return s;
  }
  // The centre of each contact corner is its radius above its palm.
  const Point from = s.shape.arcs[0].centre;
  const Point to = s.shape.arcs[second].centre;
  Point centre[2];
  for (const std::size_t side : {left, right}) {
    s.palms[side].pivot = {0, 0.3};
    centre[side] = on_palm(s.palms[side], side, between(chance, -0.03, 0.03), r);
  }
  const double across = std::hypot(to.x - from.x, to.y - from.y);
  const double rise = centre[right].y - centre[left].y;
  const double run = std::sqrt(across * across - rise * rise);
  const double apart = run - (centre[right].x - centre[left].x);
  s.palms[left].pivot.x -= apart / 2;
  s.palms[right].pivot.x += apart / 2;
  const double angle = std::atan2(rise, run) - std::atan2(to.y - from.y, to.x - from.x);
  s.pose = Pose::of({0, 0}, angle);
  const Vec turned = s.pose.to_world({from.x, from.y});
  s.pose.at = {centre[left].x - apart / 2 - turned.x, centre[left].y - turned.y};
  return s;
}

// The deepest overlap of the object with palms, floor and wall [m].
inline double overlap(const Scene& s) {
  const auto seen = [&](Point p) {
    const Vec v = s.pose.from_world(Vec{p.x, p.y} - s.pose.at);
    return Point{v.x, v.y};
  };
  double most = 0;
  const auto look = [&](Point p) { most = std::max(most, depth(s.shape, seen(p))); };
  for (const std::size_t side : {left, right}) {
    const PalmPose& palm = s.palms[side];
    for (int k = 0; k <= 10; ++k) look(on_palm(palm, side, half_palm * (k / 5.0 - 1), 0));
    look(on_palm(palm, side, -half_palm, -s.thickness));
    for (int k = 1; s.heel > 0 && k <= 10; ++k)
      look(on_palm(palm, side, half_palm, s.heel * (k / 10.0)));
    for (const Rounded::Arc& arc : s.shape.arcs) {  // and straight beside each corner
      const Vec at = s.pose.at + s.pose.to_world({arc.centre.x, arc.centre.y});
      const double out = side == left ? -1 : 1;
      const double along = out * (at.x - palm.pivot.x) * std::cos(palm.angle) +
                           (at.y - palm.pivot.y) * std::sin(palm.angle);
      const double above = (at.y - palm.pivot.y) * std::cos(palm.angle) -
                           out * (at.x - palm.pivot.x) * std::sin(palm.angle);
      if (std::abs(along) <= half_palm) look(on_palm(palm, side, along, 0));
      if (above >= 0 && above <= s.heel) look(on_palm(palm, side, half_palm, above));
    }
  }
  for (const Rounded::Arc& arc : s.shape.arcs) {
    const Vec at = s.pose.at + s.pose.to_world({arc.centre.x, arc.centre.y});
    if (s.floor) most = std::max(most, arc.radius - at.y);
    if (s.wall) most = std::max(most, at.x + arc.radius - s.wall_x);
  }
  return most;
}

}  // namespace contact_scenes
