// SPDX-License-Identifier: Apache-2.0
// The mode of a robot: a table that acts before a carry, after it, and on a stop, a fault or a lost
// station. In a carry the controller alone decides; the machine only ends it.
//
// A robot runs the first row that fits its mode and what has happened; if none fits, it keeps its
// mode. The wheels may turn only in `carrying` and `holding`, and the driver's watchdog stops them
// when no step follows.
//
// STARTING TOGETHER. A robot starts when its operator has started it and it has heard, within the
// lease, that its partner is ready or carries. Without a radio it starts when its operator says so.
// A robot that is ready and no longer hears its partner has to be started again. Otherwise a radio that
// fails between two ready robots would choose when they start.
// ENDING TOGETHER. A robot that has covered the distance is done and says so. The partner is done
// when it hears that. If a robot hears that its partner does not carry for another reason, it ends
// with a fault.
// STOPS. A stop is latched at each robot that receives one. The robot has to be released and armed
// again. A disarmed robot does not latch the stop of its partner, and cannot be armed meanwhile.
// Otherwise two robots that are released one after the other would stop each other again for ever.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/control/table.hpp"
#include "palmbots/runtime/mode_inputs.hpp"
#include "palmbots/wire/robot_mode.hpp"

namespace palmbots::runtime {

// What may happen to a robot. Several may happen in one step.
enum class ModeEvent : std::uint8_t {
  any,             // always
  storage_failed,  // what has to survive a boot cannot be stored
  stop_stored,     // a stop was in force before the boot
  carry_stored,    // a carry was under way before the boot, and the settings say rejoin
  stop,            // by the operator, heard from the station, or by hand
  partner_stop,    // heard from the partner
  release,         // by the operator
  disarm,          // by the operator
  arm,             // by the operator, and the preflight has passed
  arm_refused,     // by the operator, and it has not passed
  start,           // by the operator
  driver_failed,   // the motor board does not answer
  overrun,         // too many late ticks
  station_lost,    // not heard within the limit, and the settings say stop
  covered,         // the distance is covered
  job_failed,      // a job on the floor has been tried as often as it may
  partner_done,    // the partner is done
  partner_ended,   // the partner does not carry, for another reason
  partner_lost,    // not heard within the lease, and the settings say stop
  time_up,         // the carry has taken the time limit
  partner_silent,  // not heard within the lease
  partner_starts,  // the partner is ready or carries, heard within the lease; or there is no radio
  rests,           // the controller does not travel
  travels,         // it travels
};

constexpr const char* name_of(ModeEvent event) {
  constexpr const char* names[] = {"any",
                                   "storage_failed",
                                   "stop_stored",
                                   "carry_stored",
                                   "stop",
                                   "partner_stop",
                                   "release",
                                   "disarm",
                                   "arm",
                                   "arm_refused",
                                   "start",
                                   "driver_failed",
                                   "overrun",
                                   "station_lost",
                                   "covered",
                                   "job_failed",
                                   "partner_done",
                                   "partner_ended",
                                   "partner_lost",
                                   "time_up",
                                   "partner_silent",
                                   "partner_starts",
                                   "rests",
                                   "travels"};
  return names[static_cast<int>(event)];
}

// How the controller begins in a step.
enum class ControllerStart : std::uint8_t {
  none,    // it goes on, or it does not run
  fresh,   // a new carry
  reboot,  // its own rules after a reboot in a carry
};

// What a row does with the fault code.
enum class CodeChange : std::uint8_t {
  keep,
  set,      // to the row's code
  refusal,  // to the reason why the robot was not armed
};

constexpr const char* name_of(CodeChange change) {
  constexpr const char* names[] = {"keep", "set", "refusal"};
  return names[static_cast<int>(change)];
}

using ModeSet = EnumSet<wire::RobotMode>;
using ModeEvents = EnumSet<ModeEvent>;

struct ModeRow {
  ModeSet from;
  ModeEvent when;
  wire::RobotMode next;
  CodeChange change = CodeChange::keep;
  wire::FaultCode code = wire::FaultCode::none;
};

// What a robot does as long as it is in a mode.
struct ModeOutput {
  bool runs = false;  // the controller runs, and the wheels may turn
};

struct ModeTable {
  static constexpr std::size_t row_count = 27;
  std::array<ModeOutput, wire::robot_modes> outputs;
  std::array<ModeRow, row_count> rows;
};

constexpr ModeTable make_mode_table() {
  using enum wire::RobotMode;
  using E = ModeEvent;
  using F = wire::FaultCode;
  constexpr CodeChange set = CodeChange::set;
  constexpr CodeChange refusal = CodeChange::refusal;
  constexpr ModeSet all{off, disarmed, armed, ready, carrying, holding, done, stopped, fault};
  constexpr ModeSet active{armed, ready, carrying, holding};
  constexpr ModeSet carry{carrying, holding};
  constexpr ModeSet idle{disarmed, done, fault};
  ModeTable table{};
  table.outputs[static_cast<std::size_t>(carrying)].runs = true;
  table.outputs[static_cast<std::size_t>(holding)].runs = true;
  // clang-format off
  table.rows = {{
      // in mode                     what happens       go to     fault code
      // A stop comes before everything else.
      {all,                          E::stop,           stopped},
      {all - ModeSet{disarmed, stopped}, E::partner_stop, stopped},
      {stopped,                      E::release,        disarmed},
      // After a boot.
      {off,                          E::stop_stored,    stopped},
      {off,                          E::storage_failed, fault,    set, F::storage},
      {off,                          E::carry_stored,   carrying},
      {off,                          E::any,            disarmed},
      // Before a carry.
      {all - stopped,                E::disarm,         disarmed, set, F::none},
      {idle,                         E::arm,            armed,    set, F::none},
      {disarmed,                     E::arm_refused,    disarmed, refusal},
      {done,                         E::arm_refused,    done,     refusal},
      {fault,                        E::arm_refused,    fault,    refusal},
      // What ends a carry, or what comes before it.
      {active,                       E::driver_failed,  fault,    set, F::driver},
      {active,                       E::overrun,        fault,    set, F::overrun},
      {active,                       E::storage_failed, fault,    set, F::storage},
      {active,                       E::station_lost,   fault,    set, F::station_lost},
      {carry,                        E::covered,        done},
      {carry,                        E::job_failed,     fault,    set, F::job},
      {carry,                        E::partner_done,   done},
      {carry,                        E::partner_ended,  fault,    set, F::partner},
      {carry,                        E::partner_lost,   fault,    set, F::partner_lost},
      {carry,                        E::time_up,        fault,    set, F::time_limit},
      // The start, and the carry itself.
      {armed,                        E::start,          ready,    set, F::none},
      {ready,                        E::partner_silent, armed,    set, F::partner_lost},
      {ready,                        E::partner_starts, carrying},
      {carrying,                     E::rests,          holding},
      {holding,                      E::travels,        carrying},
  }};
  // clang-format on
  return table;
}

inline constexpr ModeTable mode_table = make_mode_table();

// Why a robot is not armed; none: the preflight has passed.
constexpr wire::FaultCode refusal_of(const ModeSettings& settings, const ModeInputs& in) {
  using F = wire::FaultCode;
  const Preflight& seen = in.preflight;
  if (!in.driver_ok) return F::driver;
  if (!in.storage_ok) return F::storage;
  if (!seen.contact) return F::contact;
  if (!seen.palm) return F::palm;
  if (!seen.arm) return F::arm;
  if (!seen.battery) return F::battery;
  if (seen.stopping > settings.stopping_limit) return F::stopping;
  if (!settings.has_radio) return F::none;
  if (in.partner_stop || in.partner.mode == wire::RobotMode::stopped) return F::stop;
  if (in.partner.age > settings.lease) return F::partner_lost;
  if (!seen.settings) return F::settings;
  return F::none;
}

// What a machine remembers between two steps.
struct ModeMemory {
  wire::RobotMode mode = wire::RobotMode::off;
  wire::FaultCode code = wire::FaultCode::none;
  std::uint32_t carried = 0;    // time since the carry began
  std::uint32_t travelled = 0;  // the part of it in mode carrying

