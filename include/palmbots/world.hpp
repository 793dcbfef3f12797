// The quasistatic world: exact motion of the contacts while the robots move and the palms turn.
//
// A step changes the separation and the palm angles linearly. Nothing is integrated: in every regime
// (one contact slides, or both do) the sliding coordinates are closed-form roots of the loop
// constraint at any instant, and a contact that sticks is never written, so it cannot drift. What
// remains is to find the instants where the regime changes:
//
//   reversal   the palms stop driving the contact points together and start driving them apart (this
//              can happen inside a step only while a palm turns);
//   tie        the squeezes at which the two contacts let go become equal. Where each slider drives
//              towards the other's region both slide from there on and keep them equal; where one
//              drives on into its own region it alone slides; where either would (a symmetric object
//              closed on by equal palms), both slide and stay equal, by rule;
//   touch      a further contact closes: resting.hpp takes over until it opens again;
//   end        the carry is over.
//
// At fixed angles every condition is a bound on dy / dx, along which a regime moves monotonically,
// so that a look at the end of the step misses nothing. While a palm turns, a step is cut into
// pieces of at most 1° for the same look.
//
// `push` is the sideways specific force of the object's inertia when the pair changes its speed
// (MECHANICS section 4). It decides only which contact lets go first. It is small, but so is what it
// competes with: with φ near θ the lower ends of the squeeze intervals are close to zero and to each
// other, and a symmetric object under no push at all stays symmetric for ever, which no real one
// does. What ends a carry is judged without it.
//
// Source: MECHANICS sections 1, 2, 4, 5, 6.
#pragma once

#include "palmbots/resting.hpp"

namespace palmbots {

template <class Real>
class World {
 public:
  World() = default;
  World(const Rig<Real>& rig, const Stance<Real>& stance)
      : rig_(rig),
        stance_(stance),
        statics_(Statics<Real>::at(rig, stance.palms)),
        pushed_(rig.moments) {
    span_ = palmbots::span(stance_, rig_.offset);
  }

  const Stance<Real>& stance() const { return stance_; }
  const Rig<Real>& rig() const { return rig_; }
  Span<Real> span() const { return span_; }
  // Where the palm is touched: p of its contact vertex as long as that is on it.
  Real touched(std::size_t side) const {
    return grip_.none() ? stance_.contacts[side] : felt(rig_, grip_, stance_, side);
  }
  const Advance<Real>& last() const { return last_; }

  // What the object rests on; none: its two contact vertices.
  const Grip<Real>& grip() const { return grip_; }
  const Touches<Real>& touches() const { return touches_; }

  // Why the object is not held where it is now (none: it is).
  End check() const {
    if (!grip_.none()) return Instant<Real>(rig_, stance_, {}, grip_).check();
    const End end = first_end(rig_, statics_, stance_.palms, stance_.contacts, span_);
    if (!is_touch(end)) return end;
    const Instant<Real> now(rig_, stance_, {}, grip_);
    const End found = now.check();
    return now.kind() == Touch::none || is_touch(found) ? end : found;
  }

  // A sudden shift of contacts; the robots under them are displaced so that the loop stays closed.
  End shift(const PerSide<Real>& by) {
    for (const std::size_t side : {left, right}) stance_.contacts[side] += by[side];
    stance_.lift = {};
    stance_.separation = closing_separation(stance_, rig_.offset, rig_.load.width);
    span_ = palmbots::span(stance_, rig_.offset);
    tied_ = Slide::stick;
    grip_ = {};
    return check();
  }

  // Changes the separation by `change` [m] and turns the palms to `angles` [rad], both linearly.
  // Returns what happened, valid until the next step.
  const Advance<Real>& advance(Real change, const PerSide<Real>& angles, Real push = Real(0)) {
    const bool turning =
        angles[left] != stance_.palms[left].angle || angles[right] != stance_.palms[right].angle;
    if (push != push_) {
      push_ = push;
      pushed_ = Moments<Real>::of(pushed(rig_.load, push));
      tied_ = Slide::stick;  // a tie lies elsewhere under another push
    }
    const bool done = grip_.none() && (turning ? slide_one<true>(change, angles)
                                               : slide_one<false>(change, angles));
    if (!done) last_ = go(change, angles);
    return last_;
  }

 private:
  static constexpr int most_changes = 6;  // of grip in a step: a bound on work

  // How far a palm turns between two looks for events.
  static constexpr Real longest_turn = radians_per_degree<Real>;

