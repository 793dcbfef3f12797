// SPDX-License-Identifier: Apache-2.0
// Which regime follows at an event.
//
// All contact modes of the closed contacts that are possible and in balance are candidates
// (mechanics/twist_feasibility.hpp). At the event itself one force or speed is just zero, so that
// the regime that ends is among them. Each candidate is therefore tried for a short while, and the
// best one that goes on is taken:
//
//   - contacts on both palms before contacts on one;
//   - as many contacts as possible persist;
//   - all of them slide before some of them do;
//   - the palm that leads slides first (`leading_side`).
//
// If several move the object differently and persist in as many contacts, the event is ambiguous
// (world/contact_step.hpp): the last two rules may be replaced by a draw.
#pragma once

#include <algorithm>

#include "palmbots/base/few_sorted.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/world/regime_conditions.hpp"

namespace palmbots {

struct RegimeCandidate {
  Regime regime;
  bool on_both;           // palms
  bool alike;             // all contacts slide
  std::size_t selection;  // of the closed pairs, the first one in which it is possible

  constexpr bool is_as_good_as(const RegimeCandidate& other) const {
    return on_both == other.on_both && regime.count == other.regime.count;
  }
};

struct RegimeCandidates {
  static constexpr std::size_t most = 64;
  std::array<RegimeCandidate, most> at;  // up to `count`
  std::size_t count = 0;
};

// A pair that is closed, as it is at the event.
struct ClosedPair {
  FeaturePair pair;
  FeatureContact contact;
};

// It persists in this way.
inline ActivePair active_of(const ClosedPair& one, Motion motion) {
  const double held = one.pair.kind == PairKind::tip_on_arc ? 0.0 : one.contact.run;
  return {one.pair, motion, held, one.contact.on_body};
}

// A gap (times w) below this counts as closed where people look at the object: 2.5 µm for the paper's
// box, finer than any measured length, coarser than a coordinate that a person writes down.
template <class Real>
inline constexpr Real contact_tolerance = Real(1e-5);

// The same where the world looks at it.
template <class Real>
inline constexpr Real closed_tolerance = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-4);

struct ClosedPairs {
  static constexpr std::size_t most = 2 * max_supports;
  std::array<ClosedPair, most> at;  // up to `count`
  std::size_t count = 0;
};

// The near pairs whose gap is at most `closed` [m], and that are at most `beyond` beyond the end of a
// feature.
inline ClosedPairs closed_among(const ContactProblem& problem, const Frames& frames,
                                const Pose& pose, const NearPairs& near, double closed,
                                double beyond = 100.0 * ContactTolerance::blank) {
  ClosedPairs found;
  for (std::size_t k = 0; k < near.count && found.count < ClosedPairs::most; ++k) {
    const FeatureContact c = problem.contact(frames, pose, near.at[k].pair);
    if (magnitude(c.gap) <= closed && c.inside >= -beyond)
      found.at[found.count++] = {near.at[k].pair, c};
  }
  return found;
}

// The palm that is computed first, so that the mirrored problem rounds alike. Left comes first only if
// nothing distinguishes left from right.
inline std::size_t leading_side(const ContactProblem& problem, const Regime& regime,
                                const Frames& frames, const Pose& pose) {
  const auto ranks = [&](std::size_t side) {
    const Frame& frame = frames[side];
    const Vec com = frame.from_world(pose.at - frame.origin);
    std::array<std::size_t, 2> touching{};
    for (std::size_t i = 0; i < regime.count; ++i) {
      if (problem.carrier(regime.active[i].pair) == side)
        ++touching[regime.active[i].motion == Motion::stick ? 1 : 0];
    }
    return std::array<double, 7>{double(touching[0] + touching[1]),
                                 frame.angle,
                                 frame.rate,
                                 com.x,
                                 com.y,
                                 double(touching[1]),
                                 mirrored(side, problem.weight(true).x)};
  };
  const auto of_left = ranks(left);
  const auto of_right = ranks(right);
  if (of_left != of_right) return of_right > of_left ? right : left;
  return problem.shapes.lopsided < 0.0 ? right : left;
}

namespace detail {

// Two pairs that touch at one point: a feature and its neighbour, where one hands over to the other,
// or a corner of the object at a tip.
inline bool at_one_point(const FeatureContact& a, const FeatureContact& b, double size) {
  return length(a.point - b.point) < ContactTolerance::blank * size;
}

inline bool in_one_direction(const FeatureContact& a, const FeatureContact& b) {
  return magnitude(cross(a.normal, b.normal)) < ContactTolerance::blank;
}

// Adds a candidate in which the closed pairs have these motions.
inline void add_candidate(const ContactProblem& problem, const ClosedPairs& closed,
                          const Motions& motions, bool pushed, std::size_t selection,
                          RegimeCandidates& found) {
  if (found.count == RegimeCandidates::most) return;
  RegimeCandidate made;
  made.regime.pushed = pushed;
  std::size_t slide = 0;
  for (std::size_t i = 0; i < closed.count && i < max_supports; ++i) {
    if (motions[i] == Motion::leave) continue;
    made.regime.active[made.regime.count++] = active_of(closed.at[i], motions[i]);
    slide += motions[i] != Motion::stick ? 1 : 0;
  }
  const std::size_t second = other_carrier(problem, made.regime);
  if (second < made.regime.count)
    made.regime.alike = made.regime.active[0].held - made.regime.active[second].held;
  made.on_both = problem.is_on_both(made.regime);
  made.alike = slide == made.regime.count;
  // On both palms in one direction: nothing but balance drives the object, which falls off.
  const auto& active = made.regime.active;
  if (problem.on_both && made.alike && slide == 2 && active[0].motion != active[1].motion) return;
  made.selection = selection;
  for (std::size_t k = 0; k < found.count; ++k) {
    RegimeCandidate& other = found.at[k];
    if (!other.regime.is_like(made.regime)) continue;
    other.selection = selection < other.selection ? selection : other.selection;
    return;
  }
  found.at[found.count++] = made;
}

}  // namespace detail

