// SPDX-License-Identifier: Apache-2.0
// The memory of a robot of the resilient algorithm besides its state: the times since certain
// events, and who travels.
//
// Written once for two uses: one robot, LeaseState<bool, std::uint16_t>, and the robots of 64
// pairs, where a truth value is a word and a count is bit-sliced (batch/bitslice.hpp). A count
// offers advance(), reset_where() and at_least().
#pragma once

#include <cstdint>

#include "palmbots/control/transition_table.hpp"

namespace palmbots {

// A count of ticks for one robot. It saturates at `most`, because longer times make no difference.
constexpr void advance(std::uint16_t& since, std::uint16_t elapsed, std::uint16_t most) {
  since = elapsed < most - since ? static_cast<std::uint16_t>(since + elapsed) : most;
}
// Resets the count of the robots in `whose`.
constexpr void reset_where(std::uint16_t& since, bool whose) {
  if (whose) since = 0;
}
constexpr bool at_least(std::uint16_t since, std::uint16_t least) { return since >= least; }

// The time limits of the algorithm [ticks].
template <class Count>
struct LeaseLimits {
  Count beacon;    // period of the beacons
  Count stale;     // the smallest age at which a message is too old: lease + 1
  Count hold;      // how long a palm stays up for a silent partner
  Count braking;   // how long the wheels take to brake
  Count long_ago;  // the smallest since_ready that no longer counts: join + 1
};

// Times and flags of one robot, or of many (B and Count as above).
template <class B, class Count>
struct LeaseState {
  B yields{};  // this robot has the lower identity
  B stopped{};
  B partner_stopped{};
  B partner_ready{};
  Count age{};            // of the newest beacon
  Count since_ready{};    // since it was last linked, idle and p = 0
  Count since_asked{};    // since the last step that sent TiltUp; a boot counts as one
  Count since_moved{};    // since the step that ended the last move; a boot counts as one
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

  // True if there is no fresh message: the partner is silent, or does not hear this robot.
  [[gnu::always_inline]] constexpr B silence(const Limits& limits) const {
    return at_least(age, limits.stale);
  }

  // The conditions of the rows, evaluated before the transition, for the robots that run.
  template <class Conditions>
  [[gnu::always_inline]] constexpr Conditions conditions(const B& run, const B& moves,
                                                         const B& palm_at_target, const B& silence,
                                                         const Limits& limits) {
    reset_where(since_moved, moves & run);
    const B braked = at_least(since_moved, limits.braking);
    // True if the partner knew, when it sent the newest message, that this robot no longer asks.
    const B is_later = opposite(at_least(age, since_asked));
    const B fresh = opposite(silence);
    const B settled = palm_at_target & braked;
    const B released = is_later & fresh;
    return {settled, released, yields, at_least(since_entered, limits.hold)};
  }

  struct Finished {
    B ready;  // ready to travel
    B send;   // a beacon is due
  };

  // Updates after the transition: which robots entered a new state, ask for the partner's palm, are
  // idle with p = 0, and have a new message.
  [[gnu::always_inline]] constexpr Finished finish(const B& run, const B& entered, const B& asks,
                                                   const B& centred, const B& says_other,
                                                   const B& silence, const Limits& limits) {
    reset_where(since_entered, entered);
    reset_where(since_asked, asks & run);
    const B fresh = opposite(silence);
    const B ready_now = centred & fresh & run;
    reset_where(since_ready, ready_now);
    const B lately_ready = opposite(at_least(since_ready, limits.long_ago));
    // True if the partner knew, when it sent the newest beacon, whether this robot travels or
    // rests.
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
    // At rest a robot is ready or not. While a start is under way it stays ready for a little
    // longer.
    const B travels = opposite(stopped);
    const B ready = ready_now | (travels & lately_ready);
    return {ready, send};
  }
};

}  // namespace palmbots
