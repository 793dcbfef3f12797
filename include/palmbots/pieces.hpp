// A step of the world in which more happens than one contact sliding: cut into pieces of one regime.
//
// In a regime the sliding coordinates are closed-form functions of the time within the step. What ends
// it, and where it ends, is the root of a condition along them:
//
//   reversal   the palms stop driving the contact points together and start driving them apart (this
//              can happen inside a step only while a palm turns);
//   tie        the squeezes at which the two contacts let go become equal. Where each slider drives
//              towards the other's region both slide from there on and keep them equal; where one
//              drives on into its own region it alone slides; where either would (a symmetric object
//              closed on by equal palms), both slide and stay equal, by rule;
//   end        the object is no longer held by its two vertices alone: the carry is over, or a further
//              contact closes, which the world looks into.
//
// At fixed angles every condition is a bound on dy / dx, along which a regime moves monotonically, so
// that a look at the end of the step misses nothing. While a palm turns, a step is cut into pieces of
// at most 1° for the same look.
//
// Source: MECHANICS sections 1, 2, 5, 6.
#pragma once

#include "palmbots/locate.hpp"
#include "palmbots/resting.hpp"
#include "palmbots/stride.hpp"

namespace palmbots {

// One step, cut into pieces.
template <class Real>
struct Pieces {
  const Rig<Real>& rig;
  Pose<Real>& pose;
  Real change;
  PerSide<Real> angles;
  Real separation = pose.stance.separation;
  PerSide<Real> from{pose.stance.palms[left].angle, pose.stance.palms[right].angle};
  PerSide<Real> turn{angles[left] - from[left], angles[right] - from[right]};
  bool turning = turn[left] != Real(0) || turn[right] != Real(0);
  PerSide<PalmAngle<Real>> turned{at_its_goal(left), at_its_goal(right)};
  Moments<Real> pushed = moments_under(rig.load, pose.push);

  // Which contacts slide in a piece.
  enum class Slider : std::uint8_t { on_left = 0, on_right = 1, both = 2, none = 3 };

  struct State {
    Stance<Real> stance;
    Span<Real> span;
  };

  // What decides, in one direction, which contact lets go.
  struct LettingGo {
    PerSide<bool> wedged;  // that contact does not, in this direction
    Real left_first;       // > 0: the left one does first; < 0: the right one; of unwedged ones
  };

  static constexpr int most_reversals = 16;  // in a step: a bound on work

  static constexpr Real sense_of(Slide direction) { return Real(static_cast<int>(direction)); }

  [[gnu::noinline]] Advance<Real> run() {
    Advance<Real> result;
    State now{pose.stance, pose.span};
    Real done = Real(0);
    Real look = longest_look();
    Slide direction = Slide::stick;
    bool known = false;  // the direction, from the event that ended the last piece
    int reversals = 0;
    for (result.pieces = 1;; ++result.pieces) {
      const bool give_up = result.pieces >= 200;  // a bound on work; tests show it is not met
      const Real goal = done + look >= Real(1) || give_up ? Real(1) : done + look;
      if (!known) direction = direction_at(now, goal);
      known = false;
      const LettingGo first = letting_go(now, direction);
      if (direction != Slide::stick && first.wedged[left] && first.wedged[right]) {
        result.end = End::jammed;
        return finish(result, now, done, Slider::none, direction);
      }
      const auto [slider, then] = choose(now, first, direction, goal);
      if (slider == Slider::both && turning && !legal(now, then, direction) &&
          goal - done > Real(1) / Real(1024)) {
        look = Real(0.5) * (goal - done);  // both slide for only a part of this piece
        continue;
      }
      look = longest_look();
      const auto at = [&, slider = slider](Real t) { return state(t, slider, direction, now); };
      // A contact right at its pivot, on a palm that turns, would go to and fro by a rounding error.
      const bool reverses = reversals < most_reversals;
      const auto [event, when] =
          first_event(done, goal, now, then, slider, direction, give_up, reverses, at);
      switch (event) {
        case Event::none:
          if (slider != Slider::both) pose.tied = Real(0);
          if (goal >= Real(1)) return finish(result, then, Real(1), slider, direction);
          now = then;
          done = goal;
          break;
        case Event::end: {
          // The reason is read where it first applies, the state where it last did not.
          const Real over = std::nextafter(when, Real(2));
          result.end = end_of(at(over < goal ? over : goal));
          return finish(result, at(when), when, slider, direction);
        }
        case Event::reversal:
          now = at(when);
          done = when;
          direction = direction == Slide::up ? Slide::down : Slide::up;
          pose.tied = Real(0);
          known = true;
          ++reversals;
          break;
        case Event::tie:
          now = at(when);
          done = when;
          pose.tied = sense_of(direction);
          known = true;
          break;
      }
    }
  }

