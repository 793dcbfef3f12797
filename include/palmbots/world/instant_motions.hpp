// SPDX-License-Identifier: Apache-2.0
// Motions at one instant, while the object rests on more contacts than its two contact vertices or
// on other ones: which contacts persist, and which of those stick.
//
// The motions that all contacts together can make and that balance decide
// (mechanics/twist_feasibility.hpp). Where several motions are possible these rules apply:
//
//   - as many contacts persist as possible, and both vertices take precedence over all others;
//   - with both palms flush and parallel the object may slide along either: along both by the same
//     amount if that balances, else along the one that balances;
//   - otherwise the first in a fixed order, the palm with the further contact first.
//
// Source: docs/theory/mechanics.md.
#pragma once

#include <array>
#include <compare>

#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/world/contact_constraints.hpp"

namespace palmbots {

// The motion of the robots during a step, or its rate: change of the separation, turns of the
// palms.
template <class Real>
struct Drive {
  Real change;
  PerSide<Real> turn;

  constexpr bool none() const {
    return change == Real(0) && turn[left] == Real(0) && turn[right] == Real(0);
  }
};

// One instant: all contacts, and the motions that are possible there.
template <class Real>
class InstantMotions {
 public:
  // Contacts of `constraints` count as they are, others only once they have closed, or, with
  // `almost`, as soon as they are found.
  InstantMotions(const Model<Real>& model, const Configuration<Real>& configuration,
                 const Drive<Real>& drive, const ContactConstraints<Real>& constraints, Real push,
                 bool almost = false)
      : model_(model),
        configuration_(configuration),
        push_(push),
        found_(detect_contacts(model, configuration, closed_tolerance<Real>)) {
    const detail::Equations<Real> equations(model, configuration, left);
    const Real closed = Real(64) * std::numeric_limits<Real>::epsilon() * model.object.width;
    std::array<bool, max_supports> counts{};
    PerSide<std::size_t> counted{};
    PerSide<std::size_t> further{};
    const std::size_t kept = found_.count < max_supports ? found_.count : max_supports;
    for (std::size_t i = 0; i < kept; ++i) {
      const ContactPoint<Real>& p = found_.points[i];
      for (std::size_t k = 0; k < constraints.count; ++k)
        counts[i] = counts[i] || constraints.active[k].is(p);
      counts[i] = counts[i] || almost ||
                  equations.gap(active_contact(p)).value <= closed * model.object.width;
      if (counts[i]) ++counted[p.support.side];
    }
    for (std::size_t i = 0; i < kept; ++i) {
      const ContactPoint<Real>& p = found_.points[i];
      // A vertex that slides over a palm's end hands over to the tip when the tip is almost closed.
      counts[i] = counts[i] || counted[p.support.side] == 0;
      if (counts[i]) further[p.support.side] += own(p) ? 0 : 1;
    }
    first_ = leading(further);
    for (const std::size_t side : {first_, other(first_)}) {
      const PalmMotion<Real> palm{outward<Real>(side) * Real(0.5) * drive.change, Real(0),
                                  outward<Real>(side) * drive.turn[side]};
      for (std::size_t i = 0; i < kept; ++i) {
        const Support<Real>& s = found_.points[i].support;
        if (s.side != side || !counts[i]) continue;
        velocities_[supports_.count] =
            velocity_at(palm, s.x - found_.pivot_x[side], s.y - found_.pivot_y[side]);
        point_[supports_.count] = i;
        supports_.at[supports_.count++] = s;
      }
    }
  }

  // `none` if the object is held, whatever moves, and no palm penetrates it; otherwise the reason.
  DropReason check() const {
    PerSide<bool> touched{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const ContactPoint<Real>& p = point(i);
      touched[p.support.side] = true;
      // A vertex this near to a palm's end (nanometres) and that end count as one contact.
      const Real half =
          model_.reach[p.support.side] - Real(200) * closed_tolerance<Real> * model_.object.width;
      const Real at = configuration_.contacts[p.support.side];
      if (own(p) && !(at >= -half && at <= half)) return DropReason::off_palm;
    }
    if (!touched[left] || !touched[right]) return DropReason::lifting;
    // Smaller than the gap of a closed contact: a corner penetrates a palm deeper than the palm
    // penetrates the corner.
    const Real near = closed_tolerance<Real> * model_.object.width / Real(64);
    if (found_.sunk[left] > near || found_.sunk[right] > near) return DropReason::flush;
    const Real slope = model_.object.slope;
    if (balances(supports_, Motions{}, slope)) return DropReason::none;
    // Checks whether the line of gravity passes beside all contacts.
    PerSide<bool> beside{true, true};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const Real x = supports_.at[i].x - slope * supports_.at[i].y;
      beside[left] = beside[left] && x < Real(0);
      beside[right] = beside[right] && x > Real(0);
    }
    return beside[left] || beside[right] ? DropReason::tipping : DropReason::sliding;
  }

