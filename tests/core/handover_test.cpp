// The common step of the world, ties on its way included, against the world taking the same step apart, and
// in lanes against itself alone.
#include "palmbots/handover.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>

#include "check.hpp"
#include "palmbots/lanes.hpp"
#include "palmbots/setup.hpp"
#include "palmbots/world.hpp"
#include "paper_spec.hpp"

namespace {

using namespace palmbots;

double uniform(double from, double to) {
  static std::uint64_t state = 1;
  state = state * 6364136223846793005 + 1442695040888963407;
  return from + (to - from) * (double(state >> 11) / 9007199254740992.0);
}

template <class Real>
bool same_bits(const Pose<Real>& a, const Pose<Real>& b) {
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

// Near the push under which both contacts let go at once, and near the change at which the palms' turning
// drives them neither together nor apart, all kinds of things happen.
template <class Real>
Real near_tie(const Fixture<Real>& fixture, const Stance<Real>& s, Span<Real> span, Real way) {
  const auto edges = edges_at(fixture.friction, s.palms, way);
  const auto behind = [&](Real push) {
    return tie(moments_under(fixture.load, push), edges[left], edges[right]).at(span);
  };
  const Real slope = behind(Real(1)) - behind(Real(0));
  const Real at_once = -behind(Real(0)) / slope;
  return at_once + Real(uniform(-1, 1) * std::pow(10, uniform(-6, -2)));
}

// How many steps were like that.
struct Seen {
  int common = 0;
  int handed_over = 0;
  int missed = 0;  // handed over all the same, when taken apart
  int otherwise = 0;
};

// Steps side by side, in lanes: both halves, from one place to another.
template <class Real>
class SideBySide {
 public:
  // A step, and what came of it by itself.
  void add(const Fixture<Real>& fixture, const Pose<Real>& before, Real change,
           const PerSide<Real>& angles, Real push, const Pose<Real>& after,
           const Stride<Real>& step) {
    put_lane(fixture_, lane_, fixture);
    put_lane(from_, lane_, static_cast<const Place<Real>&>(before));
    put_lane(sliding_, lane_, static_cast<const Sliding<Real>&>(before));
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
    Place<V> to{};
    to.stance.lift = from_.stance.lift;
    Stride<V> step{};
    stride<V>(fixture_, from_, sliding_, to, change_, angles_, push_, step);
    finish_stride<V>(fixture_, from_, sliding_, to, change_, step);
    for (int l = 0; l < n; ++l) {
      const Stride<Real>& alone = steps_[static_cast<std::size_t>(l)];
      const Pose<Real> after{take_lane(to, l), take_lane(sliding_, l)};
      CHECK(same_bits(after, after_[static_cast<std::size_t>(l)]));
      const auto is = [&](const MaskOf<V>& mask) { return (mask.bits() >> l & 1) != 0; };
      CHECK(is(step.done) == alone.done);
      if (!alone.done) continue;
      CHECK(is(step.handed_over) == alone.handed_over && is(step.on_left) == alone.on_left &&
            is(step.closing) == alone.closing);
    }
  }

  int lane_ = 0;
  Fixture<V> fixture_{};
  Place<V> from_{};
  Sliding<V> sliding_{};
  V change_;
  PerSide<V> angles_{};
  V push_;
  std::array<Pose<Real>, static_cast<std::size_t>(n)> after_{};
  std::array<Stride<Real>, static_cast<std::size_t>(n)> steps_{};
};

template <class Real>
void test_a_step(Near near, Seen& seen, SideBySide<Real>& side_by_side) {
  const Rig<Real> rig = rig_of<Real>(any_spec(near));
  const Fixture<Real>& fixture = rig;
  const bool coarse = chance(0.3);
  const double degree = radians_per_degree<double>;
  Stance<Real> stance{};
  PerSide<Real> angles{};
  PerSide<Real> turn{};
  for (const std::size_t side : {left, right}) {
    stance.palms[side] = PalmAngle<Real>::at(Real(uniform(5, 15) * degree));
    const double end = rig.half_length[side] - uniform(0, 2e-4);
    const bool at_end = chance(0.1);
    stance.contacts[side] = Real(at_end ? (chance(0.5) ? end : -end) : uniform(-0.03, 0.03));
    const double by = coarse ? uniform(-1.1, 1.1) : (chance(0.5) ? 0.5 : -0.5);
    const Real angle = stance.palms[side].angle;
    angles[side] = chance(0.4) ? angle : angle + Real(by * degree);
    turn[side] = angles[side] - angle;
  }
  stance.separation = closing_separation(stance, rig.offset, rig.load.width);
  const Span<Real> from = span(stance, rig.offset);
  auto change = Real(uniform(-1, 1) * (coarse ? 2e-3 : 2e-4));
  const auto drive = [&](Real by) {
    return drive_rate(stance.palms, stance.contacts, rig.offset, from, by, turn);
  };
  if (chance(0.4)) change = -drive(Real(0)) / from.dx + Real(uniform(-1, 1) * 5e-6);
  if (near == Near::standing && chance(0.2)) {
    change = Real(0);
    turn = {};
    for (const std::size_t side : {left, right}) angles[side] = stance.palms[side].angle;
  }
  const Real push = near_tie(fixture, stance, from, drive(change) < Real(0) ? Real(1) : Real(-1));
  const auto tied = Real(chance(0.1) ? (chance(0.5) ? -1 : 1) : 0);
  const Pose<Real> before{{stance, from}, {chance(0.5) ? push : Real(0), tied, Real(0)}};

  Pose<Real> pose = before;
  const Stride<Real> step = stride(fixture, pose, change, angles, push);
  side_by_side.add(fixture, before, change, angles, push, pose, step);
  Pose<Real> apart = before;
  if (apart.push != push) apart.tied = Real(0);
  apart.push = push;
  const Pose<Real> begun = apart;
  const Advance<Real> advance = Pieces<Real>{rig, apart, change, angles}.run();
  if (!step.done) {
    CHECK(same_bits(pose, begun));
    const Slide way = step.closing ? Slide::up : Slide::down;
    const bool hands_over = advance.pieces == 2 && advance.end == End::none &&
                            begun.tied == Real(0) && !coarse &&
                            ((advance.motion[left] == way) != (advance.motion[right] == way)) &&
                            std::abs(apart.stance.contacts[left]) < rig.safe_reach &&
                            std::abs(apart.stance.contacts[right]) < rig.safe_reach;
    (hands_over ? seen.missed : seen.otherwise) += 1;
    return;
  }
  (step.handed_over ? seen.handed_over : seen.common) += 1;
  CHECK(same_bits(pose, apart));
  CHECK(advance.end == End::none && advance.fraction == Real(1));
  CHECK(advance.pieces == (step.handed_over ? 2 : 1));
  const std::size_t side = step.on_left ? left : right;
  CHECK(advance.motion[side] == (step.closing ? Slide::up : Slide::down));
  CHECK(advance.motion[other(side)] == Slide::stick);
  if (before.push != Real(0) || tied != Real(0)) return;
  World<Real> world(rig, stance);
  const Advance<Real>& told = world.advance(change, angles, push);
  CHECK(same_bits(world.pose(), apart));
  CHECK(told.end == advance.end && told.fraction == advance.fraction);
  CHECK(told.motion == advance.motion && told.pieces == advance.pieces);
}

template <class Real>
void test_all(int steps) {
  for (const Near near : {Near::ties, Near::wedges, Near::slipping, Near::standing}) {
    Seen seen;
    SideBySide<Real> side_by_side;
    for (int i = 0; i < steps; ++i) test_a_step<Real>(near, seen, side_by_side);
    if (near != Near::ties) continue;
    CHECK(seen.common > steps / 4 && seen.handed_over > steps / 20);
    CHECK(seen.missed <= seen.handed_over / 4 && seen.otherwise > steps / 100);
  }
}

}  // namespace

int main() {
  test_all<double>(100000);
  test_all<float>(100000);
}
