// SPDX-License-Identifier: Apache-2.0
// Regimes and how they are chosen, one rule at a time: which pairs hold the object, which of them
// comes first, when a tip is beside an edge; and what a world reports of its contacts.
#include "palmbots/world/regime_choice.hpp"

#include <cmath>
#include <cstddef>
#include <random>

#include "palmbots/sim/build.hpp"
#include "palmbots/world/quasistatic_world.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

// The object of the scene `paper` on its two contact vertices, while the palms close or rest.
struct Held {
  Spec spec = paper_spec();
  Model<double> model = model_of<double>(spec);
  World<double> world{model, configuration_of(spec, model)};
  ContactShapes shapes = shapes_of(model);
  ContactProblem problem{shapes, 0.0, 0.0, true};
  Pose pose = world.pose();

  Instant instant(double closing) const {
    Travel travel{};
    for (const std::size_t side : {left, right}) {
      const double angle = world.configuration().palms[side].angle;
      travel.palms[side] = {
          world.pivot(side), {-outward<double>(side) * closing, 0.0}, angle, 0.0, angle};
    }
    return {problem, travel.frames(0.0), pose};
  }
  FeatureContact closed(std::size_t side) const { return instant(0.0).contact(shapes.own[side]); }
};

void test_what_holds_the_object() {
  const Held held;
  const FeatureContact l = held.closed(left);
  const FeatureContact r = held.closed(right);
  CHECK(reason_of(held.problem, {}) == DropReason::lifting);
  CHECK(reason_of(held.problem, {l}) == DropReason::lifting);
  CHECK(reason_of(held.problem, {l, r}) == DropReason::none);
  CHECK(reason_of(held.problem, {r}) == DropReason::lifting);
}

void test_pairs_of_a_regime() {
  const Held held;
  Regime regime;
  CHECK(regime.none() && !regime.has(held.shapes.own[left]));
  regime.active.push_back({held.shapes.own[left], Motion::stick, 0.0, {}});
  CHECK(!regime.none() && regime.has(held.shapes.own[left]) && !regime.has(held.shapes.own[right]));
}

bool all_slide(const Regime& regime) {
  for (const ActivePair& active : regime.active)
    if (active.motion == Motion::stick) return false;
  return true;
}

// When the palms close on a symmetric object, either contact may slide, or both. Regimes in which
// all slide come before others with as many contacts; both never slide to the same side.
void test_order_of_the_candidates() {
  const Held held;
  const ClosedPairs closed{held.closed(left), held.closed(right)};
  const Instant now = held.instant(0.001);
  const RegimeCandidates found = RegimeSearch(now, closed).candidates(now.frames);
  CHECK(found.size() == 3);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Regime& regime = found[k].regime;
    CHECK(found[k].on_both && regime.active.size() == 2);
    CHECK(all_slide(regime) == (k == 0));
    for (const ActivePair& active : regime.active) CHECK(active.motion != Motion::down);
  }
}

// A tip behind one edge is outside the object if it is in front of another one, and not beside that.
void test_tip_beside_an_edge() {
  Held held;
  const auto tip = static_cast<std::uint8_t>(1);
  CHECK(held.shapes.surfaces[tip].tip);
  const FeaturePair bottom{PairKind::tip_on_edge, left, tip, 0};
  FeatureContact behind{};
  behind.pair = {PairKind::tip_on_edge, left, tip, 1};
  behind.gap = -0.01;
  held.pose = Pose::of({0.0, 0.0}, 0.0);
  const Corner& corner = held.shapes.body.corners[0];
  Instant now = held.instant(0.0);
  const auto put = [&](double along, double below) {
    Frame& frame = now.frames[left];
    const Vec at{corner.middle.x + along, corner.middle.y - below};
    frame.origin = at - frame.to_world(held.shapes.surfaces[tip].at);
  };
  for (const bool is_beside : {false, true}) {
    put(is_beside ? corner.half_length + 0.01 : 0.01, 0.001);
    CHECK(is_clear(now, {{bottom, false}}, behind) == !is_beside);
    CHECK(!is_clear(now, {}, behind));
  }
}

// A neighbourhood remembers pairs. It finds those that a walk over all pairs finds, wherever palms and
// object move, up to as many as it holds.
void test_neighbourhood_remembers_nothing_wrong() {
  std::mt19937 chance(31);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(chance);
  };
  Held held;
  Model<double> model = held.model;
  Outline<double>& outline = model.outline;
  outline.count = outline.vertices.size();
  for (std::size_t i = 0; i < outline.count; ++i) {  // a round object, each vertex of it an arc
    const double turn = 2 * pi<double> * double(i) / double(outline.count);
    const double x = 0.125 + 0.1 * std::cos(turn);
    outline.vertices[i] = {{x, 0.25 - x}, 0.1 + 0.1 * std::sin(turn), 1e-3};
  }
  held.shapes = shapes_of(model);
  Neighbourhood around;
  int some = 0;
  for (int k = 0; k < 400; ++k) {
    if (k % 20 == 0) held.pose = Pose::of({between(-0.1, 0.1), between(0.0, 0.2)}, between(-1, 1));
    held.pose = Pose::of(held.pose.at + Vec{between(-1e-3, 1e-3), between(-1e-3, 1e-3)},
                         held.pose.angle + between(-0.01, 0.01));
    const Instant now = held.instant(between(-0.002, 0.002));
    const double reach = k % 50 == 49 ? 1.0 : between(0.0, 0.02);
    const double closed = 1e-6;
    NearPairs all;
    each_pair(held.shapes, left,
              [&](FeaturePair pair) { add_near(all, now.contact(pair), reach, closed); });
    const NearPairs found = around.near(now, left, reach, closed);
    CHECK(found.size() == all.size() && (reach < 1.0 || all.full()));
    for (std::size_t i = 0; i < all.size(); ++i)
      CHECK(found[i].pair == all[i].pair && found[i].behind == all[i].behind);
    some += !all.empty() && !all.full() ? 1 : 0;
  }
  CHECK(some > 100);
}

