// SPDX-License-Identifier: Apache-2.0
// The silent controller as a table: a robot corrects by the sign of its own contact and exchanges no
// messages. One table for both robots.
//
//   p > 0   palm steep, away from the partner
//   p < 0   palm shallow, closer to the partner
//   p = 0   palm shallow, nominal speed
//
// Through the object each robot feels what the other one does: closing moves the contact on the shallow palm
// outward, and opening moves the contact on the steep palm inward, whichever robot drives.
//
// TIE-BREAK. At opposite signs the two corrections cancel and the separation stays the same. So a
// robot that has moved closer for as long as a contact needs from the end of the palm to the zero
// zone pauses: its correction is being cancelled. In the pause its partner alone moves away, which
// lowers the partner's contact, on the steep palm. The pauses end the tie, and they cost little
// elsewhere, because other corrections seldom last that long. The robot that moves closer pauses,
// not the one that moves away, because away is the correction that saves more objects.
//
// A PARTNER THAT STANDS. The follower then closes in on it, and the leader runs away from it, at the
// travel speed, which no correction outruns. The only sign of it is a contact that stays off
// centre: outward at the follower, inward at the leader. After Limit::patience the robot stops where
// it is. It travels again when its contact has come back, because only the partner's motion brings
// it back. If the partner had not stopped at all, this is a brake: the follower that stops lets the
// robots separate, the leader that stops lets them close, at the travel speed.
//
// Both may stop by mistake, the follower outward and the leader inward. So the leader's wait ends:
// it backs towards its partner for a moment, which raises its contact, on the shallow palm, and then
// tries again. The follower waits without end; if it backed away from a partner that stands, it
// would lose objects. These rows need a robot that may stop (If::may_stop). Where robots correct in
// place, as on the floor, no robot does: the partner's motion would never come.
//
// START BY TOUCH. The follower starts with its palm steep. It closes in on the leader, whose contact
// then slides outward on the shallow palm and makes it start. The follower's palm is steep only for
// as long as that takes. When the leader then moves away, a steep palm would draw the follower's own
// contact inward, and it would not come back where closing cannot move it. The follower pushes also
// while its own contact is outward, because that contact does not slide on the steep palm.
// docs/theory/sign-controllers.md has the figures.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "palmbots/control/table.hpp"

namespace palmbots {

struct Silent {
  enum class State : std::uint8_t {
    centred,
    outward,
    inward,
    pause,
    outward_follower,  // as outward, of a follower that may stop
    outward_stop,
    inward_leader,  // as inward, of a leader that may stop
    inward_stop,
    inward_back,
    start_wait,  // the leader, until it feels that the follower has started
    start_push,  // the follower, whose steep palm lets the leader's contact slide
  };
  static constexpr int states = 11;
  static constexpr State initial = State::centred;
  static constexpr State started_by_touch(bool is_leader) {
    return is_leader ? State::start_wait : State::start_push;
  }

  // The name of each state, and its meaning for people.
  static constexpr StateMeaning meanings[states] = {
      {"centred", "its contact is centred"},
      {"outward", "its contact is outward"},
      {"inward", "its contact is inward"},
      {"pause", "pauses, so that its partner alone moves"},
      {"outward_follower", "its contact is outward, and it follows"},
      {"outward_stop", "stands, because its contact stays outward"},
      {"inward_leader", "its contact is inward, and it leads"},
      {"inward_stop", "stands, because its contact stays inward"},
      {"inward_back", "backs towards its partner"},
      {"start_wait", "waits until it feels that the follower has started"},
      {"start_push", "pushes, so that the leader feels it"},
  };

  enum class Limit : std::uint8_t {
    push,      // how long a robot moves closer before it pauses
    rest,      // how long a pause is
    patience,  // how long a contact may stay off centre before a robot stops
    wait,      // how long the leader stops
    back,      // how long it then backs towards its partner
    start,     // how long the follower's palm is steep at the start
  };
  static constexpr std::size_t limits = 6;
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    switch (limit) {
      case Limit::push: return timing.reach;
      case Limit::rest: return timing.reach / 8;
      case Limit::patience: return timing.reach / 10;
      case Limit::wait: return timing.reach * 4 / 5;
      case Limit::back: return timing.reach * 3 / 10;
      case Limit::start: break;
    }
    return timing.crossing < timing.reach ? timing.crossing : timing.reach;  // zones may be endless
  }

  static constexpr Mail mail = Mail::none;
  static constexpr auto push = static_cast<std::int8_t>(Limit::push);
  static constexpr auto rest = static_cast<std::int8_t>(Limit::rest);
  static constexpr auto patience = static_cast<std::int8_t>(Limit::patience);
  static constexpr auto wait = static_cast<std::int8_t>(Limit::wait);
  static constexpr auto back = static_cast<std::int8_t>(Limit::back);
  static constexpr auto start = static_cast<std::int8_t>(Limit::start);

