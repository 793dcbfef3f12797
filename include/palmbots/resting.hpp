// What happens while the object rests on more, or on something else, than its two contact vertices: an
// edge lies flush on a palm, a further vertex stands on it, or a palm's tip meets an edge.
//
// At every instant the motions that all contacts together can make, and that are in balance (twist.hpp),
// say which of them stay and which of those stick; where that leaves the object is exact (grip.hpp).
// Where several motions are possible the rules are:
//
//   - as many contacts stay as can, and both vertices before anything else;
//   - with both palms flush and parallel the object may slide along either: along both alike where
//     that is in balance, else along the one that it is;
//   - else the first in a fixed order, the palm with the further contact first.
//
// The carry is over when nothing touches one of the palms any more, and as in ends.hpp. As in world.hpp
// `push` decides which contacts slide, not whether the object is held. Source: MECHANICS sections 5, 6.
#pragma once

#include <array>

#include "palmbots/grip.hpp"
#include "palmbots/locate.hpp"
#include "palmbots/slip.hpp"

namespace palmbots {

// What a step did.
template <class Real>
struct Advance {
  End end = End::none;
  Real fraction = Real(1);  // of the step that was done
  Mode motion{};            // of its last piece
  std::int32_t pieces = 1;  // regimes passed through
};

// How the robots move during a step, or how fast: change of the separation, turns of the palms.
template <class Real>
struct Drive {
  Real change;
  PerSide<Real> turn;

  constexpr bool none() const {
    return change == Real(0) && turn[left] == Real(0) && turn[right] == Real(0);
  }
};

// Times at which the object rested on a further contact, and the latest: what it was, and when it began
// and, unless it lasts, ended, as fractions of the steps in which it did.
template <class Real>
struct Touches {
  std::uint32_t count = 0;
  Touch kind = Touch::none;
  std::size_t side = left;
  Real began = Real(0);
  Real ended = Real(0);
};

// One instant: all contacts, and what may happen to them.
template <class Real>
class Instant {
 public:
  // Contacts of `grip` count as they are, others only once they have closed.
  Instant(const Rig<Real>& rig, const Stance<Real>& stance, const Drive<Real>& drive,
          const Grip<Real>& grip, Real push)
      : rig_(rig),
        stance_(stance),
        push_(push),
        found_(touching(rig, stance, closed_tolerance<Real>)) {
    const detail::Equations<Real> equations(rig, stance, left);
    const Real closed = Real(64) * std::numeric_limits<Real>::epsilon() * rig.load.width;
    std::array<bool, max_supports> counts{};
    PerSide<std::size_t> counted{};
    PerSide<std::size_t> further{};
    const std::size_t kept = found_.count < max_supports ? found_.count : max_supports;
    for (std::size_t i = 0; i < kept; ++i) {
      const TouchPoint<Real>& p = found_.points[i];
      for (std::size_t k = 0; k < grip.count; ++k) counts[i] = counts[i] || grip.holds[k].is(p);
      counts[i] = counts[i] || equations.gap(hold(p)).value <= closed * rig.load.width;
      if (counts[i]) ++counted[p.support.side];
    }
    for (std::size_t i = 0; i < kept; ++i) {
      const TouchPoint<Real>& p = found_.points[i];
      // A vertex that slides over a palm's end hands over to the tip while that is almost closed.
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

  // Is the object held, whatever moves, and is no palm in it? none, or why not.
  End check() const {
    PerSide<bool> touched{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const TouchPoint<Real>& p = point(i);
      touched[p.support.side] = true;
      // A vertex this near to a palm's end (nanometres) and that end are one contact.
      const Real half =
          rig_.half_length[p.support.side] - Real(200) * closed_tolerance<Real> * rig_.load.width;
      const Real at = stance_.contacts[p.support.side];
      if (own(p) && !(at >= -half && at <= half)) return End::off_palm;
    }
    if (!touched[left] || !touched[right]) return End::lifting;
    // Less than what touches: a corner goes deeper into a palm than the palm goes into the corner.
    const Real near = closed_tolerance<Real> * rig_.load.width / Real(64);
    if (found_.sunk[left] > near || found_.sunk[right] > near) return End::flush;
    const Real slope = rig_.load.slope;
    if (balances(supports_, Motions{}, slope)) return End::none;
    // Does the line of gravity pass beside all contacts?
    PerSide<bool> beside{true, true};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const Real x = supports_.at[i].x - slope * supports_.at[i].y;
      beside[left] = beside[left] && x < Real(0);
      beside[right] = beside[right] && x > Real(0);
    }
    return beside[left] || beside[right] ? End::tipping : End::sliding;
  }

  // Does what moves as the grip says go on to be what happens? How the vertices move.
  bool goes_on(const Grip<Real>& grip, Mode& motion) const {
    std::array<const Hold<Real>*, max_supports> holds{};
    std::size_t found = 0;
    for (std::size_t i = 0; i < supports_.count; ++i) {
      for (std::size_t k = 0; k < grip.count; ++k) {
        if (grip.holds[k].is(point(i))) holds[i] = &grip.holds[k];
      }
      found += holds[i] != nullptr ? 1 : 0;
    }
    if (found < grip.count) return false;
    bool same = false;
    each([&](const Motions& m) {
      if (same) return;
      for (std::size_t i = 0; i < supports_.count; ++i) {
        if ((m[i] != Motion::leave) != (holds[i] != nullptr)) return;
        if (!grip.full && holds[i] != nullptr && holds[i]->sticks != (m[i] == Motion::stick))
          return;
      }
      same = true;
      motion = motion_in(m);
    });
    return same;
  }

  // Is the grip all that touches?
  bool is_all(const Grip<Real>& grip) const {
    std::size_t found = 0;
    for (std::size_t i = 0; i < supports_.count; ++i) {
      for (std::size_t k = 0; k < grip.count; ++k) found += grip.holds[k].is(point(i)) ? 1 : 0;
    }
    return found == grip.count && supports_.count == grip.count;
  }

  struct Fate {
    End end;
    Grip<Real> grip;
    Mode motion;
  };

  // What happens next; a grip that is none: the object goes on upon its two vertices alone.
  Fate fate() const {
    Fate fate{check(), {}, {}};
    if (fate.end != End::none) return fate;
    std::size_t best = 0;
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
      const std::size_t both = touched[left] && touched[right] ? 1 : 0;
      const std::size_t rank = 1 + 1000 * both + 100 * (vertices / 2) + 10 * staying + slide / 2;
      if (rank <= best) return;
      best = rank;
      fate.end = both == 1 ? End::none : End::lifting;
      fate.motion = motion_in(m);
      fate.grip = staying == vertices ? Grip<Real>{} : grip_in(m);
    });
    if (best == 0) fate.end = End::jammed;
    return fate;
  }

