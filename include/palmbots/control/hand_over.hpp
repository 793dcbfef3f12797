// SPDX-License-Identifier: Apache-2.0
// The phases of a job on the floor in which one robot hands a small object to the other one, as a
// table. One palm carries the object at a time. The *giver*, which follows, picks it up against the
// steep palm of the *taker*, which leads. It carries it half of the way and puts it down. Then the
// taker picks it up against the steep palm of the giver, carries it the rest of the way and puts it
// down. Picking up and putting down are those of one robot with a wall (control/lone.hpp).
//
//   prop      the taker stands with its brakes on, palm steep and nose on the floor: the wall
//   hold_up   the giver holds the object up until the taker is out of its way
//   clear     the taker drives away from the object; then `ahead`, as far as the giver will carry, and
//   there     waits until the giver has put the object down
//   brace     the giver stands with its palm steep beside the object: the wall
//
// Only one robot drives at a time, except while the other one leaves for good. A robot that waits
// says so as long as it waits, and the word that it waits for is also repeated. So no rule depends on
// when a message arrives.
//
// A robot stores whether the object may have been lifted. If it restarts then, it lowers its arm and
// fails, and its partner does so when it hears that. Otherwise it begins again: a taker that hears
// that the object has been put down drives under it.
#pragma once

#include "palmbots/control/lift_rules.hpp"

namespace palmbots {

struct HandOver : LiftRules<HandOver> {
  enum class State : std::uint8_t {
    begin,
    prop,
    clear,
    ahead,
    there,
    scoop,
    seat,
    ease,
    lift,
    hold_up,
    haul,
    set_down,
    tip_out,
    leave_steep,
    brace,
    retreat,
    done,
    sink,
    back_off,
    failed,
    land,
  };
  using S = State;
  using M = MessageKind;
  static constexpr int number = 2;  // among the tables of jobs
  static constexpr int states = 21;
  static constexpr State initial = S::begin;

  static constexpr StateMeaning meanings[states] = {
      {"begin", "begins the job of the robot that gives, or of the one that takes"},
      {"prop", "stands with its palm steep and its brakes on, as the wall of its partner"},
      {"clear", "drives away from the object, which its partner holds up"},
      {"ahead", "drives on, as far as its partner will carry the object"},
      {"there", "waits until its partner has put the object down"},
      {"scoop", "drives towards the object until something presses its palm"},
      {"seat", "drives on until its palm is under the whole object"},
      {"ease", "drives a little away from the wall, with the object on its palm"},
      {"lift", "raises its arm, alone"},
      {"hold_up", "holds the object up until its partner is out of the way"},
      {"haul", "drives away with the object on its palm"},
      {"set_down", "lowers its arm, with the object on its palm"},
      {"tip_out", "makes its palm steep, so that the object slides to the floor"},
      {"leave_steep", "drives away with its palm steep"},
      {"brace", "stands beside the object with its palm steep, until its partner has taken it"},
      {"retreat", "drives away from the object"},
      {"done", "the job is over"},
      {"sink", "lowers its arm, because nothing is on its palm"},
      {"back_off", "drives back, to try again"},
      {"failed", "has tried as often as it may"},
      {"land", "lowers its arm after a boot, and stands"},
  };

  enum class Limit : std::uint8_t { scoop, seat, ease, leave, back };
  static constexpr std::size_t limits = 5;
  // `reach` is the time for half a palm.
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    switch (limit) {
      case Limit::scoop: return timing.reach * 12;
      case Limit::ease: return timing.reach / 4;
      case Limit::leave: return timing.reach * 2.5;
      case Limit::seat:
      case Limit::back: break;
    }
    return timing.reach * 3;
  }

  static constexpr Mail mail = Mail::beacons;
  template <class B, class Count>
  using Memory = LiftMemory<B, Count>;

