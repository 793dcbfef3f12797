// SPDX-License-Identifier: Apache-2.0
// The distributed algorithm: Table 2 of the paper as a table, one copy for both robots.
//
// The commands for palm and wheels depend on the state alone; a row sends a message and reads one. The
// paper's prose (section 4) settles what Table 2 leaves open:
//   * A message that arrives while no state waits for it stays in the inbox, so that a robot in (d)
//     assists when it is done.
//   * TiltUp takes precedence over a robot's own negative contact (columns (c) and (d) of Table 2).
//   * An Ack states that the palm has turned, and (d) moves only after its own palm has turned.
//   * A waiting robot drops a message that it does not wait for, and so does an idle one, unless p > 0:
//     then the message is left to the state that waits for the answer. On a reliable radio with short
//     delays there is none. With losses the algorithm hangs; that is a property of the paper's
//     algorithm, not a defect here.
// While it waits, a robot keeps its nominal speed.
#pragma once

#include "palmbots/control/table.hpp"

namespace palmbots {

struct Distributed {
  enum class State : std::uint8_t {
    idle,
    a_or_b_request,  // sent TiltUp, waits for the answer that decides between (a) and (b)
    a_move,
    b_wait_ack,
    b_move,
    b_tilt_up,
    b_wait_down,
    b_tilt_down,
    c_tilt_up,
    c_wait_down,
    c_tilt_down,
    d_tilt_up,
    d_move,
    d_tilt_down,
  };
  static constexpr int states = 14;
  static constexpr State initial = State::idle;

  // The name of each state, and its meaning for people.
  static constexpr StateMeaning meanings[states] = {
      {"idle", "no correction"},
      {"a_or_b_request", "has asked its partner to tilt its palm up, and waits for an Ack"},
      {"a_move", "moves away, its partner assists"},
      {"b_wait_ack", "both robots have asked; waits for an Ack"},
      {"b_move", "moves away; its partner asked, too"},
      {"b_tilt_up", "tilts its palm up for its partner"},
      {"b_wait_down", "holds its palm up for its partner, and waits for TiltDown"},
      {"b_tilt_down", "tilts its palm down"},
      {"c_tilt_up", "tilts its palm up to assist"},
      {"c_wait_down", "assists with its palm up until TiltDown arrives"},
      {"c_tilt_down", "tilts its palm down after it has assisted"},
      {"d_tilt_up", "tilts its palm up"},
      {"d_move", "moves closer"},
      {"d_tilt_down", "tilts its palm down"},
  };

  static constexpr Mail mail = Mail::queue;

  enum class Limit : std::uint8_t {};
  static constexpr std::size_t limits = 0;

  static constexpr TableOutput outputs[states] = {
      /* idle           */ {' ', {Palm::steep, Move::hold}},
      /* a_or_b_request */ waiting({'a', {Palm::steep, Move::hold}}),
      /* a_move         */ {'a', {Palm::steep, Move::away}},
      /* b_wait_ack     */ waiting({'b', {Palm::steep, Move::hold}}),
      /* b_move         */ {'b', {Palm::steep, Move::away}},
      /* b_tilt_up      */ {'b', {Palm::shallow, Move::hold}},
      /* b_wait_down    */ waiting({'b', {Palm::shallow, Move::hold}}),
      /* b_tilt_down    */ {'b', {Palm::steep, Move::hold}},
      /* c_tilt_up      */ {'c', {Palm::shallow, Move::hold}},
      /* c_wait_down    */ waiting({'c', {Palm::shallow, Move::hold}}),
      /* c_tilt_down    */ {'c', {Palm::steep, Move::hold}},
      /* d_tilt_up      */ {'d', {Palm::shallow, Move::hold}},
      /* d_move         */ {'d', {Palm::shallow, Move::closer}},
      /* d_tilt_down    */ {'d', {Palm::steep, Move::hold}},
  };

  using P = ContactCondition;
  using S = State;
  using M = MessageKind;
  static constexpr MessageSet not_tilt_up = any_message - M::tilt_up;  // or no message

  // clang-format off
  static constexpr TableRow<State> rows[] = {
      // in state           contact          hears          if          go to              send
      // p > 0: ask for the partner's palm, and learn whether the partner asks too
      {S::idle,             P::positive,     any_message,   {},         S::a_or_b_request, M::tilt_up},
      // (a)
      {S::a_or_b_request,   P::any,          M::ack,        {},         S::a_move},
      {S::a_move,           P::not_positive, any_message,   {},         S::idle,           M::tilt_down},
      // (b)
      {S::a_or_b_request,   P::any,          M::tilt_up,    {},         S::b_wait_ack,     M::ack},
      {S::b_wait_ack,       P::any,          M::ack,        {},         S::b_move},
      {S::b_move,           P::not_positive, any_message,   {},         S::b_tilt_up},
      {S::b_tilt_up,        P::any,          any_message,   If::turned, S::b_wait_down,    M::tilt_down},
      {S::b_wait_down,      P::any,          M::tilt_down,  {},         S::b_tilt_down},
      {S::b_tilt_down,      P::any,          any_message,   If::turned, S::idle},
      // (c) p ≤ 0 and asked by the partner
      {S::idle,             P::not_positive, M::tilt_up,    {},         S::c_tilt_up},
      {S::c_tilt_up,        P::any,          any_message,   If::turned, S::c_wait_down,    M::ack},
      {S::c_wait_down,      P::any,          M::tilt_down,  {},         S::c_tilt_down},
      {S::c_tilt_down,      P::any,          any_message,   If::turned, S::idle},
      // (d) p < 0 and not asked by the partner
      {S::idle,             P::negative,     not_tilt_up,   {},         S::d_tilt_up},
      {S::d_tilt_up,        P::any,          any_message,   If::turned, S::d_move},
      {S::d_move,           P::not_negative, any_message,   {},         S::d_tilt_down},
      {S::d_tilt_down,      P::any,          any_message,   If::turned, S::idle},
      // messages that nobody waits for
      {S::idle,             P::zero,         {M::tilt_down, M::ack},     {}, S::idle},
      {S::a_or_b_request,   P::any,          M::tilt_down,               {}, S::a_or_b_request},
      {S::b_wait_ack,       P::any,          {M::tilt_up, M::tilt_down}, {}, S::b_wait_ack},
      {S::b_wait_down,      P::any,          {M::tilt_up, M::ack},       {}, S::b_wait_down},
      {S::c_wait_down,      P::any,          {M::tilt_up, M::ack},       {}, S::c_wait_down},
  };
  // clang-format on
};

constexpr const char* name_of(Distributed::State state) {
  return Distributed::meanings[static_cast<int>(state)].name;
}

}  // namespace palmbots
