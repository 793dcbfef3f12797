// SPDX-License-Identifier: Apache-2.0
// The shared-sign controller as a table: each robot sends the sign of its own contact and acts on
// both signs. One table for both robots.
//
// A robot's own sign is a, its partner's newest sign is b.
//
//   palm    shallow if a < b, steep if a > b; if a = b ≠ 0 the robots take turns with the shallow
//           palm; if a = b = 0 it stays
//   wheels  both robots move away if a + b > 0 and closer if a + b < 0; at opposite signs away; if
//           a = b = 0 nominal speed
//   brake   if a = b ≠ 0 one robot stands instead, if the scene lets robots stop: the follower if
//           both contacts are outward, so that the robots separate, and the leader if both are
//           inward. Wheels that the brakes hold add no noise to what the partner corrects
//   silence without news from the partner for a lease, the rule of `silent` on the own sign; with
//           the next news, the above again. The partner may just have stopped. So the leader's palm
//           is steep at first, because then its own contact slides and shows that. A leader that
//           has stopped waits longer than in `silent`, because the partner may still be heard.
//           Then it tries again in the same way, with its palm steep at first.
//
// TURNS. The leader decides: it holds a palm for a turn, then takes the other one. Its message
// names its palm, and the follower takes the opposite; the follower's own message names its sign
// only. So the robots need no common clock, and a turn begins with the palms that the robots had.
// One message delay before a turn ends, the leader's message already names the next palm, so that
// both palms start to turn at the same time. A turn must not be shorter than the time in which a
// palm turns, because the palms would never cross; nor than two message delays, because the message
// of one turn must arrive before the next message leaves.
//
// docs/theory/sign-controllers.md gives the reasons for each rule and what it achieves.
#pragma once

#include "palmbots/control/silent.hpp"
#include "palmbots/control/table.hpp"

namespace palmbots {

struct SharedSign {
  // Named by the signs (own_…, help_… for the partner's), then the palm where it depends on the
  // past. lead_…, follow_…: both contacts are off in the same direction, and this robot leads or
  // follows. …_ends: its turn with this palm is ending. alone_…: the partner is silent.
  enum class State : std::uint8_t {
    rest_steep,
    rest_shallow,
    own_out,         // p > 0, the partner's is not
    help_out,        // p = 0, the partner's > 0
    help_in,         // p = 0, the partner's < 0
    own_in,          // p < 0, the partner's = 0
    apart_in,        // p < 0, the partner's > 0
    lead_out_steep,  // both > 0
    lead_out_shallow,
    lead_out_steep_ends,
    lead_out_shallow_ends,
    lead_in_steep,  // both < 0
    lead_in_shallow,
    lead_in_steep_ends,
    lead_in_shallow_ends,
    follow_out_steep,
    follow_out_shallow,
    follow_in_steep,
    follow_in_shallow,
    alone_centred,
    alone_watch,
    alone_outward,
    alone_inward,
    alone_pause,
    alone_outward_follower,
    alone_outward_stop,
    alone_inward_leader,
    alone_inward_stop,
    alone_inward_back,
    alone_wait,
  };
  static constexpr int states = 30;
  static constexpr State initial = State::alone_centred;
  static constexpr State started_by_touch(bool is_leader) {
    return is_leader ? State::alone_wait : State::alone_watch;
  }

