// SPDX-License-Identifier: Apache-2.0
// One step of an object among any surfaces: exact motion from event to event.
//
// Between events a regime (world/contact_regime.hpp) holds. An event is the first instant at which
// one of its conditions fails (world/regime_conditions.hpp). What follows there is chosen among all
// modes that mechanics allow (world/regime_choice.hpp). Where robots stall, their pivots fall behind
// the step. Source: docs/theory/contacts.md.
#pragma once

#include <algorithm>
#include <cstdint>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/root_finding.hpp"
#include "palmbots/world/contact_trial.hpp"

namespace palmbots {

// A regime that the world took although others were as good, at a fraction of the last step.
struct AmbiguousChoice {
  double fraction;
  Regime regime;
};

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
  PerSide<double> lag{};      // of each pivot, along x, from where it should be then [m]
  PerSide<double> stalled{};  // the part of the step in which each robot stalled
};

// `rounding` is the error of the pose at the start [m]; `noted(frames, t)` is called whenever a regime
// has been chosen.
template <class Noted>
class ContactStep : ContactTrial {
 public:
  static constexpr int most_events = 200;

  ContactStep(const ContactProblem& problem, const Travel& travel, Pose& pose, Regime& regime,
              Neighbourhood& around, AmbiguousEvents& ambiguous, double rounding, Noted noted)
      : ContactTrial(problem, travel, pose, regime, around, rounding),
        ambiguous_(ambiguous),
        noted_(noted) {}

  // From the instant `done` on. Without a regime, or where it has ended, it begins with a choice.
  ContactStepResult run(double done = 0.0) {
    ContactStepResult result{};
    if (travel_.none()) return result;
    now_.t = done;
    go(done, result);
    result.lag = now_.lag;
    result.stalled = stalled_;
    return result;
  }

 private:
  static constexpr double shortest = 1e-6;  // piece of a step
  // How long a regime is tried, in parts of a piece.
  static constexpr double shortest_trial = 1e-7;
  static constexpr double longest_trial = 0.099;
  static constexpr double grown = 16.0;

  void go(double done, ContactStepResult& result) {
    look_around();
    // Robots that stall try again in every step.
    if (regime_.count == 0 || regime_.stalls() || !goes_along(done)) {
      if (!choose(done, result)) return;
    }
    double ahead = look_;
    while (done < 1.0) {
      const double goal = done + ahead < 1.0 ? done + ahead : 1.0;
      Place there = here();
      const Conditions then = reach(goal, there, regime_);
      if (then.settled && goal - done > shortest && moved(there.pose) > near_move()) {
        ahead = 0.5 * (goal - done);  // slow palms can turn the object fast
        continue;
      }
      ahead = look_;
      if (then.hold()) {
        go_to(there);
        done = goal;
        if (done < 1.0) look_around();
        continue;
      }
      done = event_between(done, goal, then);
      look_around();
      if (++result.pieces > most_events) {
        result.reason = DropReason::jammed;
        result.fraction = done;
        return;
      }
      const Regime ended = regime_;
      if (!choose(done, result)) return;
      // What goes on has to go on for longer each time, so that no condition that is only just met ends
      // it again and again.
      const bool again = regime_.is_like(ended) && regime_.drives == ended.drives;
      trial_ = again ? smaller(grown * trial_, longest_trial) : shortest_trial;
    }
  }

