// SPDX-License-Identifier: Apache-2.0
// General step: a step of the world in which more happens than one contact sliding. It is cut into
// pieces of one regime each.
//
// In a regime the sliding coordinates are closed-form functions of the time within the step. The
// event that ends it is the root of a condition along them:
//
//   reversal   the palms stop driving the contact points together and start driving them apart
//              (this can happen inside a step only while a palm turns);
//   tie        the squeezes at which the two contacts slip become equal. The slip rule
//              (mechanics/slip_rule.hpp) states which of them slide from there on;
//   end        the object is no longer held by its two vertices alone: the carry is over, or a
//              further contact closes, which the world then handles.
//
// At fixed angles every condition is a bound on dy / dx, along which a regime moves monotonically.
// A check at the end of the step therefore misses no event. While a palm turns, a step is cut into
// pieces of at most 1° for the same check.
//
// A rounded contact vertex that does not slide rolls (docs/theory/mechanics.md, Rounded contact
// vertices). Where rounded contacts do anything else than slide one at a time, the step ends as at a
// further contact.
//
// Source: docs/theory/mechanics.md.
#pragma once

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/world/fast_step.hpp"

namespace palmbots {

// One step, cut into pieces.
template <class Real>
struct GeneralStep {
  using State = Kinematics<Real>;

  const Model<Real>& model;
  WorldState<Real>& world;
  Real change;
  PerSide<Real> angles;
  Real separation = world.configuration.separation;
  PerSide<Real> from{world.configuration.palms[left].angle, world.configuration.palms[right].angle};
  PerSide<Real> turn{angles[left] - from[left], angles[right] - from[right]};
  bool turning = turn[left] != Real(0) || turn[right] != Real(0);
  PerSide<PalmAngle<Real>> turned{at_its_goal(left), at_its_goal(right)};
  PerSide<Real> radius = contact_radii(model.outline);
  bool is_rounded = rolls(model);
  // The part of the step between two checks for events.
  Real interval = longest_turn<Real> /
                  larger(longest_turn<Real>, larger(magnitude(turn[left]), magnitude(turn[right])));
  // What is done of the step, and the state there.
  Real done = Real(0);
  State now = world;
  SlipDirection direction = SlipDirection::stick;
  int reversals = 0;
  Advance<Real> result{};

  static constexpr int max_reversals = 16;  // per step: limits the work

  static constexpr bool slides_alone(SlidingContact slider) {
    return slider == SlidingContact::on_left || slider == SlidingContact::on_right;
  }
  Real sense() const { return Real(static_cast<int>(direction)); }

  [[gnu::noinline]] Advance<Real> run() {
    Real look = interval;
    bool known = false;  // the direction, from the event that ended the last piece
    for (int looks = 1;; ++looks) {
      const bool is_last = looks >= 200;  // limits the work; tests show that it is not reached
      const Real goal = done + look >= Real(1) || is_last ? Real(1) : done + look;
      if (!known) direction = direction_until(goal);
      known = false;
      const SlidingContact first = first_to_slide();
      const auto [slider, then] = choose(first, goal);
      if (is_rounded && !slides_alone(slider)) return leave();
      if (direction != SlipDirection::stick && first == SlidingContact::none) {
        result.reason = DropReason::jammed;
        return finish(now, done, SlidingContact::none);
      }
      if (slider == SlidingContact::both && turning && !is_legal(then) &&
          goal - done > Real(1) / Real(1024)) {
        look = Real(0.5) * (goal - done);  // both slide for only a part of this piece
        continue;
      }
      look = interval;
      const auto [event, when] = first_event(goal, then, slider, is_last);
      const State next = event == Event::none ? then : state(when, slider);
      if (is_rounded && reason_at(next) != DropReason::none) return leave();
      switch (event) {
        case Event::none:
          if (slider != SlidingContact::both) world.tied = Real(0);
          if (goal >= Real(1)) return finish(next, Real(1), slider);
          break;
        case Event::end: {
          // The reason is evaluated where it first applies, the state where it last does not.
          const Real over = std::nextafter(when, Real(2));
          result.reason = reason_at(state(over < goal ? over : goal, slider));
          return finish(next, when, slider);
        }
        case Event::reversal:
          direction = direction == SlipDirection::up ? SlipDirection::down : SlipDirection::up;
          world.tied = Real(0);
          ++reversals;
          break;
        case Event::tie: world.tied = sense(); break;
      }
      known = event != Event::none;
      if (known) ++result.segments;
      now = next;
      done = when;
    }
  }

