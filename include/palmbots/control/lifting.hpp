// SPDX-License-Identifier: Apache-2.0
// The phases of a job that begins or ends on the floor or on a stand, as a table: both robots pick
// the object up, carry it and put it down. One table for both robots; each runs it beside its
// controller.
//
// A robot's controller corrects the contact as in any carry, from `centre` to `lower` (only in `carry`
// if the pair corrects its contacts at level pivots only), and drives along the path in `carry` only.
// Before and after, the table drives the wheels itself.
//
//   dock      palms steep, noses on the floor, closer, until the own sign is not −. The first robot
//             waits there with its brakes on; the object slides along its palm, to the heel if need
//             be, while the partner gets under it
//   stand_by  one robot first: the other one begins here and docks when the first one is under
//   touch     from a stand: when the robot has reached its place below the object by its odometry,
//             its arm rises until a switch closes, and holds (`meet`, `poised`) until its partner's
//             does. Contacts are not centred there: a palm that moved outward would only lose its own
//   centre    both are under it: the ordinary corrections, still on the floor. A pair that corrects its
//             contacts at level pivots only is `poised` instead, and centres them in the air
//   raise     an arm moves only while a message younger than the lease says that the partner is
//             ready, or moves as well, and never more than a step ahead of its partner's: a robot
//             that loses messages again and again would fall behind. So do both arms that lower
//   leave     both palms away, one of them steep, until nothing presses them. The last one is steep:
//             so it drags the object least. On a stand nothing presses them then: the arms have sunk
//             until the palms are clear of the object
//
// A robot knows −, 0, + and whether a switch is closed at all, its timers, its odometry, and what its
// partner said within the lease. It cannot notice that its wheels stall. Every wait on the floor has
// a time limit, after which the robot backs off and tries again; `ready` lasts as long as its partner
// centres. In `recentre` the partner may be raising, unless it says otherwise. In the air everything
// holds.
//
// After a boot a robot whose partner may have raised its arm holds everything until it hears what the
// partner does; any other robot backs off and tries again. Arms and palms are assumed to hold while a
// program does not run.
//
// docs/guide/lifting.md describes the phases in prose.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/control/lift_rules.hpp"

namespace palmbots {

struct Lifting : LiftRules<Lifting> {
  enum class State : std::uint8_t {
    dock,
    under,
    centre,
    ready,
    recentre,
    raise,
    raise_hold,
    up,
    carry,
    arrived,
    lower,
    lower_hold,
    down,
    leave_steep,
    leave_shallow,
    empty,
    retreat,
    done,
    back_off,
    stand_back,
    failed,
    held,
    stand_by,
    touch,
    meet,
    poised,
  };
  using S = State;
  using M = MessageKind;
  static constexpr int number = 0;  // among the tables of jobs
  static constexpr int states = 26;
  static constexpr State initial = S::dock;

  // The name of each state, and its meaning for people.
  static constexpr StateMeaning meanings[states] = {
      {"dock", "drives towards the object until its contact is not inward"},
      {"under", "its palm is under the object; waits for its partner's"},
      {"centre", "corrects its contact on the floor"},
      {"ready", "its contact is centred; waits for its partner to be ready"},
      {"recentre", "corrects its contact again; its partner may be raising"},
      {"raise", "raises its arm"},
      {"raise_hold", "holds its arm until its partner raises, too"},
      {"up", "its arm is up; waits for its partner's"},
      {"carry", "carries"},
      {"arrived", "has travelled the distance; waits for its partner to stop"},
      {"lower", "lowers its arm"},
      {"lower_hold", "holds its arm until its partner lowers, too"},
      {"down", "its nose is on the floor; waits for its partner's"},
      {"leave_steep", "drives away with its palm steep"},
      {"leave_shallow", "drives away with its palm shallow, because its partner's is steep"},
      {"empty", "nothing is on its palm; waits for its partner to be empty"},
      {"retreat", "drives away from the object"},
      {"done", "the job is over"},
      {"back_off", "drives back, to try again"},
      {"stand_back", "waits for its partner to drive back, too"},
      {"failed", "has tried as often as it may"},
      {"held", "holds everything after a boot, until it hears its partner"},
      {"stand_by",
       "stands beside the object with its brakes on, until its partner's palm is under it"},
      {"touch", "is below an object on a stand; raises its arm until its palm touches the object"},
      {"meet", "its palm touches an object on a stand; waits for its partner's"},
      {"poised",
       "both palms are under the object; waits for its partner, to raise it before contacts are "
       "centred"},
  };