  // Which contacts slide in a piece.
  enum class Slider : std::uint8_t { on_left = 0, on_right = 1, both = 2, none = 3 };

  Real drive(const PerSide<PalmAngle<Real>>& palms, const PerSide<Real>& contacts, Span<Real> span,
             Real change, const PerSide<Real>& turn) const {
    return drive_rate(palms, contacts, rig_.offset, span, change, turn);
  }

  Tie<Real> let_go(const Statics<Real>& statics, Slide direction) const {
    return statics.let_go(pushed_, direction);
  }

  // The common case, without ceremony: one contact slides through the whole step. Returns false, and
  // changes nothing, if anything else is going on. Written so that everything stays in registers
  // until the step is known to be good: copying a struct just written stalls the processor.
  template <bool turning>
  [[gnu::noinline]] bool slide_one(Real change, const PerSide<Real>& angles) {
    PerSide<Real> turn{};
    Slide direction = direction_of(change);
    if constexpr (turning) {
      for (const std::size_t side : {left, right}) {
        turn[side] = angles[side] - stance_.palms[side].angle;
        if (!(turn[side] < longest_turn && turn[side] > -longest_turn)) return false;
      }
      direction = direction_of(drive(stance_.palms, stance_.contacts, span_, change, turn));
    }
    const bool left_wedged = statics_.wedged_in(left, direction, span_);
    const bool right_wedged = statics_.wedged_in(right, direction, span_);
    const bool plain = (direction != Slide::stick) & (tied_ != direction);
    const bool free = !left_wedged & !right_wedged;
    if (!(plain & free)) return false;
    const Tie<Real> tie_before = let_go(statics_, direction);
    const Real ahead = left_first(tie_before, direction, span_);
    if (ahead == Real(0)) return false;
    return ahead > Real(0)
               ? slide_side<turning, left>(change, angles, turn, direction, tie_before)
               : slide_side<turning, right>(change, angles, turn, direction, tie_before);
  }

  template <bool turning, std::size_t side>
  [[gnu::always_inline]] bool slide_side(Real change, const PerSide<Real>& angles,
                                         const PerSide<Real>& turn, Slide direction,
                                         const Tie<Real>& tie_before) {
    PerSide<PalmAngle<Real>> palms = stance_.palms;
    Statics<Real> statics = statics_;
    if constexpr (turning) {
      for (const std::size_t i : {left, right}) {
        if (turn[i] != Real(0)) palms[i] = PalmAngle<Real>::at(angles[i]);
      }
      statics = Statics<Real>::at(rig_, palms);
    }
    const Real separation = stance_.separation + change;
    const Slid<Real> next =
        slid(separation, palms, side, stance_.contacts[other(side)], rig_.offset, rig_.load.width);
    PerSide<Real> contacts{};
    contacts[side] = next.contact;
    contacts[other(side)] = stance_.contacts[other(side)];
    Tie<Real> tie_after = tie_before;
    if constexpr (turning) {
      if (direction_of(drive(palms, contacts, next.span, change, turn)) != direction) return false;
      tie_after = let_go(statics, direction);
    }
    if (!(mirrored(side, left_first(tie_after, direction, next.span)) > Real(0)) ||
        !plainly_held(rig_, statics, palms, contacts, next.span)) {
      return false;
    }
    if constexpr (turning) {
      stance_.palms = palms;
      statics_ = statics;
    }
    stance_.separation = separation;
    stance_.contacts[side] = next.contact;
    span_ = next.span;
    tied_ = Slide::stick;
    last_.end = End::none;
    last_.fraction = Real(1);
    last_.motion[side] = direction;
    last_.motion[other(side)] = Slide::stick;
    last_.pieces = 1;
    return true;
  }