  constexpr bool operator==(const ModeMemory&) const = default;
};

struct ModeOutputs {
  wire::RobotMode mode;
  wire::FaultCode code;
  bool wheels;                 // they may turn; otherwise the driver is to stop now
  ControllerStart controller;  // it begins in this step
  bool stop;                   // every packet passes it on
  StoredMode store;            // to be stored when it changes
};

// One robot.
class ModeMachine {
 public:
  // To be called at a boot, with what was stored before it. The table must outlive the machine.
  constexpr ModeMachine(const ModeSettings& settings, const StoredMode& stored,
                        const ModeTable& table = mode_table)
      : ModeMachine(settings, stored, ModeMemory{}, table) {}

  // Goes on from a memory, as a model checker does.
  constexpr ModeMachine(const ModeSettings& settings, const StoredMode& stored,
                        const ModeMemory& memory, const ModeTable& table)
      : settings_(settings), stored_(stored), memory_(memory), table_(&table) {}

  constexpr ModeOutputs step(const ModeInputs& in) {
    ModeMemory& m = memory_;
    const wire::RobotMode before = m.mode;
    const bool ran = runs(before);
    if (ran) add(m.carried, in.elapsed);
    if (before == wire::RobotMode::carrying) add(m.travelled, in.elapsed);
    const ModeEvents happened = events(in);
    for (const ModeRow& row : table_->rows) {
      if (!row.from.has(before) || !happened.has(row.when)) continue;
      m.mode = row.next;
      if (row.change == CodeChange::set) m.code = row.code;
      if (row.change == CodeChange::refusal) m.code = refusal_of(settings_, in);
      break;
    }
    ControllerStart start = ControllerStart::none;
    if (runs(m.mode) && !ran) {
      m.carried = m.travelled = 0;
      const bool boot = before == wire::RobotMode::off;
      start = boot ? ControllerStart::reboot : ControllerStart::fresh;
    }
    const bool stop = m.mode == wire::RobotMode::stopped;
    return {m.mode, m.code, runs(m.mode), start, stop, {runs(m.mode), stop}};
  }

