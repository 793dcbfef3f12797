// SPDX-License-Identifier: Apache-2.0
// The resilient distributed algorithm: the cases of Table 2 with leases instead of waits, one copy
// for both robots.
//
// No state waits for a message that may be lost. Every robot broadcasts one message that states
// what it does, in each beacon period and at once when it changes. A robot acts on its partner's
// message only while that message is fresh (control/mailbox.hpp bounds its age).
//
//   TiltUp   p > 0: the sender wants the partner's palm up
//   Ack      the sender's palm is up for the partner, which may move
//   TiltDown the sender wants nothing, its palm is steep
//   Closing  the sender is in (d)
//   Raised   the sender's palm is up or on its way, but not for the partner
//
// Times are computed in control/resilient_timing.hpp. Safety requires hold ≥ lease + braking +
// skipped ticks, and nothing else.
//
// These rules keep the object on the palms. "Newest" is the newest beacon received.
//   * (a) moves away only while the newest message is a fresh Ack. The sender keeps its palm up
//     for `hold` after its last Ack, unless it hears that the partner has stopped asking.
//   * After a request, a robot starts nothing until it is *released*: it has received a beacon
//     whose sender knew that it no longer asks. From then on none of its old requests can raise
//     the partner's palm.
//   * A move is reported as over only after the wheels have braked: (a) sends TiltUp until then,
//     and (d) sends no Ack before. So motions of the two robots do not overlap, except (d) on both
//     sides.
//   * (d) moves closer only while the newest message is fresh and states that the partner's palm
//     is steep or that the partner is in (d) too. Before (d) has begun a request takes precedence,
//     because the palm of the robot that asks may still be turning.
//   * Requests that cross are case (b): the robot that follows assists first.
//   * A correction that has begun moves for at least one tick, even if p has become 0 meanwhile,
//     as in Table 2. The reason is that turning palms shift the contacts a little. Two robots at
//     rest, with contacts at the edge of the zero zone, would otherwise request and withdraw
//     forever.
//   * Silence means that there is no fresh message: moves end, palms go steep, and the robot stops
//     travelling.
//
// Travel: a robot rests if its partner rests although the partner knows that this robot travels. So
// two robots never travel apart for longer than a lease, however one-sided the radio is. Both
// broadcast when they are *ready*: linked, idle, p = 0. A robot starts only if both are ready. A
// robot that is off centre or hears nothing looks idle, but is not ready, so skews do not add up.
// The first robot to start may move the other's contact off centre again. The other therefore also
// follows if it was ready within the last `join` ticks, and corrects while travelling.
//
// Source: the paper's section 4 for the cases; Gray and Cheriton, "Leases", SOSP 1989.
// docs/theory/protocols.md has the derivation.
#pragma once

#include "palmbots/control/resilient_memory.hpp"
#include "palmbots/control/table.hpp"

namespace palmbots {

struct Resilient {
  enum class State : std::uint8_t {
    idle,
    a_request,
    a_move,
    a_stop,
    b_tilt_up,
    c_tilt_up,
    c_grant,
    c_withdraw,
    c_tilt_down,
    d_tilt_up,
    d_move,
    d_tilt_down,
  };
  using S = State;
  using M = MessageKind;
  static constexpr int states = 12;
  static constexpr State idle = S::idle;
  // After a boot a robot starts nothing until it is linked. A palm that was up for the partner stays
  // up until the partner answers or the partner's lease must have expired.
  static constexpr State initial = S::c_tilt_down;
  static constexpr EnumSet<State> assisting = {S::c_grant, S::c_withdraw};
  static constexpr State initial_assisting = S::c_withdraw;
  static constexpr Mail mail = Mail::beacons;

  using Limit = ResilientLimit;
  static constexpr std::size_t limits = 3;
  static constexpr auto hold = static_cast<std::int8_t>(Limit::hold);

  template <class B, class Count>
  using Memory = ResilientMemory<B, Count>;

  // The name of each state, and its meaning for people.
  static constexpr StateMeaning meanings[states] = {
      {"idle", "no correction"},
      {"a_request", "asks the partner to tilt its palm up"},
      {"a_move", "moves away, its partner assists"},
      {"a_stop", "stops moving away"},
      {"b_tilt_up", "tilts its palm up; both contacts are outward, and its partner goes first"},
      {"c_tilt_up", "tilts its palm up to assist"},
      {"c_grant", "permits its partner to move away"},
      {"c_withdraw", "no longer permits it, and waits until its partner has stopped"},
      {"c_tilt_down", "tilts its palm down after assisting"},
      {"d_tilt_up", "tilts its palm up to correct alone"},
      {"d_move", "moves closer"},
      {"d_tilt_down", "tilts its palm down after moving closer"},
  };