  enum class Limit : std::uint8_t { dock, wait, centre, leave, back };
  static constexpr std::size_t limits = 5;
  static constexpr double seconds(Limit limit, const TableTiming& timing) {
    switch (limit) {
      case Limit::dock: return timing.reach * 12;
      case Limit::wait: return timing.reach * 12;
      case Limit::centre: return timing.reach * 20;
      case Limit::leave: return timing.reach * 8;
      case Limit::back: break;
    }
    return timing.reach * 3;
  }

  static constexpr Mail mail = Mail::beacons;
  template <class B, class Count>
  using Memory = LiftMemory<B, Count>;

  static constexpr auto dock_limit = static_cast<std::int8_t>(Limit::dock);
  static constexpr auto wait = static_cast<std::int8_t>(Limit::wait);
  static constexpr auto centre_limit = static_cast<std::int8_t>(Limit::centre);
  static constexpr auto leave_limit = static_cast<std::int8_t>(Limit::leave);
  static constexpr auto back = static_cast<std::int8_t>(Limit::back);

  static constexpr Command stands{Palm::steep, Move::hold, true};
  static constexpr Command closer{Palm::steep, Move::closer, true};
  // A shallow palm rests on the end of its bevel, so its nose is higher, and the partner's gets under first.
  static constexpr Command stands_shallow{Palm::shallow, Move::hold, true};
  static constexpr Command away{Palm::steep, Move::away, true};
  static constexpr Command away_shallow{Palm::shallow, Move::away, true};

  // clang-format off
  // What arm and controller do in each state, what it says, and its time limit.
  static constexpr LiftState behaviour[states] = {
      /* dock          */ {closer,         M::docking,  ArmMove::follow, Driver::table,               dock_limit},
      /* under         */ {stands,         M::under,    ArmMove::follow, Driver::table,               wait},
      /* centre        */ {stands,         M::centring, ArmMove::follow, Driver::controller_in_place, centre_limit},
      /* ready         */ {stands,         M::ready,    ArmMove::follow, Driver::controller_in_place},
      /* recentre      */ {stands,         M::centring, ArmMove::follow, Driver::controller_in_place, centre_limit},
      /* raise         */ {stands,         M::raising,  ArmMove::rise,   Driver::while_level},
      /* raise_hold    */ {stands,         M::raising,  ArmMove::hold,   Driver::while_level},
      /* up            */ {stands,         M::lifted,   ArmMove::hold,   Driver::while_level},
      /* carry         */ {stands,         M::carrying, ArmMove::hold,   Driver::controller},
      /* arrived       */ {stands,         M::arrived,  ArmMove::hold,   Driver::while_level},
      /* lower         */ {stands,         M::lowering, ArmMove::sink,   Driver::while_pressed},
      /* lower_hold    */ {stands,         M::lowering, ArmMove::hold,   Driver::while_pressed},
      /* down          */ {stands,         M::down,     ArmMove::follow, Driver::table},
      /* leave_steep   */ {away,           M::leaving,  ArmMove::follow, Driver::table,               leave_limit},
      /* leave_shallow */ {away_shallow,   M::leaving,  ArmMove::follow, Driver::table,               leave_limit},
      /* empty         */ {stands,         M::empty,    ArmMove::follow, Driver::table,               wait},
      /* retreat       */ {away,           M::empty,    ArmMove::follow, Driver::table,               back},
      /* done          */ {stands,         M::empty,    ArmMove::follow, Driver::table},
      /* back_off      */ {away,           M::backing,  ArmMove::follow, Driver::table,               back},
      /* stand_back    */ {stands,         M::empty,    ArmMove::follow, Driver::table,               back},
      /* failed        */ {stands,         M::backing,  ArmMove::follow, Driver::table},
      /* held          */ {stands,         M::holding,  ArmMove::hold,   Driver::while_level},
      /* stand_by      */ {stands_shallow, M::docking,  ArmMove::follow, Driver::table,               wait},
      /* touch         */ {stands,         M::docking,  ArmMove::reach,  Driver::table,               wait},
      /* meet          */ {stands,         M::under,    ArmMove::hold,   Driver::table,               wait},
      /* poised        */ {stands,         M::ready,    ArmMove::hold,   Driver::table},
  };

