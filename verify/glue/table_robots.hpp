// SPDX-License-Identifier: Apache-2.0
// What the glue of all models shares: robots of tables as shipped (palmbots/control/table_robot.hpp), put
// into the state and the counts that the checker keeps, and receivers of beacons at a moment. A
// receiver counts ticks without end, but all that it does depends on differences of stamps only; so
// stamps are kept as ages in cycles.
#pragma once

#include "palmbots/control/mailbox.hpp"
#include "palmbots/control/table_robot.hpp"

namespace glue {

using palmbots::Beacon;
using palmbots::BeaconReceiver;
using palmbots::BeaconStamp;
using palmbots::MessageKind;
using palmbots::Sign;
using palmbots::TableRobot;
using palmbots::TableTimes;

// A robot in this state, silent; the caller sets what else it remembers. The right robot leads.
template <class Table>
TableRobot<Table> robot_in(unsigned state, int side, const TableTimes<Table>& times,
                           bool may_stop = false) {
  TableRobot<Table> robot(times, {side == 1, may_stop});
  robot.enter(static_cast<typename Table::State>(state));
  return robot;
}

constexpr std::uint32_t present = 1000;  // what every clock reads, whatever the time

// A stamp {life, age} of the checker, as the robots have it; life 0: never.
template <class Stamp>
BeaconStamp stamp_of(const Stamp& s) {
  return s.life == 0 ? BeaconStamp{} : BeaconStamp{s.life, present - std::uint32_t{s.age}};
}

// A receiver at this moment: its own clock reads `present`, and so does the partner's.
template <class Stamp>
BeaconReceiver receiver_of(unsigned life, const Stamp& newest_heard) {
  BeaconReceiver receiver(life, present);
  Beacon newest;
  newest.sent = stamp_of(newest_heard);
  receiver.accept(newest);
  return receiver;
}

}  // namespace glue
