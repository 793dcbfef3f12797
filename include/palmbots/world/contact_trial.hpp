// SPDX-License-Identifier: Apache-2.0
// An object among any surfaces at an instant of a step, and what a regime (world/contact_regime.hpp)
// would do from there.
#pragma once

#include "palmbots/world/regime_choice.hpp"

namespace palmbots {

class ContactTrial {
 protected:
  // `rounding` is the error of the pose at the start [m].
  ContactTrial(const ContactProblem& problem, const Travel& travel, const Pose& pose,
               Regime& regime, Neighbourhood& around, double rounding)
      : problem_(problem), travel_(travel), regime_(regime), around_(around), now_{0.0, {}, pose} {
    const double size = problem.shapes.size;
    double most = 1.0;
    for (const PalmTravel& palm : travel.palms) {
      const double moved = length(palm.by);
      const double turned = magnitude(palm.turn);
      most = larger(most, larger(moved / (0.01 * size), turned / radians_per_degree<double>));
      pace_ = larger(pace_, moved + turned * size);
    }
    look_ = 1.0 / most;
    closed_ = rounding + Tolerance::closed * size + 4.0 * instant_tolerance<double> * pace_;
  }

  // Pivots and object at an instant of the step.
  struct Place {
    double t;
    PerSide<double> lag;  // how far along x each pivot is from where the step has it [m]
    Pose pose;
  };

  void go_to(const Place& there) {
    for (const std::size_t side : {left, right})
      stalled_[side] += regime_.drives[side] == Drive::as_commanded ? 0.0 : there.t - now_.t;
    now_ = there;
  }

  // The surfaces at an instant. From `from` on, robots drive like this; one that yields is drawn where
  // it was.
  Frames frames(double t, const Place& from, const PerSide<Drive>& drives) const {
    Frames frames = travel_.frames(t);
    if (!problem_.is_limited()) return frames;
    for (const std::size_t side : {left, right}) {
      frames[side].origin.x += from.lag[side];
      if (drives[side] == Drive::as_commanded) continue;
      frames[side].origin.x -= problem_.commanded[side] * (t - from.t);
      frames[side].velocity.x = 0.0;
    }
    return frames;
  }

  // The instant so much later, at most the end of the step.
  double after(double ahead) const { return smaller(now_.t + ahead, 1.0); }

  // How far a point of the object may move between two looks at what is near, and how far it has.
  double near_move() const { return 0.02 * problem_.shapes.size; }
  double apart(const Pose& one, const Pose& other) const {
    return length(one.at - other.at) + magnitude(one.angle - other.angle) * problem_.shapes.size;
  }
  double moved(const Pose& there) const { return apart(there, now_.pose); }

  // The surfaces as if robots drove, from here on, as commanded.
  Instant instant(const Place& at) const { return {problem_, frames(at.t, at, {}), at.pose}; }
  void look_around() {
    const Instant now = instant(now_);
    near_ = around_.near(now, leading_side(now, regime_), near_move() + look_ * pace_, closed_);
  }

  // A regime between the surfaces at an instant, with the object where it was in a place before.
  PosedRegime posed(double t, const Place& place, const Regime& regime) const {
    return {{problem_, frames(t, place, regime.drives), place.pose}, regime};
  }
  PosedRegime posed(const Regime& regime) const { return posed(now_.t, now_, regime); }

  // Moves it, and the place, to where the regime has the object. False: there is no such place near.
  bool settles(double t, PosedRegime& at, Place& place) const {
    if (!settle(at)) {  // too far away: once more, from where the twist leads
      const PosedRegime from = posed(place.t, place, at.regime);
      const RegimeEquations twist(from, true);
      if (!twist.system.full()) return false;
      const auto by = twist.system.solution();
      at.frames = frames(t, place, at.regime.drives);
      at.put(from.after({by[0], by[1], by[2]}, t - place.t));
      if (!settle(at)) return false;
    }
    place.t = t;
    place.pose = at.pose;
    for (const std::size_t side : {left, right}) {
      if (at.regime.drives[side] == Drive::as_commanded) continue;
      place.lag[side] =
          at.frames[side].origin.x - travel_.palms[side].pivot.x - problem_.commanded[side] * t;
    }
    return true;
  }
  // The place that a regime reaches from another one, and its conditions there.
  struct Reached : Conditions {
    Place place;
  };
  Reached reach(double t, Place from, const Regime& regime, const Conditions* failing = nullptr,
                bool all = true) const {
    PosedRegime at = posed(t, from, regime);
    if (!settles(t, at, from)) return {{{}, 0, false}, from};
    return {conditions_of(at, near_, pace_, failing, all), from};
  }

  static constexpr double lost = -1e-3;  // far beyond what rounding does to a condition

  // Whether a regime goes on, its worst condition, and where it has the object at the end.
  struct Trial {
    bool goes_on;
    double least;
    Pose end;
  };

