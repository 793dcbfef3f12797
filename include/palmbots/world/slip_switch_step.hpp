// SPDX-License-Identifier: Apache-2.0
// A step on whose way the contact that slides comes to a tie, and the other one slides on from
// there.
//
// While palms turn this is the commonest thing to happen inside a step, so it is written as the
// common step is (world/single_slip_step.hpp), for one carry or for several side by side. It does
// what world/event_step.hpp does, which takes whatever else there is.
//
// Source: MECHANICS sections 1, 2, 6.
#pragma once

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/holding_conditions.hpp"
#include "palmbots/mechanics/slip_onset.hpp"

namespace palmbots {

// A step in which the contact that lets go first slides: the left one, or the right one.
template <class V>
struct SlipSwitchInput {
  MaskOf<V> on_left;
  V way;  // +1: contacts slide up, −1: down
  V change;
  const PerSide<PalmAngle<V>>& turned;  // the palms at its end
  V push;
  V lead;       // > 0: how far the sliding contact lets go before the other, at its begin …
  V lead_then;  // … and at its end, < 0 where there is a tie
};

template <class V>
struct SlipSwitch {
  MaskOf<V> done;
  Slipped<V> end;
};

// Where `wanted`, hands over once; `done` tells where that is all that happens. Wanted may be where
// the contact that slides, if it slid on up to the end, would still be held, with neither edge
// wedged.
template <class V>
[[gnu::noinline, gnu::flatten]] SlipSwitch<V> switch_slip(const ModelParams<V>& params,
                                                          const Configuration<V>& from,
                                                          const SlipSwitchInput<V>& step,
                                                          MaskOf<V> wanted) {
  using Mask = MaskOf<V>;
  const Moments<V> pushed = moments_under(params.object, step.push);
  const PerSide<PalmAngle<V>>& turned = step.turned;
  const PerSide<V> turn{turned[left].angle - from.palms[left].angle,
                        turned[right].angle - from.palms[right].angle};
  // How far the contact that slid first still lets go before the other; 0 where an edge is wedged.
  const auto lead_at = [&](const PerSide<PalmAngle<V>>& palms,
                           const ContactVector<V>& contact_vector) {
    const PerSide<ConeEdge<V>> edges = edges_at(params.friction, palms, step.way);
    const V behind = slip_order(pushed, edges[left], edges[right]).at(contact_vector) * step.way;
    V lead = select(step.on_left, -behind, behind);
    on_both_sides([&](std::size_t side) {
      lead = select(wedged(side, edges[side], contact_vector.dx, contact_vector.dy), V(0), lead);
    });
    return lead;
  };
  // Of a palm that does not turn these are the sine and the cosine that it has.
  const auto palms_at = [&](V t) {
    PerSide<PalmAngle<V>> palms;
    on_both_sides([&](std::size_t side) {
      palms[side] = PalmAngle<V>::at(from.palms[side].angle + t * turn[side]);
    });
    return palms;
  };
  const auto slip_to = [&](V t, const PerSide<PalmAngle<V>>& palms) {
    return slip(step.on_left, from.separation + t * step.change, palms, from.contacts,
                params.offset, params.object.width);
  };

  // The last state that still leads, next to the tie. (At the step's begin nobody looks, but lanes
  // that are done and have found none.)
  PerSide<V> contacts = from.contacts;
  V lead(0);
  bracketed_root(wanted, V(0), step.lead, V(1), step.lead_then, [&](V t) {
    const PerSide<PalmAngle<V>> palms = palms_at(t);
    const Slipped<V> there = slip_to(t, palms);
    const V now = lead_at(palms, there.contact_vector);
    const Mask leads = (now >= V(0)) & (t > V(0));
    lead = select(leads, now, lead);
    // Mostly it does wherever it matters. What comes next need not wait for that: a branch is
    // guessed.
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

  const Slipped<V> end = slip<V>(!step.on_left, from.separation + step.change, turned, contacts,
                                 params.offset, params.object.width);
  good = good & (lead_at(turned, end.contact_vector) < V(0));
  const V rate =
      drive_rate(turned, end.contacts, params.offset, end.contact_vector, step.change, turn);
  const Mask drives = rate * step.way < V(0);
  const Mask left_turns = turn[left] != V(0);
  const Mask right_turns = turn[right] != V(0);
  const Mask turning = left_turns | right_turns;
  good = good & (drives | (!turning));
  return {good, end};
}

}  // namespace palmbots
