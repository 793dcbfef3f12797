// SPDX-License-Identifier: Apache-2.0
// One step of an object among any surfaces: exact motion from event to event.
//
// Between events a regime (world/contact_regime.hpp) holds. An event is the first instant at which
// one of its conditions fails (world/regime_conditions.hpp). What follows there is chosen among all
// modes that mechanics allow (world/regime_choice.hpp). Source: docs/theory/contacts.md.
#pragma once

#include <algorithm>
#include <cstdint>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/root_finding.hpp"
#include "palmbots/world/regime_choice.hpp"

namespace palmbots {

// Which of several motions that are possible alike follows: the first one by the rules of
// world/regime_choice.hpp, or any of them with equal probability, by a counter-based draw for each
// such event.
struct AmbiguousEvents {
  bool is_drawn = false;
  std::uint64_t seed = 0;
  std::uint32_t stream = 0;
  std::uint32_t count = 0;  // of those that have occurred

  std::size_t pick(std::size_t of) {
    if (of == 1) return 0;
    const std::uint32_t event = count++;
    return is_drawn ? draw(seed, event, stream)[0] % of : 0;
  }
};

// What a step did.
struct ContactStepResult {
  DropReason reason = DropReason::none;
  double fraction = 1.0;
  std::int32_t pieces = 1;
};

// `rounding` is the error of the pose at the start [m]; `noted(t)` is called whenever a regime has
// been chosen.
template <class Noted>
class ContactStep {
  using Tolerance = ContactTolerance;

 public:
  static constexpr int most_events = 200;

  ContactStep(const ContactProblem& problem, const Travel& travel, Pose& pose, Regime& regime,
              Neighbourhood& around, AmbiguousEvents& ambiguous, double rounding, Noted noted)
      : problem_(problem),
        travel_(travel),
        pose_(pose),
        regime_(regime),
        around_(around),
        ambiguous_(ambiguous),
        noted_(noted) {
    double most = 0.0;
    for (const PalmTravel& palm : travel.palms) {
      const double moved = length(palm.by);
      const double turned = magnitude(palm.turn);
      most = larger(
          most, larger(moved / (0.01 * problem.shapes.size), turned / radians_per_degree<double>));
      pace_ = larger(pace_, moved + turned * problem.shapes.size);
    }
    look_ = most > 1.0 ? 1.0 / most : 1.0;
    closed_ = rounding + Tolerance::closed * problem.shapes.size +
              4.0 * instant_tolerance<double> * pace_;
  }

  // From the instant `done` on. Without a regime, or where it has ended, it begins with a choice.
  ContactStepResult run(double done = 0.0) {
    ContactStepResult result{};
    if (travel_.none()) return result;
    look_around(done);
    if (regime_.count == 0 || !goes_along(done)) {
      if (!choose(done, result)) return result;
    }
    double ahead = look_;
    while (done < 1.0) {
      const double goal = done + ahead < 1.0 ? done + ahead : 1.0;
      Pose there = pose_;
      const Conditions then = reach(goal, there, regime_);
      if (then.settled && goal - done > shortest && moved(there) > near_move()) {
        ahead = 0.5 * (goal - done);  // slow palms can turn the object fast
        continue;
      }
      ahead = look_;
      if (then.least() >= 0.0) {
        pose_ = there;
        done = goal;
        if (done < 1.0) look_around(done);
        continue;
      }
      done = event_between(done, goal, then);
      look_around(done);
      if (++result.pieces > most_events) {
        return {DropReason::jammed, done, result.pieces};
      }
      if (!choose(done, result)) return result;
    }
    return result;
  }

 private:
  static constexpr double shortest = 1e-6;  // piece of a step

  // How far a point of the object may move between two looks at what is near, and how far it has.
  double near_move() const { return 0.02 * problem_.shapes.size; }
  double apart(const Pose& one, const Pose& other) const {
    return length(one.at - other.at) + magnitude(one.angle - other.angle) * problem_.shapes.size;
  }
  double moved(const Pose& there) const { return apart(there, pose_); }

  void look_around(double done) {
    const Frames frames = travel_.frames(done);
    near_ = around_.near(problem_, leading_side(frames), frames, pose_, near_move() + look_ * pace_,
                         closed_);
  }