// True if a contact corner of the object is not above the usable part of its palm and not higher than
// the palm, up to `closed` [m].
inline bool off_palm(const ContactProblem& problem, const Frames& frames, const Pose& pose,
                     double closed) {
  if (!problem.on_both) return false;
  const double near = ContactTolerance::blank * problem.shapes.size;
  for (const FeaturePair pair : problem.shapes.own) {
    const FeatureContact c = problem.contact(frames, pose, pair);
    if (c.gap <= closed && problem.left_of_reach(problem.carrier(pair), c) <= near) return true;
  }
  return false;
}

// Why the closed pairs do not hold the object, whatever moves, or `none`. A pose in which they hold
// it only just counts as one in which they do not: something has ended there.
inline DropReason reason_of(const ContactProblem& problem, const ClosedPairs& closed) {
  PerSide<bool> touched{};
  PerSide<bool> beside{true, true};  // of the line of gravity: all contacts
  Rays rays{};
  for (std::size_t i = 0; i < closed.count && i < max_supports; ++i) {
    const auto& [pair, c] = closed.at[i];
    const std::size_t carrier = problem.carrier(pair);
    if (carrier < 2) touched[carrier] = true;
    const double x = c.point.x - problem.slope * c.point.y;
    const double slack = ContactTolerance::blank * problem.shapes.size;
    beside[left] = beside[left] && x < slack;
    beside[right] = beside[right] && x > -slack;
    problem.add_rays(rays, c, problem.surface(pair).friction, Motion::stick);
  }
  if (problem.on_both && (!touched[left] || !touched[right])) return DropReason::lifting;
  if (beside[left] || beside[right]) return DropReason::tipping;
  const double least = 10.0 * ContactTolerance::blank;
  return depth_in(rays, problem.weight(false)) > least ? DropReason::none : DropReason::sliding;
}

// The search for the regimes that the closed pairs allow, while the surfaces move in one way or other.
class RegimeSearch {
 public:
  RegimeSearch(const ContactProblem& problem, const Frames& frames, const Pose& pose,
               const ClosedPairs& closed)
      : problem_(problem), pose_(pose), closed_(closed) {
    for (std::size_t i = 0; i < closed.count && i < max_supports; ++i) {
      const FeaturePair pair = closed.at[i].pair;
      const FeatureContact c = problem.contact(frames, pose, pair);
      supports_.at[supports_.count++] = {frames[problem.carrier(pair)].sense < 0.0 ? left : right,
                                         c.point.x,
                                         c.point.y,
                                         c.normal.x,
                                         c.normal.y,
                                         problem.surface(pair).friction};
    }
    balancing_ = balancing_edges(supports_, problem.weight(true).x);
    select();
  }

  // The best first.
  RegimeCandidates candidates(const Frames& moving) const {
    Velocities velocities{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const Vec point{supports_.at[i].x, supports_.at[i].y};
      velocities[i] = moving[problem_.carrier(closed_.at[i].pair)].velocity_at(pose_.at + point);
    }
    const Twists twists(supports_, velocities);
    RegimeCandidates found;
    const auto add_all = [&](const BalancingRays& balancing, bool pushed) {
      twists.each(selections_, balancing, [&](const Motions& motions, std::size_t selection) {
        detail::add_candidate(problem_, closed_, motions, pushed, selection, found);
      });
    };
    add_all(balancing_, true);
    if (found.count == 0 && problem_.push != 0.0)
      add_all(balancing_edges(supports_, problem_.weight(false).x), false);
    sort_few(found.at.data(), found.count, [](const RegimeCandidate& a, const RegimeCandidate& b) {
      if (a.on_both != b.on_both) return a.on_both;
      if (a.regime.count != b.regime.count) return a.regime.count > b.regime.count;
      return a.alike != b.alike ? a.alike : a.selection < b.selection;
    });
    return found;
  }

 private:
  // Each selection of the closed pairs, as bits of those that are left out: of two at one point, the
  // first, the second or both take part.
  void select() {
    int doubled = 0;
    for (std::size_t j = 0; j < closed_.count; ++j) {
      for (std::size_t i = 0; i < j && doubled < 3; ++i) {
        const FeatureContact& a = closed_.at[i].contact;
        const FeatureContact& b = closed_.at[j].contact;
        if (!detail::at_one_point(a, b, problem_.shapes.size)) continue;
        ++doubled;
        const Selections before = selections_;
        selections_.count = 0;
        for (const std::uint32_t out : {1U << j, 1U << i, 0U}) {
          // Where both touch in one direction they are the same contact.
          if (out == 0 && detail::in_one_direction(a, b)) continue;
          for (std::size_t k = 0; k < before.count; ++k) selections_.add(before.out[k] | out);
        }
      }
    }
  }

  const ContactProblem& problem_;
  const Pose& pose_;
  const ClosedPairs& closed_;
  Selections selections_;
  Supports supports_{};
  BalancingRays balancing_;
};

}  // namespace palmbots