  enum class Event : std::uint8_t { none, end, reversal, tie };
  struct StepEvent {
    Event event;
    Real when;
  };

  // The earliest event up to `goal`, given the state at `goal` if there were no event.
  StepEvent first_event(Real goal, const State& then, SlidingContact slider, bool is_last) const {
    StepEvent first{Event::none, goal};
    const auto note = [&](Event event, Real when) {
      if (first.event == Event::none || when < first.when) first = {event, when};
    };
    if (!is_rounded && reason_at(then) != DropReason::none) {
      note(Event::end, bisect_last_true(done, goal, [&](Real t) {
             return reason_at(state(t, slider)) == DropReason::none;
           }));
    }
    if (is_last) return first;
    // Where a condition of the regime falls below 0.
    const auto note_root = [&](Event event, auto condition) {
      const Real last = condition(then);
      if (!(last < Real(0))) return;
      note(event, bracketed_root(true, done, condition(now), goal, last,
                                 [&](Real t) { return condition(state(t, slider)); }));
    };
    // A contact exactly at its pivot, on a palm that turns, would alternate by a rounding error.
    if (turning && direction != SlipDirection::stick && reversals < max_reversals)
      note_root(Event::reversal, [&](const State& s) { return -sense() * drive(s); });
    if (slides_alone(slider))
      note_root(Event::tie, [&](const State& s) { return own_lead(s, slider); });
    return first;
  }

  // The state at a fraction t of the step, if `slider` slides from now on.
  State state(Real t, SlidingContact slider) const {
    State then = now;
    Configuration<Real>& at = then.configuration;
    at.separation = separation + t * change;
    for (const std::size_t side : {left, right}) {
      if (turn[side] == Real(0)) continue;
      at.palms[side] =
          t == Real(1) ? turned[side] : PalmAngle<Real>::at(from[side] + t * turn[side]);
    }
    const auto& offset = model.offset;
    const Real width = model.object.width;
    if (slides_alone(slider)) {
      const auto side = static_cast<std::size_t>(slider);
      if (radius[other(side)] != Real(0)) at.contacts[other(side)] = rolled(at, side);
      const Slipped<Real> next =
          slip<Real>(side == left, at.separation, at.palms, at.contacts, offset, width);
      at.contacts = next.contacts;
      then.contact_vector = next.contact_vector;
      return then;
    }
    if (slider == SlidingContact::both) {
      const auto edges = edges_at(model.friction, at.palms, sense());
      const Moments<Real> pushed = moments_under(model.object, world.push);
      const Real slope =
          tied_slope(slip_order(pushed, edges[left], edges[right]), now.contact_vector);
      at.contacts = solve_slide_along(at, slope, offset, width);
    }
    then.contact_vector = palmbots::contact_vector(at, offset);
    return then;
  }

  // The coordinate of the contact that rolls while that of the side `side` slides, from now to where
  // the palms are at another time.
  Real rolled(const Configuration<Real>& then, std::size_t side) const {
    const std::size_t rolls = other(side);
    const Real r = radius[rolls];
    const PalmAngle<Real>& own = then.palms[side];
    const PalmAngle<Real>& partner = then.palms[rolls];
    const auto& palms = now.configuration.palms;
    // By how much θ_L + θ_R has grown.
    const Real widened = (then.palms[left].angle - palms[left].angle) +
                         (then.palms[right].angle - palms[right].angle);
    const Real held = now.configuration.contacts[rolls];
    const PalmFrameVector<Real> seen = palm_frame_vector(now.contact_vector, side, palms[side]);
    const ContactVector<Real> base = feet(then.separation, then.palms, model.offset);
    const Real across = base.dx * own.sin + mirrored(side, base.dy) * own.cos;
    const Real both = own.sin * partner.cos + partner.sin * own.cos;  // sin(θ_L + θ_R)
    // f(δ) = w sin(β + δ) − across − both (held + r (widened − δ)) = 0. The error that is left after a
    // correction is about its square.
    constexpr Real enough = sizeof(Real) == 8 ? Real(1e-8) : Real(1e-4);
    Real delta = Real(0);
    for (int i = 0; i < 8; ++i) {
      const SinCos<Real> by = sin_cos(delta);
      const Real normal = seen.normal * by.cos + seen.inward * by.sin;
      const Real inward = seen.inward * by.cos - seen.normal * by.sin;
      const Real f = normal - across - both * (held + r * (widened - delta));
      const Real step = f / (inward + both * r);
      delta -= step;
      if (within(step, enough)) break;
    }
    return held + r * (widened - delta);
  }