  constexpr const ModeMemory& memory() const { return memory_; }

 private:
  constexpr bool runs(wire::RobotMode mode) const {
    return table_->outputs[static_cast<std::size_t>(mode)].runs;
  }

  // Adds without overflow.
  static constexpr void add(std::uint32_t& time, std::uint32_t elapsed) {
    time = elapsed < never - time ? time + elapsed : never;
  }

  // What has happened since the last step.
  constexpr ModeEvents events(const ModeInputs& in) const {
    using E = ModeEvent;
    using M = wire::RobotMode;
    using O = wire::Operation;
    const ModeSettings& s = settings_;
    const ModeMemory& m = memory_;
    ModeEvents found = E::any;
    const auto note = [&](bool is_so, E event) {
      if (is_so) found.bits |= ModeEvents(event).bits;
    };
    note(in.stop, E::stop);
    note(!in.storage_ok, E::storage_failed);
    note(stored_.stop, E::stop_stored);
    note(stored_.carries && s.after_reboot == AfterReboot::rejoin, E::carry_stored);
    if (in.operates) {
      note(in.operation == O::release, E::release);
      note(in.operation == O::disarm, E::disarm);
      note(in.operation == O::start, E::start);
      if (in.operation == O::arm) {
        const bool refused = refusal_of(s, in) != wire::FaultCode::none;
        note(true, refused ? E::arm_refused : E::arm);
      }
    }
    note(!in.driver_ok, E::driver_failed);
    note(in.overruns > s.most_overruns, E::overrun);
    note(in.covered || (s.travel > 0 && m.travelled >= s.travel), E::covered);
    note(in.failed, E::job_failed);
    note(m.carried >= s.time_limit, E::time_up);
    note(in.travels, E::travels);
    note(!in.travels, E::rests);
    // After a reboot no packet has arrived yet: silence counts from the start of the carry.
    const bool alone = is_silent(in.station_age, s.station_limit);
    note(alone && s.station_lost == StationLost::stop, E::station_lost);
    if (!s.has_radio) {
      note(true, E::partner_starts);
      return found;
    }
    note(in.partner_stop, E::partner_stop);
    const ModeSet starts{M::ready, M::carrying, M::holding};
    const ModeSet others{M::disarmed, M::armed, M::fault};
    note(in.partner.age <= s.lease && starts.has(in.partner.mode), E::partner_starts);
    note(in.partner.mode == M::done && !in.ends_alone, E::partner_done);
    note(others.has(in.partner.mode), E::partner_ended);
    const bool silent = is_silent(in.partner.age, s.lease);
    note(silent, E::partner_silent);
    note(silent && s.partner_lost == PartnerLost::stop, E::partner_lost);
    return found;
  }

  constexpr bool is_silent(std::uint32_t age, std::uint32_t limit) const {
    return age > limit && (!runs(memory_.mode) || memory_.carried > limit);
  }

  ModeSettings settings_;
  StoredMode stored_;
  ModeMemory memory_;
  const ModeTable* table_;
};

}  // namespace palmbots::runtime
