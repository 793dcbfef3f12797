// SPDX-License-Identifier: Apache-2.0
// The conditions under which a regime (world/contact_regime.hpp) holds at one instant. Each is a
// number that is ≥ 0 while it holds, so that the first instant at which it fails is a root:
//
//   balance   the least share of a force, in the combination of forces that balances best;
//   limits    the forces of the robots, and the speed of one that stalls (world/force_limits.hpp);
//   slides    the speed of each sliding contact in its direction;
//   features  how far each contact is inside the features that touch;
//   corners   how far each contact corner is inside the part of its palm that may be used, or above
//             the palm;
//   gaps      those of pairs near by.
#pragma once

#include <algorithm>

#include "palmbots/world/contact_shapes.hpp"
#include "palmbots/world/regime_equations.hpp"

namespace palmbots {

// Tolerances, far below anything that is measured and above rounding. Gaps are in sizes of the
// object.
struct ContactTolerance {
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();
  static constexpr double gap = 64.0 * epsilon;
  static constexpr double closed = 2e5 * epsilon;    // counts as closed at an event
  static constexpr double inside = 128.0 * epsilon;  // [m], or the sine of an angle
  static constexpr double blank = 1e-9;
  static constexpr double force = 1e-10;         // [weights]
  static constexpr double instant = 1e-13;       // of a step
  static constexpr double jump = 1e-6;           // of the size of the object
  static constexpr double rate = 1e-9;           // of the pace
  static constexpr double balanced_rate = 1e-6;  // the same, where balance takes part
};

inline constexpr std::size_t most_near = 64;

// A pair of features that may close soon. One that overlaps is behind: it was not a pair of nearest
// points when its gap closed. (Surfaces have one side only.)
struct NearPair {
  FeaturePair pair;
  bool behind;
};

struct NearPairs {
  std::array<NearPair, most_near> at;  // up to `count`
  std::size_t count = 0;
};

// Calls visit(pair) for every pair of features that can touch. Those of a palm are walked from its
// own contact corner inward, those of the ground as those of the palm that comes `first`: in the
// mirror it is the same walk.
template <class Visit>
void each_pair(const ContactProblem& problem, std::size_t first, Visit visit) {
  const RoundedBody& body = problem.shapes.body;
  const Surfaces& surfaces = problem.shapes.surfaces;
  for (std::size_t i = 0; i < surfaces.count; ++i) {
    const std::size_t s = surfaces.walked(first, i);
    const Surface& surface = surfaces.at[s];
    const auto carrier = static_cast<std::size_t>(surface.carrier);
    const std::size_t side = carrier < 2 ? carrier : first;
    std::size_t corner = problem.shapes.own[side].feature;
    for (std::size_t k = 0; k < body.count; ++k) {
      const std::size_t edge = side == left ? corner : body.before(corner);
      const auto pair = [&](PairKind kind, std::size_t feature) {
        return FeaturePair{kind, static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(feature)};
      };
      if (surface.tip) {
        if (!body.is_disc()) visit(pair(PairKind::tip_on_edge, edge));
        if (body.corners[corner].radius > 0.0) visit(pair(PairKind::tip_on_arc, corner));
      } else if (body.corners[corner].convex) {
        visit(pair(PairKind::corner_on_face, corner));
      }
      corner = side == left ? body.after(corner) : body.before(corner);
    }
  }
}

// Adds a pair if its gap is at most `reach` [m]. A pair that overlaps by more than `closed` [m] is
// marked as behind.
inline void add_near(NearPairs& found, FeaturePair pair, const FeatureContact& c, double reach,
                     double closed) {
  if (!(magnitude(c.gap) <= reach)) return;
  const bool behind = c.gap < -closed;
  if (behind && c.inside > ContactTolerance::blank) return;
  if (found.count < most_near) found.at[found.count++] = {pair, behind};
}

// Finds the near pairs repeatedly while object and surfaces move. It remembers the pairs of a wider
// neighbourhood, so that most calls compute the gaps of only these.
class Neighbourhood {
 public:
  NearPairs near(const ContactProblem& problem, std::size_t first, const Frames& frames,
                 const Pose& pose, double reach, double closed) {
    if (first != first_ || !(reach + moved(frames, pose) <= reach_))
      collect(problem, first, frames, pose, reach);
    NearPairs found;
    for (std::size_t k = 0; k < count_; ++k)
      add_near(found, pairs_[k], problem.contact(frames, pose, pairs_[k]), reach, closed);
    return found;
  }