  // True if the motion that the constraints state continues to occur. `motion` gets the motion of
  // the vertices.
  bool goes_on(const ContactConstraints<Real>& constraints, ContactMode& motion) const {
    HeldAs held_as{};
    if (!find(constraints, held_as)) return false;
    bool same = false;
    each([&](const Motions& m) {
      if (same || !stay_and_leave(m, held_as)) return;
      for (std::size_t i = 0; i < supports_.count; ++i) {
        if (!constraints.full && held_as[i] != nullptr &&
            held_as[i]->sticks != (m[i] == Motion::stick))
          return;
      }
      same = true;
      motion = motion_in(m);
    });
    return same;
  }

  // True if the object can move as the constraints state while all other contacts leave. Balance
  // does not matter.
  bool can_keep(const ContactConstraints<Real>& constraints) const {
    HeldAs held_as{};
    if (!find(constraints, held_as)) return false;
    bool possible = false;
    Twists<Real>(supports_, velocities_).each([&](const Motions& m) {
      bool as_stated = stay_and_leave(m, held_as);
      for (std::size_t i = 0; i < supports_.count && !constraints.full; ++i) {
        as_stated =
            as_stated && !(held_as[i] != nullptr && held_as[i]->sticks && m[i] != Motion::stick);
      }
      possible = possible || as_stated;
    });
    return possible;
  }

  // True if the constraints contain all closed contacts.
  bool is_all(const ContactConstraints<Real>& constraints) const {
    HeldAs held_as{};
    return find(constraints, held_as) && supports_.count == constraints.count;
  }

  struct Decision {
    DropReason reason;
    ContactConstraints<Real> constraints;
    ContactMode motion;
  };

  // What happens next at a state. Several contacts may close at one instant, for example when an
  // edge and a palm turn through level together. Rounding then closes some of them a little
  // earlier, and with those alone a palm may seem to lose the object. In that case contacts that
  // are almost closed count as well.
  static Decision decide(const Model<Real>& model, const Configuration<Real>& configuration,
                         const Drive<Real>& drive, const ContactConstraints<Real>& constraints,
                         Real push) {
    const InstantMotions closed(model, configuration, drive, constraints, push);
    const Decision first = closed.decision();
    const bool is_open = first.reason == DropReason::lifting || first.reason == DropReason::jammed;
    if (!is_open || closed.supports_.count == closed.found_.count) return first;
    const InstantMotions all(model, configuration, drive, constraints, push, true);
    const Decision second = all.decision();
    return second.reason == DropReason::none ? second : first;
  }

  // What happens next. Without constraints the object continues on its two vertices alone.
  Decision decision() const {
    Decision decision{check(), {}, {}};
    if (decision.reason != DropReason::none) return decision;
    Rank best{};
    each([&](const Motions& m) {
      std::size_t staying = 0;
      std::size_t vertices = 0;
      std::size_t slide = 0;
      PerSide<bool> touched{};
      for (std::size_t i = 0; i < supports_.count; ++i) {
        if (m[i] == Motion::leave) continue;
        ++staying;
        touched[supports_.at[i].side] = true;
        if (!own(point(i))) continue;
        ++vertices;
        slide += m[i] != Motion::stick ? 1 : 0;
      }
      const Rank rank{true, touched[left] && touched[right], vertices == 2, staying, slide == 2};
      if (rank <= best) return;
      best = rank;
      decision.reason = rank.on_both_palms ? DropReason::none : DropReason::lifting;
      decision.motion = motion_in(m);
      decision.constraints = staying == vertices ? ContactConstraints<Real>{} : constraints_at(m);
    });
    if (!best.is_possible) decision.reason = DropReason::jammed;
    return decision;
  }

  // All contacts, if there are more than the two vertices. Each may slide.
  ContactConstraints<Real> all() const {
    Motions m{};
    m.fill(Motion::up);
    return further() == max_supports ? ContactConstraints<Real>{} : constraints_at(m);
  }

  // The kind of the first contact that is not a contact vertex.
  ContactKind kind() const {
    const std::size_t i = further();
    if (i == max_supports) return ContactKind::none;
    return point(i).kind == ContactKind::tip ? ContactKind::tip : ContactKind::flush;
  }
  std::size_t side() const {
    const std::size_t i = further();
    return i == max_supports ? first_ : supports_.at[i].side;
  }

 private:
  // Motions in the order of the rules above, from the first criterion to the last.
  struct Rank {
    bool is_possible = false;
    bool on_both_palms = false;
    bool keeps_both_vertices = false;
    std::size_t staying = 0;  // contacts that persist
    bool slides_along_both = false;