  static constexpr auto scoop_limit = static_cast<std::int8_t>(Limit::scoop);
  static constexpr auto seat_limit = static_cast<std::int8_t>(Limit::seat);
  static constexpr auto ease_limit = static_cast<std::int8_t>(Limit::ease);
  static constexpr auto leave_limit = static_cast<std::int8_t>(Limit::leave);
  static constexpr auto back = static_cast<std::int8_t>(Limit::back);

  static constexpr Command wall{Palm::steep, Move::hold, true};
  static constexpr Command away{Palm::steep, Move::away, true};
  static constexpr Command goes_ahead{Palm::steep, Move::hold, false};
  static constexpr Command closer{Palm::shallow, Move::closer, true};
  static constexpr Command stands{Palm::shallow, Move::hold, true};
  static constexpr Command travels{Palm::shallow, Move::hold, false};
  static constexpr Command away_shallow{Palm::shallow, Move::away, true};

  // clang-format off
  // What arm and controller do in each state, what it says, and its time limit.
  static constexpr LiftState behaviour[states] = {
      /* begin       */ {wall,         M::docking,  ArmMove::follow, Driver::table},
      /* prop        */ {wall,         M::ready,    ArmMove::follow, Driver::table},
      /* clear       */ {away,         M::leaving,  ArmMove::follow, Driver::table, back},
      /* ahead       */ {goes_ahead,   M::carrying, ArmMove::follow, Driver::table},
      /* there       */ {wall,         M::arrived,  ArmMove::follow, Driver::table},
      /* scoop       */ {closer,       M::docking,  ArmMove::follow, Driver::table, scoop_limit},
      /* seat        */ {closer,       M::under,    ArmMove::follow, Driver::table, seat_limit},
      /* ease        */ {away_shallow, M::under,    ArmMove::follow, Driver::table, ease_limit},
      /* lift        */ {stands,       M::raising,  ArmMove::rise,   Driver::table},
      /* hold_up     */ {stands,       M::lifted,   ArmMove::hold,   Driver::table},
      /* haul        */ {travels,      M::carrying, ArmMove::hold,   Driver::table},
      /* set_down    */ {stands,       M::lowering, ArmMove::sink,   Driver::table},
      /* tip_out     */ {wall,         M::down,     ArmMove::follow, Driver::table},
      /* leave_steep */ {away,         M::leaving,  ArmMove::follow, Driver::table, leave_limit},
      /* brace       */ {wall,         M::empty,    ArmMove::follow, Driver::table},
      /* retreat     */ {away,         M::empty,    ArmMove::follow, Driver::table, back},
      /* done        */ {wall,         M::empty,    ArmMove::follow, Driver::table},
      /* sink        */ {stands,       M::under,    ArmMove::sink,   Driver::table},
      /* back_off    */ {away_shallow, M::backing,  ArmMove::follow, Driver::table, back},
      /* failed      */ {stands,       M::holding,  ArmMove::follow, Driver::table},
      /* land        */ {stands,       M::under,    ArmMove::sink,   Driver::table},
  };

  using P = ContactCondition;
  using Set = EnumSet<State>;
  // The states in which the nose is on the floor and the robot has not lifted the object.
  static constexpr Set on_trial = {S::begin, S::prop, S::scoop, S::seat, S::ease, S::back_off};
  static constexpr Set ending = {S::set_down, S::tip_out, S::leave_steep,
                                 S::brace,    S::retreat, S::done};
  static constexpr Set assisting = Set::all() - on_trial;
  static constexpr State initial_assisting = S::land;
  // In these a robot waits for its partner without a time limit.
  static constexpr Set waits = {S::prop, S::there, S::hold_up, S::brace};
  // What the taker says once it has lifted the object.
  static constexpr MessageSet has_taken = {M::carrying, M::lowering, M::down, M::leaving,
                                           M::empty};

