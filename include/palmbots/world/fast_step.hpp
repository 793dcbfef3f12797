// SPDX-License-Identifier: Apache-2.0
// The fast step of the world: one contact slides through the whole step, or first one and, from a
// tie on, the other one. While palms turn, a tie is the most frequent event inside a step.
//
// It is written for one carry or for several side by side (base/simd_lanes.hpp), without branches
// that lanes could not share. Few steps need the second half, which evaluates all conditions that
// hold the object and ties inside the step. Several packs of lanes execute the first half in turn,
// so that a branch misprediction in the second half does not discard work of the first. If anything
// else happens (a reversal, an end, an edge that wedges), nothing is changed, and the general step
// (world/general_step.hpp) takes over. Both follow the slip rule (mechanics/slip_rule.hpp).
//
// Source: docs/theory/mechanics.md.
#pragma once

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/sliding.hpp"
#include "palmbots/mechanics/slip_rule.hpp"
#include "palmbots/world/state.hpp"

namespace palmbots {

// The largest turn of a palm between two checks for events [rad].
template <class Real>
inline constexpr Real longest_turn = radians_per_degree<Real>;

// The result of a step, in the lanes where it is done.
template <class V>
struct FastStep {
  MaskOf<V> done;
  MaskOf<V> closing;   // the contact slid up, otherwise down
  MaskOf<V> on_left;   // it was the left contact, otherwise the right one
  MaskOf<V> switched;  // the other one slid before it, up to a tie
  // For the second half: `unsure` are the lanes where the step is done if the object is held, and
  // `ties` the lanes with a tie inside the step. The leads state by how much the first contact to
  // slip does so before the other, at the start and at the end of the step.
  MaskOf<V> unsure;
  MaskOf<V> ties;
  V lead_before;
  V lead;
};

// The first half: changes the separation by `change` [m] and turns the palms to `angles` [rad],
// both linearly, under a push. It fills in `step` except `switched`.
template <class V>
[[gnu::always_inline]] inline void step_fast(const ModelParams<V>& params,
                                             const Kinematics<V>& from, SlipState<V>& slip_state,
                                             Kinematics<V>& to, V change, const PerSide<V>& angles,
                                             V push, FastStep<V>& step) {
  using Mask = MaskOf<V>;
  const PerSide<PalmAngle<V>>& palms = from.configuration.palms;
  const PerSide<V>& contacts = from.configuration.contacts;
  const Moments<V> pushed = moments_under(params.object, push);
  const bool some_tied = any(slip_state.tied != V(0));
  // A different push moves the ties.
  if (some_tied) slip_state.tied = select(push != slip_state.push, V(0), slip_state.tied);
  slip_state.push = push;
  const PerSide<V> turn{angles[left] - palms[left].angle, angles[right] - palms[right].angle};
  const Mask left_turns = turn[left] != V(0);
  const Mask right_turns = turn[right] != V(0);
  const Mask turning = left_turns | right_turns;
  const bool some_turn = any(turning);

  V rate = change;
  if (some_turn) {
    rate = select(turning,
                  drive_rate(palms, contacts, params.offset, from.contact_vector, change, turn),
                  change);
  }
  const Mask closing = rate < V(0);
  const V way = select(closing, V(1), V(-1));
  const PerSide<ConeEdge<V>> edges = edges_at(params.friction, palms, way);
  const SlipOrder<V> before = slip_order(pushed, edges[left], edges[right]);
  const V lead_of_left = left_lead(before, from.contact_vector, way);
  const Mask on_left = lead_of_left > V(0);
  Mask good = (closing | (rate > V(0))) & (on_left | (lead_of_left < V(0)));
  good = good & (slip_state.multi_contact == V(0));
  if (some_tied) good = good & (slip_state.tied * way <= V(0));
  on_both_sides([&](std::size_t side) {
    good = good & (!wedged(side, edges[side], from.contact_vector.dx, from.contact_vector.dy));
  });

  PerSide<PalmAngle<V>> turned = palms;
  if (some_turn) {
    const V longest(longest_turn<typename ScalarOf<V>::type>);
    on_both_sides([&](std::size_t side) { good = good & within(turn[side], longest); });
    // For a palm that does not turn, the recomputed sine and cosine have the same bits as before.
    if (any(left_turns)) turned[left] = PalmAngle<V>::at(angles[left]);
    if (any(right_turns)) turned[right] = PalmAngle<V>::at(angles[right]);
  }
  const V separation = from.configuration.separation + change;
  const Slipped<V> alone =
      slip(on_left, separation, turned, contacts, params.offset, params.object.width);

  SlipOrder<V> tie_after = before;
  if (some_turn) {
    const V rate_after =
        drive_rate(turned, alone.contacts, params.offset, alone.contact_vector, change, turn);
    good = good & ((!turning) | (rate_after * way < V(0)));
    const PerSide<ConeEdge<V>> edges_after = edges_at(params.friction, turned, way);
    tie_after = slip_order(pushed, edges_after[left], edges_after[right]);
  }
  const V lead = lead_of<V>(on_left, left_lead(tie_after, alone.contact_vector, way));
  const Mask ties = good & (lead < V(0));
  good = good & (lead > V(0));
  Mask held(good);
  on_both_sides(
      [&](std::size_t side) { held = held & within(alone.contacts[side], params.safe_reach); });
  const Mask unsure = good & (!held);
  good = good & held;

  to.configuration.separation = separation;
  on_both_sides([&](std::size_t side) {
    to.configuration.palms[side] = turned[side];
    to.configuration.contacts[side] = alone.contacts[side];
  });
  to.contact_vector = alone.contact_vector;
  if (some_tied) slip_state.tied = select(good, V(0), slip_state.tied);
  // Copies field by field: a copy of the whole struct would stall on fields that have only just
  // been written.
  step.done = good;
  step.closing = closing;
  step.on_left = on_left;
  step.unsure = unsure;
  step.ties = ties;
  step.lead_before = lead_of<V>(on_left, lead_of_left);
  step.lead = lead;
}

// A step that passes a tie: where it is done, and the contacts at its end.
template <class V>
struct TieStep {
  MaskOf<V> done;
  Slipped<V> end;
};

// From a tie on, the other contact slides: in the lanes `wanted`. `done` is true in the lanes where
// nothing else happens. A lane may be wanted if the object would still be held, with neither edge
// wedged, if the sliding contact continued to the end, where the palms are `turned`.
template <class V>
[[gnu::noinline, gnu::flatten]] TieStep<V> pass_tie(const ModelParams<V>& params,
                                                    const Configuration<V>& from,
                                                    const FastStep<V>& step, V change,
                                                    const PerSide<PalmAngle<V>>& turned, V push,
                                                    V way, MaskOf<V> wanted) {
  using Mask = MaskOf<V>;
  const Moments<V> pushed = moments_under(params.object, push);
  const PerSide<V> turn{turned[left].angle - from.palms[left].angle,
                        turned[right].angle - from.palms[right].angle};
  // The lead of the contact that slid first over the other.
  const auto lead_at = [&](const PerSide<PalmAngle<V>>& palms,
                           const ContactVector<V>& contact_vector) {
    const PerSide<ConeEdge<V>> edges = edges_at(params.friction, palms, way);
    return SlipOnset<V>::at(pushed, edges, contact_vector, way).own_lead(step.on_left);
  };
  // The last state that still leads, next to the tie. The start of the step is evaluated only in
  // lanes that are done and have found no tie.
  PerSide<V> contacts = from.contacts;
  V lead(0);
  bracketed_root(wanted, V(0), step.lead_before, V(1), step.lead, [&](V t) {
    PerSide<PalmAngle<V>> palms;  // one that does not turn keeps its sine and cosine
    on_both_sides([&](std::size_t side) {
      palms[side] = PalmAngle<V>::at(from.palms[side].angle + t * turn[side]);
    });
    const Slipped<V> there = slip(step.on_left, from.separation + t * change, palms, from.contacts,
                                  params.offset, params.object.width);
    const V now = lead_at(palms, there.contact_vector);
    const Mask leads = (now >= V(0)) & (t > V(0));
    lead = select(leads, now, lead);
    // The lead mostly holds in all lanes that matter. A predicted branch lets the following work
    // start early.
    if (all(leads | !wanted)) [[likely]] {
      contacts = there.contacts;
    } else {
      on_both_sides([&](std::size_t side) {
        contacts[side] = select(leads, there.contacts[side], contacts[side]);
      });
    }
    return now;
  });
  Mask good = wanted & (lead > V(0));

  const Slipped<V> end = slip<V>(!step.on_left, from.separation + change, turned, contacts,
                                 params.offset, params.object.width);
  good = good & (lead_at(turned, end.contact_vector) < V(0));
  const V rate = drive_rate(turned, end.contacts, params.offset, end.contact_vector, change, turn);
  const Mask drives = rate * way < V(0);
  const Mask left_turns = turn[left] != V(0);
  const Mask right_turns = turn[right] != V(0);
  const Mask turning = left_turns | right_turns;
  good = good & (drives | (!turning));
  return {good, end};
}

// The second half of a step that is not done in all lanes. In lanes where it is still not done
// afterwards, nothing has changed.
template <class V>
[[gnu::noinline, gnu::flatten]] void finish_fast(const ModelParams<V>& params,
                                                 const Kinematics<V>& from, SlipState<V>& slip,
                                                 Kinematics<V>& to, V change, FastStep<V>& step) {
  using Mask = MaskOf<V>;
  const PerSide<PalmAngle<V>>& turned = to.configuration.palms;
  PerSide<V>& after = to.configuration.contacts;
  Mask good = step.unsure;
  Mask held = !good;
  if (any(step.ties)) {
    Mask wanted = step.ties;
    const V way = select(step.closing, V(1), V(-1));
    const PerSide<ConeEdge<V>> edges = edges_at(params.friction, turned, way);
    on_both_sides([&](std::size_t side) {
      const Mask reached = within(after[side], params.safe_reach);
      const Mask wedges = wedged(side, edges[side], to.contact_vector.dx, to.contact_vector.dy);
      wanted = wanted & reached & (!wedges);
    });
    // The step is mostly done at all ties. A predicted branch lets the following work start early.
    if (all(wanted | !step.ties)) [[likely]]
      wanted = step.ties;
    const TieStep<V> over =
        pass_tie<V>(params, from.configuration, step, change, turned, slip.push, way, wanted);
    step.switched = over.done;
    step.on_left = step.on_left ^ over.done;
    good = good | over.done;
    // Written at every tie, even where the step may not be done. Those lanes are restored later, so
    // that nothing waits for the result.
    on_both_sides([&](std::size_t side) {
      after[side] = select(step.ties, over.end.contacts[side], after[side]);
      held = held & (within(after[side], params.safe_reach) | !step.ties);
    });
    to.contact_vector = {select(step.ties, over.end.contact_vector.dx, to.contact_vector.dx),
                         select(step.ties, over.end.contact_vector.dy, to.contact_vector.dy)};
  }
  // Few contacts are outside the safe reach. Only then all conditions are evaluated.
  if (any(good & (!held))) {
    held =
        held | certainly_held(params, params.moments, to.contact_vector,
                              cones_at(params.friction, turned), turned, after, to.contact_vector);
  }
  good = good & held;
  slip.tied = select(good, V(0), slip.tied);
  step.done = step.done | good;
  if (all(step.done)) return;
  const auto put_back = [&](V& there, V then) { there = select(step.done, there, then); };
  put_back(to.configuration.separation, from.configuration.separation);
  on_both_sides([&](std::size_t side) {
    PalmAngle<V>& palm = to.configuration.palms[side];
    palm = select<V>(step.done, palm, from.configuration.palms[side]);
    put_back(after[side], from.configuration.contacts[side]);
  });
  put_back(to.contact_vector.dx, from.contact_vector.dx);
  put_back(to.contact_vector.dy, from.contact_vector.dy);
}

// Both halves, in place.
template <class V>
[[gnu::always_inline]] inline FastStep<V> step_fast(const ModelParams<V>& params,
                                                    WorldState<V>& state, V change,
                                                    const PerSide<V>& angles, V push) {
  Kinematics<V> to = state;
  FastStep<V> step{};
  step_fast<V>(params, state, state, to, change, angles, push, step);
  if (!all(step.done)) finish_fast<V>(params, state, state, to, change, step);
  static_cast<Kinematics<V>&>(state) = to;
  return step;
}

}  // namespace palmbots