 private:
  void collect(const ContactProblem& problem, std::size_t first, const Frames& frames,
               const Pose& pose, double reach) {
    constexpr double ahead = 3.0;  // larger: more pairs, collected less often
    reach_ = ahead * reach;
    first_ = first;
    frames_ = frames;
    pose_ = pose;
    count_ = 0;
    extent_ = reach;
    for (std::size_t i = 0; i < problem.shapes.body.count; ++i)
      extent_ = larger(extent_, length(problem.shapes.body.corners[i].centre));
    double palm = 0.0;
    for (std::size_t s = 0; s < problem.shapes.surfaces.count; ++s) {
      const Surface& surface = problem.shapes.surfaces.at[s];
      const double end = larger(magnitude(surface.low), magnitude(surface.high));
      if (surface.carrier != Carrier::ground) palm = larger(palm, length(surface.at) + end);
    }
    extent_ += palm;
    each_pair(problem, first, [&](FeaturePair pair) {
      if (magnitude(problem.contact(frames, pose, pair).gap) <= reach_) pairs_[count_++] = pair;
    });
  }

  // Upper bound of the distance by which any two near points have approached each other since the
  // pairs were collected [m].
  double moved(const Frames& frames, const Pose& pose) const {
    double most = 0.0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      most = larger(most, length(frames[i].origin - frames_[i].origin) +
                              magnitude(frames[i].angle - frames_[i].angle) * extent_);
    }
    return most + length(pose.at - pose_.at) + magnitude(pose.angle - pose_.angle) * extent_;
  }

  std::array<FeaturePair, 2 * max_surfaces * max_outline> pairs_;  // there are no more
  std::size_t count_ = 0;
  std::size_t first_ = 2;  // no side: nothing is collected yet
  double reach_ = -1.0;
  // The farthest point of the object from its COM, plus that of the palms from their pivots [m].
  double extent_ = 0.0;
  Frames frames_{};
  Pose pose_{};
};

struct Conditions {
  static constexpr std::size_t most = 2 * max_supports + most_near + 8;
  std::array<double, most> value;  // up to `count`
  std::size_t count = 0;
  std::size_t of_motion = 0;  // the first of them: they depend on how the surfaces move
  bool settled = true;

  static constexpr double behind = -1.0;  // the value of a pair that is behind where it can touch
  static constexpr double rounding = 8.0 * ContactTolerance::epsilon;
  static constexpr double met = 1.0;  // that of a condition without a measure

  void add(double v) { value[count++] = v; }
  // Adds the next `n` conditions as met where none of them fails in `elsewhere`, conditions of the
  // same regime. False: they have to be evaluated.
  bool skips(const Conditions* elsewhere, std::size_t n = 1) {
    if (elsewhere == nullptr) return false;
    const auto begin = elsewhere->value.begin() + count;
    if (std::any_of(begin, begin + n, [](double v) { return v < 0.0; })) return false;
    std::fill_n(value.begin() + count, n, met);
    count += n;
    return true;
  }
  // Takes pairs that are behind as met if another condition fails. False: none does.
  bool spare_behind() {
    const auto fails = [](double v) { return v < 0.0 && v != behind; };
    if (!std::any_of(value.begin(), value.begin() + count, fails)) return false;
    std::replace(value.begin(), value.begin() + count, behind, met);
    return true;
  }
  // Whether all hold. One that an event leaves at 0 may fall below it by rounding.
  bool hold() const { return least() >= -rounding; }
  // The worst of them; negative where one fails or the object cannot be there.
  double least() const {
    if (!settled) return -1.0;
    double worst = value[0];
    for (std::size_t i = 1; i < count; ++i) worst = smaller(worst, value[i]);
    return worst;
  }
};

// ≥ 0 iff the rays contain the weight: the best, over all combinations, of the least share of a ray.
inline double balance(const Rays& rays, Triple weight) {
  double best = -1.0;
  for_each_combination(rays, weight,
                       [&](const RayShares& shares) { best = larger(best, shares.least()); });
  return best;
}

// Whether a pair that is behind is apart. A sharp corner below a face is if its edges pass the end of
// the face. A tip behind an edge is if it is nearer to another edge and in front of that.
inline bool is_clear(const ContactProblem& problem, const Frames& frames, const Pose& pose,
                     const NearPairs& near, FeaturePair behind, double gap) {
  if (behind.kind == PairKind::corner_on_face) {
    if (problem.shapes.body.corners[behind.feature].radius > 0.0) return false;
    const double deep = ContactTolerance::blank * problem.shapes.size;
    return !is_pierced(problem.shapes.body, pose, frames[problem.carrier(behind)],
                       problem.surface(behind), deep);
  }
  for (std::size_t k = 0; k < near.count; ++k) {
    const FeaturePair pair = near.at[k].pair;
    if (pair.surface != behind.surface || pair.kind != PairKind::tip_on_edge) continue;
    const FeatureContact c = problem.contact(frames, pose, pair);
    const bool beside = magnitude(c.place) > problem.shapes.body.corners[pair.feature].half_length;
    if (!beside && c.gap > 0.5 * gap) return true;
  }
  return false;
}