  // The name of each state, and its meaning for people.
  static constexpr StateMeaning meanings[states] = {
      {"rest_steep", "both contacts are centred"},
      {"rest_shallow", "both contacts are centred"},
      {"own_out", "its contact is outward, its partner's is not"},
      {"help_out", "its partner's contact is outward"},
      {"help_in", "its partner's contact is inward"},
      {"own_in", "its contact is inward, its partner's is centred"},
      {"apart_in", "its contact is inward, its partner's outward"},
      {"lead_out_steep", "both are outward; it leads"},
      {"lead_out_shallow", "both are outward; it leads"},
      {"lead_out_steep_ends", "both are outward; it leads and announces its next palm"},
      {"lead_out_shallow_ends", "both are outward; it leads and announces its next palm"},
      {"lead_in_steep", "both are inward; it leads"},
      {"lead_in_shallow", "both are inward; it leads"},
      {"lead_in_steep_ends", "both are inward; it leads and announces its next palm"},
      {"lead_in_shallow_ends", "both are inward; it leads and announces its next palm"},
      {"follow_out_steep", "both are outward; it follows"},
      {"follow_out_shallow", "both are outward; it follows"},
      {"follow_in_steep", "both are inward; it follows"},
      {"follow_in_shallow", "both are inward; it follows"},
      {"alone_centred", "hears nothing; its contact is centred"},
      {"alone_watch", "hears nothing; watches whether its partner stands"},
      {"alone_outward", "hears nothing; its contact is outward"},
      {"alone_inward", "hears nothing; its contact is inward"},
      {"alone_pause", "hears nothing; pauses, so that its partner alone moves"},
      {"alone_outward_follower", "hears nothing; its contact is outward, and it follows"},
      {"alone_outward_stop", "hears nothing; stands, because its contact stays outward"},
      {"alone_inward_leader", "hears nothing; its contact is inward, and it leads"},
      {"alone_inward_stop", "hears nothing; stands, because its contact stays inward"},
      {"alone_inward_back", "hears nothing; backs towards its partner"},
      {"alone_wait", "hears nothing; waits before it tries again"},
  };

  enum class Limit : std::uint8_t {
    turn,    // how long the leader keeps its palm before it announces the other one
    notice,  // how long before it turns the leader announces its next palm
    push,    // this and the next three as in Silent
    rest,
    patience,
    back,
    watch,  // how long the leader watches for a partner that stands
    wait,   // how long the leader stops
  };
  static constexpr std::size_t limits = 8;
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    switch (limit) {
      case Limit::turn:
        return timing.turn > 2 * timing.delay ? timing.turn - timing.delay : timing.delay;
      case Limit::notice: return timing.delay;
      case Limit::push: return Silent::seconds(Silent::Limit::push, timing);
      case Limit::rest: return Silent::seconds(Silent::Limit::rest, timing);
      case Limit::patience: return Silent::seconds(Silent::Limit::patience, timing);
      case Limit::back: return Silent::seconds(Silent::Limit::back, timing);
      case Limit::watch: return Silent::seconds(Silent::Limit::wait, timing);
      case Limit::wait: break;
    }
    return timing.reach * 4;
  }

  static constexpr Mail mail = Mail::beacons;
  static constexpr auto turn = static_cast<std::int8_t>(Limit::turn);
  static constexpr auto notice = static_cast<std::int8_t>(Limit::notice);
  static constexpr auto push = static_cast<std::int8_t>(Limit::push);
  static constexpr auto rest = static_cast<std::int8_t>(Limit::rest);
  static constexpr auto patience = static_cast<std::int8_t>(Limit::patience);
  static constexpr auto back = static_cast<std::int8_t>(Limit::back);
  static constexpr auto watch = static_cast<std::int8_t>(Limit::watch);
  static constexpr auto wait = static_cast<std::int8_t>(Limit::wait);

  using S = State;
  using M = MessageKind;
  static constexpr bool stop = true;
  // A robot that hears nothing does off centre what Silent does: the state for one of Silent's, and its
  // output.
  static constexpr auto alone_state = [](Silent::State state) {
    return static_cast<State>(static_cast<int>(S::alone_outward) + static_cast<int>(state) -
                              static_cast<int>(Silent::State::outward));
  };
  static constexpr auto alone = [](Silent::State state, M message, std::int8_t limit = -1) {
    TableOutput output = Silent::outputs[static_cast<int>(state)];
    output.message = message;
    output.limit = limit;
    return output;
  };