  // Settles at an instant; the conditions there.
  Conditions reach(double t, Pose& pose, const Regime& regime) const {
    const Frames frames = travel_.frames(t);
    ActiveContacts contacts;
    if (!settle(problem_, regime, frames, pose, contacts)) {
      Conditions none;
      none.settled = false;
      return none;
    }
    return conditions_of(problem_, regime, frames, pose, contacts, near_, pace_);
  }

  // The same where the object is.
  Conditions here(double t) const {
    const Frames frames = travel_.frames(t);
    return conditions_of(problem_, regime_, frames, pose_,
                         contacts_of(problem_, regime_, frames, pose_), near_, pace_);
  }

  // Moves the pose to the first instant at which a condition that fails at `goal` does, and returns
  // it. Only those take part in the search: others may be near zero all the time.
  double event_between(double done, double goal, Conditions then) {
    const Conditions now = here(done);
    const Pose start = pose_;
    for (int i = 0; i < most_events; ++i) {
      const auto worst = [&](const Conditions& at) {
        if (!at.settled) return -1.0;
        double least = 1.0;
        for (std::size_t k = 0; k < at.count; ++k) {
          if (!(then.value[k] < 0.0) && then.settled) continue;
          // What starts at zero, such as a corner of an edge that lies flush, does not show when it
          // fails before it does.
          const bool blank = now.value[k] < Tolerance::blank && (&at == &now || at.value[k] >= 0.0);
          if (!blank) least = smaller(least, at.value[k]);
        }
        return least;
      };
      Pose there = start;
      const double from = worst(now);
      const auto at = [&](double t) {
        there = start;
        return worst(reach(t, there, regime_));
      };
      double when =
          bracketed_root(from > 0.0, done, from, goal, worst(then), at, Tolerance::instant);
      if (!(when > done)) return done;
      there = start;
      Conditions found = reach(when, there, regime_);
      if (found.least() >= 0.0 && then.least() == Conditions::behind)
        found = passed(done, when, start);
      if (found.least() >= 0.0) {
        pose_ = there;
        return when;
      }
      goal = when;
      then = found;
    }
    return done;
  }

  // A pair that is behind where it can touch came there past another one, which closed for a while.
  // Looks for that; `when` becomes an instant at which it is closed.
  Conditions passed(double done, double& when, const Pose& start) const {
    constexpr int looks = 16;
    Conditions found{};
    const double end = when;
    for (int k = 1; k <= looks && found.least() >= 0.0; ++k) {
      Pose there = start;
      when = done + (end - done) * (double(k) / looks);
      found = reach(when, there, regime_);
    }
    return found;
  }

  // Chooses the regime that continues from here. False if the object is not held; `result` says why.
  bool choose(double done, ContactStepResult& result) {
    const Frames frames = travel_.frames(done);
    const ClosedPairs closed = closed_pairs(frames);
    result.reason =
        off_palm(problem_, frames, pose_, closed_) ? DropReason::off_palm : DropReason::none;
    if (result.reason == DropReason::none) result.reason = choose_among(closed, frames, done);
    if (result.reason == DropReason::none) {
      noted_(done);
      return true;
    }
    result.fraction = done;
    return false;
  }

  // The best candidate that goes on becomes the regime, or one of those that are as good and move the
  // object elsewhere.
  DropReason choose_among(const ClosedPairs& closed, const Frames& frames, double done) {
    constexpr double elsewhere = 1e-3;  // of the way of the surfaces
    const RegimeCandidates found = candidates_at(problem_, frames, pose_, closed);
    for (double ahead = 1e-7; ahead < 0.1; ahead *= 16.0) {
      const double then = done + ahead * look_ < 1.0 ? done + ahead * look_ : 1.0;
      std::array<const RegimeCandidate*, RegimeCandidates::most> best;
      std::array<Pose, RegimeCandidates::most> ends;
      std::size_t count = 0;
      for (std::size_t k = 0; k < found.count; ++k) {
        const RegimeCandidate& one = found.at[k];
        if (count > 0 && !one.is_as_good_as(*best[0])) break;
        ends[count] = pose_;
        if (!goes_on(done, then, one.regime, ends[count])) continue;
        const auto is_there = [&](const Pose& other) {
          return apart(ends[count], other) < elsewhere * (then - done) * pace_;
        };
        if (std::none_of(ends.begin(), ends.begin() + count, is_there)) best[count++] = &one;
      }
      if (count == 0) continue;
      if (problem_.on_both && !best[0]->on_both) return DropReason::lifting;
      regime_ = best[ambiguous_.pick(count)]->regime;
      return DropReason::none;
    }
    if (choose_later(found, done)) return DropReason::none;
    const DropReason why = reason_of(problem_, closed);
    if (why != DropReason::none) return why;
    // What has run off its feature holds the object no more.
    ClosedPairs rest;
    for (std::size_t i = 0; i < closed.count; ++i) {
      const ClosedPair& c = closed.at[i];
      if (!regime_.has(c.pair) || c.contact.inside > Tolerance::blank) rest.at[rest.count++] = c;
    }
    const DropReason then = reason_of(problem_, rest);
    return then == DropReason::none ? DropReason::jammed : then;
  }

