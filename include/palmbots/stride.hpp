// The common step of the world, without ceremony: one contact slides through the whole step.
//
// Written for one carry or for several side by side (lanes.hpp), without a branch that lanes could
// not share. What few steps need, a look at all that holds the object and a tie on the way, comes
// in a second half: several packs of lanes make the first one in turn, and a processor that guesses
// wrong which of them need the other has nothing else under way that is lost. Where anything else goes on
// (a reversal, an end, both edges wedged), nothing is changed, and the world takes the step apart (world.hpp).
//
// Source: MECHANICS sections 1, 2, 6.
#pragma once

#include "palmbots/handover.hpp"

namespace palmbots {

// How far a palm turns between two looks for events.
template <class Real>
inline constexpr Real longest_turn = radians_per_degree<Real>;

// Where everything is.
template <class V>
struct Place {
  Stance<V> stance;
  Span<V> span;
};

// What its contacts slide by.
template <class V>
struct Sliding {
  V push;   // sideways specific force of the pair's acceleration
  V tied;   // ±1: the direction in which both contacts slide along their tie; 0: they do not
  V rests;  // 1: the object rests on more, or on something else, than its two vertices
};

// Everything in the world that moves.
template <class V>
struct Pose : Place<V>, Sliding<V> {};

// What a step did, where it is done.
template <class V>
struct Stride {
  MaskOf<V> done;
  MaskOf<V> closing;      // the contact slid up, otherwise down
  MaskOf<V> on_left;      // it was the left contact, otherwise the right one
  MaskOf<V> handed_over;  // the other one slid before it, up to a tie
  // For the second half: where the step is done if the object is held, where there is a tie on the way,
  // and how far the contact that lets go first does so before the other, at its begin and at its end.
  MaskOf<V> unsure;
  MaskOf<V> ties;
  V lead_before;
  V lead;
};

namespace detail {

template <class V>
constexpr PerSide<Cone<V>> cones_at(const Fixture<V>& fixture, const PerSide<PalmAngle<V>>& palms) {
  PerSide<Cone<V>> cones{};
  on_both_sides([&](std::size_t side) {
    cones[side] = friction_cone<V>({palms[side].sin, palms[side].cos}, fixture.friction[side]);
  });
  return cones;
}

}  // namespace detail

// Changes the separation by `change` [m] and turns the palms to `angles` [rad], both linearly, under a
// push: the first half, which fills in `step` but for `handed_over`.
template <class V>
[[gnu::always_inline]] inline void stride(const Fixture<V>& fixture, const Place<V>& from,
                                          Sliding<V>& sliding, Place<V>& to, V change,
                                          const PerSide<V>& angles, V push, Stride<V>& step) {
  using Mask = MaskOf<V>;
  const PerSide<PalmAngle<V>>& palms = from.stance.palms;
  const PerSide<V>& contacts = from.stance.contacts;
  const Moments<V> pushed = moments_under(fixture.load, push);
  const bool some_tied = any(sliding.tied != V(0));
  // Ties lie elsewhere under another push.
  if (some_tied) sliding.tied = select(push != sliding.push, V(0), sliding.tied);
  sliding.push = push;
  const PerSide<V> turn{angles[left] - palms[left].angle, angles[right] - palms[right].angle};
  const Mask left_turns = turn[left] != V(0);
  const Mask right_turns = turn[right] != V(0);
  const Mask turning = left_turns | right_turns;
  const bool some_turn = any(turning);

  V rate = change;
  if (some_turn) {
    rate = select(turning, drive_rate(palms, contacts, fixture.offset, from.span, change, turn),
                  change);
  }
  const Mask closing = rate < V(0);
  const V way = select(closing, V(1), V(-1));
  const PerSide<Edge<V>> edges = edges_at(fixture.friction, palms, way);
  const Tie<V> before = tie(pushed, edges[left], edges[right]);
  const V left_behind = before.at(from.span) * way;  // < 0: the left contact slides sooner
  const Mask on_left = left_behind < V(0);
  Mask good = (closing | (rate > V(0))) & (on_left | (left_behind > V(0)));
  good = good & (sliding.rests == V(0));
  if (some_tied) good = good & (sliding.tied * way <= V(0));
  on_both_sides([&](std::size_t side) {
    good = good & (!wedged(side, edges[side], from.span.dx, from.span.dy));
  });

  PerSide<PalmAngle<V>> turned = palms;
  if (some_turn) {
    const V longest(longest_turn<typename ScalarOf<V>::type>);
    on_both_sides([&](std::size_t side) { good = good & within(turn[side], longest); });
    // A palm that does not turn has its sine and cosine already: what is found anew are the same bits.
    if (any(left_turns)) turned[left] = PalmAngle<V>::at(angles[left]);
    if (any(right_turns)) turned[right] = PalmAngle<V>::at(angles[right]);
  }
  const V separation = from.stance.separation + change;
  const Slipped<V> alone =
      slip(on_left, separation, turned, contacts, fixture.offset, fixture.load.width);

  Tie<V> tie_after = before;
  if (some_turn) {
    const V rate_after =
        drive_rate(turned, alone.contacts, fixture.offset, alone.span, change, turn);
    good = good & ((!turning) | (rate_after * way < V(0)));
    const PerSide<Edge<V>> edges_after = edges_at(fixture.friction, turned, way);
    tie_after = tie(pushed, edges_after[left], edges_after[right]);
  }
  const V still_behind = tie_after.at(alone.span) * way;
  const V lead = select(on_left, -still_behind, still_behind);
  const Mask ties = good & (lead < V(0));
  good = good & (lead > V(0));
  Mask held(good);
  on_both_sides(
      [&](std::size_t side) { held = held & within(alone.contacts[side], fixture.safe_reach); });
  const Mask unsure = good & (!held);
  good = good & held;

  to.stance.separation = separation;
  on_both_sides([&](std::size_t side) {
    to.stance.palms[side] = turned[side];
    to.stance.contacts[side] = alone.contacts[side];
  });
  to.span = alone.span;
  if (some_tied) sliding.tied = select(good, V(0), sliding.tied);
  // Field by field: a copy of the whole would wait for fields that have only just been written.
  step.done = good;
  step.closing = closing;
  step.on_left = on_left;
  step.unsure = unsure;
  step.ties = ties;
  step.lead_before = select(on_left, -left_behind, left_behind);
  step.lead = lead;
}

// The second half of a step that is not done everywhere. Where it is not done then either, everything is
// where it was.
template <class V>
[[gnu::noinline, gnu::flatten]] void finish_stride(const Fixture<V>& fixture, const Place<V>& from,
                                                   Sliding<V>& sliding, Place<V>& to, V change,
                                                   Stride<V>& step) {
  using Mask = MaskOf<V>;
  const PerSide<PalmAngle<V>>& turned = to.stance.palms;
  PerSide<V>& after = to.stance.contacts;
  Mask good = step.unsure;
  Mask held = !good;
  if (any(step.ties)) {
    Mask wanted = step.ties;
    const V way = select(step.closing, V(1), V(-1));
    const PerSide<Edge<V>> edges = edges_at(fixture.friction, turned, way);
    on_both_sides([&](std::size_t side) {
      const Mask reached = within(after[side], fixture.safe_reach);
      const Mask wedges = wedged(side, edges[side], to.span.dx, to.span.dy);
      wanted = wanted & reached & (!wedges);
    });
    // Mostly it is so at all ties. What comes next need not wait for that: a branch is guessed.
    if (all(wanted | !step.ties)) [[likely]]
      wanted = step.ties;
    const HandedOver<V> over = hand_over<V>(
        fixture, from.stance,
        {step.on_left, way, change, turned, sliding.push, step.lead_before, step.lead}, wanted);
    step.handed_over = over.done;
    step.on_left = step.on_left ^ over.done;
    good = good | over.done;
    // Wherever there is a tie, though it may not be done there: then it is put back, and nobody has waited.
    on_both_sides([&](std::size_t side) {
      after[side] = select(step.ties, over.end.contacts[side], after[side]);
      held = held & (within(after[side], fixture.safe_reach) | !step.ties);
    });
    to.span = {select(step.ties, over.end.span.dx, to.span.dx),
               select(step.ties, over.end.span.dy, to.span.dy)};
  }
  // Few contacts are ever out of the safe reach; only then all conditions are looked at.
  if (any(good & (!held))) {
    held = held | plainly_held(fixture, detail::cones_at(fixture, turned), turned, after, to.span);
  }
  good = good & held;
  sliding.tied = select(good, V(0), sliding.tied);
  step.done = step.done | good;
  if (all(step.done)) return;
  const auto put_back = [&](V& there, V then) { there = select(step.done, there, then); };
  put_back(to.stance.separation, from.stance.separation);
  on_both_sides([&](std::size_t side) {
    PalmAngle<V>& palm = to.stance.palms[side];
    palm = select<V>(step.done, palm, from.stance.palms[side]);
    put_back(after[side], from.stance.contacts[side]);
  });
  put_back(to.span.dx, from.span.dx);
  put_back(to.span.dy, from.span.dy);
}

// Both halves, in place.
template <class V>
[[gnu::always_inline]] inline Stride<V> stride(const Fixture<V>& fixture, Pose<V>& pose, V change,
                                               const PerSide<V>& angles, V push) {
  Place<V> to = pose;
  Stride<V> step{};
  stride<V>(fixture, pose, pose, to, change, angles, push, step);
  if (!all(step.done)) finish_stride<V>(fixture, pose, pose, to, change, step);
  static_cast<Place<V>&>(pose) = to;
  return step;
}

}  // namespace palmbots
