// SPDX-License-Identifier: Apache-2.0
// A step in which the sliding contact reaches a tie, and the other contact slides on from there.
//
// While palms turn this is the most frequent event inside a step. It is therefore written like the
// fast step (world/fast_step.hpp), for one carry or for several side by side. It gives the
// same result as world/general_step.hpp, which handles all other events.
//
// Source: docs/theory/mechanics.md.
#pragma once

#include "palmbots/base/root_finding.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/sliding.hpp"
#include "palmbots/mechanics/slip_rule.hpp"

namespace palmbots {

// The input: a step in which the contact that slips first slides, the left one or the right one.
template <class V>
struct TieInput {
  MaskOf<V> on_left;
  V way;  // +1: contacts slide up, −1: down
  V change;
  const PerSide<PalmAngle<V>>& turned;  // the palms at the end of the step
  V push;
  V lead;       // > 0: lead of the sliding contact over the other at the start
  V lead_then;  // the same at the end; < 0 where there is a tie
};

// The result: where the step is done, and the contacts at its end.
template <class V>
struct TieStep {
  MaskOf<V> done;
  Slipped<V> end;
};

// Switches once, in the lanes `wanted`. `done` is true in the lanes where nothing else happens. A
// lane may be wanted if the object would still be held, with neither edge wedged, if the sliding
// contact continued to the end.
template <class V>
[[gnu::noinline, gnu::flatten]] TieStep<V> pass_tie(const ModelParams<V>& params,
                                                    const Configuration<V>& from,
                                                    const TieInput<V>& step, MaskOf<V> wanted) {
  using Mask = MaskOf<V>;
  const Moments<V> pushed = moments_under(params.object, step.push);
  const PerSide<PalmAngle<V>>& turned = step.turned;
  const PerSide<V> turn{turned[left].angle - from.palms[left].angle,
                        turned[right].angle - from.palms[right].angle};
  // The lead of the contact that slid first over the other.
  const auto lead_at = [&](const PerSide<PalmAngle<V>>& palms,
                           const ContactVector<V>& contact_vector) {
    const PerSide<ConeEdge<V>> edges = edges_at(params.friction, palms, step.way);
    return SlipOnset<V>::at(pushed, edges, contact_vector, step.way).own_lead(step.on_left);
  };
  // For a palm that does not turn these are the sine and cosine that it already has.
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

  // The last state that still leads, next to the tie. The start of the step is evaluated only in
  // lanes that are done and have found no tie.
  PerSide<V> contacts = from.contacts;
  V lead(0);
  bracketed_root(wanted, V(0), step.lead, V(1), step.lead_then, [&](V t) {
    const PerSide<PalmAngle<V>> palms = palms_at(t);
    const Slipped<V> there = slip_to(t, palms);
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