  static constexpr bool stop = true;
  static constexpr TableOutput outputs[states] = {
      /* centred          */ {' ', {Palm::shallow, Move::hold}, MessageKind::none},
      /* outward          */ {'a', {Palm::steep, Move::away}, MessageKind::none},
      /* inward           */ {'d', {Palm::shallow, Move::closer}, MessageKind::none, push},
      /* pause            */ {'d', {Palm::shallow, Move::hold}, MessageKind::none, rest},
      /* outward_follower */ {'a', {Palm::steep, Move::away}, MessageKind::none, patience},
      /* outward_stop     */ {'a', {Palm::steep, Move::hold, stop}, MessageKind::none},
      /* inward_leader    */ {'d', {Palm::shallow, Move::closer}, MessageKind::none, patience},
      /* inward_stop      */ {'d', {Palm::shallow, Move::hold, stop}, MessageKind::none, wait},
      /* inward_back      */ {'d', {Palm::shallow, Move::closer, stop}, MessageKind::none, back},
      /* start_wait       */ {' ', {Palm::shallow, Move::hold, stop}, MessageKind::none},
      /* start_push       */ {' ', {Palm::steep, Move::hold}, MessageKind::none, start},
  };

  using P = ContactCondition;
  using S = State;
  using Set = EnumSet<State>;
  static constexpr Set any = Set::all();
  static constexpr Set out = {S::outward_follower, S::outward_stop};
  static constexpr Set in = {S::inward, S::pause, S::inward_leader, S::inward_stop, S::inward_back};
  static constexpr IfSet waited = If::timed_out;
  static constexpr IfSet leads_and_stops = {If::leads, If::may_stop};
  static constexpr IfSet follows_and_stops = {If::follows, If::may_stop};

  // clang-format off
  static constexpr TableRow<State> rows[] = {
      // in state            contact         heard     if                 go to
      {S::start_wait,        P::zero,         any_message, {},                S::start_wait},
      {S::start_push,        P::not_negative, any_message, waited,            S::centred},
      {S::start_push,        P::not_negative, any_message, {},                S::start_push},
      {any,                  P::zero,         any_message, {},                S::centred},
      {S::outward_follower,  P::positive,     any_message, waited,            S::outward_stop},
      {any - out,            P::positive,     any_message, follows_and_stops, S::outward_follower},
      {any - out,            P::positive,     any_message, {},                S::outward},
      {S::inward_leader,     P::negative,     any_message, waited,            S::inward_stop},
      {S::inward_stop,       P::negative,     any_message, waited,            S::inward_back},
      {S::inward_back,       P::negative,     any_message, waited,            S::inward_leader},
      {S::inward,            P::negative,     any_message, waited,            S::pause},
      {S::pause,             P::negative,     any_message, waited,            S::inward},
      {any - in,             P::negative,     any_message, leads_and_stops,   S::inward_leader},
      {any - in,             P::negative,     any_message, {},                S::inward},
  };
  // clang-format on
};

// The rows of another table, and behind them those of Silent for a contact off centre, for robots that
// hear one of these messages. `of` gives the other table's state for each of Silent's from outward
// to inward_back; all its other states count as centred.
template <class State, std::size_t n, class Of>
constexpr auto with_rows_of_silent(const TableRow<State> (&own)[n], MessageSet heard, Of of) {
  constexpr auto is_off = [](const TableRow<Silent::State>& row) {
    return row.p == ContactCondition::positive || row.p == ContactCondition::negative;
  };
  std::array<TableRow<State>, n + std::ranges::count_if(Silent::rows, is_off)> rows{};
  auto* next = std::copy(own, own + n, rows.data());
  for (const TableRow<Silent::State>& row : Silent::rows) {
    if (!is_off(row)) continue;
    const bool from_centred = row.from.has(Silent::State::centred);
    EnumSet<State> others;  // the states in which it starts, or, if it starts centred, does not
    for (int k = 1; k < static_cast<int>(Silent::State::start_wait); ++k) {
      const auto s = static_cast<Silent::State>(k);
      if (row.from.has(s) != from_centred) others.bits |= EnumSet<State>(of(s)).bits;
    }
    *next++ = {from_centred ? EnumSet<State>::all() - others : others, row.p, heard, row.when,
               of(row.next)};
  }
  return rows;
}

constexpr const char* name_of(Silent::State state) {
  return Silent::meanings[static_cast<int>(state)].name;
}

constexpr const char* name_of(Silent::Limit limit) {
  constexpr const char* names[] = {"push", "rest", "patience", "wait", "back", "start"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
