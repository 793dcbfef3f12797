// The quasistatic world: exact motion of the contacts while the robots move and the palms turn.
//
// A step changes the separation and the palm angles linearly. Nothing is integrated: in every regime
// (one contact slides, or both do) the sliding coordinates are closed-form roots of the loop
// constraint at any instant, and a contact that sticks is never written, so it cannot drift. Where one
// contact slides through a whole step, stride.hpp takes it; where the regime changes, pieces.hpp. Where
// a further contact closes, resting.hpp takes over until it opens again.
//
// `push` is the sideways specific force of the object's inertia when the pair changes its speed
// (MECHANICS section 4). It decides only which contact lets go first. It is small, but so is what it
// competes with: with φ near θ the lower ends of the squeeze intervals are close to zero and to each
// other, and a symmetric object under no push at all stays symmetric for ever, which no real one
// does. What ends a carry is judged without it.
//
// Source: MECHANICS sections 1, 2, 4, 5, 6.
#pragma once

#include "palmbots/pieces.hpp"

namespace palmbots {

template <class Real>
class World {
 public:
  World() = default;
  World(const Rig<Real>& rig, const Stance<Real>& stance)
      : rig_(rig),
        pose_{{stance, palmbots::span(stance, rig.offset)}, {Real(0), Real(0), Real(0)}} {}

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
    if (!grip_.none()) return Instant<Real>(rig_, here, {}, grip_, pose_.push).check();
    const Statics<Real> statics = Statics<Real>::at(rig_, here.palms);
    const End end = first_end(rig_, statics, here.palms, here.contacts, pose_.span);
    if (!is_touch(end)) return end;
    const Instant<Real> now(rig_, here, {}, grip_, pose_.push);
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
      last_.pieces = step.handed_over ? 2 : 1;
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
  static constexpr int most_changes = 6;  // of grip in a step: a bound on work

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
                : Pieces<Real>{rig_, pose_, drive.change, angles}.run();
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
        const Instant<Real> now(rig_, stance, drive, grip_, pose_.push);
        if (now.kind() == Touch::none) return total;  // at the very end of a palm
        const auto fate = now.fate();
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

  Rig<Real> rig_{};
  Pose<Real> pose_{};
  Advance<Real> last_{};
  Grip<Real> grip_{};
  Touches<Real> touches_{};
};

}  // namespace palmbots