  // clang-format off
  static constexpr TableOutput outputs[states] = {
      /* rest_steep             */ {' ', {Palm::steep, Move::hold}, M::zero},
      /* rest_shallow           */ {' ', {Palm::shallow, Move::hold}, M::zero},
      /* own_out                */ {'a', {Palm::steep, Move::away}, M::plus},
      /* help_out               */ {'c', {Palm::shallow, Move::away}, M::zero},
      /* help_in                */ {'c', {Palm::steep, Move::closer}, M::zero},
      /* own_in                 */ {'d', {Palm::shallow, Move::closer}, M::minus_shallow},
      /* apart_in               */ {'d', {Palm::shallow, Move::away}, M::minus_shallow},
      /* lead_out_steep         */ {'b', {Palm::steep, Move::away}, M::plus, turn},
      /* lead_out_shallow       */ {'b', {Palm::shallow, Move::away}, M::plus_shallow, turn},
      /* lead_out_steep_ends    */ {'b', {Palm::steep, Move::away}, M::plus_shallow, notice},
      /* lead_out_shallow_ends  */ {'b', {Palm::shallow, Move::away}, M::plus, notice},
      /* lead_in_steep          */ braking({'d', {Palm::steep, Move::closer}, M::minus, turn}),
      /* lead_in_shallow        */ braking({'d', {Palm::shallow, Move::closer}, M::minus_shallow, turn}),
      /* lead_in_steep_ends     */ braking({'d', {Palm::steep, Move::closer}, M::minus_shallow, notice}),
      /* lead_in_shallow_ends   */ braking({'d', {Palm::shallow, Move::closer}, M::minus, notice}),
      /* follow_out_steep       */ braking({'b', {Palm::steep, Move::away}, M::plus}),
      /* follow_out_shallow     */ braking({'b', {Palm::shallow, Move::away}, M::plus}),
      /* follow_in_steep        */ {'d', {Palm::steep, Move::closer}, M::minus_shallow},
      /* follow_in_shallow      */ {'d', {Palm::shallow, Move::closer}, M::minus_shallow},
      /* alone_centred          */ {' ', {Palm::shallow, Move::hold}, M::zero},
      /* alone_watch            */ {' ', {Palm::steep, Move::hold}, M::zero, watch},
      /* alone_outward          */ alone(Silent::State::outward, M::plus),
      /* alone_inward           */ alone(Silent::State::inward, M::minus_shallow, push),
      /* alone_pause            */ alone(Silent::State::pause, M::minus_shallow, rest),
      /* alone_outward_follower */ alone(Silent::State::outward_follower, M::plus, patience),
      /* alone_outward_stop     */ alone(Silent::State::outward_stop, M::plus),
      /* alone_inward_leader    */ alone(Silent::State::inward_leader, M::minus_shallow, patience),
      /* alone_inward_stop      */ alone(Silent::State::inward_stop, M::minus_shallow, wait),
      /* alone_inward_back      */ alone(Silent::State::inward_back, M::minus_shallow, back),
      /* alone_wait             */ {' ', {Palm::shallow, Move::hold, stop}, M::zero, wait},
  };
  // clang-format on

  using P = ContactCondition;
  using Set = EnumSet<State>;
  static constexpr Set any = Set::all();
  // Silence changes nothing for a robot whose contact is centred while its partner's is.
  static constexpr Set quiet = {S::rest_steep, S::rest_shallow, S::alone_centred, S::alone_watch};
  static constexpr std::int8_t quiet_limit = watch;
  static constexpr Set backed = {S::alone_inward_back, S::alone_wait};
  static constexpr Set together = [] {
    Set before;  // the states in which the partner is heard come first
    before.bits = (1U << static_cast<unsigned>(S::alone_centred)) - 1;
    return before;
  }();
  static constexpr Set steep = states_with<State>(Palm::steep, outputs);
  static constexpr Set shallow = states_with<State>(Palm::shallow, outputs);
  static constexpr Set ends_out = {S::lead_out_steep_ends, S::lead_out_shallow_ends};
  static constexpr Set ends_in = {S::lead_in_steep_ends, S::lead_in_shallow_ends};
  static constexpr MessageSet silence = M::none;
  static constexpr MessageSet zero = M::zero;
  static constexpr MessageSet plus = {M::plus, M::plus_shallow};
  static constexpr MessageSet minus = {M::minus, M::minus_shallow};
  static constexpr MessageSet not_plus = {M::zero, M::minus, M::minus_shallow};
  static constexpr IfSet leads_and_stops = {If::leads, If::may_stop};