  static constexpr TableOutput outputs[states] = {
      /* idle        */ {' ', {Palm::steep, Move::hold}, M::tilt_down},
      /* a_request   */ waiting({'a', {Palm::steep, Move::hold}, M::tilt_up}),
      /* a_move      */ {'a', {Palm::steep, Move::away}, M::tilt_up},
      /* a_stop      */ {'a', {Palm::steep, Move::hold}, M::tilt_up},
      /* b_tilt_up   */ {'b', {Palm::shallow, Move::hold}, M::raised},
      /* c_tilt_up   */ {'c', {Palm::shallow, Move::hold}, M::raised},
      /* c_grant     */ {'c', {Palm::shallow, Move::hold}, M::ack},
      /* c_withdraw  */ {'c', {Palm::shallow, Move::hold}, M::raised, hold},
      /* c_tilt_down */ {'c', {Palm::steep, Move::hold}, M::raised},
      /* d_tilt_up   */ {'d', {Palm::shallow, Move::hold}, M::closing},
      /* d_move      */ {'d', {Palm::shallow, Move::closer}, M::closing},
      /* d_tilt_down */ {'d', {Palm::steep, Move::hold}, M::closing},
  };

  using P = ContactCondition;
  static constexpr MessageSet silence = M::none;
  static constexpr MessageSet not_tilt_up = any_message - M::tilt_up;  // or silence
  static constexpr MessageSet not_ack = any_message - M::ack;          // or silence
  static constexpr MessageSet other = not_tilt_up - silence;
  static constexpr MessageSet steep = {M::tilt_up, M::tilt_down, M::closing};  // or in (d)
  static constexpr MessageSet not_steep = any_message - steep;                 // or silence

  // clang-format off
  static constexpr TableRow<State> rows[] = {
      // in state        contact          hears        if             go to
      // a request takes precedence over corrections of one's own
      {S::idle,          P::positive,     M::tilt_up,  {},            S::b_tilt_up},
      {S::idle,          P::any,          M::tilt_up,  {},            S::c_tilt_up},
      {S::idle,          P::positive,     any_message, If::released,  S::a_request},
      {S::idle,          P::negative,     any_message, If::released,  S::d_tilt_up},
      // (a), and (b) where requests cross
      {S::a_request,     P::any,          M::ack,      If::settled,   S::a_move},
      {S::a_request,     P::any,          M::tilt_up,  If::follows,   S::b_tilt_up},
      {S::a_move,        P::not_positive, any_message, {},            S::a_stop},
      {S::a_move,        P::any,          not_ack,     {},            S::a_stop},
      {S::a_stop,        P::positive,     M::ack,      {},            S::a_move},
      {S::a_stop,        P::positive,     any_message, If::settled,   S::a_request},
      {S::a_stop,        P::any,          any_message, If::settled,   S::idle},
      // (c)
      {S::b_tilt_up,     P::any,          not_tilt_up, {},            S::c_tilt_down},
      {S::b_tilt_up,     P::any,          any_message, If::settled,   S::c_grant},
      {S::c_tilt_up,     P::any,          not_tilt_up, {},            S::c_tilt_down},
      {S::c_tilt_up,     P::any,          any_message, If::settled,   S::c_grant},
      {S::c_grant,       P::any,          silence,     {},            S::c_withdraw},
      {S::c_grant,       P::any,          other,       {},            S::c_tilt_down},
      {S::c_withdraw,    P::any,          M::tilt_up,  If::settled,   S::c_grant},
      {S::c_withdraw,    P::any,          other,       {},            S::c_tilt_down},
      {S::c_withdraw,    P::any,          any_message, If::timed_out, S::c_tilt_down},
      {S::c_tilt_down,   P::any,          M::tilt_up,  {},            S::c_tilt_up},
      {S::c_tilt_down,   P::positive,     any_message, If::released,  S::a_request},
      {S::c_tilt_down,   P::negative,     any_message, If::released,  S::d_tilt_up},
      {S::c_tilt_down,   P::any,          any_message, If::settled,   S::idle},
      // (d)
      {S::d_tilt_up,     P::any,          silence,     {},            S::d_tilt_down},
      {S::d_tilt_up,     P::any,          M::tilt_up,  {},            S::c_tilt_up},
      {S::d_tilt_up,     P::any,          steep,       If::settled,   S::d_move},
      {S::d_move,        P::not_negative, M::tilt_up,  {},            S::c_tilt_up},
      {S::d_move,        P::not_negative, any_message, {},            S::d_tilt_down},
      {S::d_move,        P::any,          not_steep,   {},            S::d_tilt_up},
      {S::d_tilt_down,   P::not_positive, M::tilt_up,  {},            S::c_tilt_up},
      {S::d_tilt_down,   P::any,          any_message, If::settled,   S::idle},
  };
  // clang-format on
};

constexpr const char* name_of(Resilient::State state) {
  return Resilient::meanings[static_cast<int>(state)].name;
}

constexpr const char* name_of(ResilientLimit limit) {
  constexpr const char* names[] = {"hold", "braking", "join"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
