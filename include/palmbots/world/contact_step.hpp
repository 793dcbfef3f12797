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
#include <optional>
#include <utility>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/root_finding.hpp"
#include "palmbots/world/contact_trial.hpp"
#include "palmbots/world/state.hpp"

namespace palmbots {

// A regime that the world took although others were as good, at a fraction of the last step.
struct AmbiguousChoice {
  double fraction;
  Regime regime;
};

// Which of several motions that are possible alike follows: one by the rules of
// world/regime_choice.hpp, or any of them with equal probability, by a counter-based draw for each
// such event.
struct AmbiguousEvents {
  bool is_drawn = false;
  std::uint64_t seed = 0;
  std::uint32_t stream = 0;
  std::uint32_t count = 0;  // of those that have occurred

  template <class Rule>
  std::size_t pick(std::size_t of, Rule rule) {
    if (of == 1) return 0;
    const std::uint32_t event = count++;
    return is_drawn ? draw(seed, event, stream)[0] % of : rule();
  }
};

// `rounding` is the error of the pose at the start [m]; `noted(instant, t, run_off)` is called whenever a
// regime has been chosen; `run_off` are the contacts of the last one that ran off the end of a feature.
template <class Noted>
class ContactStep : ContactTrial {
 public:
  static constexpr int most_events = 200;

  ContactStep(const ContactProblem& problem, const Travel& travel, Pose& pose, Regime& regime,
              Neighbourhood& around, AmbiguousEvents& ambiguous, double rounding, Noted noted)
      : ContactTrial(problem, travel, pose, regime, around, rounding),
        pose_(pose),
        ambiguous_(ambiguous),
        noted_(noted) {}

  // From the instant `done` on. Without a regime, or where it has ended, it begins with a choice.
  Advance<double> run(double done = 0.0) {
    if (!(pace_ > 0.0)) return {};
    now_.t = done;
    const DropReason reason = go();
    pose_ = now_.pose;
    return {reason, now_.t, {}, pieces_, now_.lag, stalled_};
  }

 private:
  static constexpr double shortest = 1e-6;  // piece of a step
  // How long a regime is tried, in parts of a piece.
  static constexpr double shortest_trial = 1e-7;
  static constexpr double longest_trial = 0.099;
  static constexpr double grown = 16.0;

  // Moves the object to the end of the step, or to where it ends before, and returns why.
  DropReason go() {
    look_around();
    // Robots that stall try again in every step.
    if (regime_.none() || regime_.stalls() || !goes_along()) {
      if (const DropReason reason = choose(); reason != DropReason::none) return reason;
    }
    double ahead = look_;
    while (now_.t < 1.0) {
      const double goal = after(ahead);
      Reached then = reach(goal, now_, regime_);
      if (then.settled && goal - now_.t > shortest && moved(then.place.pose) > near_move()) {
        ahead = 0.5 * (goal - now_.t);  // slow palms can turn the object fast
        continue;
      }
      ahead = look_;
      if (then.hold()) {
        go_to(then.place);
        if (goal < 1.0) look_around();
        continue;
      }
      go_to_event(goal, then);
      at_end_.clear();
      for (std::size_t i = 0; then.settled && i < regime_.active.size(); ++i)
        if (then[then.of_motion + i] < -Conditions::rounding) at_end_.push_back(regime_.active[i]);
      look_around();
      if (++pieces_ > most_events) return DropReason::jammed;
      const Regime ended = regime_;
      if (const DropReason reason = choose(); reason != DropReason::none) return reason;
      // What goes on has to go on for longer each time, so that no condition that is only just met ends
      // it again and again.
      const bool again = regime_.is_like(ended) && regime_.drives == ended.drives;
      trial_ = again ? smaller(grown * trial_, longest_trial) : shortest_trial;
    }
    return DropReason::none;
  }