  // clang-format off
  static constexpr TableRow<State> own_rows[] = {
      // in state                 contact      hears            if             go to
      // the partner is silent, and the contact is centred, or the robot waits (behind these rows: off centre)
      {S::alone_wait,             P::zero,     silence,         If::timed_out,     S::alone_watch},
      {S::alone_watch,            P::zero,     silence,         If::timed_out,     S::alone_centred},
      {backed,                    P::zero,     silence,         {},                S::alone_wait},
      {together,                  P::zero,     silence,         leads_and_stops,   S::alone_watch},
      {any - S::alone_watch,      P::zero,     silence,         {},                S::alone_centred},
      {S::alone_wait,             P::negative, silence,         leads_and_stops,   S::alone_inward_stop},
      // different signs, or both zero
      {steep,                     P::zero,     zero,            {},            S::rest_steep},
      {shallow,                   P::zero,     zero,            {},            S::rest_shallow},
      {any,                       P::positive, not_plus,        {},            S::own_out},
      {any,                       P::zero,     plus,            {},            S::help_out},
      {any,                       P::zero,     minus,           {},            S::help_in},
      {any,                       P::negative, zero,            {},            S::own_in},
      {any,                       P::negative, plus,            {},            S::apart_in},
      // both outward: the leader holds a palm for its turn
      {S::lead_out_shallow,       P::positive, plus,            If::timed_out, S::lead_out_shallow_ends},
      {S::lead_out_shallow_ends,  P::positive, plus,            If::timed_out, S::lead_out_steep},
      {S::lead_out_steep,         P::positive, plus,            If::timed_out, S::lead_out_steep_ends},
      {S::lead_out_steep_ends,    P::positive, plus,            If::timed_out, S::lead_out_shallow},
      {shallow - ends_out,        P::positive, plus,            If::leads,     S::lead_out_shallow},
      {steep - ends_out,          P::positive, plus,            If::leads,     S::lead_out_steep},
      // and the follower takes the other palm
      {any,                       P::positive, M::plus,         If::follows,   S::follow_out_shallow},
      {any,                       P::positive, M::plus_shallow, If::follows,   S::follow_out_steep},
      // both inward: the same
      {S::lead_in_shallow,        P::negative, minus,           If::timed_out, S::lead_in_shallow_ends},
      {S::lead_in_shallow_ends,   P::negative, minus,           If::timed_out, S::lead_in_steep},
      {S::lead_in_steep,          P::negative, minus,           If::timed_out, S::lead_in_steep_ends},
      {S::lead_in_steep_ends,     P::negative, minus,           If::timed_out, S::lead_in_shallow},
      {shallow - ends_in,         P::negative, minus,           If::leads,     S::lead_in_shallow},
      {steep - ends_in,           P::negative, minus,           If::leads,     S::lead_in_steep},
      {any,                       P::negative, M::minus,         If::follows,  S::follow_in_shallow},
      {any,                       P::negative, M::minus_shallow, If::follows,  S::follow_in_steep},
  };
  // clang-format on
  static constexpr auto rows = with_rows_of_silent(own_rows, silence, alone_state);
};

constexpr const char* name_of(SharedSign::State state) {
  return SharedSign::meanings[static_cast<int>(state)].name;
}

constexpr const char* name_of(SharedSign::Limit limit) {
  constexpr const char* names[] = {"turn",     "notice", "push",  "rest",
                                   "patience", "back",   "watch", "wait"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
