// SPDX-License-Identifier: Apache-2.0
// The memory of a robot of the resilient algorithm besides its state: the times since certain
// events, and who travels.
//
// Written once for two uses: one robot, ResilientMemory<bool, std::uint16_t>, and the robots of 64
// pairs, where a truth value is a word and a count is bit-sliced (batch/bitslice.hpp).
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/control/table.hpp"

namespace palmbots {

// Time limits of the algorithm (control/resilient_timing.hpp).
enum class ResilientLimit : std::uint8_t {
  hold,     // how long a palm stays up for a silent partner
  braking,  // how long the wheels take to brake
  join,     // for how long a robot that was ready may still start after its partner
};

// Times and flags of one robot, or of many. `robots` are asked which of them have an output:
// robots.who(predicate). `age` is that of the partner's newest message, and it counts where it is
// `fresh`.
template <class B, class Count>
struct ResilientMemory {
  B stopped{};
  B partner_stopped{};
  B partner_ready{};
  Count since_ready{};   // since it was last linked, idle and p = 0
  Count since_asked{};   // since the last step that sent TiltUp; a boot counts as one
  Count since_moved{};   // since the step that ended the last move; a boot counts as one
  Count since_turned{};  // since the step at which it last started or stopped

  // What the counts are compared with [ticks]: the smallest age at which a message is too old
  // (lease + 1), how long the wheels take to brake, and the smallest since_ready that no longer
  // counts (join + 1).
  enum : std::size_t { stale, brake, long_ago };
  using Limits = std::array<Count, 3>;

  template <class Times>
  static constexpr std::array<std::uint16_t, 3> limits(const Times& times) {
    const auto limit = [&](ResilientLimit one) {
      return times.limits[static_cast<std::size_t>(one)];
    };
    return {static_cast<std::uint16_t>(times.lease + 1), limit(ResilientLimit::braking),
            static_cast<std::uint16_t>(limit(ResilientLimit::join) + 1)};
  }

  // After a boot a robot rests.
  [[gnu::always_inline]] constexpr void boot(const B& whose, const Limits& limits) {
    exhaust_where(since_ready, whose, limits[long_ago]);
    for (Count* since : {&since_asked, &since_moved, &since_turned}) reset_where(*since, whose);
    stopped = stopped | whose;
    partner_stopped = partner_stopped | whose;
    partner_ready = partner_ready & opposite(whose);
  }

  [[gnu::always_inline]] constexpr void pass(std::uint16_t elapsed, const Limits& limits) {
    advance(since_asked, elapsed, limits[stale]);
    advance(since_ready, elapsed, limits[long_ago]);
    advance(since_moved, elapsed, limits[brake]);
    advance(since_turned, elapsed, limits[stale]);
  }

  // What a beacon said besides the message.
  [[gnu::always_inline]] constexpr void hear(const B& whose, const B& stops, const B& is_ready) {
    partner_stopped = (partner_stopped & opposite(whose)) | (stops & whose);
    partner_ready = (partner_ready & opposite(whose)) | (is_ready & whose);
  }

  // The conditions of the rows, before the transition, for the robots that run.
  template <class Robots>
  [[gnu::always_inline]] constexpr void meet(TableConditions<B>& met, const B& run,
                                             const Robots& robots, const Count& age, const B& fresh,
                                             const Limits& limits) {
    reset_where(since_moved, robots.who(moves) & run);
    const B braked = at_least(since_moved, limits[brake]);
    // True if the partner knew, when it sent the newest message, that this robot no longer asks.
    const B is_later = opposite(at_least(age, since_asked));
    met.settled = met.turned & braked;
    met.released = is_later & fresh;
  }

  struct Effect {
    B ready;    // ready to travel
    B is_news;  // it has started or stopped to travel
  };

  // Updates after the transition, for the robots that run. `centred`: idle with p = 0.
  template <class Robots>
  [[gnu::always_inline]] constexpr Effect finish(const B& run, const Robots& robots,
                                                 const B& centred, const Count& age, const B& fresh,
                                                 const Limits& limits) {
    reset_where(since_asked, robots.who(asks) & run);
    const B ready_now = centred & fresh & run;
    reset_where(since_ready, ready_now);
    const B lately_ready = opposite(at_least(since_ready, limits[long_ago]));
    // True if the partner knew, when it sent the newest beacon, whether this robot travels or
    // rests.
    const B known = at_least(since_turned, age);
    const B partner_travels = opposite(partner_stopped);
    const B may_start = fresh & partner_ready &
                        ((partner_stopped & ready_now & known) | (partner_travels & lately_ready));
    const B must_stop = opposite(fresh) | (partner_stopped & known);
    const B was_stopped = stopped;
    const B travelled = opposite(was_stopped);
    const B stays = opposite<B>(may_start & run);
    stopped = (was_stopped & stays) | (travelled & must_stop & run);
    const B changed = stopped ^ was_stopped;
    reset_where(since_turned, changed);
    // At rest a robot is ready or not. While a start is under way it stays ready for a little
    // longer.
    const B travels = opposite(stopped);
    const B ready = ready_now | (travels & lately_ready);
    return {ready, changed};
  }

  // The same where steps change nothing but these counts.
  template <class Robots>
  constexpr void stay(const B& run, const Robots& robots, const B& centred, const B& fresh) {
    reset_where(since_moved, robots.who(moves) & run);
    reset_where(since_asked, robots.who(asks) & run);
    reset_where(since_ready, centred & fresh & run);
  }

  // Calls visit(since, limit) for the counts whose limit changes what one robot does in its state.
  // Comparisons of two ages do not change, because both ages grow.
  template <class Visit>
  constexpr void until(bool palm_at_target, const Limits& limits, Visit&& visit) const {
    if (palm_at_target) visit(since_moved, limits[brake]);
  }

 private:
  static constexpr auto moves = [](const TableOutput& output) {
    return output.command.move != Move::hold;
  };
  static constexpr auto asks = [](const TableOutput& output) {
    return output.message == MessageKind::tilt_up;
  };
};

}  // namespace palmbots
