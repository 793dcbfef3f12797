// SPDX-License-Identifier: Apache-2.0
// What happens while the object rests on more, or on something else, than its two contact vertices:
// an edge lies flush on a palm, a further vertex stands on it, or a palm's tip meets an edge.
//
// At every instant world/instant_motions.hpp says which contacts stay and which of those stick;
// where that leaves the object is exact (world/contact_constraints.hpp).
//
// The carry is over when nothing touches one of the palms any more, and as in
// mechanics/drop_reason.hpp. As in world/quasistatic_world.hpp `push` decides which contacts
// slide, not whether the object is held. Source: docs/theory/mechanics.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "palmbots/base/root_finding.hpp"
#include "palmbots/world/instant_motions.hpp"

namespace palmbots {

// What a step did.
template <class Real>
struct Advance {
  DropReason reason = DropReason::none;
  Real fraction = Real(1);    // of the step that was done
  ContactMode motion{};       // of its last piece
  std::int32_t segments = 1;  // regimes passed through
};

// Times at which the object rested on a further contact, and the latest: what it was, and when it
// began and, unless it lasts, ended, as fractions of the steps in which it did.
template <class Real>
struct ContactEventCounter {
  std::uint32_t count = 0;
  ContactKind kind = ContactKind::none;
  std::size_t side = left;
  Real began = Real(0);
  Real ended = Real(0);
};

// A step, or what is left of one, with constraints.
template <class Real>
struct MultiContactStep {
  const Model<Real>& model;
  Drive<Real> drive;
  PerSide<Real> angles;  // at the end [rad]
  Real push;

  // Moves `configuration` as far as the constraints, or those that take their place, stay. Where
  // there are become none and nothing ended, what is left of the step is for the two vertices
  // alone. `by_force` keeps the constraints whatever is in balance, as long as the object is held.
  Advance<Real> run(Configuration<Real>& configuration, ContactConstraints<Real>& constraints,
                    bool by_force) const {
    Advance<Real> result{};
    if (drive.none()) return result;
    const Configuration<Real> from = configuration;
    Real done = Real(0);
    result.fraction = done;
    if (!by_force && !decide(configuration, constraints, result)) return result;
    int decisions = 0;
    bool forced = by_force;
    for (result.segments = 1; done < Real(1); ++result.segments) {
      const Real length = forced && !by_force ? look() * forced_share : look();
      const Real goal = done + length < Real(1) ? done + length : Real(1);
      const auto at = [&](Real t, Configuration<Real>& there) {
        there = between(from, configuration, t);
        return settle(model, constraints, there);
      };
      const auto stays = [&](Real t) {
        Configuration<Real> there{};
        if (!at(t, there)) return false;
        const InstantMotions<Real> instant(model, there, drive, constraints, push);
        if (instant.check() != DropReason::none) return false;
        if (!forced) return instant.goes_on(constraints, result.motion);
        return instant.is_all(constraints) || instant.can_keep(constraints);
      };
      const bool through = stays(goal);
      const Real when = through ? goal : bisect_last_true(done, goal, stays);
      Configuration<Real> now = configuration;
      if (when > done && at(when, now)) configuration = now;
      done = result.fraction = when;
      if (through) {
        decisions = 0;
        forced = by_force;
        continue;
      }
      // Find out why, as early as possible. Just when a contact comes to rest or begins to slide,
      // its rate is within rounding of zero and nothing can be decided; look a little later then.
      Real over = std::nextafter(when, Real(2));
      for (Real later = (goal - when) * Real(1e-12);; later *= Real(8)) {
        Configuration<Real> past{};
        result.reason = DropReason::jammed;
        if (at(over < goal ? over : goal, past)) decide(past, constraints, result);
        if (result.reason != DropReason::jammed || !(later < Real(0.02) * (goal - when))) break;
        over = when + later;
      }
      if (result.reason != DropReason::none || constraints.none()) return result;
      by_force = false;
      forced = ++decisions > most_decisions;
      if (decisions > 4 * most_decisions) {
        result.reason = DropReason::jammed;  // no motion can be distinguished that continues
        return result;
      }
    }
    return result;
  }

 private:
  // Number of decisions without progress after which the constraints are kept for the fraction
  // `forced_share` of a search interval (`look()`). Otherwise contacts that slide alternately would
  // switch infinitely often within a step. Each one now slides slightly too far, by at most that
  // fraction, before the next decision switches to the other.
  static constexpr int most_decisions = 6;
  static constexpr Real forced_share = Real(1) / Real(64);

  // What happens from here on; false where there are no constraints.
  bool decide(const Configuration<Real>& configuration, ContactConstraints<Real>& constraints,
              Advance<Real>& result) const {
    const auto decision =
        InstantMotions<Real>::decide(model, configuration, drive, constraints, push);
    result.reason = decision.reason;
    if (decision.reason != DropReason::none) return false;
    result.motion = decision.motion;
    constraints = decision.constraints;
    return !constraints.none();
  }

  // Newton's method starts from the look before: 1°, or a hundredth of the object, away.
  Real look() const {
    Real most = drive.change < Real(0) ? -drive.change : drive.change;
    most /= Real(0.01) * model.object.width;
    for (const Real t : drive.turn) {
      const Real turn = (t < Real(0) ? -t : t) / radians_per_degree<Real>;
      most = turn > most ? turn : most;
    }
    return most > Real(1) ? Real(1) / most : Real(1);
  }

  Configuration<Real> between(const Configuration<Real>& from, const Configuration<Real>& near,
                              Real t) const {
    Configuration<Real> there = near;
    there.separation = from.separation + t * drive.change;
    for (const std::size_t side : {left, right}) {
      if (drive.turn[side] == Real(0)) continue;
      there.palms[side] = PalmAngle<Real>::at(
          t == Real(1) ? angles[side] : from.palms[side].angle + t * drive.turn[side]);
    }
    return there;
  }
};

}  // namespace palmbots
