// SPDX-License-Identifier: Apache-2.0
// What a robot of the resilient algorithm remembers besides its state: how long ago what happened,
// and who travels.
//
// Written once for one robot, LeaseState<bool, std::uint16_t>, and for the robots of 64 pairs,
// where a truth value is a word and a count is bit-sliced (batch/bitslice.hpp). A count offers
// advance(), reset_where() and at_least().
#pragma once

#include <cstdint>

#include "palmbots/control/transition_table.hpp"

namespace palmbots {

// A count of one robot. It stops at `most`: longer makes no difference.
constexpr void advance(std::uint16_t& since, std::uint16_t elapsed, std::uint16_t most) {
  since = elapsed < most - since ? static_cast<std::uint16_t>(since + elapsed) : most;
}
constexpr void reset_where(std::uint16_t& since, bool whose) {
  if (whose) since = 0;
}
constexpr bool at_least(std::uint16_t since, std::uint16_t least) { return since >= least; }

// The times of the algorithm, in ticks.
template <class Count>
struct LeaseLimits {
  Count beacon;    // period of the beacons
  Count stale;     // the first age of a message that is too old: lease + 1
  Count hold;      // how long a palm stays up for a partner that fell silent
  Count braking;   // how long the wheels take to brake
  Count long_ago;  // the first time since a robot was ready that no longer counts: join + 1
};

template <class B, class Count>
struct LeaseState {
  B yields{};  // this robot has the lower identity
  B stopped{};
  B partner_stopped{};
  B partner_ready{};
  Count age{};            // of the newest beacon
  Count since_ready{};    // since it was linked, idle and p = 0
  Count since_asked{};    // since the last step that said TiltUp; a boot may follow one
  Count since_moved{};    // since the step that ended the last move; a boot may follow one
  Count since_turned{};   // since the step at which it last started or stopped
  Count since_entered{};  // since the state was entered
  Count since_sent{};     // since the last beacon

  using Limits = LeaseLimits<Count>;

  [[gnu::always_inline]] constexpr void pass(std::uint16_t elapsed, const Limits& limits) {
    advance(age, elapsed, limits.stale);
    advance(since_asked, elapsed, limits.stale);
    advance(since_ready, elapsed, limits.long_ago);
    advance(since_moved, elapsed, limits.braking);
    advance(since_turned, elapsed, limits.stale);
    advance(since_entered, elapsed, limits.hold);
    advance(since_sent, elapsed, limits.beacon);
  }

  // No fresh message: the partner is silent, or does not hear this robot.
  [[gnu::always_inline]] constexpr B silence(const Limits& limits) const {
    return at_least(age, limits.stale);
  }

  // Before the transition, of those that run: what the conditions of rows are.
  template <class Conditions>
  [[gnu::always_inline]] constexpr Conditions conditions(const B& run, const B& moves,
                                                         const B& palm_at_target, const B& silence,
                                                         const Limits& limits) {
    reset_where(since_moved, moves & run);
    const B braked = at_least(since_moved, limits.braking);
    // The partner knew, when it sent the newest message, that this robot asks no more.
    const B is_later = opposite(at_least(age, since_asked));
    const B fresh = opposite(silence);
    const B settled = palm_at_target & braked;
    const B released = is_later & fresh;
    return {settled, released, yields, at_least(since_entered, limits.hold)};
  }

  struct Finished {
    B ready;  // to travel
    B send;   // a beacon is due
  };

  // After it: who has entered a new state, asks for the partner's palm, is idle with p = 0, and has
  // another message than before.
  [[gnu::always_inline]] constexpr Finished finish(const B& run, const B& entered, const B& asks,
                                                   const B& centred, const B& says_other,
                                                   const B& silence, const Limits& limits) {
    reset_where(since_entered, entered);
    reset_where(since_asked, asks & run);
    const B fresh = opposite(silence);
    const B ready_now = centred & fresh & run;
    reset_where(since_ready, ready_now);
    const B lately_ready = opposite(at_least(since_ready, limits.long_ago));
    // The partner knew, when it sent the newest beacon, that this robot travels (or rests) as it
    // does.
    const B known = at_least(since_turned, age);
    const B partner_travels = opposite(partner_stopped);
    const B may_start = fresh & partner_ready &
                        ((partner_stopped & ready_now & known) | (partner_travels & lately_ready));
    const B must_stop = silence | (partner_stopped & known);
    const B was_stopped = stopped;
    const B travelled = opposite(was_stopped);
    const B stays = opposite<B>(may_start & run);
    stopped = (was_stopped & stays) | (travelled & must_stop & run);
    const B changed = stopped ^ was_stopped;
    reset_where(since_turned, changed);
    const B due = at_least(since_sent, limits.beacon);
    const B send = (says_other | changed | due) & run;
    reset_where(since_sent, send);
    // At rest a robot is ready, or not; while a start is under way it is so for a little longer.
    const B travels = opposite(stopped);
    const B ready = ready_now | (travels & lately_ready);
    return {ready, send};
  }
};

}  // namespace palmbots
