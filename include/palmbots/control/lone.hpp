// SPDX-License-Identifier: Apache-2.0
// The phases of a job on the floor that one robot does alone, as a table. A wall stands behind a small
// object. The robot drives its palm under the whole object, backs away with it and puts it down. The
// robot that leads does so. The other one stands aside; it is in the last state from the start.
//
//   scoop     palm shallow, nose on the floor, closer. The robot pushes the object to the wall; then
//             the near corner climbs the palm, and its switches close
//   seat      no reading says that the object lies flush. So the robot drives on for as long as it
//             needs for its whole palm. Its wheels stall when the nose is at the wall, or the object
//             at the heel
//   ease      a little away: the palm takes the object along, and the wall no longer holds it
//   lift      if something presses the palm in the air, the object is on it. Otherwise the robot
//             lowers its arm and tries again
//   tip_out   nose on the floor, palm steep, that is, steeper than the friction angle: the object slides
//             down until its far corner is on the floor. A palm that stayed shallow would take the
//             object along
//
// The shallow angle is below the friction angle, so the palm need not turn before it carries.
//
// A robot that restarts while the object may be on its palm does not know how far it has carried it.
// It lowers its arm and stands; a person ends the job. Every other wait has a time limit or ends when
// the arm or the palm arrives.
#pragma once

#include "palmbots/control/lift_rules.hpp"

namespace palmbots {

struct Lone : LiftRules<Lone> {
  enum class State : std::uint8_t {
    scoop,
    seat,
    ease,
    lift,
    haul,
    set_down,
    tip_out,
    leave_steep,
    retreat,
    done,
    sink,
    back_off,
    failed,
    land,
  };
  using S = State;
  using M = MessageKind;
  static constexpr int number = 1;  // among the tables of jobs
  static constexpr int states = 14;
  static constexpr State initial = S::scoop;

  static constexpr StateMeaning meanings[states] = {
      {"scoop", "drives towards the object until something presses its palm"},
      {"seat", "drives on until its palm is under the whole object"},
      {"ease", "drives a little away from the wall, with the object on its palm"},
      {"lift", "raises its arm, alone"},
      {"haul", "drives away with the object on its palm"},
      {"set_down", "lowers its arm, with the object on its palm"},
      {"tip_out", "makes its palm steep, so that the object slides to the floor"},
      {"leave_steep", "drives away with its palm steep"},
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
      case Limit::leave: return timing.reach * 8;
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

  static constexpr Command closer{Palm::shallow, Move::closer, true};
  static constexpr Command stands{Palm::shallow, Move::hold, true};
  static constexpr Command travels{Palm::shallow, Move::hold, false};
  static constexpr Command tips{Palm::steep, Move::hold, true};
  static constexpr Command away{Palm::steep, Move::away, true};
  static constexpr Command away_shallow{Palm::shallow, Move::away, true};

  // clang-format off
  // What arm and controller do in each state, what it says, and its time limit.
  static constexpr LiftState behaviour[states] = {
      /* scoop       */ {closer,       M::docking,  ArmMove::follow, Driver::table, scoop_limit},
      /* seat        */ {closer,       M::under,    ArmMove::follow, Driver::table, seat_limit},
      /* ease        */ {away_shallow, M::under,    ArmMove::follow, Driver::table, ease_limit},
      /* lift        */ {stands,       M::raising,  ArmMove::rise,   Driver::table},
      /* haul        */ {travels,      M::carrying, ArmMove::hold,   Driver::table},
      /* set_down    */ {stands,       M::lowering, ArmMove::sink,   Driver::table},
      /* tip_out     */ {tips,         M::down,     ArmMove::follow, Driver::table},
      /* leave_steep */ {away,         M::leaving,  ArmMove::follow, Driver::table, leave_limit},
      /* retreat     */ {away,         M::empty,    ArmMove::follow, Driver::table, back},
      /* done        */ {tips,         M::empty,    ArmMove::follow, Driver::table},
      /* sink        */ {stands,       M::lowering, ArmMove::sink,   Driver::table},
      /* back_off    */ {away_shallow, M::backing,  ArmMove::follow, Driver::table, back},
      /* failed      */ {stands,       M::backing,  ArmMove::follow, Driver::table},
      /* land        */ {stands,       M::lowering, ArmMove::sink,   Driver::table},
  };

  using P = ContactCondition;
  using Set = EnumSet<State>;
  // The states in which the nose is on the floor and the object has not been carried.
  static constexpr Set on_trial = {S::scoop, S::seat, S::ease, S::back_off, S::failed};
  static constexpr Set ending = {S::set_down, S::tip_out, S::leave_steep, S::retreat, S::done};
  static constexpr Set assisting = Set::all() - on_trial;
  static constexpr State initial_assisting = S::land;

  static constexpr TableRow<State> rows[] = {
      // in state       contact  hears        if                            go to
      {S::scoop,        P::any,  any_message, If::touches,                  S::seat},
      {S::scoop,        P::any,  any_message, If::timed_out,                S::back_off},
      {S::seat,         P::any,  any_message, If::timed_out,                S::ease},
      {S::ease,         P::any,  any_message, If::timed_out,                S::lift},
      {S::lift,         P::any,  any_message, {If::reached, If::touches},   S::haul},
      {S::lift,         P::any,  any_message, {If::reached, If::is_empty},  S::sink},
      {S::haul,         P::any,  any_message, If::reached,                  S::set_down},
      {S::set_down,     P::any,  any_message, If::reached,                  S::tip_out},
      {S::tip_out,      P::any,  any_message, If::turned,                   S::leave_steep},
      {S::leave_steep,  P::any,  any_message, If::is_empty,                 S::retreat},
      {S::leave_steep,  P::any,  any_message, If::timed_out,                S::retreat},
      {S::retreat,      P::any,  any_message, If::timed_out,                S::done},
      // try again
      {S::sink,         P::any,  any_message, If::reached,                  S::back_off},
      {S::back_off,     P::any,  any_message, {If::timed_out, If::gave_up}, S::failed},
      {S::back_off,     P::any,  any_message, If::timed_out,                S::scoop},
      // after a boot
      {S::land,         P::any,  any_message, If::reached,                  S::failed},
  };
  // clang-format on

  static constexpr auto columns = columns_of(behaviour);
  static constexpr const auto& outputs = columns.outputs;

  static constexpr bool alone = true;
  static constexpr bool on_one_palm = true;
  static constexpr State first(bool, bool stands_by) { return stands_by ? S::done : initial; }
  static constexpr bool has_ended(State state, bool) { return state == S::done; }
  static constexpr bool is_carrying(State state) { return state == S::haul; }
  static constexpr bool has_failed(State one, State other) {
    return one == S::failed || other == S::failed;
  }
};

constexpr const char* name_of(Lone::State state) {
  return Lone::meanings[static_cast<int>(state)].name;
}

constexpr const char* name_of(Lone::Limit limit) {
  constexpr const char* names[] = {"scoop", "seat", "ease", "leave", "back"};
  return names[static_cast<int>(limit)];
}

}  // namespace palmbots
