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
// docs/theory/sign-controllers.md has the figures.
#pragma once

#include "palmbots/control/table.hpp"

namespace palmbots {

struct Silent {
  enum class State : std::uint8_t { centred, outward, inward, pause };
  static constexpr int states = 4;
  static constexpr State initial = State::centred;

  enum class Limit : std::uint8_t {
    push,  // how long a robot moves closer before it pauses
    rest,  // how long a pause is
  };
  static constexpr std::size_t limits = 2;
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    return limit == Limit::push ? timing.reach : timing.reach / 8;
  }

  static constexpr bool talks = false;
  static constexpr int push = static_cast<int>(Limit::push);
  static constexpr int rest = static_cast<int>(Limit::rest);

  static constexpr TableOutput outputs[states] = {
      /* centred */ {' ', {Palm::shallow, Move::hold}, MessageKind::none},
      /* outward */ {'a', {Palm::steep, Move::away}, MessageKind::none},
      /* inward  */ {'d', {Palm::shallow, Move::closer}, MessageKind::none, push},
      /* pause   */ {'d', {Palm::shallow, Move::hold}, MessageKind::none, rest},
  };

  using P = ContactCondition;
  static constexpr EnumSet<State> any = EnumSet<State>::all();
  static constexpr EnumSet<State> elsewhere = any - EnumSet<State>{State::inward, State::pause};

  // clang-format off
  static constexpr TableRow<State> rows[] = {
      // in state        contact      heard     if             go to
      {any,              P::positive, any_word, {},            State::outward},
      {any,              P::zero,     any_word, {},            State::centred},
      {State::inward,    P::negative, any_word, If::timed_out, State::pause},
      {State::pause,     P::negative, any_word, If::timed_out, State::inward},
      {elsewhere,        P::negative, any_word, {},            State::inward},
  };
  // clang-format on
};

constexpr const char* name_of(Silent::State state) {
  constexpr const char* names[] = {"centred", "outward", "inward", "pause"};
  return names[static_cast<int>(state)];
}

constexpr const char* name_of(Silent::Limit limit) {
  constexpr const char* names[] = {"push", "rest"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