  // Moves the pose to the first instant at which a condition that fails at `goal` does, and returns
  // it. Only those take part in the search: others may be near zero all the time.
  double event_between(double done, double goal, Conditions then) {
    const Conditions now = conditions_here();
    const Place start = here();
    for (int i = 0; i < most_events; ++i) {
      const bool is_behind = then.settled && !then.spare_behind();
      // Not a number, so that the search bisects and does not take a jump for a slope.
      constexpr double jumps = std::numeric_limits<double>::quiet_NaN();
      const auto worst = [&](const Conditions& at) {
        if (!at.settled) return jumps;
        double least = Conditions::met;
        for (std::size_t k = 0; k < at.count; ++k) {
          if (!(then.value[k] < -Conditions::rounding) && then.settled) continue;
          // What starts at zero, such as a corner of an edge that lies flush, does not show when it
          // fails before it does.
          const bool blank = now.value[k] < Tolerance::blank && (&at == &now || at.value[k] >= 0.0);
          if (!blank) least = smaller(least, at.value[k]);
        }
        return least == Conditions::behind ? jumps : least;
      };
      Place there = start;
      const double from = worst(now);
      double before = from;                      // the good end
      std::array<double, 2> failed{goal, goal};  // the last instants at which something fails
      std::array<double, 2> by{worst(then), jumps};
      const auto at = [&](double t) {
        there = start;
        double value = worst(reach(t, there, regime_, then.settled ? &then : nullptr));
        if (value < 0.0) {
          failed = {t, failed[0]};
          by = {value, by[0]};
        } else if (value == Conditions::met) {
          // Without a measure, what the failures after it suggest.
          const double line = by[0] + (by[1] - by[0]) * ((t - failed[0]) / (failed[1] - failed[0]));
          if (line > 0.0) value = line;
        }
        if (value >= 0.0) before = value;
        return before == Conditions::met && value < 0.0 ? jumps : value;
      };
      const double to = from == Conditions::met ? jumps : worst(then);
      double when = bracketed_root(from > 0.0, done, from, goal, to, at, Tolerance::instant);
      if (!(when > done)) return done;
      there = start;
      Conditions found = reach(when, there, regime_);
      if (found.hold() && is_behind) found = passed(done, when, start);
      if (found.hold()) {
        go_to(there);
        return when;
      }
      goal = when;
      then = found;
    }
    return done;
  }

  // A pair that is behind where it can touch came there past another one, which closed for a while.
  // Looks for that; `when` becomes an instant at which it is closed.
  Conditions passed(double done, double& when, const Place& start) const {
    constexpr int looks = 16;
    Conditions found{};
    const double end = when;
    for (int k = 1; k <= looks && found.hold(); ++k) {
      Place there = start;
      when = done + (end - done) * (double(k) / looks);
      found = reach(when, there, regime_);
    }
    return found;
  }

  // Chooses the regime that continues from here. False if the object is not held; `result` says why.
  bool choose(double done, ContactStepResult& result) {
    const Frames frames = this->frames(now_);
    const ClosedPairs closed = closed_pairs(frames);
    result.reason =
        off_palm(problem_, frames, pose_, closed_) ? DropReason::off_palm : DropReason::none;
    if (result.reason == DropReason::none) result.reason = choose_among(closed, frames, done);
    if (result.reason == DropReason::none) {
      noted_(frames, done);
      return true;
    }
    result.fraction = done;
    return false;
  }

  // Robots stall only if there is no motion in which both drive, and the object does not fall.
  DropReason choose_among(const ClosedPairs& closed, const Frames& frames, double done) {
    // A tip that moves along an arc leaves it without a speed, as may what touches a palm that turns:
    // that shows only a little later.
    constexpr double later = 1e-3;  // of a step
    const auto is_on_arc = [](const ClosedPair& c) { return c.pair.kind == PairKind::tip_on_arc; };
    const bool looks_later =
        travel_.turns() ||
        std::any_of(closed.at.begin(), closed.at.begin() + closed.count, is_on_arc);
    const RegimeSearch search(problem_, frames, pose_, closed);
    Found as_commanded = go_on_with(search.candidates(frames), done);
    if (!as_commanded.any && looks_later) {
      const Frames then = palmbots::moved(frames, later);
      const RegimeSearch moved(problem_, then, pose_, closed);
      as_commanded = go_on_with(moved.candidates(then), done);
    }
    if (as_commanded.any) return as_commanded.reason;
    const DropReason why = reason_of(problem_, closed);
    if (why != DropReason::none) return why;
    // What has run off its feature holds the object no more. What is at the end of its feature because
    // an edge lies flush there does.
    ClosedPairs rest;
    for (std::size_t i = 0; i < closed.count; ++i) {
      const ClosedPair& c = closed.at[i];
      const auto lies_flush_with = [&](const ClosedPair& other) {
        return problem_.carrier(c.pair) == problem_.carrier(other.pair) &&
               detail::in_one_direction(c.contact, other.contact) &&
               !detail::at_one_point(c.contact, other.contact, problem_.shapes.size);
      };
      if (!regime_.has(c.pair) || c.contact.inside > Tolerance::blank ||
          std::any_of(closed.at.begin(), closed.at.begin() + closed.count, lies_flush_with))
        rest.at[rest.count++] = c;
    }
    const DropReason then = rest.count < closed.count ? reason_of(problem_, rest) : why;
    if (then != DropReason::none) return then;
    const bool stalls = problem_.is_limited() && stall(search, closed, frames, done);
    return stalls ? DropReason::none : DropReason::jammed;
  }