  ActingObject<Real> acting_at(const State& s) const {
    return acting_object(model.object, radius, s.configuration.palms, s.contact_vector);
  }

  // Why the two vertices alone do not hold the object; of rounded ones, whether they surely do.
  DropReason reason_at(const State& s) const {
    const Real safe = model.safe_reach;
    const auto& p = s.configuration.contacts;
    if (within(p[left], safe) && within(p[right], safe)) return DropReason::none;
    const auto& palms = s.configuration.palms;
    if (!is_rounded) return drop_reason(model, palms, p, s.contact_vector);
    const ActingObject<Real> acting = acting_at(s);
    return certainly_held<Real>(model, Moments<Real>::of(acting.object), acting.contact_vector,
                                cones_at(model.friction, palms), palms, p, s.contact_vector)
               ? DropReason::none
               : DropReason::flush;
  }

  PalmAngle<Real> at_its_goal(std::size_t side) const {
    return turn[side] == Real(0) ? world.configuration.palms[side]
                                 : PalmAngle<Real>::at(angles[side]);
  }

  // Half the rate of change of the squared distance of the points that touch the palms, if both
  // stayed where they are on the palms.
  Real drive(const State& s) const {
    return drive_rate(s.configuration.palms, s.configuration.contacts,
                      {model.offset[left] - radius[left], model.offset[right] - radius[right]},
                      acting_at(s).contact_vector, change, turn);
  }

  // The direction in which contacts slide on.
  SlipDirection direction_until(Real goal) const {
    if (!turning) return direction_of(change);
    const Real rate = drive(now);
    return direction_of(rate != Real(0) ? rate : drive(state(goal, SlidingContact::none)));
  }

  SlipOnset<Real> slip_onset(const State& s) const {
    const auto edges = edges_at(model.friction, s.configuration.palms, sense());
    const ActingObject<Real> acting = acting_at(s);
    return SlipOnset<Real>::at(moments_under(acting.object, world.push), edges,
                               acting.contact_vector, sense());
  }

  // Which contact slides now.
  SlidingContact first_to_slide() const {
    if (direction == SlipDirection::stick) return SlidingContact::none;
    return first_to_slip(slip_onset(now), world.tied == sense());
  }

  // ≥ 0 while the sliding contact is still the one that slips first.
  Real own_lead(const State& s, SlidingContact slider) const {
    return slip_onset(s).own_lead(slider == SlidingContact::on_left);
  }

  // A choice of sliding contacts, and the state at `goal` that results.
  struct Choice {
    SlidingContact slider;
    State then;
  };

  Choice choose(SlidingContact first, Real goal) const {
    const auto with = [&](SlidingContact slider) { return Choice{slider, state(goal, slider)}; };
    if (first != SlidingContact::tie) return with(first);
    const Choice one = with(SlidingContact::on_left);
    const Choice another = with(SlidingContact::on_right);
    const SlidingContact on = slides_at_tie(own_lead(one.then, one.slider) > Real(0),
                                            own_lead(another.then, another.slider) > Real(0));
    if (on != SlidingContact::both) return on == SlidingContact::on_left ? one : another;
    world.tied = sense();
    return with(SlidingContact::both);
  }

  // True if both contacts move as this direction allows.
  bool is_legal(const State& then) const {
    const auto& p = now.configuration.contacts;
    const auto& q = then.configuration.contacts;
    const Real slack = Real(16) * std::numeric_limits<Real>::epsilon() * model.object.width;
    return (q[left] - p[left]) * sense() >= -slack && (q[right] - p[right]) * sense() >= -slack;
  }

  Advance<Real> finish(const State& s, Real fraction, SlidingContact slider) {
    static_cast<State&>(world) = s;
    result.fraction = fraction;
    for (const std::size_t side : {left, right})
      if (slider == SlidingContact::both || static_cast<std::size_t>(slider) == side)
        result.motion[side] = direction;
    return result;
  }

  // Ends where rounded contacts begin what they do not do here.
  Advance<Real> leave() {
    result.reason = DropReason::flush;
    --result.segments;
    return finish(now, done, SlidingContact::none);
  }
};

}  // namespace palmbots
