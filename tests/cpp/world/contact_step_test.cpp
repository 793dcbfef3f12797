// SPDX-License-Identifier: Apache-2.0
// The step among any contacts, by what it must obey: nothing overlaps, the forces that the regime
// allows carry the weight, what sticks does not slip, what slides does in its direction. Geometry
// and balance are computed anew here. With two contacts it is the step of two vertices, and in the
// mirror it is itself to the last bit.
//
// contact_step_test [SCENES]   SCENES: random scenes of each test; 24 if not given
#include "palmbots/world/contact_step.hpp"

#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "palmbots/sim/build.hpp"
#include "palmbots/world/quasistatic_world.hpp"
#include "support/check.hpp"
#include "support/contact_scenes.hpp"
#include "support/paper_spec.hpp"

namespace {

using namespace contact_scenes;

// --- What a regime claims -------------------------------------------------------------------------

using Wrench = std::array<double, 3>;

double dot_of(const Wrench& a, const Wrench& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The least distance of the wrench from sums of some of the rays with shares ≥ 0: over all subsets of
// at most three, each by least squares (Gauss).
double missing(const std::vector<Wrench>& rays, const Wrench& wrench) {
  double least = std::sqrt(dot_of(wrench, wrench));
  const std::size_t n = rays.size();
  for (std::size_t bits = 1; bits < (std::size_t{1} << n); ++bits) {
    std::vector<Wrench> some;
    for (std::size_t i = 0; i < n; ++i)
      if ((bits >> i & 1) != 0) some.push_back(rays[i]);
    const std::size_t m = some.size();
    if (m > 3) continue;
    double a[3][4] = {};
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < m; ++j) a[i][j] = dot_of(some[i], some[j]);
      a[i][i] += 1e-12;
      a[i][3] = dot_of(some[i], wrench);
    }
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = i + 1; j < m; ++j)
        for (std::size_t k = 4; k-- > i;) a[j][k] -= a[i][k] * a[j][i] / a[i][i];
    double share[3] = {};
    bool possible = true;
    for (std::size_t i = m; i-- > 0;) {
      double rest = a[i][3];
      for (std::size_t j = i + 1; j < m; ++j) rest -= a[i][j] * share[j];
      share[i] = rest / a[i][i];
      possible = possible && share[i] >= -1e-7;
    }
    if (!possible) continue;
    Wrench left_over = wrench;
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t c = 0; c < 3; ++c) left_over[c] -= share[i] * some[i][c];
    least = std::min(least, std::sqrt(dot_of(left_over, left_over)));
  }
  return least;
}

struct Touch {
  Point at;       // in the world
  Point normal;   // into the object
  Point tangent;  // outward: right, for the right palm and for the ground
  double friction;
  Motion motion;
  std::size_t carrier;
};

// Where a contact of the regime is, from the shapes of this test.
Touch touch_of(const Scene& s, const ActivePair& active) {
  const Surface& surface = s.shapes.surfaces[active.pair.surface];
  const auto carrier = static_cast<std::size_t>(surface.carrier);
  const auto on_carrier = [&](Vec v) {
    return carrier < 2 ? on_palm(s.palms[carrier], carrier, v.x, v.y) : Point{v.x, v.y};
  };
  const Point origin = on_carrier({0, 0});
  Point normal{};
  Point at{};
  const Rounded::Arc& arc = s.shape.arcs[active.pair.feature];
  if (!surface.tip) {
    const Point tip = on_carrier(surface.normal);
    normal = {tip.x - origin.x, tip.y - origin.y};
    const Vec c = s.pose.at + s.pose.to_world({arc.centre.x, arc.centre.y});
    at = {c.x - arc.radius * normal.x, c.y - arc.radius * normal.y};
  } else {
    at = on_carrier(surface.at);
    Vec outward{arc.out.x, arc.out.y};
    if (active.pair.kind == PairKind::tip_on_arc) {
      const Vec v =
          s.pose.from_world(Vec{at.x, at.y} - s.pose.at) - Vec{arc.centre.x, arc.centre.y};
      outward = v * (1 / std::hypot(v.x, v.y));
    }
    const Vec v = s.pose.to_world(outward);
    normal = {-v.x, -v.y};
  }
  const double out = carrier == left ? -1 : 1;
  const double friction = carrier < 2 ? s.friction[carrier] : s.ground_friction;
  return {at, normal, {out * normal.y, -out * normal.x}, friction, active.motion, carrier};
}