  // Moves object and pivots to the first instant at which a condition that fails at `goal` does, and
  // sets `then` to those that fail there. Only they take part in the search: others may be near zero
  // all the time.
  void go_to_event(double goal, Conditions& then) {
    const Conditions now = conditions_of(posed(regime_), near_, pace_);
    const Place start = now_;
    for (int i = 0; i < most_events; ++i) {
      const bool is_behind = then.settled && !then.spare_behind();
      // Not a number, so that the search bisects and does not take a jump for a slope.
      constexpr double jumps = std::numeric_limits<double>::quiet_NaN();
      const auto worst = [&](const Conditions& at) {
        if (!at.settled) return jumps;
        double least = Conditions::met;
        for (std::size_t k = 0; k < at.size(); ++k) {
          if (!(then[k] < -Conditions::rounding) && then.settled) continue;
          // What starts at zero, such as a corner of an edge that lies flush, does not show when it
          // fails before it does.
          const bool blank = now[k] < Tolerance::blank && (&at == &now || at[k] >= 0.0);
          if (!blank) least = smaller(least, at[k]);
        }
        return least == Conditions::behind ? jumps : least;
      };
      const double from = worst(now);
      double before = from;                      // the good end
      std::array<double, 2> failed{goal, goal};  // the last instants at which something fails
      std::array<double, 2> by{worst(then), jumps};
      const auto at = [&](double t) {
        double value = worst(reach(t, start, regime_, then.settled ? &then : nullptr));
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
      double when = bracketed_root(from > 0.0, start.t, from, goal, to, at, Tolerance::instant);
      if (!(when > start.t)) return;
      const Reached there = reach(when, start, regime_);
      Conditions found = there;
      if (found.hold() && is_behind) found = passed(when, start);
      if (found.hold()) return go_to(there.place);
      goal = when;
      then = found;
    }
  }

  // A pair that is behind where it can touch came there past another one, which closed for a while.
  // Looks for that; `when` becomes an instant at which it is closed.
  Conditions passed(double& when, const Place& start) const {
    constexpr int looks = 16;
    const double end = when;
    for (int k = 1;; ++k) {
      when = start.t + (end - start.t) * (double(k) / looks);
      const Conditions found = reach(when, start, regime_);
      if (k == looks || !found.hold()) return found;
    }
  }

  // Chooses the regime that continues from here. Returns why there is none.
  DropReason choose() {
    const Instant now = instant(now_);
    if (off_palm(now, closed_)) return DropReason::off_palm;
    const DropReason reason = choose_among(closed_pairs(now), now);
    if (reason != DropReason::none) return reason;
    ActivePairs run_off;
    for (const ActivePair& one : at_end_)
      if (has_run_off(now, one, regime_)) run_off.push_back(one);
    noted_(now, now_.t, run_off);
    return reason;
  }

  // Robots stall only if there is no motion in which both drive, and the object does not fall.
  DropReason choose_among(const ClosedPairs& closed, const Instant& now) {
    // A tip that moves along an arc leaves it without a speed, as may what touches a palm that turns:
    // that shows only a little later.
    constexpr double later = 1e-3;  // of a step
    const bool looks_later = travel_.turns() || std::ranges::any_of(closed, [](const auto& c) {
                               return c.pair.kind == PairKind::tip_on_arc;
                             });
    const RegimeSearch search(now, closed);
    RegimeCandidates as_commanded = search.candidates(now.frames);
    std::optional<DropReason> driven = go_on_with(as_commanded);
    if (!driven && looks_later) {
      const Frames then = palmbots::moved(now.frames, later);
      driven = go_on_with(RegimeSearch({problem_, then, now.pose}, closed).candidates(then));
    }
    if (driven) return *driven;
    const DropReason why = reason_of(problem_, closed);
    if (why != DropReason::none) return why;
    // What has run off its feature holds the object no more. What is at the end of its feature because
    // an edge lies flush there does.
    ClosedPairs rest;
    for (const FeatureContact& c : closed) {
      const auto lies_flush_with = [&](const FeatureContact& other) {
        return c.pair.carrier == other.pair.carrier && in_one_direction(c, other) &&
               !at_one_point(c, other, problem_.shapes.size);
      };
      if (!regime_.has(c.pair) || c.inside > Tolerance::blank ||
          std::ranges::any_of(closed, lies_flush_with))
        rest.push_back(c);
    }
    const DropReason then = rest.size() < closed.size() ? reason_of(problem_, rest) : why;
    if (then != DropReason::none) return then;
    const bool stalls = problem_.is_limited() && stall(search, as_commanded, closed, now);
    return stalls ? DropReason::none : DropReason::jammed;
  }

  // Chooses a regime in which a robot stalls: the weaker one; otherwise the stronger one; otherwise
  // both, the weaker one up to standing. False if there is none.
  bool stall(const RegimeSearch& search, RegimeCandidates& as_commanded, const ClosedPairs& closed,
             const Instant& now) {
    constexpr auto ground = static_cast<std::size_t>(Carrier::ground);
    const PerSide<double>& limit = problem_.limit;
    std::size_t weaker = limit[left] < limit[right] ? left : right;
    if (limit[left] == limit[right]) weaker = leading_side(now, regime_);
    const std::size_t stronger = other(weaker);
    // While this robot stands, or both do (2): made when first needed.
    std::array<RegimeCandidates, 3> made;
    std::array<bool, 3> is_made{};
    struct Attempt {
      std::size_t side;
      bool both;
    };
    for (const auto [side, both] : {Attempt{weaker, false}, Attempt{stronger, false},
                                    Attempt{stronger, true}, Attempt{weaker, true}}) {
      const std::size_t partner = other(side);
      const double fastest = problem_.commanded[side];
      const double sense = problem_.sense(side);
      if (fastest == 0.0 || (both && problem_.commanded[partner] == 0.0)) continue;
      Instant moving = now;
      PerSide<Drive> drives{};
      if (both) {
        drives[partner] = Drive::stands;
        moving.frames[partner].velocity.x = 0.0;
      }
      const auto goes = [&, side = side](RegimeCandidates& all, Drive drive, bool at_limit) {
        drives[side] = drive;
        for (RegimeCandidate& one : all) one.regime.drives = drives;
        return go_on_with(all, at_limit) == DropReason::none;
      };
      const auto at = [&, side = side](double speed) {
        moving.frames[side].velocity.x = speed;
        return search.candidates(moving.frames);
      };
      for (const std::size_t held_by : {partner, ground}) {
        moving.frames[side].velocity.x = 0.0;
        const double speed = speed_with(closed, moving, side, held_by);
        const double least = Tolerance::rate * pace_;
        if (!(sense * speed > least && sense * (fastest - speed) > -least)) continue;
        RegimeCandidates all = at(speed);
        if (goes(all, Drive::yields, false)) return true;
      }
      // A contact slides while the robot exerts its greatest force. Its direction does not depend on
      // whether the robot is as fast as this, or slower.
      const auto known = [&](std::size_t standing, double speed) -> RegimeCandidates& {
        if (!std::exchange(is_made[standing], true)) made[standing] = at(speed);
        return made[standing];
      };
      RegimeCandidates& fast = both ? known(partner, fastest) : as_commanded;
      if (goes(fast, Drive::yields, true)) return true;
      RegimeCandidates& still = known(both ? 2 : side, 0.0);
      if (goes(still, Drive::yields, true)) return true;
      if ((!both || side == weaker) && goes(still, Drive::stands, false)) return true;
    }
    return false;
  }

  using Best = FixedList<const RegimeCandidate*, RegimeCandidates::capacity>;
  // The number of the one that follows by the rule: of those in which all contacts slide, if there are
  // some, the one with the largest margin; of several, the one in which the robot in front slides.
  std::size_t by_rule(const Best& best) const {
    if (best[1]->alike != best[0]->alike) return 0;
    constexpr double same = 1e-9;  // margins that differ by less [rad]
    const Instant now = instant(now_);
    const double travel = now.frames[left].velocity.x + now.frames[right].velocity.x;
    const std::size_t front =
        travel == 0.0 ? leading_side(now, regime_) : (travel < 0.0 ? left : right);
    const auto held = [&](std::size_t k) {  // contacts of the robot in front that stick
      return std::ranges::count_if(best[k]->regime.active, [&](const ActivePair& a) {
        return a.pair.carrier == front && a.motion == Motion::stick;
      });
    };
    std::size_t found = 0;
    double most = margin_in(posed(best[0]->regime));
    for (std::size_t k = 1; k < best.size() && best[k]->alike == best[0]->alike; ++k) {
      const double margin = margin_in(posed(best[k]->regime));
      if (!(margin > most + same || (margin + same >= most && held(k) < held(found)))) continue;
      found = k;
      most = margin;
    }
    return found;
  }

  // The best candidate that goes on becomes the regime, or one of those that are as good and move the
  // object elsewhere; `at_limit`: of those in which a robot that yields exerts its greatest force.
  // Nothing: none goes on. A reason: the object is then on one palm only.
  std::optional<DropReason> go_on_with(const RegimeCandidates& found, bool at_limit = false) {
    constexpr double elsewhere = 1e-3;                        // of the way of the surfaces
    std::array<double, RegimeCandidates::capacity> missed{};  // what fails of each
    for (double ahead = trial_; ahead < 0.1; ahead *= grown) {
      const double then = after(ahead * look_);
      Best best;
      FixedList<Pose, RegimeCandidates::capacity> ends;
      for (std::size_t k = 0; k < found.size(); ++k) {
        const RegimeCandidate& one = found[k];
        if (!best.empty() && !one.is_as_good_as(*best[0])) break;
        if (ahead == trial_ &&
            ((at_limit && !one.regime.has_unique_forces()) || !can_drive(one.regime)))
          missed[k] = 2.0 * lost;
        if (missed[k] < lost) continue;
        const Trial trial = try_out(then, one.regime);
        // What fails clearly, or the more the longer it lasts, will not hold later.
        const bool grows =
            missed[k] < -Conditions::rounding && trial.least < 0.5 * grown * missed[k];
        missed[k] = grows ? 2.0 * lost : trial.least;
        const auto is_there = [&](const Pose& other) {
          return apart(trial.end, other) < elsewhere * (then - now_.t) * pace_;
        };
        if (!trial.goes_on || std::ranges::any_of(ends, is_there)) continue;
        best.push_back(&one);
        ends.push_back(trial.end);
      }
      if (best.empty()) continue;
      if (problem_.on_both && !best[0]->on_both) return DropReason::lifting;
      regime_ = best[ambiguous_.pick(best.size(), [&] { return by_rule(best); })]->regime;
      return DropReason::none;
    }
    return choose_later(found) ? std::optional(DropReason::none) : std::nullopt;
  }

  // Where a mode is possible for an instant only, as on a palm that turns through level, or where a
  // slide reverses, the first order does not say which of its contacts slides or leaves then. One of
  // the regimes that go on follows; as many contacts as possible stay, and at most two change. Robots
  // that stall take part if both stand.
  bool choose_later(const RegimeCandidates& found) {
    if (found.empty()) return false;
    const PerSide<Drive> drives = found[0].regime.drives;
    if (drives[left] != drives[right] || drives[left] == Drive::yields) return false;
    const auto is_instant = [&](const RegimeCandidate& one) {
      return (one.on_both || !problem_.on_both) && !lasts(one.regime);
    };
    const auto first = std::ranges::find_if(found, is_instant);
    if (first == found.end()) return false;
    const Regime& instant = first->regime;
    const std::size_t most = instant.active.size();
    // What each contact may do: it leaves or, if it sticks, slides.
    struct Change {
      std::size_t contact;
      Motion motion;
    };
    FixedList<Change, 3 * max_supports> changes;
    const bool may_slide = pace_of(frames(now_.t, now_, drives), problem_.shapes.size) > 0.0;
    for (std::size_t i = 0; i < most; ++i)
      for (const Motion motion : {Motion::up, Motion::down, Motion::leave})
        if (motion == Motion::leave || (may_slide && instant.active[i].motion == Motion::stick))
          changes.push_back({i, motion});
    for (std::size_t stay = most; stay > 0 && stay + 2 >= most; --stay) {
      for (std::size_t j = 0; j < changes.size(); ++j) {
        for (std::size_t i = j + 1; i-- > 0;) {  // i = j: one change
          if (i != j && changes[i].contact == changes[j].contact) continue;
          Regime regime = instant;
          for (const Change& change : {changes[i], changes[j]})
            regime.active[change.contact].motion = change.motion;
          regime.let_go();
          if (regime.active.size() != stay || (problem_.on_both && !regime.is_on_both()) ||
              !try_out(after(1e-3 * look_), regime).goes_on)
            continue;
          regime_ = regime;
          return true;
        }
      }
    }
    return false;
  }

  Pose& pose_;
  AmbiguousEvents& ambiguous_;
  Noted noted_;
  ActivePairs at_end_;  // the contacts that ended the last regime at the end of a feature
  double trial_ = shortest_trial;  // the first one
  std::int32_t pieces_ = 1;
};

}  // namespace palmbots