  // All contacts, where there are more than the two vertices; each may slide.
  Grip<Real> all() const {
    Motions m{};
    m.fill(Motion::up);
    return further() == max_supports ? Grip<Real>{} : grip_in(m);
  }

  // The first contact that is no contact vertex.
  Touch kind() const {
    const std::size_t i = further();
    if (i == max_supports) return Touch::none;
    return point(i).meeting == Meeting::tip ? Touch::tip : Touch::flush;
  }
  std::size_t side() const {
    const std::size_t i = further();
    return i == max_supports ? first_ : supports_.at[i].side;
  }

 private:
  const TouchPoint<Real>& point(std::size_t i) const { return found_.points[point_[i]]; }
  bool own(const TouchPoint<Real>& p) const {
    return !p.palm_end && p.feature == rig_.outline.contact[p.support.side];
  }
  // The palm with more contacts besides its vertex; the mirror must not matter, and left comes first
  // only where all is alike.
  std::size_t leading(const PerSide<std::size_t>& beside,
                      const PerSide<std::size_t>& stuck = {}) const {
    const auto ranks = [&](std::size_t side) {
      return std::array<Real, 9>{
          Real(beside[side]),
          stance_.palms[side].angle,
          stance_.contacts[side],
          Real(stuck[side]),
          rig_.friction[side],
          rig_.offset[side],
          rig_.half_length[side],
          side == left ? rig_.load.com_left : rig_.load.com_right,
          mirrored(side, rig_.load.slope + push_),
      };
    };
    const auto of_left = ranks(left);
    const auto of_right = ranks(right);
    if (of_left != of_right) return of_right > of_left ? right : left;
    const auto& outline = rig_.outline;
    for (std::size_t i = 0; i < outline.count; ++i) {
      const Vertex<Real>& a = outline.vertices[outline.walked(left, i)];
      const Vertex<Real>& b = outline.vertices[outline.walked(right, i)];
      if (a.along[left] != b.along[right]) return b.along[right] > a.along[left] ? right : left;
      if (a.height != b.height) return b.height > a.height ? right : left;
    }
    return left;
  }

  static Hold<Real> hold(const TouchPoint<Real>& p) {
    return {p.support.side, p.palm_end, p.feature, p.place, false, Real(0)};
  }
  std::size_t further() const {
    for (std::size_t i = 0; i < supports_.count; ++i) {
      if (!own(point(i))) return i;
    }
    return max_supports;
  }

  // Of a palm's first contact that stays.
  Mode motion_in(const Motions& m) const {
    Mode motion{};
    PerSide<bool> known{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      const std::size_t side = supports_.at[i].side;
      if (m[i] == Motion::leave || known[side]) continue;
      known[side] = true;
      motion[side] = static_cast<Slide>(m[i]);
    }
    return motion;
  }