bool is_in_balance(const Scene& s, const Regime& regime, double slope) {
  std::vector<Wrench> rays;
  for (const ActivePair& active : regime.active) {
    const Touch t = touch_of(s, active);
    for (const double sign : {-1.0, 1.0}) {  // friction against sliding up, and down
      if (t.motion == Motion::up && sign > 0) continue;
      if (t.motion == Motion::down && sign < 0) continue;
      const Point f{t.normal.x + sign * t.friction * t.tangent.x,
                    t.normal.y + sign * t.friction * t.tangent.y};
      const Point arm{t.at.x - s.pose.at.x, t.at.y - s.pose.at.y};
      rays.push_back({f.x, f.y, cross_of(arm, f) / s.shapes.size});
    }
  }
  return missing(rays, {slope, 1, 0}) < 1e-5;
}

// How far the object slips on a surface at a contact while both move from one scene to the other.
double slip(const Scene& before, const Scene& after, const Touch& t) {
  const Vec at{t.at.x, t.at.y};
  const Vec seen = before.pose.from_world(at - before.pose.at);
  const Vec object = after.pose.at + after.pose.to_world(seen) - at;
  Point carried{};
  if (t.carrier < 2) {
    const PalmPose& was = before.palms[t.carrier];
    const PalmPose& is = after.palms[t.carrier];
    const double out = t.carrier == left ? -1 : 1;
    const double turn = out * (is.angle - was.angle);
    const Point arm{t.at.x - was.pivot.x, t.at.y - was.pivot.y};
    carried = {is.pivot.x + arm.x * std::cos(turn) - arm.y * std::sin(turn) - t.at.x,
               is.pivot.y + arm.x * std::sin(turn) + arm.y * std::cos(turn) - t.at.y};
  }
  return (object.x - carried.x) * t.tangent.x + (object.y - carried.y) * t.tangent.y;
}

Travel travel_of(const Scene& s, const PalmPose (&by)[2], double share) {
  Travel travel{};
  for (const std::size_t side : {left, right}) {
    const PalmPose& palm = s.palms[side];
    const double turn = by[side].angle * share;
    travel.palms[side] = {{palm.pivot.x, palm.pivot.y},
                          {by[side].pivot.x * share, by[side].pivot.y * share},
                          palm.angle,
                          turn,
                          palm.angle + turn};
  }
  return travel;
}

struct Seen {
  int steps = 0;
  int slides = 0;
  int sticks = 0;
  int many = 0;  // contacts: more than two
  int held = 0;  // scenes that did not end early
};

Advance<double> step(Scene& s, Regime& regime, double slope, const PalmPose (&by)[2],
                     double share) {
  const ContactProblem problem{s.shapes, slope, 0.0, false};
  const Travel travel = travel_of(s, by, share);
  AmbiguousEvents ambiguous;
  const double rounding = 1e-14 * s.shapes.size;
  const Advance<double> done =
      ContactStep(problem, travel, s.pose, regime, s.around, ambiguous, rounding,
                  [](const Instant&, double, const ActivePairs&) {})
          .run();
  for (const std::size_t side : {left, right}) {
    s.palms[side].pivot.x += done.fraction * travel.palms[side].by.x;
    s.palms[side].pivot.y += done.fraction * travel.palms[side].by.y;
    s.palms[side].angle += done.fraction * travel.palms[side].turn;
  }
  return done;
}

