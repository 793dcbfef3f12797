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
struct Tolerance {
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

// A pair of features that may close soon. One that overlaps is behind: it was not a pair of nearest
// points when its gap closed. (Surfaces have one side only.)
struct NearPair {
  FeaturePair pair;
  bool behind;
};

using NearPairs = FixedList<NearPair, 64>;

// Calls visit(pair) for every pair of features that can touch. Those of a palm are walked from its
// own contact corner inward, those of the ground as those of the palm that comes `first`: in the
// mirror it is the same walk.
template <class Visit>
void each_pair(const ContactShapes& shapes, std::size_t first, Visit visit) {
  const RoundedBody& body = shapes.body;
  const Surfaces& surfaces = shapes.surfaces;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const std::size_t s = surfaces.walked(first, i);
    const Surface& surface = surfaces[s];
    const auto carrier = static_cast<std::size_t>(surface.carrier);
    const std::size_t side = carrier < 2 ? carrier : first;
    std::size_t corner = shapes.own[side].feature;
    for (std::size_t k = 0; k < body.count; ++k) {
      const std::size_t edge = side == left ? corner : body.before(corner);
      const auto pair = [&](PairKind kind, std::size_t feature) {
        return FeaturePair{kind, std::uint8_t(carrier), std::uint8_t(s), std::uint8_t(feature)};
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
inline void add_near(NearPairs& found, const FeatureContact& c, double reach, double closed) {
  if (found.full() || !(magnitude(c.gap) <= reach)) return;
  const bool behind = c.gap < -closed;
  if (!behind || !(c.inside > Tolerance::blank)) found.push_back({c.pair, behind});
}

// Finds the near pairs repeatedly while object and surfaces move. It remembers the pairs of a wider
// neighbourhood, so that most calls compute the gaps of only these.
class Neighbourhood {
 public:
  NearPairs near(const Instant& at, std::size_t first, double reach, double closed) {
    if (first != first_ || !(reach + moved(at) <= reach_)) collect(at, first, reach);
    NearPairs found;
    for (const FeaturePair pair : pairs_) add_near(found, at.contact(pair), reach, closed);
    return found;
  }

 private:
  void collect(const Instant& at, std::size_t first, double reach) {
    const ContactShapes& shapes = at.problem.shapes;
    constexpr double ahead = 3.0;  // larger: more pairs, collected less often
    reach_ = ahead * reach;
    first_ = first;
    frames_ = at.frames;
    pose_ = at.pose;
    extent_ = reach;
    for (std::size_t i = 0; i < shapes.body.count; ++i)
      extent_ = larger(extent_, length(shapes.body.corners[i].centre));
    double palm = 0.0;
    for (const Surface& surface : shapes.surfaces) {
      const double end = larger(magnitude(surface.low), magnitude(surface.high));
      if (surface.carrier != Carrier::ground) palm = larger(palm, length(surface.at) + end);
    }
    extent_ += palm;
    pairs_.clear();
    each_pair(shapes, first, [&](FeaturePair pair) {
      if (magnitude(at.contact(pair).gap) <= reach_) pairs_.push_back(pair);
    });
  }

  // Upper bound of the distance by which any two near points have approached each other since the
  // pairs were collected [m].
  double moved(const Instant& at) const {
    double most = 0.0;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const Frame& frame = at.frames[i];
      most = larger(most, length(frame.origin - frames_[i].origin) +
                              magnitude(frame.angle - frames_[i].angle) * extent_);
    }
    return most + length(at.pose.at - pose_.at) + magnitude(at.pose.angle - pose_.angle) * extent_;
  }

  FixedList<FeaturePair, 2 * max_surfaces * max_outline> pairs_;  // there are no more
  std::size_t first_ = 2;  // no side: nothing is collected yet
  double reach_ = -1.0;
  // The farthest point of the object from its COM, plus that of the palms from their pivots [m].
  double extent_ = 0.0;
  Frames frames_{};
  Pose pose_{};
};

struct Conditions : FixedList<double, 2 * max_supports + NearPairs::capacity + 8> {
  std::size_t of_motion = 0;  // the first of them: they depend on how the surfaces move
  bool settled = true;

  static constexpr double behind = -1.0;  // the value of a pair that is behind where it can touch
  static constexpr double rounding = 8.0 * Tolerance::epsilon;
  static constexpr double met = 1.0;  // that of a condition without a measure

  // Adds the next `n` conditions as met where none of them fails in `elsewhere`, conditions of the
  // same regime. False: they have to be evaluated.
  bool skips(const Conditions* elsewhere, std::size_t n = 1) {
    if (elsewhere == nullptr) return false;
    const double* next = elsewhere->begin() + size();
    if (std::any_of(next, next + n, [](double v) { return v < 0.0; })) return false;
    for (std::size_t k = 0; k < n; ++k) push_back(met);
    return true;
  }
  // Takes pairs that are behind as met if another condition fails. False: none does.
  bool spare_behind() {
    const auto fails = [](double v) { return v < 0.0 && v != behind; };
    if (std::ranges::none_of(*this, fails)) return false;
    std::ranges::replace(*this, behind, met);
    return true;
  }
  // Whether all hold. One that an event leaves at 0 may fall below it by rounding.
  bool hold() const { return least() >= -rounding; }
  // The worst of them; negative where one fails or the object cannot be there.
  double least() const {
    double worst = settled ? (*this)[0] : -1.0;
    for (std::size_t k = 1; settled && k < size(); ++k) worst = smaller(worst, (*this)[k]);
    return worst;
  }
};

// Whether a pair that is behind is apart. A sharp corner below a face is if its edges pass the end of
// the face. A tip behind an edge is if it is nearer to another edge and in front of that.
inline bool is_clear(const Instant& at, const NearPairs& near, const FeatureContact& behind) {
  const ContactShapes& shapes = at.problem.shapes;
  const Surface& surface = at.problem.surface(behind.pair);
  if (behind.pair.kind == PairKind::corner_on_face)
    return !(shapes.body.corners[behind.pair.feature].radius > 0.0) &&
           !is_pierced(at, surface, Tolerance::blank * shapes.size);
  return std::ranges::any_of(near, [&](const NearPair& one) {
    const FeaturePair pair = one.pair;
    if (pair.surface != behind.pair.surface || pair.kind != PairKind::tip_on_edge) return false;
    const FeatureContact c = at.contact(pair);
    const bool beside = magnitude(c.place) > shapes.body.corners[pair.feature].half_length;
    return !beside && c.gap > 0.5 * behind.gap;
  });
}

// ≥ 0 iff the forces of the regime balance: the best, over all combinations, of the least share of a
// force.
inline double balance_of(const PosedRegime& at) {
  return best_least_share(at.rays(), at.weight()) + Tolerance::force;
}

// Adds those of the forces of robots with limits.
inline void add_limits(Conditions& all, const PosedRegime& at) {
  const BalancedForces forces(at, Tolerance::force);
  all.push_back(Tolerance::force - forces.least_excess());
  if (!at.regime.stalls()) return;
  double most = -1.0;
  for (const std::size_t side : {left, right})
    if (at.regime.drives[side] != Drive::as_commanded)
      most = larger(most, forces.most_push(side, at.problem.sense(side)));
  all.push_back(most + 10.0 * Tolerance::force);
}

// The conditions that depend on how the surfaces move, but for balance: limits and slides. `twist`
// holds the regime's rate equations; `pace` bounds how far a point of a surface moves in the step [m].
inline void add_motion(Conditions& all, const PosedRegime& at, const RegimeEquations& twist,
                       double pace) {
  const auto moves = twist.system.solution();
  const double least = twist.balance ? Tolerance::balanced_rate : Tolerance::rate;
  if (at.problem.is_limited()) add_limits(all, at);
  if (const std::size_t side = at.regime.yielding(); side <= right) {
    const double sense = at.problem.sense(side);
    all.push_back(sense * moves[3] / pace + least);
    all.push_back(sense * (at.problem.commanded[side] - moves[3]) / pace + least);
  }
  for (const ActiveContact& c : at.contacts) {
    if (c.motion == Motion::stick) continue;
    const bool yields = c.pair.carrier == at.regime.yielding();
    const double speed = dot(at.row(c, c.tangent), {moves[0], moves[1], moves[2]}) -
                         at.given(c, c.tangent) - (yields ? c.tangent.x * moves[3] : 0.0);
    all.push_back(way_of(c.motion) * speed / pace + least);
  }
}

// All conditions of a regime in a pose, or (not `all`) those up to some that fail. With `failing`, the
// conditions of the same regime elsewhere, only those that fail there are evaluated; the others count
// as met.
inline Conditions conditions_of(const PosedRegime& at, const NearPairs& near, double pace,
                                const Conditions* failing = nullptr, bool all_of_them = true) {
  const ContactProblem& problem = at.problem;
  Conditions all;
  if (!all.skips(failing)) all.push_back(balance_of(at));
  if (!all.skips(failing, failing == nullptr ? 0 : failing->of_motion - 1))
    add_motion(all, at, RegimeEquations(at, true), pace);
  all.of_motion = all.size();
  if (!all_of_them && !all.hold()) return all;
  for (const ActiveContact& c : at.contacts) all.push_back(c.inside + Tolerance::inside);
  if (problem.on_both) {
    for (const FeaturePair pair : problem.shapes.own) {
      if (all.skips(failing)) continue;
      const FeatureContact c = at.contact(pair);
      const double above = c.gap / problem.shapes.size - Tolerance::gap;
      all.push_back(larger(problem.left_of_reach(c), above) + Tolerance::inside);
    }
  }
  for (const NearPair& one : near) {
    if (at.regime.has(one.pair) || all.skips(failing)) continue;
    const FeatureContact c = at.contact(one.pair);
    const double gap = c.gap / problem.shapes.size + Tolerance::gap;
    if (one.behind) {  // if it can touch now, another pair has closed in between
      const bool sunk = c.inside > Tolerance::blank && gap < 0.0 && !is_clear(at, near, c);
      all.push_back(sunk ? Conditions::behind : Conditions::met);
    } else {
      all.push_back(c.inside < -Tolerance::inside ? Conditions::met : gap);
    }
  }
  return all;
}

}  // namespace palmbots
