// SPDX-License-Identifier: Apache-2.0
// The rolling step of the world: the object has rounded contact vertices, and one contact slides
// through the whole step while the other one rolls; or first one slides and, from a tie on, the
// other one.
//
// A contact that rolls keeps p − r β, where r is the radius of its arc and β the angle between palm
// and object. If the other contact slides, the normal part of the vector between the centres of the
// arcs, seen from the palm of the contact that slides, is w sin β there. As both β sum up to
// θ_L + θ_R, this is Kepler's equation for the change of β, which Newton's method solves from the
// state before. Which contact slides follows the slip rule (mechanics/slip_rule.hpp) with the points
// that touch the palms (mechanics/acting_object.hpp).
//
// If anything else happens, nothing is changed, and world/contact_step.hpp takes over.
//
// Source: docs/theory/mechanics.md, Rounded contact vertices.
#pragma once

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/acting_object.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/sliding.hpp"
#include "palmbots/mechanics/slip_rule.hpp"
#include "palmbots/world/fast_step.hpp"
#include "palmbots/world/state.hpp"

namespace palmbots {

// Whether a contact vertex is rounded and rolls.
template <class Real>
bool rolls(const Model<Real>& model) {
  const PerSide<Real> radius = contact_radii(model.outline);
  return radius[left] > Real(0) || radius[right] > Real(0);
}

// Whether no step can be one of lanes: a contact vertex rolls, a nose or a heel may touch the object
// within reach, or a robot may stall.
template <class Real>
bool takes_single_steps(const Model<Real>& model) {
  return rolls(model) || model.limit != no_limits<double> ||
         model.profile[left].touches_within_reach || model.profile[right].touches_within_reach;
}

// One step: the separation changes by `change` [m], and the palms turn to `angles` [rad], both
// linearly.
template <class Real>
struct RollingStep {
  const Model<Real>& model;
  WorldState<Real>& state;  // changed if the step is done
  Real change;
  PerSide<Real> angles;
  PerSide<Real> radius = contact_radii(model.outline);
  PerSide<Real> surface{model.offset[left] - radius[left], model.offset[right] - radius[right]};
  PerSide<Real> turn{angles[left] - state.configuration.palms[left].angle,
                     angles[right] - state.configuration.palms[right].angle};

  // What happens in the step, if it is done.
  struct Result {
    bool done = false;
    bool closing = false;       // the contact slid up, otherwise down
    std::size_t slides = left;  // the side whose contact slid last
    bool switched = false;      // the other one slid before it, up to a tie
  };

  [[gnu::noinline]] Result run() {
    Result result;
    if (!(within(turn[left], longest_turn<Real>) && within(turn[right], longest_turn<Real>)))
      return result;
    const Kinematics<Real> start = state;
    const ActingObject<Real> acting = acting_at(start);
    const Real rate = drive(start, acting);
    result.closing = rate < Real(0);
    const Real way = result.closing ? Real(1) : Real(-1);
    const SlipOnset<Real> onset = onset_at(start, acting, way);
    if (rate == Real(0) || onset.left_lead == Real(0) || onset.wedged[left] || onset.wedged[right])
      return result;
    result.slides = onset.left_lead > Real(0) ? left : right;

    Kinematics<Real> end = slid(start, Real(1), result.slides);
    Real lead = own_lead(end, way, result.slides);
    if (lead < Real(0)) {
      Kinematics<Real> tie = start;
      Real when = Real(0);
      const Real lead_before = lead_of(result.slides == left, onset.left_lead);
      bracketed_root(true, Real(0), lead_before, Real(1), lead, [&](Real t) {
        const Kinematics<Real> there = slid(start, t, result.slides);
        const Real now = own_lead(there, way, result.slides);
        if (now >= Real(0) && t > when) {
          when = t;
          tie = there;
        }
        return now;
      });
      if (when == Real(0)) return result;
      result.slides = other(result.slides);
      result.switched = true;
      end = slid(tie, Real(1), result.slides);
      lead = own_lead(end, way, result.slides);
    }
    const ActingObject<Real> acting_then = acting_at(end);
    if (!(lead > Real(0)) || !(drive(end, acting_then) * way < Real(0)) || !held(end, acting_then))
      return result;
    result.done = true;
    static_cast<Kinematics<Real>&>(state) = end;
    state.tied = Real(0);
    return result;
  }