  // Chooses a regime in which a robot stalls: the weaker one; otherwise the stronger one; otherwise
  // both, the weaker one up to standing. False if there is none.
  bool stall(const RegimeSearch& search, const ClosedPairs& closed, const Frames& frames,
             double done) {
    constexpr auto ground = static_cast<std::size_t>(Carrier::ground);
    const PerSide<double>& limit = problem_.limit;
    std::size_t weaker = limit[left] < limit[right] ? left : right;
    if (limit[left] == limit[right]) weaker = leading_side(frames);
    for (const bool both : {false, true}) {
      for (const std::size_t side :
           {both ? other(weaker) : weaker, both ? weaker : other(weaker)}) {
        const std::size_t partner = other(side);
        const double sense = problem_.commanded[side] < 0.0 ? -1.0 : 1.0;
        if (problem_.commanded[side] == 0.0 || (both && problem_.commanded[partner] == 0.0))
          continue;
        Frames moving = frames;
        PerSide<Drive> drives{};
        if (both) {
          drives[partner] = Drive::stands;
          moving[partner].velocity.x = 0.0;
        }
        const auto goes_at = [&](double speed, Drive drive, bool at_limit = false) {
          drives[side] = drive;
          moving[side].velocity.x = speed;
          RegimeCandidates found = search.candidates(moving);
          std::size_t count = 0;
          for (std::size_t k = 0; k < found.count; ++k) {
            Regime& regime = found.at[k].regime;
            regime.drives = drives;
            if (!at_limit || is_at_limit(regime, moving)) found.at[count++] = found.at[k];
          }
          found.count = count;
          const Found stalled = go_on_with(found, done);
          return stalled.any && stalled.reason == DropReason::none;
        };
        const double fastest = problem_.commanded[side];
        for (const std::size_t held_by : {partner, ground}) {
          moving[side].velocity.x = 0.0;
          const double speed = speed_with(closed, moving, side, held_by);
          const double least = Tolerance::rate * pace_;
          if (sense * speed > least && sense * (fastest - speed) > -least &&
              goes_at(speed, Drive::yields))
            return true;
        }
        // A contact slides while the robot exerts its greatest force. Its direction does not depend
        // on whether the robot is as fast as this, or slower.
        for (const double speed : {fastest, 0.0})
          if (goes_at(speed, Drive::yields, true)) return true;
        if ((!both || side == weaker) && goes_at(0.0, Drive::stands)) return true;
      }
    }
    return false;
  }

  // Whether the force of a robot that yields is unique and, here, its greatest one.
  bool is_at_limit(const Regime& regime, const Frames& frames) const {
    constexpr double near = 1e-6;  // [weights]: the regime finds the place to rounding
    return regime.has_unique_forces() &&
           magnitude(detail::above_limit(problem_, regime,
                                         contacts_of(problem_, regime, frames, pose_))) < near;
  }

  // The speed of a palm along x if its contacts, and those of another carrier, stick; not a number: they
  // do not determine it.
  double speed_with(const ClosedPairs& closed, const Frames& frames, std::size_t side,
                    std::size_t partner) const {
    EchelonForm<double, 4> system;
    for (std::size_t i = 0; i < closed.count; ++i) {
      const auto& [pair, c] = closed.at[i];
      const std::size_t carrier = problem_.carrier(pair);
      if (carrier != side && carrier != partner) continue;
      for (const Vec direction : {c.normal, c.tangent}) {
        const Triple row = problem_.row(c, direction);
        system.add({row.x, row.y, row.z, carrier == side ? -direction.x : 0.0},
                   problem_.given(frames, pose_, pair, c, direction));
      }
    }
    return system.full() ? system.solution()[3] : std::numeric_limits<double>::quiet_NaN();
  }

  // Whether any candidate goes on; a reason, if the object is then on one palm only.
  struct Found {
    bool any;
    DropReason reason;
  };

