// The common step of the world, without ceremony: one contact slides through the whole step.
//
// Written for one carry or for several side by side (lanes.hpp), without a branch that lanes could
// not share. Where anything else goes on (a tie, a reversal, an end, both edges wedged), nothing is
// changed, and the world takes the step apart (world.hpp).
//
// Source: MECHANICS sections 1, 2, 6.
#pragma once

#include "palmbots/handover.hpp"

namespace palmbots {

// How far a palm turns between two looks for events.
template <class Real>
inline constexpr Real longest_turn = radians_per_degree<Real>;

// Everything in the world that moves.
template <class V>
struct Pose {
  Stance<V> stance;
  Span<V> span;
  V push;   // sideways specific force of the pair's acceleration
  V tied;   // ±1: the direction in which both contacts slide along their tie; 0: they do not
  V rests;  // 1: the object rests on more, or on something else, than its two vertices
};

// What a step did, where it is done.
template <class V>
struct Stride {
  MaskOf<V> done;
  MaskOf<V> closing;      // the contact slid up, otherwise down
  MaskOf<V> on_left;      // it was the left contact, otherwise the right one
  MaskOf<V> handed_over;  // the other one slid before it, up to a tie
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
// push.
template <class V>
[[gnu::always_inline]] inline Stride<V> stride(const Fixture<V>& fixture, Pose<V>& pose, V change,
                                               const PerSide<V>& angles, V push) {
  using Mask = MaskOf<V>;
  const PerSide<PalmAngle<V>>& palms = pose.stance.palms;
  const PerSide<V>& contacts = pose.stance.contacts;
  const Moments<V> pushed = moments_under(fixture.load, push);
  const bool some_tied = any(pose.tied != V(0));
  // Ties lie elsewhere under another push.
  if (some_tied) pose.tied = select(push != pose.push, V(0), pose.tied);
  pose.push = push;
  const PerSide<V> turn{angles[left] - palms[left].angle, angles[right] - palms[right].angle};
  const Mask left_turns = turn[left] != V(0);
  const Mask right_turns = turn[right] != V(0);
  const Mask turning = left_turns | right_turns;
  const bool some_turn = any(turning);

  V rate = change;
  if (some_turn) {
    rate = select(turning, drive_rate(palms, contacts, fixture.offset, pose.span, change, turn),
                  change);
  }
  const Mask closing = rate < V(0);
  const V way = select(closing, V(1), V(-1));
  const PerSide<Edge<V>> edges = edges_at(fixture.friction, palms, way);
  const Tie<V> before = tie(pushed, edges[left], edges[right]);
  const V left_behind = before.at(pose.span) * way;  // < 0: the left contact slides sooner
  Mask on_left = left_behind < V(0);
  Mask good = (closing | (rate > V(0))) & (on_left | (left_behind > V(0)));
  good = good & (pose.rests == V(0));
  if (some_tied) good = good & (pose.tied * way <= V(0));
  on_both_sides([&](std::size_t side) {
    good = good & (!wedged(side, edges[side], pose.span.dx, pose.span.dy));
  });

  PerSide<PalmAngle<V>> turned = palms;
  if (some_turn) {
    const V longest(longest_turn<typename ScalarOf<V>::type>);
    on_both_sides([&](std::size_t side) { good = good & within(turn[side], longest); });
    if (!any(good)) return {good, closing, on_left, good};
    // A palm that does not turn has its sine and cosine already: what is found anew are the same bits.
    if (any(left_turns)) turned[left] = PalmAngle<V>::at(angles[left]);
    if (any(right_turns)) turned[right] = PalmAngle<V>::at(angles[right]);
  }
  const V separation = pose.stance.separation + change;
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
  Mask handed_over = good & (lead < V(0));
  good = good & (lead > V(0));
  // Number by number, so that they stay in registers.
  PerSide<V> after{alone.contacts[left], alone.contacts[right]};
  Span<V> span{alone.span.dx, alone.span.dy};
  if (any(handed_over)) {
    const PerSide<Edge<V>> edges_then = edges_at(fixture.friction, turned, way);
    on_both_sides([&](std::size_t side) {
      const Mask reached = within(after[side], fixture.safe_reach);
      const Mask wedges = wedged(side, edges_then[side], span.dx, span.dy);
      handed_over = handed_over & reached & (!wedges);
    });
    const V lead_before = select(on_left, -left_behind, left_behind);
    const HandedOver<V> over = hand_over<V>(
        fixture, pose.stance, {on_left, way, change, turned, push, lead_before, lead}, handed_over);
    handed_over = over.done;
    good = good | handed_over;
    on_left = on_left ^ handed_over;
    on_both_sides([&](std::size_t side) {
      after[side] = select(handed_over, over.end.contacts[side], after[side]);
    });
    span = {select(handed_over, over.end.span.dx, span.dx),
            select(handed_over, over.end.span.dy, span.dy)};
  }
  Mask held(good);
  on_both_sides([&](std::size_t side) { held = held & within(after[side], fixture.safe_reach); });
  // Few contacts are ever out of the safe reach; only then all conditions are looked at.
  if (any(good & (!held))) {
    held = held | plainly_held(fixture, detail::cones_at(fixture, turned), turned, after, span);
  }
  good = good & held;

  const auto settle = [&](auto&& kept) {
    pose.stance.separation = kept(separation, pose.stance.separation);
    on_both_sides([&](std::size_t side) {
      PalmAngle<V>& palm = pose.stance.palms[side];
      palm = {kept(turned[side].angle, palm.angle), kept(turned[side].sin, palm.sin),
              kept(turned[side].cos, palm.cos)};
      pose.stance.contacts[side] = kept(after[side], pose.stance.contacts[side]);
    });
    pose.span = {kept(span.dx, pose.span.dx), kept(span.dy, pose.span.dy)};
    if (some_tied) pose.tied = kept(V(0), pose.tied);
  };
  if (all(good)) [[likely]] {
    settle([](V now, V) { return now; });
  } else {
    settle([&](V now, V then) { return select(good, now, then); });
  }
  return {good, closing, on_left, handed_over};
}

}  // namespace palmbots