  // Where contacts stick for an instant only, as on a palm that turns through level, the first order
  // does not say which of them slides or leaves then. One of the regimes that go on follows; as many
  // contacts as possible stay.
  bool choose_later(const RegimeCandidates& found, double done) {
    const auto is_instant = [&](const RegimeCandidate& one) {
      return (one.on_both || !problem_.on_both) && !lasts(done, one.regime);
    };
    const auto first = std::find_if(found.at.begin(), found.at.begin() + found.count, is_instant);
    if (first == found.at.begin() + found.count) return false;
    const Regime& instant = first->regime;
    std::size_t ways = 1;
    for (std::size_t i = 0; i < instant.count; ++i)
      ways *= instant.active[i].motion == Motion::stick ? 4 : 1;
    for (const double ahead : {1e-3, 1e-5}) {
      const double then = done + ahead * look_ < 1.0 ? done + ahead * look_ : 1.0;
      for (std::size_t leaving = 0; leaving < instant.count; ++leaving) {
        for (std::size_t way = 1; way < ways; ++way) {
          const Regime regime = varied(instant, way);
          Pose end = pose_;
          if (regime.count + leaving != instant.count || !goes_on(done, then, regime, end))
            continue;
          regime_ = regime;
          return true;
        }
      }
    }
    return false;
  }

  // A regime in which contacts that stick do otherwise: each as a digit of `way` to the base 4 says.
  Regime varied(const Regime& instant, std::size_t way) const {
    Regime regime = instant;
    regime.count = 0;
    PerSide<bool> touched{};
    for (std::size_t i = 0; i < instant.count; ++i) {
      ActivePair contact = instant.active[i];
      if (contact.motion == Motion::stick) {
        constexpr std::array<Motion, 4> motions{Motion::stick, Motion::up, Motion::down,
                                                Motion::leave};
        contact.motion = motions[way % 4];
        way /= 4;
      }
      if (contact.motion == Motion::leave) continue;
      regime.active[regime.count++] = contact;
      const std::size_t carrier = problem_.carrier(contact.pair);
      if (carrier < 2) touched[carrier] = true;
    }
    if (problem_.on_both && !(touched[left] && touched[right])) regime.count = 0;
    return regime;
  }

  // Whether a regime holds at a later instant, and its contacts slide in their directions until
  // then. They are compared from the middle on: at first the pose may jump by a rounding error. `end`,
  // the pose before, becomes that at the later instant.
  bool goes_on(double from, double to, const Regime& regime, Pose& end) const {
    if (!(reach(to, end, regime).least() >= 0.0)) return false;
    if (!lasts(from, regime)) return false;
    const double middle = 0.5 * (from + to);
    Pose half = pose_;
    if (!reach(middle, half, regime).settled) return false;
    const Frames before = travel_.frames(middle);
    const Frames after = travel_.frames(to);
    for (std::size_t i = 0; i < regime.count; ++i) {
      const ActivePair& a = regime.active[i];
      if (a.motion == Motion::stick) continue;
      const double ran = problem_.contact(after, end, a.pair, a.reference).run -
                         problem_.contact(before, half, a.pair, a.reference).run;
      if (double(static_cast<int>(a.motion)) * ran < -8.0 * Tolerance::epsilon) return false;
    }
    return true;
  }