  enum class Event : std::uint8_t { none, end, reversal, tie };
  struct Happening {
    Event event;
    Real when;
  };

  // The earliest event between `done` and `goal`, given the state now, and at `goal` if there were none.
  template <class At>
  Happening first_event(Real done, Real goal, const State& now, const State& then, Slider slider,
                        Slide direction, bool give_up, bool reverses, At at) const {
    Happening first{Event::none, goal};
    const auto note = [&](Event event, Real when) {
      if (first.event == Event::none || when < first.when) first = {event, when};
    };
    if (end_of(then) != End::none) {
      note(Event::end,
           last_holding(done, goal, [&](Real t) { return end_of(at(t)) == End::none; }));
    }
    if (give_up) return first;
    const auto drives_on = [&](const State& s) {
      return direction == Slide::up ? -drive(s) : drive(s);
    };
    if (turning && direction != Slide::stick && reverses) {
      const Real last = drives_on(then);
      if (last < Real(0)) {
        note(Event::reversal, root(true, done, drives_on(now), goal, last,
                                   [&](Real t) { return drives_on(at(t)); }));
      }
    }
    if (slider == Slider::on_left || slider == Slider::on_right) {
      const auto ahead = [&](const State& s) { return own_choice(s, slider, direction); };
      const Real last = ahead(then);
      if (last < Real(0)) {
        note(Event::tie,
             root(true, done, ahead(now), goal, last, [&](Real t) { return ahead(at(t)); }));
      }
    }
    return first;
  }

  Real longest_look() const {
    Real most = Real(0);
    for (const Real t : turn) {
      const Real size = t < Real(0) ? -t : t;
      if (size > most) most = size;
    }
    return most > longest_turn<Real> ? longest_turn<Real> / most : Real(1);
  }

  // The state at a fraction t of the step, if `slider` slides from `now` on.
  State state(Real t, Slider slider, Slide direction, const State& now) const {
    State then = now;
    then.stance.separation = separation + t * change;
    if (t == Real(1)) {
      then.stance.palms = turned;
    } else if (turning) {
      for (const std::size_t side : {left, right}) {
        if (turn[side] == Real(0)) continue;
        then.stance.palms[side] = PalmAngle<Real>::at(from[side] + t * turn[side]);
      }
    }
    const auto& offset = rig.offset;
    const Real width = rig.load.width;
    if (slider == Slider::both) {
      const auto edges = edges_at(rig.friction, then.stance.palms, sense_of(direction));
      const Tie<Real> equal = tie(pushed, edges[left], edges[right]);
      const Real slope =
          equal.tilt != Real(0) ? -equal.level / equal.tilt : now.span.dy / now.span.dx;
      then.stance.contacts = slid_along(then.stance, slope, offset, width);
    } else if (slider != Slider::none) {
      const auto side = static_cast<std::size_t>(slider);
      const auto next = slid(then.stance.separation, then.stance.palms, side,
                             then.stance.contacts[other(side)], offset, width);
      then.stance.contacts[side] = next.contact;
      then.span = next.span;
      return then;
    }
    then.span = palmbots::span(then.stance, offset);
    return then;
  }