  using P = ContactCondition;
  using Set = EnumSet<State>;
  static constexpr Set on_trial = {S::dock,     S::under, S::centre, S::ready, S::recentre,
                                   S::stand_by, S::touch, S::meet,   S::poised};
  static constexpr Set docking = {S::dock, S::stand_by};
  static constexpr Set leaving = {S::leave_steep, S::leave_shallow};
  // In these a robot puts the object down, or has put it down.
  static constexpr Set ending = {S::arrived,     S::lower,         S::lower_hold, S::down,
                                 S::leave_steep, S::leave_shallow, S::empty,      S::retreat,
                                 S::done};
  // In one of these states the partner may have raised its arm, or the object has been put down. A robot
  // stores that.
  static constexpr Set assisting =
      Set::all() - Set{S::dock,     S::under,      S::centre, S::stand_by,
                       S::back_off, S::stand_back, S::failed, S::touch,
                       S::meet};
  static constexpr State initial_assisting = S::held;
  // After a boot any other robot drives back before it docks again: its partner may still hear what it
  // said before, and would leave while this robot raises its arm.
  static constexpr State rebooted = S::back_off;
  static constexpr MessageSet raised = {M::raising, M::lifted};
  static constexpr MessageSet is_under = {M::under,   M::centring, M::ready,
                                          M::raising, M::lifted,   M::holding};
  static constexpr MessageSet joins = {M::centring, M::ready, M::raising, M::lifted, M::holding};
  static constexpr MessageSet rises = {M::ready, M::raising, M::lifted, M::carrying};
  static constexpr MessageSet landed = {M::down, M::leaving, M::empty, M::backing};
  static constexpr MessageSet carries = {M::lifted, M::carrying};
  static constexpr MessageSet sinks = {M::arrived, M::lowering, M::down,
                                       M::leaving, M::empty,    M::backing};