  // A whole step, by turns upon the two vertices alone and in another grip.
  [[gnu::noinline]] Advance<Real> go(Real change, const PerSide<Real>& angles) {
    const Real goal = stance_.separation + change;
    Drive<Real> drive{change, {}};
    Advance<Real> total{End::none, Real(0), {}, 0};
    Real released = Real(-1);  // when the object came back upon its two vertices
    bool by_force = false;
    for (int changes = 0;; ++changes) {
      for (const std::size_t side : {left, right}) {
        drive.turn[side] = angles[side] - stance_.palms[side].angle;
      }
      const bool rests = !grip_.none();
      const bool turning = drive.turn[left] != Real(0) || drive.turn[right] != Real(0);
      const Advance<Real> part =
          rests ? Rest<Real>{rig_, drive, angles, push_}.run(stance_, grip_, by_force)
                : Pieces{*this, drive.change, angles, turning}.run();
      total = {part.end, total.fraction + (Real(1) - total.fraction) * part.fraction, part.motion,
               total.pieces + part.pieces};
      if (rests) {
        statics_ = Statics<Real>::at(rig_, stance_.palms);
        tied_ = Slide::stick;
        if (grip_.none()) {
          stance_.lift = {};
          released = touches_.ended = total.fraction;
        }
        span_ = palmbots::span(stance_, vertex_offset(rig_, stance_));
      } else if (is_touch(part.end)) {
        const Instant<Real> now(rig_, stance_, drive, grip_);
        if (now.kind() == Touch::none) return total;  // at the very end of a palm
        const auto fate = now.fate(push_);
        const bool again = released == total.fraction;
        if (!again) {
          touches_ = {touches_.count + 1, now.kind(), now.side(), total.fraction, total.fraction};
        }
        total.end = fate.end;
        grip_ = fate.grip;
        // What balance opens and the vertices' motion closes all the same (by rounding, or because
        // they slide by turns) stays for the rest of the step.
        by_force = fate.end == End::none && grip_.none() && (again || changes > most_changes);
        if (by_force) grip_ = now.all();
        released = total.fraction;
      }
      if (changes > 4 * most_changes) total.end = End::jammed;
      if (total.end != End::none || total.fraction >= Real(1)) return total;
      drive.change = goal - stance_.separation;
    }
  }

  struct State {
    Stance<Real> stance;
    Span<Real> span;
    Statics<Real> statics;
  };

  // One step, cut into pieces of one regime each.
  struct Pieces {
    World& world;
    Real change;
    PerSide<Real> angles;
    bool turning;
    Real separation = world.stance_.separation;
    PerSide<Real> from{world.stance_.palms[left].angle, world.stance_.palms[right].angle};
    PerSide<Real> turn{angles[left] - from[left], angles[right] - from[right]};