  // The best candidate that goes on becomes the regime, or one of those that are as good and move the
  // object elsewhere.
  Found go_on_with(const RegimeCandidates& found, double done) {
    constexpr double elsewhere = 1e-3;  // of the way of the surfaces
    constexpr double lost = -1e-3;      // far beyond what rounding does to a condition
    std::array<double, RegimeCandidates::most> missed{};  // what fails of each
    for (double ahead = trial_; ahead < 0.1; ahead *= grown) {
      const double then = done + ahead * look_ < 1.0 ? done + ahead * look_ : 1.0;
      std::array<const RegimeCandidate*, RegimeCandidates::most> best;
      std::array<Pose, RegimeCandidates::most> ends;
      std::size_t count = 0;
      for (std::size_t k = 0; k < found.count; ++k) {
        const RegimeCandidate& one = found.at[k];
        if (count > 0 && !one.is_as_good_as(*best[0])) break;
        if (missed[k] < lost) continue;
        Place end = here();
        const Trial trial = try_out(done, then, one.regime, end);
        // What fails clearly, or the more the longer it lasts, will not hold later.
        const bool grows =
            missed[k] < -Conditions::rounding && trial.least < 0.5 * grown * missed[k];
        missed[k] = grows ? 2.0 * lost : trial.least;
        if (!trial.goes_on) continue;
        ends[count] = end.pose;
        const auto is_there = [&](const Pose& other) {
          return apart(ends[count], other) < elsewhere * (then - done) * pace_;
        };
        if (std::none_of(ends.begin(), ends.begin() + count, is_there)) best[count++] = &one;
      }
      if (count == 0) continue;
      if (problem_.on_both && !best[0]->on_both) return {true, DropReason::lifting};
      regime_ = best[ambiguous_.pick(count)]->regime;
      return {true, DropReason::none};
    }
    return {found.count > 0 && choose_later(found, done), DropReason::none};
  }

  // Where a mode is possible for an instant only, as on a palm that turns through level, or where a
  // slide reverses, the first order does not say which of its contacts slides or leaves then. One of
  // the regimes that go on follows; as many contacts as possible stay, and at most two change. Robots
  // that stall take part if both stand.
  bool choose_later(const RegimeCandidates& found, double done) {
    const auto is_instant = [&](const RegimeCandidate& one) {
      return (one.on_both || !problem_.on_both) && !lasts(done, one.regime);
    };
    const auto first = std::find_if(found.at.begin(), found.at.begin() + found.count, is_instant);
    if (first == found.at.begin() + found.count) return false;
    const Regime& instant = first->regime;
    if (instant.yields() || instant.drives[left] != instant.drives[right]) return false;
    const double later = done + 1e-3 * look_;
    const bool may_slide = !is_still(instant.drives);
    for (std::size_t leaving = 0; leaving <= 2 && leaving < instant.count; ++leaving) {
      for (std::size_t way = 1; way < std::size_t{1} << (2 * instant.count); ++way) {
        const Changes changes = changes_in(way);
        if (changes.leaving != leaving || changes.leaving + changes.sliding > 2 ||
            (changes.sliding > 0 && !may_slide))
          continue;
        const Regime regime = varied(problem_, instant, way);
        Place end = here();
        if (regime.none() || !try_out(done, later < 1.0 ? later : 1.0, regime, end).goes_on)
          continue;
        regime_ = regime;
        return true;
      }
    }
    return false;
  }

  // Whether no surface moves.
  bool is_still(const PerSide<Drive>& drives) const {
    for (const std::size_t side : {left, right}) {
      const Vec by = travel_.palms[side].by;
      if (by.y != 0.0 || (by.x != 0.0 && drives[side] != Drive::stands)) return false;
    }
    return !travel_.turns();
  }

  // The pairs that touch, those of the palm that leads first, and of each those of the regime.
  ClosedPairs closed_pairs(const Frames& frames) const {
    const ClosedPairs touching = closed_among(problem_, frames, pose_, near_, closed_);
    const std::size_t first = leading_side(frames);
    ClosedPairs closed;
    for (const std::size_t carrier : {first, other(first), std::size_t(Carrier::ground)}) {
      const auto add = [&](FeaturePair pair) {
        if (problem_.carrier(pair) == carrier && closed.count < ClosedPairs::most)
          closed.at[closed.count++] = {pair, problem_.contact(frames, pose_, pair)};
      };
      for (std::size_t i = 0; i < regime_.count; ++i) add(regime_.active[i].pair);
      for (std::size_t k = 0; k < touching.count; ++k)
        if (!regime_.has(touching.at[k].pair)) add(touching.at[k].pair);
    }
    return closed;
  }

  AmbiguousEvents& ambiguous_;
  Noted noted_;
  double trial_ = shortest_trial;  // the first one
};

}  // namespace palmbots