  static constexpr TableRow<State> rows[] = {
      // in state      contact          hears                                  if               go to
      {on_trial,       P::any,          M::backing,                            {},              S::back_off},
      // pick up
      {S::dock,        P::any,          any_message,                           If::reached,     S::touch},
      {docking,        P::not_negative, any_message,                           If::touches,     S::under},
      {S::stand_by,    P::any,          M::under,                              {},              S::dock},
      {S::stand_by,    P::any,          any_message,                           If::timed_out,   S::back_off},
      {S::dock,        P::any,          any_message,                           If::timed_out,   S::back_off},
      {S::touch,       P::any,          any_message,                           If::touches,     S::meet},
      {S::touch,       P::any,          any_message,                           If::timed_out,   S::back_off},
      {S::meet,        P::any,          is_under,                              {},              S::poised},
      {S::meet,        P::any,          any_message,                           If::timed_out,   S::back_off},
      {S::poised,      P::any,          rises,                                 {},              S::raise},
      {S::poised,      P::any,          M::lowering,                           {},              S::back_off},
      {S::under,       P::any,          is_under,                              If::level_only,  S::poised},
      {S::under,       P::any,          is_under,                              {},              S::centre},
      {S::under,       P::any,          any_message,                           If::timed_out,   S::back_off},
      {S::centre,      P::zero,         joins,                     {If::turned, If::touches},   S::ready},
      {S::centre,      P::any,          any_message - raised,                  If::timed_out,   S::back_off},
      {S::ready,       P::zero,         rises,                                 {},              S::raise},
      {S::ready,       P::positive,     any_message,                           {},              S::recentre},
      {S::ready,       P::negative,     any_message,                           {},              S::recentre},
      {S::recentre,    P::zero,         any_message,               {If::turned, If::touches},   S::ready},
      {S::recentre,    P::any,          {M::centring, M::ready},               If::timed_out,   S::back_off},
      {S::raise,       P::any,          any_message,                           If::reached,     S::up},
      {S::raise,       P::any,          any_message - rises,                   {},              S::raise_hold},
      {S::raise,       P::any,          any_message,                           If::ahead,       S::raise_hold},
      {S::raise_hold,  P::any,          rises,                                 If::abreast,     S::raise},
      {S::raise_hold,  P::any,          {M::arrived, M::lowering},             {},              S::arrived},
      {S::up,          P::any,          {M::lifted, M::carrying, M::arrived},  {},              S::carry},
      // carry
      {S::carry,       P::any,          {M::arrived, M::lowering},             {},              S::arrived},
      {S::carry,       P::any,          any_message,                           If::reached,     S::arrived},
      {S::carry,       P::any,          any_message - carries,                 {},              S::up},
      // put down
      {S::arrived,     P::any,          sinks,                                 If::abreast,     S::lower},
      {S::lower,       P::any,          any_message,                           If::reached,     S::down},
      {S::lower,       P::any,          any_message - sinks,                   {},              S::lower_hold},
      {S::lower,       P::any,          any_message,                           If::ahead,       S::lower_hold},
      {S::lower_hold,  P::any,          sinks,                                 If::abreast,     S::lower},
      {S::down,        P::any,          landed,                                If::leads,       S::leave_steep},
      {S::down,        P::any,          landed,                                If::follows,     S::leave_shallow},
      {leaving,        P::any,          any_message,                           If::is_empty,    S::empty},
      {S::leave_shallow, P::any,        M::empty,                              {},              S::leave_steep},
      {leaving,        P::any,          any_message,                           If::timed_out,   S::retreat},
      {S::empty,       P::any,          any_message,              {If::touches, If::leads},     S::leave_steep},
      {S::empty,       P::any,          any_message,              {If::touches, If::follows},   S::leave_shallow},
      {S::empty,       P::any,          M::empty,                              {},              S::retreat},
      {S::empty,       P::any,          any_message,                           If::timed_out,   S::retreat},
      {S::retreat,     P::any,          any_message,                           If::timed_out,   S::done},
      // try again
      {S::back_off,    P::any,          any_message,                           If::timed_out,   S::stand_back},
      {S::stand_back,  P::any,          any_message,                           If::gave_up,     S::failed},
      {S::stand_back,  P::any,          any_message,                           If::timed_out,   S::dock},
      // after a boot
      {S::held,        P::any,          M::backing,                            {},              S::back_off},
      {S::held,        P::zero,         {M::ready, M::raising},    {If::turned, If::touches},   S::raise_hold},
      {S::held,        P::any,          {M::ready, M::raising},                If::reached,     S::raise_hold},
      {S::held,        P::any,          {M::ready, M::raising},                If::level_only,  S::raise_hold},
      {S::held,        P::any,          M::lifted,                             {},              S::raise_hold},
      {S::held,        P::any,          sinks,                                 {},              S::lower_hold},
  };
  // clang-format on

  static constexpr auto columns = columns_of(behaviour);
  static constexpr const auto& outputs = columns.outputs;

  static constexpr bool alone = false;        // one robot does the job
  static constexpr bool on_one_palm = false;  // one palm holds the object in the air
  // In which state a robot begins: with the object on the floor, or with palms that hold it;
  // `stands_by`: it docks after its partner.
  static constexpr State first(bool begins_low, bool stands_by) {
    return !begins_low ? S::carry : stands_by ? S::stand_by : S::dock;
  }
  static constexpr bool is_carrying(State state) { return state == S::carry; }
  // Its part of the job is over: with the object on the floor, or held by the palms.
  static constexpr bool has_ended(State state, bool ends_low) {
    return ends_low ? state == S::done : state == S::arrived || state == S::lower;
  }
  static constexpr bool has_failed(State one, State other) {
    return one == S::failed && other == S::failed;
  }
};

constexpr const char* name_of(Lifting::State state) {
  return Lifting::meanings[static_cast<int>(state)].name;
}

constexpr const char* name_of(Lifting::Limit limit) {
  constexpr const char* names[] = {"dock", "wait", "centre", "leave", "back"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
