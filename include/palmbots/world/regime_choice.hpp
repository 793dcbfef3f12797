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
//   - the larger margin (mechanics/mode_margin.hpp);
//   - the robot in front, in the direction of travel, slides.
//
// If several move the object differently and persist in as many contacts, the event is ambiguous
// (world/contact_step.hpp): the last three rules may be replaced by a draw.
#pragma once

#include <algorithm>
#include <tuple>

#include "palmbots/base/few_sorted.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/mode_margin.hpp"
#include "palmbots/world/regime_conditions.hpp"

namespace palmbots {

struct RegimeCandidate {
  Regime regime;
  bool on_both;           // palms
  bool alike;             // all contacts slide
  std::size_t selection;  // of the closed pairs, the first one in which it is possible

  constexpr bool is_as_good_as(const RegimeCandidate& other) const {
    return on_both == other.on_both && regime.active.size() == other.regime.active.size();
  }
};

using RegimeCandidates = FixedList<RegimeCandidate, 64>;

// A pair that is closed persists in this way.
inline ActivePair active_of(const FeatureContact& one, Motion motion) {
  return {one.pair, motion, one.pair.kind == PairKind::tip_on_arc ? 0.0 : one.run, one.on_body};
}

// A gap (times w) below this counts as closed where people look at the object: 2.5 µm for the paper's
// box, finer than any measured length, coarser than a coordinate that a person writes down.
template <class Real>
inline constexpr Real contact_tolerance = Real(1e-5);

// The same where the world looks at it.
template <class Real>
inline constexpr Real closed_tolerance = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-4);

// The pairs that are closed, as they are at the event.
using ClosedPairs = FixedList<FeatureContact, 2 * max_supports>;

// The near pairs whose gap is at most `closed` [m], and that are at most `beyond` beyond the end of a
// feature.
inline ClosedPairs closed_among(const Instant& at, const NearPairs& near, double closed,
                                double beyond = 100.0 * Tolerance::blank) {
  ClosedPairs found;
  for (const NearPair& one : near) {
    const FeatureContact c = at.contact(one.pair);
    if (!found.full() && magnitude(c.gap) <= closed && c.inside >= -beyond) found.push_back(c);
  }
  return found;
}

// The palm that is computed first, so that the mirrored problem rounds alike. Left comes first only if
// nothing distinguishes left from right.
inline std::size_t leading_side(const Instant& at, const Regime& regime) {
  const ContactProblem& problem = at.problem;
  const auto ranks = [&](std::size_t side) {
    const Frame& frame = at.frames[side];
    const Vec com = frame.from_world(at.pose.at - frame.origin);
    double touching = 0.0;
    double sticking = 0.0;
    for (const ActivePair& a : regime.active) {
      if (a.pair.carrier != side) continue;
      touching += 1.0;
      sticking += a.motion == Motion::stick ? 1.0 : 0.0;
    }
    const double pushed = mirrored(side, problem.weight(true).x);
    return std::array{touching, frame.angle, frame.rate, com.x, com.y, sticking, pushed};
  };
  const auto of_left = ranks(left);
  const auto of_right = ranks(right);
  if (of_left != of_right) return of_right > of_left ? right : left;
  return problem.shapes.lopsided < 0.0 ? right : left;
}

// Two pairs that touch at one point: a feature and its neighbour, where one hands over to the other,
// or a corner of the object at a tip.
inline bool at_one_point(const FeatureContact& a, const FeatureContact& b, double size) {
  return length(a.point - b.point) < Tolerance::blank * size;
}

inline bool in_one_direction(const FeatureContact& a, const FeatureContact& b) {
  return magnitude(cross(a.normal, b.normal)) < Tolerance::blank;
}

// Whether a contact has run off the end of its feature: the regime that follows has neither it nor one in
// its place, at the same point or where the object lies flush.
inline bool has_run_off(const Instant& at, const ActivePair& one, const Regime& regime) {
  const FeatureContact c = at.contact(one.pair, one.reference);
  if (c.inside > Tolerance::blank) return false;
  return std::ranges::none_of(regime.active, [&](const ActivePair& other) {
    const FeatureContact in_place = at.contact(other.pair, other.reference);
    return other.pair.carrier == one.pair.carrier &&
           (in_one_direction(c, in_place) || at_one_point(c, in_place, at.problem.shapes.size));
  });
}

// The margin of a regime [rad].
inline double margin_in(const PosedRegime& at) {
  Supports supports;
  Motions motions{};
  SurfaceNumbers carriers{};
  for (const ActiveContact& c : at.contacts) {
    motions[supports.size()] = c.motion;
    carriers[supports.size()] = c.pair.carrier;
    supports.push_back(c);
  }
  return margin_of(supports, motions, at.weight().x, carriers).angle;
}