  static constexpr TableRow<State> rows[] = {
      // in state       contact  hears        if                            go to
      {S::begin,        P::any,  any_message, If::leads,                    S::prop},
      {S::begin,        P::any,  any_message, If::follows,                  S::scoop},
      // the partner has failed
      {waits,           P::any,  M::holding,  {},                           S::land},
      // pick up
      {S::scoop,        P::any,  any_message, If::touches,                  S::seat},
      {S::scoop,        P::any,  any_message, If::timed_out,                S::back_off},
      {S::seat,         P::any,  any_message, If::timed_out,                S::ease},
      {S::ease,         P::any,  any_message, If::timed_out,                S::lift},
      {S::lift,         P::any,  any_message, {If::reached, If::is_empty},  S::sink},
      {S::lift,         P::any,  any_message, {If::reached, If::leads},     S::haul},
      {S::lift,         P::any,  any_message, {If::reached, If::follows},   S::hold_up},
      // the taker gets out of the way
      {S::prop,         P::any,  M::lifted,   {},                           S::clear},
      {S::prop,         P::any,  M::empty,    {},                           S::scoop},
      {S::clear,        P::any,  any_message, If::timed_out,                S::ahead},
      {S::ahead,        P::any,  any_message, If::reached,                  S::there},
      {S::hold_up,      P::any,  M::arrived,  {},                           S::haul},
      // put down
      {S::haul,         P::any,  any_message, If::reached,                  S::set_down},
      {S::set_down,     P::any,  any_message, If::reached,                  S::tip_out},
      {S::tip_out,      P::any,  any_message, If::turned,                   S::leave_steep},
      // Switches open for a moment while the object slides off: an open switch shows that
      // the palm is free only when the time is over.
      {S::leave_steep,  P::any,  any_message, {If::timed_out, If::leads},   S::retreat},
      {S::leave_steep,  P::any,  any_message, {If::timed_out, If::touches}, S::failed},
      {S::leave_steep,  P::any,  any_message, If::timed_out,                S::brace},
      // hand over
      {S::there,        P::any,  M::empty,    {},                           S::scoop},
      {S::brace,        P::any,  has_taken,   {},                           S::retreat},
      {S::retreat,      P::any,  any_message, If::timed_out,                S::done},
      // try again
      {S::sink,         P::any,  any_message, If::reached,                  S::back_off},
      {S::back_off,     P::any,  any_message, {If::timed_out, If::gave_up}, S::failed},
      {S::back_off,     P::any,  any_message, If::timed_out,                S::scoop},
      // after a boot, or after the partner has failed
      {S::land,         P::any,  any_message, If::reached,                  S::failed},
  };
  // clang-format on

  static constexpr auto columns = columns_of(behaviour);
  static constexpr const auto& outputs = columns.outputs;

  static constexpr bool alone = false;
  static constexpr bool on_one_palm = true;
  static constexpr State first(bool, bool) { return initial; }
  static constexpr bool has_ended(State state, bool) { return state == S::done; }
  static constexpr bool is_carrying(State state) { return state == S::haul || state == S::ahead; }
  // The giver carries half of the way; the taker goes as far without the object, and then on with it.
  static constexpr unsigned halves_of_way(State state, bool leads) {
    return leads && state == S::haul ? 2 : 1;
  }
  // A robot says that it has failed until its partner has put the object down, too.
  static constexpr bool gives_up(State state, MessageKind heard) {
    return state == S::failed && (heard == M::holding || heard == M::empty);
  }
  static constexpr bool moves_object(State one, State other) {
    const Set without = {S::clear, S::ahead};
    return !without.has(one) && !without.has(other);
  }
  static constexpr bool has_failed(State one, State other) {
    const Set over = {S::failed, S::done};
    return over.has(one) && over.has(other) && (one == S::failed || other == S::failed);
  }
};

constexpr const char* name_of(HandOver::State state) {
  return HandOver::meanings[static_cast<int>(state)].name;
}

constexpr const char* name_of(HandOver::Limit limit) {
  constexpr const char* names[] = {"scoop", "seat", "ease", "leave", "back"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