    constexpr auto operator<=>(const Rank&) const = default;
  };

  // For each contact that counts: its constraint, or null.
  using HeldAs = std::array<const ActiveContact<Real>*, max_supports>;

  // Fills `held_as`; false unless every constraint still touches.
  bool find(const ContactConstraints<Real>& constraints, HeldAs& held_as) const {
    std::size_t found = 0;
    for (std::size_t i = 0; i < supports_.count; ++i) {
      for (std::size_t k = 0; k < constraints.count; ++k) {
        if (constraints.active[k].is(point(i))) held_as[i] = &constraints.active[k];
      }
      found += held_as[i] != nullptr ? 1 : 0;
    }
    return found == constraints.count;
  }

  // True if exactly the contacts of the constraints stay in this motion.
  bool stay_and_leave(const Motions& m, const HeldAs& held_as) const {
    for (std::size_t i = 0; i < supports_.count; ++i) {
      if ((m[i] != Motion::leave) != (held_as[i] != nullptr)) return false;
    }
    return true;
  }

  const ContactPoint<Real>& point(std::size_t i) const { return found_.points[point_[i]]; }
  bool own(const ContactPoint<Real>& p) const {
    return !p.palm_end && p.feature == model_.outline.contact[p.support.side];
  }
  // The palm with more contacts besides its vertex. The choice must be the same in the mirrored
  // problem; left comes first only if both sides are equal.
  std::size_t leading(const PerSide<std::size_t>& beside,
                      const PerSide<std::size_t>& stuck = {}) const {
    const auto ranks = [&](std::size_t side) {
      return std::array<Real, 10>{
          Real(beside[side]),
          configuration_.palms[side].angle,
          configuration_.contacts[side],
          Real(stuck[side]),
          model_.friction[side],
          model_.offset[side],
          model_.half_length[side],
          model_.reach[side],
          side == left ? model_.object.com_left : model_.object.com_right,
          mirrored(side, model_.object.slope + push_),
      };
    };
    const auto of_left = ranks(left);
    const auto of_right = ranks(right);
    if (of_left != of_right) return of_right > of_left ? right : left;
    const auto& outline = model_.outline;
    for (std::size_t i = 0; i < outline.count; ++i) {
      const Vertex<Real>& a = outline.vertices[outline.walked(left, i)];
      const Vertex<Real>& b = outline.vertices[outline.walked(right, i)];
      if (a.along[left] != b.along[right]) return b.along[right] > a.along[left] ? right : left;
      if (a.height != b.height) return b.height > a.height ? right : left;
    }
    return left;
  }

  static ActiveContact<Real> active_contact(const ContactPoint<Real>& p) {
    return {p.support.side, p.palm_end, p.feature, p.place, false, Real(0)};
  }
  std::size_t further() const {
    for (std::size_t i = 0; i < supports_.count; ++i) {
      if (!own(point(i))) return i;
    }
    return max_supports;
  }

  // The motion of each palm's first contact that persists.
  ContactMode motion_in(const Motions& m) const {
    ContactMode motion{};
    PerSide<bool> known{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const std::size_t side = supports_.at[i].side;
      if (m[i] == Motion::leave || known[side]) continue;
      known[side] = true;
      motion[side] = static_cast<SlipDirection>(m[i]);
    }
    return motion;
  }

  ContactConstraints<Real> constraints_at(const Motions& m) const {
    ContactConstraints<Real> constraints{};
    PerSide<std::size_t> beside{};
    PerSide<std::size_t> stuck{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      if (m[i] == Motion::leave) continue;
      const ContactPoint<Real>& p = point(i);
      beside[p.support.side] += own(p) ? 0 : 1;
      stuck[p.support.side] += m[i] == Motion::stick ? 1 : 0;
      constraints.active[constraints.count++] = {
          p.support.side, p.palm_end, p.feature, p.place, m[i] == Motion::stick, Real(0)};
    }
    constraints.first = leading(beside, stuck);
    remember(model_, configuration_, constraints);
    return constraints;
  }

  // The motions that balance under the push or, if there are none, without it.
  template <class Found>
  void each(Found found) const {
    bool any = false;
    each_outcome(supports_, velocities_, model_.object.slope + push_, [&](const Motions& m) {
      any = true;
      found(m);
    });
    if (!any && push_ != Real(0)) each_outcome(supports_, velocities_, model_.object.slope, found);
  }

  const Model<Real>& model_;
  const Configuration<Real>& configuration_;
  Real push_;
  ContactSet<Real> found_;
  Supports<Real> supports_{};
  Velocities<Real> velocities_{};
  std::array<std::size_t, max_supports> point_{};
  std::size_t first_ = left;
};

}  // namespace palmbots
