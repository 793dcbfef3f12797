// SPDX-License-Identifier: Apache-2.0
// The resilient algorithm written once more, as a robot that follows the prose of
// docs/theory/protocols.md: plain conditions instead of a table, plain instants instead of
// counters. The tests compare the shipped controller with it.
#pragma once

#include <limits>

#include "palmbots/control/resilient.hpp"
#include "palmbots/control/table_robot.hpp"

struct ResilientOracle {
  using MessageKind = palmbots::MessageKind;
  using Sign = palmbots::Sign;

  // Where a robot is in its case.
  enum Doing { nothing, ask, pull, brake, yield, help, grant, withdraw, lower, rise, push, sink };

  palmbots::TableTimes<palmbots::Resilient> times;
  bool lower_identity;
  Doing now;
  bool standing = true;
  long clock = 0;
  long heard_at = std::numeric_limits<long>::min() / 2;  // my instant that the newest beacon echoes
  long asked_at = 0;    // last instant at which I said TiltUp, or may have
  long changed_at = 0;  // first instant at which I stood, or travelled, as I do
  long entered_at = 0;
  long ready_at = std::numeric_limits<long>::min() / 2;
  long moved_at = 0;  // the instant that ended the last move, or may have
  long said_at = std::numeric_limits<long>::min() / 2;
  MessageKind newest = MessageKind::none;
  bool partner_stands = true;
  bool partner_ready = false;

  ResilientOracle(const palmbots::TableTimes<palmbots::Resilient>& t, bool lower_id, bool assisted)
      : times(t), lower_identity(lower_id), now(assisted ? withdraw : lower) {}

  long limit(palmbots::ResilientLimit one) const {
    return times.limits[static_cast<std::size_t>(one)];
  }

  static MessageKind message_of(Doing doing) {
    switch (doing) {
      case nothing: return MessageKind::tilt_down;
      case ask:
      case pull:
      case brake: return MessageKind::tilt_up;
      case grant: return MessageKind::ack;
      case rise:
      case push:
      case sink: return MessageKind::closing;
      default: return MessageKind::raised;
    }
  }

  static bool palm_up(Doing d) {
    return d == yield || d == help || d == grant || d == withdraw || d == rise || d == push;
  }

  // "A request goes before corrections of one's own."
  Doing at_leisure(Sign p, bool asked, bool free) const {
    if (asked) return p == Sign::positive ? yield : help;
    if (free && p == Sign::positive) return ask;
    if (free && p == Sign::negative) return rise;
    return nothing;
  }

  Doing next(Sign p, bool palm_turned) const {
    const bool palm_at_target =
        palm_turned && clock - moved_at >= limit(palmbots::ResilientLimit::braking);
    const bool fresh = clock - heard_at <= times.lease;
    const bool asked = fresh && newest == MessageKind::tilt_up;
    const bool granted = fresh && newest == MessageKind::ack;
    const bool free = fresh && heard_at > asked_at;
    const bool partner_steep = fresh && !granted && newest != MessageKind::raised;
    switch (now) {
      case nothing: return at_leisure(p, asked, free);
      case ask:
        if (granted && palm_at_target) return pull;
        return asked && lower_identity ? yield : ask;
      case pull: return p == Sign::positive && granted ? pull : brake;
      case brake:
        if (p == Sign::positive && granted) return pull;
        if (!palm_at_target) return brake;
        return p == Sign::positive ? ask : nothing;
      case yield:
      case help:
        if (!asked) return lower;
        return palm_at_target ? grant : now;
      case grant:
        if (asked) return grant;
        return fresh ? lower : withdraw;
      case withdraw:
        if (asked && palm_at_target) return grant;
        if (fresh && !asked) return lower;
        return clock - entered_at >= limit(palmbots::ResilientLimit::hold) ? lower : withdraw;
      case lower:
        if (asked) return help;
        if (free && p == Sign::positive) return ask;
        if (free && p == Sign::negative) return rise;
        return palm_at_target ? nothing : lower;
      case rise:
        if (!fresh) return sink;
        if (asked) return help;
        return palm_at_target && partner_steep ? push : rise;
      case push:
        if (p != Sign::negative) return asked ? help : sink;
        return partner_steep ? push : rise;
      case sink:
        if (asked && p != Sign::positive) return help;
        return palm_at_target ? nothing : sink;
    }
    return now;
  }

  palmbots::RobotOutput step(const palmbots::RobotInput& in) {
    using palmbots::Move;
    using palmbots::Palm;
    clock += in.elapsed;
    if (in.message != MessageKind::none) {
      newest = in.message;
      partner_stands = in.stopped;
      partner_ready = in.ready;
      heard_at = clock - in.age;
    }
    const Doing before = now;
    const bool stood = standing;
    if (now == pull || now == push) moved_at = clock;
    now = next(in.sign, in.palm_at_target);
    if (now != before) entered_at = clock;
    if (message_of(now) == MessageKind::tilt_up) asked_at = clock;
    const bool fresh = clock - heard_at <= times.lease;
    const bool partner_knows = heard_at >= changed_at;
    if (fresh && now == nothing && in.sign == Sign::zero) ready_at = clock;
    const bool ready = ready_at == clock;
    const bool was_ready = clock - ready_at <= limit(palmbots::ResilientLimit::join);
    if (!fresh) {
      standing = true;
    } else if (standing) {
      const bool first = ready && partner_stands && partner_knows;
      const bool second = was_ready && !partner_stands;
      if (partner_ready && (first || second)) standing = false;
    } else if (partner_stands && partner_knows) {
      standing = true;
    }
    if (standing != stood) changed_at = clock;
    const bool say = message_of(now) != message_of(before) || standing != stood ||
                     clock - said_at >= times.beacon;
    if (say) said_at = clock;
    const Move move = now == pull ? Move::away : (now == push ? Move::closer : Move::hold);
    return {{palm_up(now) ? Palm::shallow : Palm::steep, move, standing},
            message_of(now),
            say,
            false,
            ready || (!standing && was_ready),
            now == grant || now == withdraw};
  }
};