void obeys_mechanics(int scenes) {
  std::mt19937 chance(20);
  Seen seen{};
  for (int k = 0; k < scenes; ++k) {
    Scene s = random_scene(chance, k % 3 == 0);
    const double slope = k % 4 == 1 ? between(chance, -0.05, 0.05) : 0;
    if (overlap(s) > 1e-7) continue;
    Regime regime{};
    PalmPose by[2]{};
    bool ended = false;
    for (int i = 0; i < 100 && !ended; ++i) {
      if (i % 20 == 0) {
        for (const std::size_t side : {left, right}) {
          const double inward = side == left ? 0.0004 : -0.0004;
          by[side].pivot.x = between(chance, -0.0006, 0.0006) + (s.floor ? inward : 0);
          by[side].pivot.y = chance_of(chance, 0.8) ? 0 : between(chance, -0.0002, 0.0004);
          by[side].angle = chance_of(chance, 0.5) ? 0 : between(chance, -0.008, 0.008);
        }
      }
      ended = step(s, regime, slope, by, 1).reason != DropReason::none;
      ++seen.steps;
      CHECK(overlap(s) < 1e-9);
      if (ended) break;
      CHECK(is_in_balance(s, regime, slope));
      seen.many += regime.active.size() > 2 ? 1 : 0;
      // A little further, in which nothing happens, as a rule.
      const Scene before = s;
      const Advance<double> little = step(s, regime, slope, by, 1e-3);
      ended = little.reason != DropReason::none;
      if (ended || little.segments > 1) continue;
      const double pace = 1e-3 * (std::hypot(by[left].pivot.x, by[left].pivot.y) +
                                  std::hypot(by[right].pivot.x, by[right].pivot.y) +
                                  0.3 * (std::abs(by[left].angle) + std::abs(by[right].angle)));
      for (const ActivePair& active : regime.active) {
        const Touch t = touch_of(before, active);
        const double up = slip(before, s, t);
        if (t.motion == Motion::stick) {
          CHECK(std::abs(up) <= 1e-3 * pace + 1e-13);
          ++seen.sticks;
        } else {
          CHECK(static_cast<int>(t.motion) * up >= -1e-3 * pace - 1e-13);
          ++seen.slides;
        }
      }
    }
    seen.held += ended ? 0 : 1;
  }
  CHECK(seen.steps > 20 * scenes && seen.held > scenes / 10);
  CHECK(seen.slides > seen.steps / 10 && seen.sticks > seen.steps / 10 && seen.many > 0);
}

// Steps in which the palms move by centimetres and turn through level, as a whole and in parts: what
// happens does not depend on where a step ends. Where two events nearly coincide, rounding decides
// which comes first: that is seen in one of 4000 steps.
void whole_or_in_parts(int scenes, unsigned seed) {
  constexpr int parts = 16;
  std::mt19937 chance(seed);
  int steps = 0;
  int many = 0;  // steps with several events
  int differ = 0;
  for (int k = 0; k < scenes; ++k) {
    Scene s = random_scene(chance, k % 3 == 0);
    if (overlap(s) > 1e-7) continue;
    Regime regime{};
    for (int i = 0; i < 10; ++i) {
      PalmPose by[2]{};
      for (const std::size_t side : {left, right}) {
        const double inward = side == left ? 0.012 : -0.012;
        by[side].pivot.x = between(chance, -0.018, 0.018) + (s.floor ? inward : 0);
        if (chance_of(chance, 0.5))
          by[side].angle = between(chance, -2.5, 0.5) * s.palms[side].angle;
      }
      Scene other_way = s;
      Regime of_parts = regime;
      const Advance<double> whole = step(s, regime, 0, by, 1);
      double done = 0;
      DropReason reason = DropReason::none;
      for (int part = 0; part < parts && reason == DropReason::none; ++part) {
        const Advance<double> one = step(other_way, of_parts, 0, by, 1.0 / parts);
        done += one.fraction / parts;
        reason = one.reason;
      }
      const Vec apart = other_way.pose.at - s.pose.at;
      const bool alike = reason == whole.reason && std::abs(done - whole.fraction) < 1e-7 &&
                         std::hypot(apart.x, apart.y) < 1e-7 &&
                         std::abs(other_way.pose.angle - s.pose.angle) < 1e-6;
      differ += alike ? 0 : 1;
      many += whole.segments > 3 ? 1 : 0;
      ++steps;
      if (reason != DropReason::none || whole.reason != DropReason::none) break;
    }
  }
  CHECK(differ <= steps / 1000 && many > scenes / 4);
}