  End end_of(const State& s) const {
    const Real safe = rig.safe_reach;
    const auto& p = s.stance.contacts;
    if (within(p[left], safe) && within(p[right], safe)) return End::none;
    const Statics<Real> statics = Statics<Real>::at(rig, s.stance.palms);
    return first_end(rig, statics, s.stance.palms, s.stance.contacts, s.span);
  }

  PalmAngle<Real> at_its_goal(std::size_t side) const {
    return turn[side] == Real(0) ? pose.stance.palms[side] : PalmAngle<Real>::at(angles[side]);
  }

  Real drive(const State& s) const {
    return drive_rate(s.stance.palms, s.stance.contacts, rig.offset, s.span, change, turn);
  }

  Slide direction_at(const State& now, Real goal) const {
    Real rate = change;
    if (turning) {
      rate = drive(now);
      if (rate == Real(0)) rate = drive(state(goal, Slider::none, Slide::stick, now));
    }
    return direction_of(rate);
  }

  LettingGo letting_go(const State& s, Slide direction) const {
    const auto edges = edges_at(rig.friction, s.stance.palms, sense_of(direction));
    const auto is_wedged = [&](std::size_t side) {
      return wedged(side, edges[side], s.span.dx, s.span.dy);
    };
    return {{is_wedged(left), is_wedged(right)},
            left_first(tie(pushed, edges[left], edges[right]), direction, s.span)};
  }

  // ≥ 0 while the sliding contact is still the one that lets go first.
  Real own_choice(const State& s, Slider slider, Slide direction) const {
    const LettingGo first = letting_go(s, direction);
    if (first.wedged[left] || first.wedged[right]) return Real(0);
    return slider == Slider::on_left ? first.left_first : -first.left_first;
  }

  // What slides, and where that leads by `goal`.
  struct Choice {
    Slider slider;
    State then;
  };

  Choice choose(const State& now, const LettingGo& first, Slide direction, Real goal) const {
    const auto with = [&](Slider slider) {
      return Choice{slider, state(goal, slider, direction, now)};
    };
    if (direction == Slide::stick) return with(Slider::none);
    if (first.wedged[left]) return with(Slider::on_right);
    if (first.wedged[right]) return with(Slider::on_left);
    if (pose.tied != sense_of(direction) && first.left_first != Real(0)) {
      return with(first.left_first > Real(0) ? Slider::on_left : Slider::on_right);
    }
    // On the tie: does one slider, alone, go on into its own region?
    const Choice one = with(Slider::on_left);
    const Choice another = with(Slider::on_right);
    const bool one_goes_on = own_choice(one.then, one.slider, direction) > Real(0);
    const bool another_goes_on = own_choice(another.then, another.slider, direction) > Real(0);
    if (one_goes_on != another_goes_on) return one_goes_on ? one : another;
    pose.tied = sense_of(direction);
    return with(Slider::both);
  }

  // Both contacts moved the way this direction allows.
  bool legal(const State& now, const State& then, Slide direction) const {
    const Real sense = direction == Slide::up ? Real(1) : Real(-1);
    const auto& p = now.stance.contacts;
    const auto& q = then.stance.contacts;
    const Real slack = Real(16) * std::numeric_limits<Real>::epsilon() * rig.load.width;
    return (q[left] - p[left]) * sense >= -slack && (q[right] - p[right]) * sense >= -slack;
  }

  Advance<Real> finish(Advance<Real> result, const State& s, Real done, Slider slider,
                       Slide direction) const {
    pose.stance = s.stance;
    pose.span = s.span;
    result.fraction = done;
    if (slider == Slider::on_left || slider == Slider::both) result.motion[left] = direction;
    if (slider == Slider::on_right || slider == Slider::both) result.motion[right] = direction;
    return result;
  }
};

}  // namespace palmbots