// Adds a candidate in which the closed pairs have these motions.
inline void add_candidate(const ContactProblem& problem, const ClosedPairs& closed,
                          const Motions& motions, bool pushed, std::size_t selection,
                          RegimeCandidates& found) {
  if (found.full()) return;
  RegimeCandidate made;
  Regime& regime = made.regime;
  auto& active = regime.active;
  regime.pushed = pushed;
  for (std::size_t i = 0; i < closed.size() && i < max_supports; ++i)
    if (motions[i] != Motion::leave) active.push_back(active_of(closed[i], motions[i]));
  const std::size_t second = regime.other_carrier();
  if (second < active.size()) regime.alike = active[0].held - active[second].held;
  made.on_both = regime.is_on_both();
  made.alike = regime.unknown_forces() == active.size();
  made.selection = selection;
  // On both palms in one direction: nothing but balance drives the object, which falls off.
  if (problem.on_both && made.alike && active.size() == 2 && active[0].motion != active[1].motion)
    return;
  const auto is_same = [&](const RegimeCandidate& one) { return one.regime.is_like(regime); };
  RegimeCandidate* const known = std::ranges::find_if(found, is_same);
  if (known == found.end()) return found.push_back(made);
  known->selection = std::min(known->selection, selection);
}

// True if a contact corner of the object is not above the usable part of its palm and not higher than
// the palm, up to `closed` [m].
inline bool off_palm(const Instant& at, double closed) {
  const ContactProblem& problem = at.problem;
  return problem.on_both && std::ranges::any_of(problem.shapes.own, [&](FeaturePair pair) {
           const FeatureContact c = at.contact(pair);
           const double near = Tolerance::blank * problem.shapes.size;
           return c.gap <= closed && problem.left_of_reach(c) <= near;
         });
}

// Why the closed pairs do not hold the object, whatever moves, or `none`. A pose in which they hold
// it only just counts as one in which they do not: something has ended there.
inline DropReason reason_of(const ContactProblem& problem, const ClosedPairs& closed) {
  PerSide<bool> touched{};
  PerSide<bool> beside{true, true};  // of the line of gravity: all contacts
  Rays rays;
  for (std::size_t i = 0; i < closed.size() && i < max_supports; ++i) {
    const FeatureContact& c = closed[i];
    if (c.pair.carrier <= right) touched[c.pair.carrier] = true;
    const double x = c.point.x - problem.slope * c.point.y;
    const double slack = Tolerance::blank * problem.shapes.size;
    beside[left] = beside[left] && x < slack;
    beside[right] = beside[right] && x > -slack;
    add_rays(rays, c, Motion::stick, problem.shapes.size);
  }
  if (problem.on_both && (!touched[left] || !touched[right])) return DropReason::lifting;
  if (beside[left] || beside[right]) return DropReason::tipping;
  const double least = 10.0 * Tolerance::blank;
  return depth_in(rays, problem.weight(false)) > least ? DropReason::none : DropReason::sliding;
}

// The search for the regimes that the closed pairs allow, while the surfaces move in one way or other.
class RegimeSearch {
 public:
  RegimeSearch(const Instant& at, const ClosedPairs& closed)
      : problem_(at.problem), com_(at.pose.at), closed_(closed) {
    for (std::size_t i = 0; i < closed.size() && i < max_supports; ++i)
      supports_.push_back(at.contact(closed[i].pair));
    balancing_ = balancing_edges(supports_, problem_.weight(true).x);
    select();
  }

  // The best first.
  RegimeCandidates candidates(const Frames& moving) const {
    Velocities velocities{};
    for (std::size_t i = 0; i < supports_.size(); ++i)
      velocities[i] = moving[closed_[i].pair.carrier].velocity_at(com_ + supports_[i].point);
    const Twists twists(supports_, velocities);
    RegimeCandidates found;
    const auto add_all = [&](const ContainingCones& balancing, bool pushed) {
      twists.each(selections_, balancing, [&](const Motions& motions, std::size_t selection) {
        add_candidate(problem_, closed_, motions, pushed, selection, found);
      });
    };
    add_all(balancing_, true);
    if (found.empty() && problem_.push != 0.0)
      add_all(balancing_edges(supports_, problem_.weight(false).x), false);
    sort_few(found.begin(), found.size(), [](const RegimeCandidate& one) {
      const std::size_t lost = max_supports - one.regime.active.size();
      return std::tuple(!one.on_both, lost, !one.alike, one.selection);
    });
    return found;
  }

 private:
  // Each selection of the closed pairs, as bits of those that are left out: of two at one point, the
  // first, the second or both take part.
  void select() {
    int doubled = 0;
    for (std::size_t j = 0; j < closed_.size(); ++j) {
      for (std::size_t i = 0; i < j && doubled < 3; ++i) {
        const FeatureContact& a = closed_[i];
        const FeatureContact& b = closed_[j];
        if (!at_one_point(a, b, problem_.shapes.size)) continue;
        ++doubled;
        const Selections before = selections_;
        selections_.clear();
        for (const std::uint32_t out : {1U << j, 1U << i, 0U}) {
          // Where both touch in one direction they are the same contact.
          if (out == 0 && in_one_direction(a, b)) continue;
          for (const std::uint32_t one : before)
            if (!selections_.contains(one | out)) selections_.push_back(one | out);
        }
      }
    }
  }

  const ContactProblem& problem_;
  Vec com_;
  const ClosedPairs& closed_;
  Selections selections_{0};
  Supports supports_;
  ContainingCones balancing_;
};

}  // namespace palmbots
