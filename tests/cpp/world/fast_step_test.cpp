// SPDX-License-Identifier: Apache-2.0
// The fast step of the world, ties on its way included, against the general step, and in lanes
// against itself alone.
//
// fast_step_test [STEPS]   STEPS: random steps of each kind and precision; 30000 if not given
#include "palmbots/world/fast_step.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/world/quasistatic_world.hpp"
#include "support/check.hpp"
#include "support/paper_spec.hpp"

namespace {

using namespace palmbots;

double uniform(double from, double to) {
  static std::uint64_t state = 1;
  state = state * 6364136223846793005 + 1442695040888963407;
  return from + (to - from) * (double(state >> 11) / 9007199254740992.0);
}

template <class Real>
bool same_bits(const WorldState<Real>& a, const WorldState<Real>& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool chance(double share) { return uniform(0, 1) < share; }

// What steps are made near to.
enum class Near {
  ties,
  wedges,    // edges that wedge within the step
  slipping,  // palms so slippery that hardly any squeeze holds the object, looked at every time
  standing,  // steps in which nothing moves
};

Spec any_spec(Near near) {
  Spec spec = paper_spec();
  // The larger ones hold for what is made here; beyond the largest contacts are off their palms.
  const double end = 0.5 * spec.palms[left].length;
  spec.safe_reach = chance(0.2) ? end : (chance(0.5) ? 0.037 : 0.015);
  spec.com_height = uniform(0.01, 0.08);
  if (chance(0.5)) {
    spec.com_left = uniform(0.1, 0.15);
    spec.com_right = spec.width - spec.com_left;
  }
  for (PalmSpec& palm : spec.palms) {
    if (chance(0.5)) palm.friction = uniform(0.1, 0.6);
    if (chance(0.1)) palm.friction = uniform(2, 10);  // wedges
    if (chance(0.3)) palm.offset = uniform(-0.01, 0.01);
    // An edge is upright at that angle.
    const double upright = (90 - uniform(4, 16)) * radians_per_degree<double>;
    if (near == Near::wedges && chance(0.5)) palm.friction = std::tan(upright);
    if (near == Near::slipping) palm.friction = uniform(0, 0.12);
  }
  if (near == Near::slipping) spec.safe_reach = -1;
  return spec;
}

// Near the push under which both contacts let go at once, and near the change at which the palms'
// turning drives them neither together nor apart, all kinds of things happen.
template <class Real>
Real near_tie(const ModelParams<Real>& params, const Configuration<Real>& s,
              ContactVector<Real> contact_vector, Real way) {
  const auto edges = edges_at(params.friction, s.palms, way);
  const auto behind = [&](Real push) {
    return slip_order(moments_under(params.object, push), edges[left], edges[right])
        .at(contact_vector);
  };
  const Real slope = behind(Real(1)) - behind(Real(0));
  const Real at_once = -behind(Real(0)) / slope;
  return at_once + Real(uniform(-1, 1) * std::pow(10, uniform(-6, -2)));
}

// How many steps were like that.
struct Seen {
  int common = 0;
  int switched = 0;
  int missed = 0;  // handed over all the same, when taken apart
  int otherwise = 0;
};

// Steps side by side, in lanes: both halves, from one place to another.
template <class Real>
class SideBySide {
 public:
  // A step, and what came of it by itself.
  void add(const ModelParams<Real>& params, const WorldState<Real>& before, Real change,
           const PerSide<Real>& angles, Real push, const WorldState<Real>& after,
           const FastStep<Real>& step) {
    put_lane(params_, lane_, params);
    put_lane(from_, lane_, static_cast<const Kinematics<Real>&>(before));
    put_lane(slip_, lane_, static_cast<const SlipState<Real>&>(before));
    change_.raw[lane_] = change;
    for (const std::size_t side : {left, right}) angles_[side].raw[lane_] = angles[side];
    push_.raw[lane_] = push;
    after_[static_cast<std::size_t>(lane_)] = after;
    steps_[static_cast<std::size_t>(lane_)] = step;
    if (++lane_ < n) return;
    lane_ = 0;
    compare();
  }

 private:
  static constexpr int n = register_bytes / static_cast<int>(sizeof(Real));
  using V = Lanes<Real, n>;

  void compare() {
    Kinematics<V> to{};
    to.configuration.lift = from_.configuration.lift;
    FastStep<V> step{};
    step_fast<V>(params_, from_, slip_, to, change_, angles_, push_, step);
    finish_fast<V>(params_, from_, slip_, to, change_, step);
    for (int l = 0; l < n; ++l) {
      const FastStep<Real>& alone = steps_[static_cast<std::size_t>(l)];
      const WorldState<Real> after{take_lane(to, l), take_lane(slip_, l)};
      CHECK(same_bits(after, after_[static_cast<std::size_t>(l)]));
      const auto is = [&](const MaskOf<V>& mask) { return (mask.bits() >> l & 1) != 0; };
      CHECK(is(step.done) == alone.done);
      if (!alone.done) continue;
      CHECK(is(step.switched) == alone.switched && is(step.on_left) == alone.on_left &&
            is(step.closing) == alone.closing);
    }
  }

  int lane_ = 0;
  ModelParams<V> params_{};
  Kinematics<V> from_{};
  SlipState<V> slip_{};
  V change_;
  PerSide<V> angles_{};
  V push_;
  std::array<WorldState<Real>, static_cast<std::size_t>(n)> after_{};
  std::array<FastStep<Real>, static_cast<std::size_t>(n)> steps_{};
};

template <class Real>
void test_a_step(Near near, Seen& seen, SideBySide<Real>& side_by_side) {
  const Model<Real> model = model_of<Real>(any_spec(near));
  const ModelParams<Real>& params = model;
  const bool coarse = chance(0.3);
  const double degree = radians_per_degree<double>;
  Configuration<Real> configuration{};
  PerSide<Real> angles{};
  PerSide<Real> turn{};
  for (const std::size_t side : {left, right}) {
    configuration.palms[side] = PalmAngle<Real>::at(Real(uniform(5, 15) * degree));
    const double end = model.half_length[side] - uniform(0, 2e-4);
    const bool at_end = chance(0.1);
    configuration.contacts[side] = Real(at_end ? (chance(0.5) ? end : -end) : uniform(-0.03, 0.03));
    const double by = coarse ? uniform(-1.1, 1.1) : (chance(0.5) ? 0.5 : -0.5);
    const Real angle = configuration.palms[side].angle;
    angles[side] = chance(0.4) ? angle : angle + Real(by * degree);
    turn[side] = angles[side] - angle;
  }
  configuration.separation = closing_separation(configuration, model.offset, model.object.width);
  const ContactVector<Real> from = contact_vector(configuration, model.offset);
  auto change = Real(uniform(-1, 1) * (coarse ? 2e-3 : 2e-4));
  const auto drive = [&](Real by) {
    return drive_rate(configuration.palms, configuration.contacts, model.offset, from, by, turn);
  };
  if (chance(0.4)) change = -drive(Real(0)) / from.dx + Real(uniform(-1, 1) * 5e-6);
  if (near == Near::standing && chance(0.2)) {
    change = Real(0);
    turn = {};
    for (const std::size_t side : {left, right}) angles[side] = configuration.palms[side].angle;
  }
  const Real push =
      near_tie(params, configuration, from, drive(change) < Real(0) ? Real(1) : Real(-1));
  const auto tied = Real(chance(0.1) ? (chance(0.5) ? -1 : 1) : 0);
  const WorldState<Real> before{{configuration, from},
                                {chance(0.5) ? push : Real(0), tied, Real(0)}};

  WorldState<Real> state = before;
  const FastStep<Real> step = step_fast(params, state, change, angles, push);
  side_by_side.add(params, before, change, angles, push, state, step);
  WorldState<Real> apart = before;
  if (apart.push != push) apart.tied = Real(0);
  apart.push = push;
  const WorldState<Real> begun = apart;
  const Advance<Real> advance = GeneralStep<Real>{model, apart, change, angles}.run();
  if (!step.done) {
    CHECK(same_bits(state, begun));
    const SlipDirection way = step.closing ? SlipDirection::up : SlipDirection::down;
    const bool hands_over = advance.segments == 2 && advance.reason == DropReason::none &&
                            begun.tied == Real(0) && !coarse &&
                            ((advance.motion[left] == way) != (advance.motion[right] == way)) &&
                            std::abs(apart.configuration.contacts[left]) < model.safe_reach &&
                            std::abs(apart.configuration.contacts[right]) < model.safe_reach;
    (hands_over ? seen.missed : seen.otherwise) += 1;
    return;
  }
  (step.switched ? seen.switched : seen.common) += 1;
  CHECK(same_bits(state, apart));
  CHECK(advance.reason == DropReason::none && advance.fraction == Real(1));
  CHECK(advance.segments == (step.switched ? 2 : 1));
  const std::size_t side = step.on_left ? left : right;
  CHECK(advance.motion[side] == (step.closing ? SlipDirection::up : SlipDirection::down));
  CHECK(advance.motion[other(side)] == SlipDirection::stick);
  if (before.push != Real(0) || tied != Real(0)) return;
  World<Real> world(model, configuration);
  const Advance<Real>& result = world.advance(change, angles, push);
  CHECK(same_bits(world.state(), apart));
  CHECK(result.reason == advance.reason && result.fraction == advance.fraction);
  CHECK(result.motion == advance.motion && result.segments == advance.segments);
}

template <class Real>
void test_all(int steps) {
  for (const Near near : {Near::ties, Near::wedges, Near::slipping, Near::standing}) {
    Seen seen;
    SideBySide<Real> side_by_side;
    for (int i = 0; i < steps; ++i) test_a_step<Real>(near, seen, side_by_side);
    if (near != Near::ties) continue;
    CHECK(seen.common > steps / 4 && seen.switched > steps / 20);
    CHECK(seen.missed <= seen.switched / 4 && seen.otherwise > steps / 100);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 10000;
  test_all<double>(steps);
  test_all<float>(steps);
}