// --- Two contacts, and the mirror -----------------------------------------------------------------

Model<double> random_model(std::mt19937& chance, Spec& spec) {
  spec = paper_spec();
  spec.safe_reach = -1;
  spec.com_left = between(chance, 0.1, 0.15);
  spec.com_right = spec.width - spec.com_left;
  for (const std::size_t side : {left, right}) {
    spec.start[side] = between(chance, -0.03, 0.03);
    spec.palms[side].friction = between(chance, 0.15, 0.5);
    spec.palms[side].offset = between(chance, 0, 0.01);
  }
  return model_of<double>(spec);
}

// Where the two vertices alone touch, the step finds what the step of two vertices computes by
// closed forms.
void two_vertices(int scenes) {
  std::mt19937 chance(21);
  int compared = 0;
  for (int k = 0; k < scenes; ++k) {
    Spec spec;
    const Model<double> model = random_model(chance, spec);
    World<double> world(model, configuration_of(spec, model));
    const ContactShapes shapes = shapes_of(model);
    const ContactProblem problem{shapes, model.object.slope, 0.0, true};
    if (world.check() != DropReason::none) continue;
    for (int i = 0; i < 20; ++i) {
      const Configuration<double> from = world.configuration();
      const double change = between(chance, -0.002, 0.002);
      const PerSide<double> angles{between(chance, 5 * degree, 20 * degree),
                                   between(chance, 5 * degree, 20 * degree)};
      if (world.advance(change, angles).reason != DropReason::none) break;
      if (!world.regime().none()) break;
      Travel travel{};
      Vec vertex[2];
      for (const std::size_t side : {left, right}) {
        const double out = side == left ? -1 : 1;
        const double angle = from.palms[side].angle;
        travel.palms[side] = {{out * from.separation / 2, 0},
                              {out * change / 2, 0},
                              angle,
                              angles[side] == angle ? 0.0 : angles[side] - angle,
                              angles[side]};
        const Frame frame =
            travel.frame(side == left ? Carrier::left_palm : Carrier::right_palm, 0);
        vertex[side] = frame.origin + frame.to_world({from.contacts[side], model.offset[side]});
      }
      const Vec across = vertex[right] - vertex[left];
      Pose pose = Pose::of({0, 0}, std::atan2(across.y, across.x));
      pose.at = vertex[left] - pose.to_world({-model.object.com_left, -model.object.com_height});
      Regime regime{};
      Neighbourhood around;
      AmbiguousEvents ambiguous;
      const Advance<double> done =
          ContactStep(problem, travel, pose, regime, around, ambiguous, 1e-13,
                      [](const Instant&, double, const ActivePairs&) {})
              .run();
      CHECK(done.reason == DropReason::none && regime.active.size() == 2);
      for (const std::size_t side : {left, right}) {
        const double place =
            Instant{problem, travel.frames(1), pose}.contact(shapes.own[side]).place;
        CHECK(std::abs(place - world.configuration().contacts[side]) < 1e-9);
      }
      ++compared;
    }
  }
  CHECK(compared > 4 * scenes);
}

