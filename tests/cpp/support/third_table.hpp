// SPDX-License-Identifier: Apache-2.0
// A table that no registry knows: what a new controller takes is this header. It uses every kind of
// condition that a row can have, and means nothing.
#pragma once

#include "palmbots/control/table.hpp"

namespace palmbots {

struct ThirdTable {
  enum class State : std::uint8_t { calm, asks, waits, works, rests };
  static constexpr int states = 5;
  static constexpr State initial = State::calm;
  enum class Limit : std::uint8_t { patience, nap };
  static constexpr std::size_t limits = 2;
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    return limit == Limit::patience ? timing.turn : timing.delay;
  }
  static constexpr Mail mail = Mail::beacons;

  using S = State;
  using M = MessageKind;
  static constexpr TableOutput outputs[states] = {
      {' ', {Palm::steep, Move::hold}, M::tilt_down},
      {'a', {Palm::steep, Move::hold}, M::tilt_up, 0, true},
      {'c', {Palm::shallow, Move::hold}, M::ack},
      {'b', {Palm::steep, Move::away, true}, M::tilt_up, 1},
      {'d', {Palm::shallow, Move::closer}, M::closing, 1},
  };
  using P = ContactCondition;
  static constexpr EnumSet<State> any = EnumSet<State>::all();
  static constexpr TableRow<State> rows[] = {
      {S::asks, P::any, M::ack, {If::turned, If::may_stop}, S::works},
      {S::asks, P::any, any_message, If::timed_out, S::rests},
      {any, P::not_positive, M::tilt_up, If::follows, S::waits},
      {{S::works, S::rests}, P::zero, any_message, {If::leads, If::timed_out}, S::calm},
      {{S::works, S::rests}, P::any, any_message, {If::follows, If::timed_out}, S::calm},
      {S::waits, P::not_negative, {M::none, M::tilt_down}, {}, S::calm},
      {any - EnumSet<State>{S::works, S::rests}, P::positive, any_message, If::turned, S::asks},
      {S::calm, P::negative, M::closing, If::may_stop, S::rests},
  };
};

constexpr const char* name_of(ThirdTable::State state) {
  constexpr const char* names[] = {"calm", "asks", "waits", "works", "rests"};
  return names[static_cast<int>(state)];
}

constexpr const char* name_of(ThirdTable::Limit limit) {
  return limit == ThirdTable::Limit::patience ? "patience" : "nap";
}

}  // namespace palmbots