  Grip<Real> grip_in(const Motions& m) const {
    Grip<Real> grip{};
    PerSide<std::size_t> beside{};
    PerSide<std::size_t> stuck{};
    for (std::size_t i = 0; i < supports_.count; ++i) {
      if (m[i] == Motion::leave) continue;
      const TouchPoint<Real>& p = point(i);
      beside[p.support.side] += own(p) ? 0 : 1;
      stuck[p.support.side] += m[i] == Motion::stick ? 1 : 0;
      grip.holds[grip.count++] = {p.support.side,        p.palm_end, p.feature, p.place,
                                  m[i] == Motion::stick, Real(0)};
    }
    grip.first = leading(beside, stuck);
    remember(rig_, stance_, grip);
    return grip;
  }

  // The motions in balance under the push; where there are none, without it.
  template <class Found>
  void each(Found found) const {
    bool any = false;
    each_outcome(supports_, velocities_, rig_.load.slope + push_, [&](const Motions& m) {
      any = true;
      found(m);
    });
    if (!any && push_ != Real(0)) each_outcome(supports_, velocities_, rig_.load.slope, found);
  }

  const Rig<Real>& rig_;
  const Stance<Real>& stance_;
  Real push_;
  Touching<Real> found_;
  Supports<Real> supports_{};
  Velocities<Real> velocities_{};
  std::array<std::size_t, max_supports> point_{};
  std::size_t first_ = left;
};

// A step, or what is left of one, with a grip.
template <class Real>
struct Rest {
  const Rig<Real>& rig;
  Drive<Real> drive;
  PerSide<Real> angles;  // at the end [rad]
  Real push;

  // Moves `stance` as far as the grip, or one that takes its place, stays. Where the grip has become
  // none and nothing ended, what is left of the step is for the two vertices alone. `by_force` keeps
  // the grip whatever is in balance, as long as the object is held.
  Advance<Real> run(Stance<Real>& stance, Grip<Real>& grip, bool by_force) const {
    Advance<Real> result{};
    if (drive.none()) return result;
    const Stance<Real> from = stance;
    Real done = Real(0);
    result.fraction = done;
    if (!by_force && !decide(stance, grip, result)) return result;
    int decisions = 0;
    for (result.pieces = 1; done < Real(1); ++result.pieces) {
      const Real goal = done + look() < Real(1) ? done + look() : Real(1);
      const auto at = [&](Real t, Stance<Real>& there) {
        there = between(from, stance, t);
        return settle(rig, grip, there);
      };
      const auto stays = [&](Real t) {
        Stance<Real> there{};
        if (!at(t, there)) return false;
        const Instant<Real> instant(rig, there, drive, grip, push);
        if (instant.check() != End::none) return false;
        return by_force ? instant.is_all(grip) : instant.goes_on(grip, result.motion);
      };
      const bool through = stays(goal);
      const Real when = through ? goal : last_holding(done, goal, stays);
      Stance<Real> now = stance;
      if (when > done && at(when, now)) stance = now;
      done = result.fraction = when;
      if (through) continue;
      // The reason is read where it first applies. Where what slides has only just come to rest or
      // begun to move, its rate is still nothing: then a little later.
      Real over = std::nextafter(when, Real(2));
      for (Real later = (goal - when) * Real(1e-12);; later *= Real(8)) {
        Stance<Real> past{};
        result.end = End::jammed;
        if (at(over < goal ? over : goal, past)) decide(past, grip, result);
        if (result.end != End::jammed || !(later < Real(0.02) * (goal - when))) break;
        over = when + later;
      }
      if (result.end != End::none || grip.none()) return result;
      by_force = ++decisions > most_decisions;
      if (decisions > 4 * most_decisions) {
        result.end = End::jammed;  // nothing that can be told apart goes on
        return result;
      }
    }
    return result;
  }

 private:
  // In a step: contacts that slide by turns would do so for ever.
  static constexpr int most_decisions = 6;

  // What happens from here on; false where it is nothing for a grip.
  bool decide(const Stance<Real>& stance, Grip<Real>& grip, Advance<Real>& result) const {
    const auto fate = Instant<Real>(rig, stance, drive, grip, push).fate();
    result.end = fate.end;
    if (fate.end != End::none) return false;
    result.motion = fate.motion;
    grip = fate.grip;
    return !grip.none();
  }

  // Newton's method starts from the look before: 1°, or a hundredth of the object, away.
  Real look() const {
    Real most = drive.change < Real(0) ? -drive.change : drive.change;
    most /= Real(0.01) * rig.load.width;
    for (const Real t : drive.turn) {
      const Real turn = (t < Real(0) ? -t : t) / radians_per_degree<Real>;
      most = turn > most ? turn : most;
    }
    return most > Real(1) ? Real(1) / most : Real(1);
  }

  Stance<Real> between(const Stance<Real>& from, const Stance<Real>& near, Real t) const {
    Stance<Real> there = near;
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
