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
#include "palmbots/stride.hpp"

namespace palmbots {

template <class Real>
class World {
 public:
  World() = default;
  World(const Rig<Real>& rig, const Stance<Real>& stance)
      : rig_(rig), pose_{stance, palmbots::span(stance, rig.offset), Real(0), Real(0), Real(0)} {}

  const Stance<Real>& stance() const { return pose_.stance; }
  const Rig<Real>& rig() const { return rig_; }
  Span<Real> span() const { return pose_.span; }
  // Where the palms are touched: p of the contact vertex as long as that is on the palm.
  PerSide<Real> touched() const {
    if (grip_.none()) return pose_.stance.contacts;
    return {felt(rig_, grip_, pose_.stance, left), felt(rig_, grip_, pose_.stance, right)};
  }
  const Advance<Real>& last() const { return last_; }

  // What is moving, to be taken out and put back by whoever moves several worlds in lockstep.
  const Pose<Real>& pose() const { return pose_; }
  void place(const Pose<Real>& pose) { pose_ = pose; }

  // What the object rests on; none: its two contact vertices.
  const Grip<Real>& grip() const { return grip_; }
  const Touches<Real>& touches() const { return touches_; }

  // Why the object is not held where it is now (none: it is).
  End check() const {
    const Stance<Real>& here = pose_.stance;
    if (!grip_.none()) return Instant<Real>(rig_, here, {}, grip_).check();
    const Statics<Real> statics = Statics<Real>::at(rig_, here.palms);
    const End end = first_end(rig_, statics, here.palms, here.contacts, pose_.span);
    if (!is_touch(end)) return end;
    const Instant<Real> now(rig_, here, {}, grip_);
    const End found = now.check();
    return now.kind() == Touch::none || is_touch(found) ? end : found;
  }

  // A sudden shift of contacts; the robots under them are displaced so that the loop stays closed.
  End shift(const PerSide<Real>& by) {
    Stance<Real>& now = pose_.stance;
    for (const std::size_t side : {left, right}) now.contacts[side] += by[side];
    now.lift = {};
    now.separation = closing_separation(now, rig_.offset, rig_.load.width);
    pose_.span = palmbots::span(now, rig_.offset);
    pose_.tied = Real(0);
    grip_ = {};
    pose_.rests = Real(0);
    return check();
  }

  // Changes the separation by `change` [m] and turns the palms to `angles` [rad], both linearly.
  // Returns what happened, valid until the next step.
  const Advance<Real>& advance(Real change, const PerSide<Real>& angles, Real push = Real(0)) {
    const Fixture<Real>& fixture = rig_;
    const Stride<Real> step = stride(fixture, pose_, change, angles, push);
    if (step.done) {
      const std::size_t side = step.on_left ? left : right;
      last_.end = End::none;
      last_.fraction = Real(1);
      last_.motion[side] = step.closing ? Slide::up : Slide::down;
      last_.motion[other(side)] = Slide::stick;
      last_.pieces = 1;
    } else {
      take_apart(change, angles);
    }
    return last_;
  }

  // The same where the common step (stride.hpp) has been tried, and left it undone.
  const Advance<Real>& take_apart(Real change, const PerSide<Real>& angles) {
    last_ = go(change, angles);
    pose_.rests = Real(grip_.none() ? 0 : 1);
    return last_;
  }

 private:
  static constexpr int most_changes = 6;     // of grip in a step: a bound on work
  static constexpr int most_reversals = 16;  // in a step, likewise

  // Which contacts slide in a piece.
  enum class Slider : std::uint8_t { on_left = 0, on_right = 1, both = 2, none = 3 };

  static constexpr Real sense_of(Slide direction) { return Real(static_cast<int>(direction)); }