    [[gnu::noinline]] Advance<Real> run() {
      Advance<Real> result;
      State now{world.stance_, world.span_, world.statics_};
      Real done = Real(0);
      Real look = longest_look();
      Slide direction = Slide::stick;
      bool known = false;  // the direction, from the event that ended the last piece
      for (result.pieces = 1;; ++result.pieces) {
        const bool give_up = result.pieces >= 200;  // a bound on work; tests show it is not met
        const Real goal = done + look >= Real(1) || give_up ? Real(1) : done + look;
        if (!known) direction = direction_at(now, goal);
        known = false;
        if (direction != Slide::stick && now.statics.wedged_in(left, direction, now.span) &&
            now.statics.wedged_in(right, direction, now.span)) {
          result.end = End::jammed;
          return finish(result, now, done, Slider::none, direction);
        }
        const Slider slider = choose(now, direction, goal);
        const State then = state(goal, slider, direction, now);
        if (slider == Slider::both && turning && !legal(now, then, direction) &&
            goal - done > Real(1) / Real(1024)) {
          look = Real(0.5) * (goal - done);  // both slide for only a part of this piece
          continue;
        }
        look = longest_look();
        const auto at = [&](Real t) { return state(t, slider, direction, now); };
        const auto [event, when] = first_event(done, goal, then, slider, direction, give_up, at);
        switch (event) {
          case Event::none:
            if (slider != Slider::both) world.tied_ = Slide::stick;
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
            world.tied_ = Slide::stick;
            known = true;
            break;
          case Event::tie:
            now = at(when);
            done = when;
            world.tied_ = direction;
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

    // The earliest event between `done` and `goal`, given the state at `goal` if there were none.
    template <class At>
    Happening first_event(Real done, Real goal, const State& then, Slider slider, Slide direction,
                          bool give_up, At at) const {
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
      if (turning && direction != Slide::stick && drives_on(then) < Real(0)) {
        note(Event::reversal, root(done, goal, [&](Real t) { return drives_on(at(t)); }));
      }
      if (slider == Slider::on_left || slider == Slider::on_right) {
        const auto ahead = [&](const State& s) { return own_choice(s, slider, direction); };
        if (ahead(then) < Real(0)) {
          note(Event::tie, root(done, goal, [&](Real t) { return ahead(at(t)); }));
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
      return most > longest_turn ? longest_turn / most : Real(1);
    }

    // The state at a fraction t of the step, if `slider` slides from `now` on.
    State state(Real t, Slider slider, Slide direction, const State& now) const {
      State then = now;
      then.stance.separation = separation + t * change;
      if (turning) {
        for (const std::size_t side : {left, right}) {
          if (turn[side] == Real(0)) continue;
          then.stance.palms[side] =
              PalmAngle<Real>::at(t == Real(1) ? angles[side] : from[side] + t * turn[side]);
        }
        then.statics = Statics<Real>::at(world.rig_, then.stance.palms);
      }
      const auto& offset = world.rig_.offset;
      const Real width = world.rig_.load.width;
      if (slider == Slider::both) {
        const Tie<Real> equal = world.let_go(then.statics, direction);
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
      return first_end(world.rig_, s.statics, s.stance.palms, s.stance.contacts, s.span);
    }

    Real drive(const State& s) const {
      return world.drive(s.stance.palms, s.stance.contacts, s.span, change, turn);
    }

    Slide direction_at(const State& now, Real goal) const {
      Real rate = change;
      if (turning) {
        rate = drive(now);
        if (rate == Real(0)) rate = drive(state(goal, Slider::none, Slide::stick, now));
      }
      return direction_of(rate);
    }

    // ≥ 0 while the sliding contact is still the one that lets go first.
    Real own_choice(const State& s, Slider slider, Slide direction) const {
      if (s.statics.wedged_in(left, direction, s.span) ||
          s.statics.wedged_in(right, direction, s.span)) {
        return Real(0);
      }
      const Real ahead = left_first(world.let_go(s.statics, direction), direction, s.span);
      return slider == Slider::on_left ? ahead : -ahead;
    }

    Slider choose(const State& now, Slide direction, Real goal) const {
      if (direction == Slide::stick) return Slider::none;
      if (now.statics.wedged_in(left, direction, now.span)) return Slider::on_right;
      if (now.statics.wedged_in(right, direction, now.span)) return Slider::on_left;
      const bool on_tie = world.tied_ == direction;
      if (on_tie && !turning) return settle(now, direction, goal);
      const Real ahead = left_first(world.let_go(now.statics, direction), direction, now.span);
      if (!on_tie && ahead != Real(0)) return ahead > Real(0) ? Slider::on_left : Slider::on_right;
      return settle(now, direction, goal);
    }

    // On the tie: does one slider, alone, go on into its own region?
    Slider settle(const State& now, Slide direction, Real goal) const {
      const auto goes_on = [&](Slider slider) {
        return own_choice(state(goal, slider, direction, now), slider, direction) > Real(0);
      };
      const bool left_goes_on = goes_on(Slider::on_left);
      const bool right_goes_on = goes_on(Slider::on_right);
      if (left_goes_on != right_goes_on) return left_goes_on ? Slider::on_left : Slider::on_right;
      world.tied_ = direction;
      return Slider::both;
    }

    // Both contacts moved the way this direction allows.
    bool legal(const State& now, const State& then, Slide direction) const {
      const Real sense = direction == Slide::up ? Real(1) : Real(-1);
      const auto& p = now.stance.contacts;
      const auto& q = then.stance.contacts;
      const Real slack = Real(16) * std::numeric_limits<Real>::epsilon() * world.rig_.load.width;
      return (q[left] - p[left]) * sense >= -slack && (q[right] - p[right]) * sense >= -slack;
    }

    Advance<Real> finish(Advance<Real> result, const State& s, Real done, Slider slider,
                         Slide direction) const {
      world.stance_ = s.stance;
      world.span_ = s.span;
      world.statics_ = s.statics;
      result.fraction = done;
      if (slider == Slider::on_left || slider == Slider::both) result.motion[left] = direction;
      if (slider == Slider::on_right || slider == Slider::both) result.motion[right] = direction;
      return result;
    }
  };

  Rig<Real> rig_{};
  Stance<Real> stance_{};
  Span<Real> span_{};
  Statics<Real> statics_{};
  Advance<Real> last_{};
  Real push_ = Real(0);
  Moments<Real> pushed_{};     // of the load under this push
  Slide tied_ = Slide::stick;  // the direction in which both contacts slide along their tie
  Grip<Real> grip_{};
  Touches<Real> touches_{};
};

}  // namespace palmbots
