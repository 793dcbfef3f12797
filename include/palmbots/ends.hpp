// What ends a carry: the conditions under which two palms hold an object, at one instant.
//
// Source: MECHANICS section 5.
#pragma once

#include "palmbots/clearance.hpp"

namespace palmbots {

enum class End : std::uint8_t {
  none,
  off_palm,  // a contact ran past an end of its palm
  sliding,   // no squeeze balances the object: it slides on both palms
  flush,     // an edge of the object came to lie on a palm
  tip,       // a palm's end met an edge of the object
  tipping,   // the COM went past a contact
  jammed,    // no motion is possible in balance, and the robots still drive
  lifting,   // the object lifted off a palm, and rests on the other one alone
};

// A further contact closed: what comes of it is not said here.
constexpr bool is_touch(End end) { return end == End::flush || end == End::tip; }

// What does not change during a carry, in numbers.
template <class Real>
struct Fixture {
  Load<Real> load;
  Moments<Real> moments;  // of the load
  PerSide<ClearCone<Real>> clear;
  PerSide<Real> offset;       // of the palm's surface from its pivot [m]
  PerSide<Real> half_length;  // of the palm [m]
  PerSide<Real> friction;
  // The object is held while both |p| are at most this [m], whatever angles of theirs the palms have
  // (safe_reach.hpp); negative where nothing of the kind is known.
  Real safe_reach;
};

// The same with the object's outline.
template <class Real>
struct Rig : Fixture<Real> {
  Outline<Real> outline;
};

// The statics at one pair of palm angles.
template <class Real>
struct Statics {
  PerSide<Cone<Real>> cones;

  static constexpr Statics at(const Rig<Real>& rig, const PerSide<PalmAngle<Real>>& palms) {
    Statics s{};
    for (const std::size_t side : {left, right}) {
      s.cones[side] = friction_cone<Real>({palms[side].sin, palms[side].cos}, rig.friction[side]);
    }
    return s;
  }

  // ≥ 0 while the squeezes that one side's lower end and the other's upper end permit overlap.
  constexpr Real overlap(const Moments<Real>& load, std::size_t lower, Span<Real> span) const {
    if (lower == right) return tie(load, cones[left].up, cones[right].down).at(span);
    return -tie(load, cones[left].down, cones[right].up).at(span);
  }

  // Does the edge that slides in this direction bound no squeeze?
  constexpr bool wedged_in(std::size_t side, Slide direction, Span<Real> span) const {
    const Edge<Real> edge = direction == Slide::up ? cones[side].up : cones[side].down;
    return wedged(side, edge, span.dx, span.dy);
  }
};

// Is the object certainly held? A quick yes without a branch, for almost every tick; `false` leaves it
// open, since a wedged edge or a palm that passes below an overhang may hold all the same.
template <class Real>
[[gnu::always_inline]] inline MaskOf<Real> plainly_held(const Fixture<Real>& fixture,
                                                        const PerSide<Cone<Real>>& cones,
                                                        const PerSide<PalmAngle<Real>>& palms,
                                                        const PerSide<Real>& contacts,
                                                        Span<Real> span) {
  const Real left_up = tie(fixture.moments, cones[left].up, cones[right].down).at(span);
  const Real right_up = tie(fixture.moments, cones[left].down, cones[right].up).at(span);
  MaskOf<Real> held = (left_up >= Real(0)) & (right_up <= Real(0));
  on_both_sides([&](std::size_t side) {
    const MaskOf<Real> on_palm = within(contacts[side], fixture.half_length[side]);
    const Real arm = fixture.moments.lift_arm(side, span.dx, mirrored(side, span.dy));
    const MaskOf<Real> clear = fixture.clear[side].contains(reach(span, side, palms[side]));
    held = held & on_palm & (arm >= Real(0)) & clear;
  });
  return held;
}

// The first reason, in a fixed order, why the object is not held.
template <class Real>
[[gnu::noinline]] End first_end(const Rig<Real>& rig, const Statics<Real>& statics,
                                const PerSide<PalmAngle<Real>>& palms,
                                const PerSide<Real>& contacts, Span<Real> span) {
  for (const std::size_t side : {left, right}) {
    const Real p = contacts[side];
    if (!(p >= -rig.half_length[side] && p <= rig.half_length[side])) return End::off_palm;
  }
  bool at_tip = false;
  for (const std::size_t side : {left, right}) {
    const Reach<Real> r = reach(span, side, palms[side]);
    if (rig.clear[side].contains(r)) continue;
    const Touch t =
        touch(rig.outline, side, r, rig.load.width, contacts[side], rig.half_length[side]);
    if (t == Touch::flush) return End::flush;
    at_tip = at_tip || t == Touch::tip;
  }
  if (at_tip) return End::tip;
  for (const std::size_t side : {left, right}) {
    const Real arm = rig.moments.lift_arm(side, span.dx, mirrored(side, span.dy));
    if (!(arm >= Real(0))) return End::tipping;
  }
  const bool left_holds = statics.overlap(rig.moments, right, span) >= Real(0) ||
                          statics.wedged_in(left, Slide::up, span) ||
                          statics.wedged_in(right, Slide::down, span);
  const bool right_holds = statics.overlap(rig.moments, left, span) >= Real(0) ||
                           statics.wedged_in(left, Slide::down, span) ||
                           statics.wedged_in(right, Slide::up, span);
  return left_holds && right_holds ? End::none : End::sliding;
}

}  // namespace palmbots