  // A whole step, by turns upon the two vertices alone and in another grip.
  [[gnu::noinline]] Advance<Real> go(Real change, const PerSide<Real>& angles) {
    Stance<Real>& stance = pose_.stance;
    const Real goal = stance.separation + change;
    Drive<Real> drive{change, {}};
    Advance<Real> total{End::none, Real(0), {}, 0};
    Real released = Real(-1);  // when the object came back upon its two vertices
    bool by_force = false;
    for (int changes = 0;; ++changes) {
      for (const std::size_t side : {left, right}) {
        drive.turn[side] = angles[side] - stance.palms[side].angle;
      }
      const bool rests = !grip_.none();
      const Advance<Real> part =
          rests ? Rest<Real>{rig_, drive, angles, pose_.push}.run(stance, grip_, by_force)
                : Pieces{*this, drive.change, angles}.run();
      total = {part.end, total.fraction + (Real(1) - total.fraction) * part.fraction, part.motion,
               total.pieces + part.pieces};
      if (rests) {
        pose_.tied = Real(0);
        if (grip_.none()) {
          stance.lift = {};
          released = touches_.ended = total.fraction;
        }
        pose_.span = palmbots::span(stance, vertex_offset(rig_, stance));
      } else if (is_touch(part.end)) {
        const Instant<Real> now(rig_, stance, drive, grip_);
        if (now.kind() == Touch::none) return total;  // at the very end of a palm
        const auto fate = now.fate(pose_.push);
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
      drive.change = goal - stance.separation;
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
    Real separation = world.pose_.stance.separation;
    PerSide<Real> from{world.pose_.stance.palms[left].angle, world.pose_.stance.palms[right].angle};
    PerSide<Real> turn{angles[left] - from[left], angles[right] - from[right]};
    bool turning = turn[left] != Real(0) || turn[right] != Real(0);
    Moments<Real> pushed = moments_under<Real>(world.rig_, world.pose_.push);

    [[gnu::noinline]] Advance<Real> run() {
      Advance<Real> result;
      State now{world.pose_.stance, world.pose_.span,
                Statics<Real>::at(world.rig_, world.pose_.stance.palms)};
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
        // A contact right at its pivot, on a palm that turns, would go to and fro by a rounding error.
        const bool reverses = reversals < most_reversals;
        const auto [event, when] =
            first_event(done, goal, then, slider, direction, give_up, reverses, at);
        switch (event) {
          case Event::none:
            if (slider != Slider::both) world.pose_.tied = Real(0);
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
            world.pose_.tied = Real(0);
            known = true;
            ++reversals;
            break;
          case Event::tie:
            now = at(when);
            done = when;
            world.pose_.tied = sense_of(direction);
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
                          bool give_up, bool reverses, At at) const {
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
          note(Event::reversal, root(done, goal, last, [&](Real t) { return drives_on(at(t)); }));
        }
      }
      if (slider == Slider::on_left || slider == Slider::on_right) {
        const auto ahead = [&](const State& s) { return own_choice(s, slider, direction); };
        const Real last = ahead(then);
        if (last < Real(0)) {
          note(Event::tie, root(done, goal, last, [&](Real t) { return ahead(at(t)); }));
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
        const Tie<Real> equal = then.statics.let_go(pushed, direction);
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
      const Real safe = world.rig_.safe_reach;
      const auto& p = s.stance.contacts;
      if (within(p[left], safe) && within(p[right], safe)) return End::none;
      return first_end(world.rig_, s.statics, s.stance.palms, s.stance.contacts, s.span);
    }

    Real drive(const State& s) const {
      return drive_rate(s.stance.palms, s.stance.contacts, world.rig_.offset, s.span, change, turn);
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
      const Real ahead = left_first(s.statics.let_go(pushed, direction), direction, s.span);
      return slider == Slider::on_left ? ahead : -ahead;
    }

    Slider choose(const State& now, Slide direction, Real goal) const {
      if (direction == Slide::stick) return Slider::none;
      if (now.statics.wedged_in(left, direction, now.span)) return Slider::on_right;
      if (now.statics.wedged_in(right, direction, now.span)) return Slider::on_left;
      const bool on_tie = world.pose_.tied == sense_of(direction);
      if (on_tie && !turning) return settle(now, direction, goal);
      const Real ahead = left_first(now.statics.let_go(pushed, direction), direction, now.span);
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
      world.pose_.tied = sense_of(direction);
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
      world.pose_.stance = s.stance;
      world.pose_.span = s.span;
      result.fraction = done;
      if (slider == Slider::on_left || slider == Slider::both) result.motion[left] = direction;
      if (slider == Slider::on_right || slider == Slider::both) result.motion[right] = direction;
      return result;
    }
  };

  Rig<Real> rig_{};
  Pose<Real> pose_{};
  Advance<Real> last_{};
  Grip<Real> grip_{};
  Touches<Real> touches_{};
};

}  // namespace palmbots