// Two palms approach an object on the floor, 1 mm in each step. After 2.5 mm both tips touch it, at
// one height: nothing can move any more. Robots stall there for the rest of the step.
void test_object_on_the_floor(CarryPhase phase) {
  Held held;
  held.model.surroundings = Surroundings::on_floor(0.3);
  World<double> world(held.model, configuration_of(held.spec, held.model));
  world.set_phase(phase);
  const double angle = 15 * radians_per_degree<double>;
  const double inner = held.model.half_length[left];
  const double high = inner * std::sin(angle) + 0.005;  // the tips are 5 mm above the floor
  const double away = held.model.object.com_left + 0.0025 + inner * std::cos(angle);
  world.put({Vec{-away, high}, Vec{away, high}}, {angle, angle}, Pose::of({0.0, 0.04}, 0.0));
  CHECK(world.check() == DropReason::none || world.check() == DropReason::lifting);
  for (int step = 1; step <= 3; ++step) {
    const auto& done = world.advance({Vec{0.001, 0.0}, Vec{-0.001, 0.0}}, {angle, angle});
    const bool jams = step == 3;
    const bool ends = jams && phase == CarryPhase::by_hand;
    CHECK(done.reason == (ends ? DropReason::jammed : DropReason::none));
    for (const double stalled : {done.stalled[left], done.stalled[right]})
      CHECK(std::abs(stalled - (jams && !ends ? 0.5 : 0.0)) < 1e-6);
    CHECK(std::abs(done.fraction - (step < 3 ? 1.0 : 0.5)) < 1e-6);
    CHECK(done.segments <= 2);
    CHECK(!world.is_touched(left) && !world.is_touched(right) && !world.regime().none());
  }
}

// An object 2 mm above the floor, which nothing holds: it falls if it may.
void test_fall() {
  Held held;
  held.model.surroundings = Surroundings::on_floor(0.3);
  const auto end_in = [&](CarryPhase phase, double most_fall) {
    World<double> world(held.model, configuration_of(held.spec, held.model));
    world.set_phase(phase, most_fall);
    const double away = held.model.object.com_left + 0.3;
    world.put({Vec{-away, 0.3}, Vec{away, 0.3}}, {0.1, 0.1}, Pose::of({0.0, 0.042}, 0.0));
    const Advance<double> done = world.advance({Vec{0.001, 0.0}, Vec{-0.001, 0.0}}, {0.1, 0.1});
    const bool fell = world.fall().has_value();
    CHECK(fell == (done.reason == DropReason::none) && done.fraction == 0.0);
    if (fell) {
      CHECK(std::abs(world.fall()->height - 0.002) < 1e-6);
      CHECK(std::abs(world.fall()->com - 0.002) < 1e-6);
      CHECK(std::abs(world.pose().at.y - 0.04) < 1e-9);
    }
    return done.reason;
  };
  for (const CarryPhase phase : {CarryPhase::low, CarryPhase::by_hand}) {
    CHECK(end_in(phase, 0.003) == DropReason::none);
    CHECK(end_in(phase, 0.001) == DropReason::toppled);
  }
  CHECK(end_in(CarryPhase::carried, 0.003) == DropReason::off_palm);  // its corners are beside them
}

// What rests on its two contact vertices rests nowhere else, however it came there.
void test_two_vertices_after_a_placement() {
  const Held held;
  World<double> world(held.model, configuration_of(held.spec, held.model));
  const PerSide<Vec> pivots{world.pivot(left), world.pivot(right)};
  const PerSide<double> angles{held.world.configuration().palms[left].angle,
                               held.world.configuration().palms[right].angle};
  world.put(pivots, angles, held.pose);
  CHECK(world.advance(-1e-4, angles).reason == DropReason::none);
  CHECK(world.regime().none() && world.is_touched(left) && world.is_touched(right));
  // After a sudden shift no contacts are tied.
  CHECK(world.shift({0.001, 0.001}) == DropReason::none);
  CHECK(world.state().tied == 0.0);
}

// A palm that lies a little deeper in the object than a closed contact is flush with it.
void test_depth_of_a_flush_palm() {
  const Held held;
  const double deep = closed_tolerance<double> * held.model.object.width / 64.0;
  for (const double depth : {0.25 * deep, 4.0 * deep}) {
    Held level;
    for (PalmSpec& palm : level.spec.palms) palm.shallow = palm.steep = 0.0;
    const Model<double> model = model_of<double>(level.spec);
    World<double> world(model, configuration_of(level.spec, model));
    Pose pose = world.pose();
    pose.at.y -= depth;
    world.put({world.pivot(left), world.pivot(right)}, {0.0, 0.0}, pose);
    CHECK((world.check() == DropReason::flush) == (depth > deep));
  }
}

}  // namespace

int main() {
  test_what_holds_the_object();
  test_pairs_of_a_regime();
  test_order_of_the_candidates();
  test_tip_beside_an_edge();
  test_two_vertices_after_a_placement();
  test_depth_of_a_flush_palm();
  test_neighbourhood_remembers_nothing_wrong();
  test_object_on_the_floor(CarryPhase::low);
  test_object_on_the_floor(CarryPhase::by_hand);
  test_fall();
}