  // Whether a regime holds at a later instant, and its contacts slide in their directions until
  // then. They are compared from the middle on: at first the pose may jump by a rounding error. It may
  // not jump farther: where forces balance elsewhere, as when two palms pass through level together,
  // the object does not get there.
  Trial try_out(double to, const Regime& regime) const {
    const Reached end = reach(to, now_, regime, nullptr, false);
    const Trial fails{false, end.least(), end.place.pose};
    if (!end.hold() || !lasts(regime)) return fails;
    const double middle = 0.5 * (now_.t + to);
    Place half = now_;
    PosedRegime at = posed(middle, half, regime);
    if (!settles(middle, at, half)) return fails;
    const double jump = apart(now_.pose, half.pose) - 8.0 * apart(half.pose, end.place.pose);
    if (jump > Tolerance::jump * problem_.shapes.size) return fails;
    const Instant before = instant(half);
    const Instant after = instant(end.place);
    for (const ActivePair& a : regime.active) {
      if (a.motion == Motion::stick) continue;
      const double ran =
          after.contact(a.pair, a.reference).run - before.contact(a.pair, a.reference).run;
      if (way_of(a.motion) * ran < -8.0 * Tolerance::epsilon) return fails;
    }
    return {true, fails.least, fails.end};
  }

  // Whether the regime of the last step, in which no robot stalls, also holds in the motion of this
  // one. The pose is the same.
  bool goes_along() const {
    const PosedRegime at = posed(regime_);
    const RegimeEquations twist(at, true);
    if (!twist.system.full()) return false;
    Conditions all;
    all.push_back(balance_of(at));
    add_motion(all, at, twist, pace_);
    return all.hold() && (!twist.balance || is_here()) && lasts(regime_, twist);
  }

  // Whether the pose in which the forces of the regime balance is that of the object. Another push
  // than in the last step moves that pose, but not the object.
  bool is_here() const {
    PosedRegime there = posed(regime_);
    return settle(there) && moved(there.pose) <= closed_;
  }

  bool lasts(const Regime& regime) const { return lasts(regime, {posed(regime), true}); }
  // Whether more contacts stick than the pose has unknowns, and do so for longer than an instant.
  bool lasts(const Regime& regime, const RegimeEquations& twist) const {
    if (!twist.spare) return true;
    PosedRegime later = posed(after(0.01 * look_), now_, regime);
    return settle(later);
  }

  // The pairs that touch, those of the palm that leads first, and of each those of the regime.
  ClosedPairs closed_pairs(const Instant& now) const {
    ClosedPairs closed;
    for (const ActivePair& a : regime_.active) closed.push_back(now.contact(a.pair));
    for (const FeatureContact& c : closed_among(now, near_, closed_))
      if (!regime_.has(c.pair) && !closed.full()) closed.push_back(c);
    const bool is_right_first = leading_side(now, regime_) == right;
    sort_few(closed.begin(), closed.size(), [&](const FeatureContact& c) {
      return c.pair.carrier == right && is_right_first ? -1 : int(c.pair.carrier);
    });
    return closed;
  }

  // Whether the forces here permit that robots drive like this, so that a trial is worth its while: they
  // are within the limits, or nearly. Where the force of a robot that yields is unique, it is its
  // greatest one.
  bool can_drive(const Regime& regime) const {
    constexpr double near = 1e-6;  // [weights]: the regime finds the place to rounding
    if (!problem_.is_limited()) return true;
    const PosedRegime at = posed(regime);
    if (regime.yielding() <= right && regime.has_unique_forces() &&
        !(magnitude(above_limit(at)) < near))
      return false;
    Conditions limits;
    add_limits(limits, at);
    return limits.least() > 2.0 * lost;
  }

  // The speed of a palm along x if its contacts, and those of another carrier, stick; not a number: they
  // do not determine it.
  static double speed_with(const ClosedPairs& closed, const Instant& now, std::size_t side,
                           std::size_t partner) {
    RegimeEquations::System system;
    for (const FeatureContact& c : closed) {
      if (c.pair.carrier != side && c.pair.carrier != partner) continue;
      for (const Vec direction : {c.normal, c.tangent}) {
        const Triple row = now.row(c, direction);
        system.add({row.x, row.y, row.z, c.pair.carrier == side ? -direction.x : 0.0},
                   now.given(c, direction));
      }
    }
    return system.full() ? system.solution()[3] : std::numeric_limits<double>::quiet_NaN();
  }

  const ContactProblem& problem_;
  const Travel& travel_;
  Regime& regime_;
  Neighbourhood& around_;
  Place now_;
  PerSide<double> stalled_{};
  double look_ = 1.0;
  double pace_ = 0.0;    // how far a point of a surface moves in the step, at most [m]
  double closed_ = 0.0;  // a gap that counts as closed at an event [m]
  NearPairs near_;
};

}  // namespace palmbots