// Adds those of robots with limits. `speed` is that of one that yields; it is known to `slack`, as a
// share of the pace.
inline void add_limits(Conditions& all, const ContactProblem& problem, const Regime& regime,
                       const ActiveContacts& contacts, double speed, double slack, double pace) {
  using Tolerance = ContactTolerance;
  const BalancedForces forces(problem, regime, contacts, Tolerance::force);
  all.add(Tolerance::force - forces.least_excess());
  if (!regime.stalls()) return;
  double most = -1.0;
  for (const std::size_t side : {left, right}) {
    const double commanded = problem.commanded[side];
    const double sense = commanded < 0.0 ? -1.0 : 1.0;
    if (regime.drives[side] != Drive::as_commanded)
      most = larger(most, forces.most_push(side, sense));
    if (regime.drives[side] != Drive::yields) continue;
    all.add(sense * speed / pace + slack);
    all.add(sense * (commanded - speed) / pace + slack);
  }
  all.add(most + 10.0 * Tolerance::force);
}

// The conditions that depend on how the surfaces move, but for balance: limits and slides. `twist`
// holds the regime's rate equations; `pace` bounds how far a point of a surface moves in the step [m].
inline void add_motion(Conditions& all, const ContactProblem& problem, const Regime& regime,
                       const Frames& frames, const Pose& pose, const ActiveContacts& contacts,
                       const detail::RegimeEquations& twist, double pace) {
  using Tolerance = ContactTolerance;
  const auto moves = twist.system.solution();
  const double least = twist.balance ? Tolerance::balanced_rate : Tolerance::rate;
  if (problem.is_limited()) add_limits(all, problem, regime, contacts, moves[3], least, pace);
  for (std::size_t i = 0; i < regime.count; ++i) {
    const ActivePair& a = regime.active[i];
    if (a.motion == Motion::stick) continue;
    const FeatureContact& c = contacts[i];
    const std::size_t carrier = problem.carrier(a.pair);
    const bool yields = carrier < 2 && regime.drives[carrier] == Drive::yields;
    const double speed = dot(problem.row(c, c.tangent), {moves[0], moves[1], moves[2]}) -
                         problem.given(frames, pose, a.pair, c, c.tangent) -
                         (yields ? c.tangent.x * moves[3] : 0.0);
    all.add(double(static_cast<int>(a.motion)) * speed / pace + least);
  }
}

// Whether the forces of the regime balance.
inline double balance_of(const ContactProblem& problem, const Regime& regime,
                         const ActiveContacts& contacts) {
  return balance(rays_of(problem, regime, contacts), problem.weight(regime.pushed)) +
         ContactTolerance::force;
}

// All conditions of a regime in a pose, or (not `all`) those up to some that fail. With `failing`, the
// conditions of the same regime elsewhere, only those that fail there are evaluated; the others count
// as met.
inline Conditions conditions_of(const ContactProblem& problem, const Regime& regime,
                                const Frames& frames, const Pose& pose,
                                const ActiveContacts& contacts, const NearPairs& near, double pace,
                                const Conditions* failing = nullptr, bool all_of_them = true) {
  using Tolerance = ContactTolerance;
  Conditions all;
  if (!all.skips(failing)) all.add(balance_of(problem, regime, contacts));
  if (!all.skips(failing, failing == nullptr ? 0 : failing->of_motion - 1)) {
    add_motion(all, problem, regime, frames, pose, contacts,
               detail::equations(problem, regime, frames, pose, contacts, true), pace);
  }
  all.of_motion = all.count;
  if (!all_of_them && !all.hold()) return all;
  for (std::size_t i = 0; i < regime.count; ++i) {
    all.add(contacts[i].inside + Tolerance::inside);
  }
  if (problem.on_both) {
    for (const FeaturePair pair : problem.shapes.own) {
      if (all.skips(failing)) continue;
      const FeatureContact c = problem.contact(frames, pose, pair);
      const double above = c.gap / problem.shapes.size - Tolerance::gap;
      all.add(larger(problem.left_of_reach(problem.carrier(pair), c), above) + Tolerance::inside);
    }
  }
  for (std::size_t k = 0; k < near.count; ++k) {
    const NearPair& n = near.at[k];
    if (regime.has(n.pair) || all.skips(failing)) continue;
    const FeatureContact c = problem.contact(frames, pose, n.pair);
    const double gap = c.gap / problem.shapes.size + Tolerance::gap;
    if (n.behind) {  // if it can touch now, another pair has closed in between
      const bool sunk = c.inside > Tolerance::blank && gap < 0.0 &&
                        !is_clear(problem, frames, pose, near, n.pair, c.gap);
      all.add(sunk ? Conditions::behind : Conditions::met);
    } else {
      all.add(c.inside < -Tolerance::inside ? Conditions::met : gap);
    }
  }
  return all;
}

}  // namespace palmbots