template <class Real>
Model<Real> mirrored_model(const Model<Real>& model) {
  Model<Real> image = model;
  std::swap(image.object.com_left, image.object.com_right);
  image.object.slope = -model.object.slope;
  image.moments = Moments<Real>::of(image.object);
  for (auto* of_palm : {&image.offset, &image.half_length, &image.reach, &image.friction})
    std::swap((*of_palm)[left], (*of_palm)[right]);
  Outline<Real>& outline = image.outline;
  for (std::size_t i = 0; i < outline.count; ++i) {
    outline.vertices[i] = model.outline.vertices[outline.count - 1 - i];
    std::swap(outline.vertices[i].along[left], outline.vertices[i].along[right]);
  }
  outline.contact = {outline.count - 1 - model.outline.contact[right],
                     outline.count - 1 - model.outline.contact[left]};
  for (const std::size_t side : {left, right}) image.clear[side] = clear_cone(outline, side);
  return image;
}

// The mirrored world moves mirrored to the last bit, with any contacts.
template <class Real>
void mirrored_to_the_bit(int scenes) {
  const Polygon keel{{0, 0}, {0.06, -0.01}, {0.25, 0}, {0.25, 0.1}, {0, 0.1}};
  const Polygon lid{{0, 0},      {0.25, 0},   {0.25, 0.02}, {0.35, 0.02},
                    {0.35, 0.1}, {-0.1, 0.1}, {-0.1, 0.02}, {0, 0.02}};
  std::mt19937 chance(22);
  int further = 0;
  for (int k = 0; k < scenes; ++k) {
    Spec spec;
    random_model(chance, spec);
    if (k % 3 > 0) {
      const Polygon& corners = k % 3 == 1 ? keel : lid;
      spec.outline.count = corners.size();
      for (std::size_t i = 0; i < corners.size(); ++i)
        spec.outline.vertices[i] = {{corners[i].x, spec.width - corners[i].x}, corners[i].y};
      spec.outline.contact = {0, k % 3 == 1 ? std::size_t{2} : std::size_t{1}};
    }
    const Model<Real> model = model_of<Real>(spec);
    const Configuration<Real> start = configuration_of(spec, model);
    Configuration<Real> image = start;
    std::swap(image.palms[left], image.palms[right]);
    std::swap(image.contacts[left], image.contacts[right]);
    World<Real> there(model, start);
    World<Real> back(mirrored_model(model), image);
    CHECK(there.check() == back.check());
    if (there.check() != DropReason::none) continue;
    for (int i = 0; i < 20; ++i) {
      constexpr std::array<int, 8> angles{-5, -2, 0, 2, 3, 5, 8, 15};
      const auto change = static_cast<Real>(between(chance, -0.01, 0.01));
      const auto push = static_cast<Real>(k % 2 == 0 ? 0 : between(chance, -0.03, 0.03));
      const auto angle = [&] { return Real(angles[chance() % 8]) * radians_per_degree<Real>; };
      const PerSide<Real> goals{angle(), angle()};
      const Advance<Real> a = there.advance(change, goals, push);
      const Advance<Real> b = back.advance(change, {goals[right], goals[left]}, -push);
      further += there.regime().none() ? 0 : 1;
      const Configuration<Real>& p = there.configuration();
      const Configuration<Real>& q = back.configuration();
      CHECK(a.reason == b.reason && a.fraction == b.fraction && p.separation == q.separation);
      for (const std::size_t side : {left, right}) {
        CHECK(p.contacts[side] == q.contacts[other(side)]);
        CHECK(p.lift[side] == q.lift[other(side)]);
      }
      if (a.reason != DropReason::none) break;
    }
  }
  CHECK(further > scenes);
}

}  // namespace

int main(int argc, char** argv) {
  const int scenes = argc > 1 ? std::atoi(argv[1]) : 24;
  obeys_mechanics(scenes);
  for (const unsigned seed : {23U, 119U}) whole_or_in_parts(4 * scenes / 3, seed);
  two_vertices(scenes);
  mirrored_to_the_bit<double>(scenes);
  mirrored_to_the_bit<float>(scenes);
  return 0;
}