  // Whether the regime of the last step also holds in the motion of this one. The pose is the same.
  bool goes_along(double done) const {
    const Frames frames = travel_.frames(done);
    const ActiveContacts contacts = contacts_of(problem_, regime_, frames, pose_);
    const auto twist = detail::equations(problem_, regime_, frames, pose_, contacts, true);
    if (!twist.system.full()) return false;
    const Conditions all =
        conditions_of_motion(problem_, regime_, frames, pose_, contacts, twist, pace_);
    return all.least() >= 0.0 && (!twist.balance || is_here(done)) && lasts(done, regime_, twist);
  }

  // Whether the pose in which the forces of the regime balance is that of the object. Another push
  // than in the last step moves that pose, but not the object.
  bool is_here(double done) const {
    Pose there = pose_;
    ActiveContacts contacts;
    return settle(problem_, regime_, travel_.frames(done), there, contacts) &&
           moved(there) <= closed_;
  }

  bool lasts(double from, const Regime& regime) const {
    const Frames now = travel_.frames(from);
    const ActiveContacts contacts = contacts_of(problem_, regime, now, pose_);
    return lasts(from, regime, detail::equations(problem_, regime, now, pose_, contacts, true));
  }
  // Whether more contacts stick than the pose has unknowns, and do so for longer than an instant.
  bool lasts(double from, const Regime& regime, const detail::RegimeEquations& twist) const {
    if (!twist.spare) return true;
    const double later = from + 0.01 * look_ < 1.0 ? from + 0.01 * look_ : 1.0;
    Pose there = pose_;
    ActiveContacts then;
    return settle(problem_, regime, travel_.frames(later), there, then);
  }

  // The pairs that touch, those of the palm that leads first.
  ClosedPairs closed_pairs(const Frames& frames) const {
    ClosedPairs closed;
    const std::size_t first = leading_side(frames);
    for (const std::size_t carrier : {first, other(first), std::size_t(Carrier::ground)}) {
      for (std::size_t i = 0; i < regime_.count; ++i) {
        if (problem_.carrier(regime_.active[i].pair) == carrier)
          add(closed, frames, regime_.active[i].pair);
      }
      for (std::size_t k = 0; k < near_.count; ++k) {
        const FeaturePair pair = near_.at[k].pair;
        if (problem_.carrier(pair) != carrier || regime_.has(pair)) continue;
        const FeatureContact c = problem_.contact(frames, pose_, pair);
        if (magnitude(c.gap) <= closed_ && c.inside >= -100.0 * Tolerance::blank)
          add(closed, frames, pair);
      }
    }
    return closed;
  }
  void add(ClosedPairs& closed, const Frames& frames, FeaturePair pair) const {
    if (closed.count == ClosedPairs::most) return;
    closed.at[closed.count++] = {pair, problem_.contact(frames, pose_, pair)};
  }

  // The palm that is computed first, so that the mirrored problem rounds alike. Left comes first
  // only if nothing distinguishes left from right.
  std::size_t leading_side(const Frames& frames) const {
    const auto ranks = [&](std::size_t side) {
      const Frame& frame = frames[side];
      const Vec com = frame.from_world(pose_.at - frame.origin);
      std::array<std::size_t, 2> touching{};
      for (std::size_t i = 0; i < regime_.count; ++i) {
        if (problem_.carrier(regime_.active[i].pair) == side)
          ++touching[regime_.active[i].motion == Motion::stick ? 1 : 0];
      }
      return std::array<double, 7>{double(touching[0] + touching[1]),
                                   frame.angle,
                                   frame.rate,
                                   com.x,
                                   com.y,
                                   double(touching[1]),
                                   mirrored(side, problem_.weight(true).x)};
    };
    const auto of_left = ranks(left);
    const auto of_right = ranks(right);
    if (of_left != of_right) return of_right > of_left ? right : left;
    return problem_.shapes.lopsided < 0 ? right : left;
  }

  const ContactProblem& problem_;
  const Travel& travel_;
  Pose& pose_;
  Regime& regime_;
  Neighbourhood& around_;
  AmbiguousEvents& ambiguous_;
  Noted noted_;
  double look_ = 1.0;
  double pace_ = 0.0;    // how far a point of a surface moves in the step, at most [m]
  double closed_ = 0.0;  // a gap that counts as closed at an event [m]
  NearPairs near_;
};

}  // namespace palmbots
