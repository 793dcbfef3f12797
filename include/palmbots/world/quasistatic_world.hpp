// SPDX-License-Identifier: Apache-2.0
// The quasistatic world: exact motion of the contacts while the robots move and the palms turn.
//
// A step changes the separation and the palm angles linearly. Nothing is integrated. In every
// regime (one contact slides, or both do) the sliding coordinates are closed-form roots of the loop
// constraint at any instant. A contact that sticks is never written, so it cannot drift. If one
// contact slides through a whole step, world/fast_step.hpp computes it; if the regime
// changes, world/general_step.hpp does. If a further contact closes, world/multi_contact_step.hpp
// takes over until it opens again.
//
// `push` is the sideways specific force of the object's inertia when the pair changes its speed
// (docs/theory/mechanics.md). It affects only which contact slips first. It is small, but so are
// the quantities it competes with: with φ near θ the lower ends of the squeeze intervals are close
// to zero and to each other. Without a push a symmetric object would stay symmetric forever, which
// no real object does. The conditions that end a carry are evaluated without the push.
//
// Source: docs/theory/mechanics.md.
#pragma once

#include "palmbots/world/general_step.hpp"

namespace palmbots {

// The world of one carry.
template <class Real>
class World {
 public:
  World() = default;
  World(const Model<Real>& model, const Configuration<Real>& configuration)
      : model_(model),
        state_{{configuration, palmbots::contact_vector(configuration, model.offset)},
               {Real(0), Real(0), Real(0)}} {}

  const Configuration<Real>& configuration() const { return state_.configuration; }
  const Model<Real>& model() const { return model_; }
  ContactVector<Real> contact_vector() const { return state_.contact_vector; }
  // The coordinates at which the palms are touched: p of the contact vertex as long as that is on
  // the palm [m].
  PerSide<Real> touched() const {
    if (constraints_.none()) return state_.configuration.contacts;
    return {felt(model_, constraints_, state_.configuration, left),
            felt(model_, constraints_, state_.configuration, right)};
  }
  const Advance<Real>& last() const { return last_; }

  // The moving state, for a caller that runs several worlds in lanes and copies states out and
  // back.
  const WorldState<Real>& state() const { return state_; }
  void set_state(const WorldState<Real>& state) { state_ = state; }

  // The contacts on which the object rests; `none()` if these are its two contact vertices.
  const ContactConstraints<Real>& constraints() const { return constraints_; }
  const ContactEventCounter<Real>& contact_events() const { return contact_events_; }

  // Why the object is not held in its present position, or `none`.
  DropReason check() const {
    const Configuration<Real>& here = state_.configuration;
    if (!constraints_.none())
      return InstantMotions<Real>(model_, here, {}, constraints_, state_.push).check();
    const Statics<Real> statics = Statics<Real>::at(model_, here.palms);
    const DropReason reason =
        drop_reason(model_, statics, here.palms, here.contacts, state_.contact_vector);
    if (!adds_contact(reason)) return reason;
    const InstantMotions<Real> now(model_, here, {}, constraints_, state_.push);
    const DropReason found = now.check();
    return now.kind() == ContactKind::none || adds_contact(found) ? reason : found;
  }

  // Shifts the contacts suddenly, by `by` [m]. The robots are displaced so that the loop stays
  // closed.
  DropReason shift(const PerSide<Real>& by) {
    Configuration<Real>& now = state_.configuration;
    for (const std::size_t side : {left, right}) now.contacts[side] += by[side];
    now.lift = {};
    now.separation = closing_separation(now, model_.offset, model_.object.width);
    state_.contact_vector = palmbots::contact_vector(now, model_.offset);
    state_.tied = Real(0);
    constraints_ = {};
    state_.multi_contact = Real(0);
    return check();
  }

  // Changes the separation by `change` [m] and turns the palms to `angles` [rad], both linearly.
  // Returns the events of the step; the reference is valid until the next step.
  const Advance<Real>& advance(Real change, const PerSide<Real>& angles, Real push = Real(0)) {
    const ModelParams<Real>& params = model_;
    const FastStep<Real> step = step_fast(params, state_, change, angles, push);
    if (step.done) {
      const std::size_t side = step.on_left ? left : right;
      last_.reason = DropReason::none;
      last_.fraction = Real(1);
      last_.motion[side] = step.closing ? SlipDirection::up : SlipDirection::down;
      last_.motion[other(side)] = SlipDirection::stick;
      last_.segments = step.switched ? 2 : 1;
    } else {
      take_apart(change, angles);
    }
    return last_;
  }

  // The same, for a step that the fast step (world/fast_step.hpp) has tried and left
  // undone.
  const Advance<Real>& take_apart(Real change, const PerSide<Real>& angles) {
    last_ = go(change, angles);
    state_.multi_contact = Real(constraints_.none() ? 0 : 1);
    return last_;
  }

 private:
  static constexpr int most_changes = 6;  // of the constraints per step: limits the work

  // A whole step, alternately on the two vertices alone and under other constraints.
  [[gnu::noinline]] Advance<Real> go(Real change, const PerSide<Real>& angles) {
    Configuration<Real>& configuration = state_.configuration;
    const Real goal = configuration.separation + change;
    Drive<Real> drive{change, {}};
    Advance<Real> total{DropReason::none, Real(0), {}, 0};
    Real released = Real(-1);  // when the object returned to its two vertices
    bool by_force = false;
    for (int changes = 0;; ++changes) {
      for (const std::size_t side : {left, right}) {
        drive.turn[side] = angles[side] - configuration.palms[side].angle;
      }
      const bool rests = !constraints_.none();
      const Advance<Real> part =
          rests ? MultiContactStep<Real>{model_, drive, angles, state_.push}.run(
                      configuration, constraints_, by_force)
                : GeneralStep<Real>{model_, state_, drive.change, angles}.run();
      total = {part.reason, total.fraction + (Real(1) - total.fraction) * part.fraction,
               part.motion, total.segments + part.segments};
      if (rests) {
        state_.tied = Real(0);
        if (constraints_.none()) {
          configuration.lift = {};
          released = contact_events_.ended = total.fraction;
        }
        state_.contact_vector =
            palmbots::contact_vector(configuration, vertex_offset(model_, configuration));
      } else if (adds_contact(part.reason)) {
        const InstantMotions<Real> now(model_, configuration, drive, constraints_, state_.push);
        if (now.kind() == ContactKind::none) return total;  // at the very end of a palm
        const auto decision =
            InstantMotions<Real>::decide(model_, configuration, drive, constraints_, state_.push);
        const bool again = released == total.fraction;
        if (!again) {
          contact_events_ = {contact_events_.count + 1, now.kind(), now.side(), total.fraction,
                             total.fraction};
        }
        total.reason = decision.reason;
        constraints_ = decision.constraints;
        // A contact may open by balance and still be closed by the motion of the vertices, because
        // of rounding or because they slide alternately. It persists for the rest of the step.
        by_force = decision.reason == DropReason::none && constraints_.none() &&
                   (again || changes > most_changes);
        if (by_force) constraints_ = now.all();
        released = total.fraction;
      }
      if (changes > 4 * most_changes) total.reason = DropReason::jammed;
      if (total.reason != DropReason::none || total.fraction >= Real(1)) return total;
      drive.change = goal - configuration.separation;
    }
  }

  Model<Real> model_{};
  WorldState<Real> state_{};
  Advance<Real> last_{};
  ContactConstraints<Real> constraints_{};
  ContactEventCounter<Real> contact_events_{};
};

}  // namespace palmbots