 private:
  ActingObject<Real> acting_at(const Kinematics<Real>& s) const {
    return acting_object(model.object, radius, s.configuration.palms, s.contact_vector);
  }

  // Half the rate of change of the squared distance of the points that touch the palms, if both
  // stayed where they are on the palms.
  Real drive(const Kinematics<Real>& s, const ActingObject<Real>& acting) const {
    return drive_rate(s.configuration.palms, s.configuration.contacts, surface,
                      acting.contact_vector, change, turn);
  }

  SlipOnset<Real> onset_at(const Kinematics<Real>& s, const ActingObject<Real>& acting,
                           Real way) const {
    return SlipOnset<Real>::at(moments_under(acting.object, state.push),
                               edges_at(model.friction, s.configuration.palms, way),
                               acting.contact_vector, way);
  }
  Real own_lead(const Kinematics<Real>& s, Real way, std::size_t slides) const {
    return onset_at(s, acting_at(s), way).own_lead(slides == left);
  }

  bool held(const Kinematics<Real>& s, const ActingObject<Real>& acting) const {
    const PerSide<PalmAngle<Real>>& palms = s.configuration.palms;
    return certainly_held<Real>(model, Moments<Real>::of(acting.object), acting.contact_vector,
                                detail::cones_at<Real>(model, palms), palms,
                                s.configuration.contacts, s.contact_vector);
  }

  // The state at the fraction `t` of the step. From the state before on, the contact of one side
  // slides and the other one rolls.
  Kinematics<Real> slid(const Kinematics<Real>& before, Real t, std::size_t side) const {
    Kinematics<Real> after = before;
    Configuration<Real>& now = after.configuration;
    now.separation = t == Real(1) ? state.configuration.separation + change
                                  : state.configuration.separation + t * change;
    for (const std::size_t s : {left, right}) {
      if (turn[s] == Real(0)) continue;
      const Real angle =
          t == Real(1) ? angles[s] : state.configuration.palms[s].angle + t * turn[s];
      now.palms[s] = PalmAngle<Real>::at(angle);
    }
    // By how much θ_L + θ_R has grown.
    const Real turned = (now.palms[left].angle - before.configuration.palms[left].angle) +
                        (now.palms[right].angle - before.configuration.palms[right].angle);
    const std::size_t rolls = other(side);
    Real& held = now.contacts[rolls];
    if (radius[rolls] != Real(0)) held = rolled(before, now, side, turned);
    const SlideSolution<Real> next =
        solve_slide(now.separation, now.palms, side, held, model.offset, model.object.width);
    now.contacts[side] = next.contact;
    after.contact_vector = next.contact_vector;
    return after;
  }

  // The coordinate of the contact that has rolled, while that of the side `side` slides.
  Real rolled(const Kinematics<Real>& before, const Configuration<Real>& now, std::size_t side,
              Real turned) const {
    const std::size_t rolls = other(side);
    const Real r = radius[rolls];
    const PalmAngle<Real>& own = now.palms[side];
    const PalmAngle<Real>& partner = now.palms[rolls];
    const Real held = before.configuration.contacts[rolls];
    const PalmFrameVector<Real> seen =
        palm_frame_vector(before.contact_vector, side, before.configuration.palms[side]);
    const ContactVector<Real> base = feet(now.separation, now.palms, model.offset);
    const Real across = base.dx * own.sin + mirrored(side, base.dy) * own.cos;
    const Real both = own.sin * partner.cos + partner.sin * own.cos;  // sin(θ_L + θ_R)
    // f(δ) = w sin(β + δ) − across − both (held + r (turned − δ)) = 0. The error that is left after a
    // correction is about its square.
    constexpr Real enough = sizeof(Real) == 8 ? Real(1e-8) : Real(1e-4);
    Real delta = Real(0);
    for (int i = 0; i < 8; ++i) {
      const SinCos<Real> by = sin_cos(delta);
      const Real normal = seen.normal * by.cos + seen.inward * by.sin;
      const Real inward = seen.inward * by.cos - seen.normal * by.sin;
      const Real f = normal - across - both * (held + r * (turned - delta));
      const Real step = f / (inward + both * r);
      delta -= step;
      if (within(step, enough)) break;
    }
    return held + r * (turned - delta);
  }
};

}  // namespace palmbots
