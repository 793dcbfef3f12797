// SPDX-License-Identifier: Apache-2.0
// The team of a job that begins or ends on the floor or on a stand: any team of a carry, with the
// table that lifts (control/lifting.hpp) beside the controller of each robot.
//
// The messages of the table travel by a radio of their own, with the properties of the scene's; what
// both send at the same time does not collide. While the table drives a robot, the controller sees a
// centred contact.
#pragma once

#include <utility>

#include "palmbots/control/hand_over.hpp"
#include "palmbots/control/lifting.hpp"
#include "palmbots/control/lone.hpp"
#include "palmbots/sim/standing_start.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots {

template <class Table>
TableTimes<Table> times_with(const TableTiming& timing, const Spec& spec) {
  return {ticks_in(spec.beacon, spec.period), ticks_in(table_lease(spec), spec.period),
          table_limits<Table>(timing, spec.period)};
}

// A robot drives back, and centres, for some leases at least: what it said before is then out of date
// (docs/theory/verification.md).
template <>
inline TableTimes<Lifting> table_times_of<Lifting>(const Spec& spec) {
  TableTiming timing = table_timing_of(spec);
  timing.reach = larger(timing.reach, table_lease(spec));
  return times_with<Lifting>(timing, spec);
}

// A robot that picks up alone drives its whole palm under the object, whatever part of it is usable.
template <class Table>
TableTimes<Table> times_of_scooping(const Spec& spec) {
  TableTiming timing = table_timing_of(spec);
  double reach = 0;
  for (const std::size_t side : {left, right}) {
    if (Table::alone && side != leader_of(spec)) continue;
    if (spec.robots[side].correction > 0)
      reach = larger(reach, 0.5 * spec.palms[side].length / spec.robots[side].correction);
  }
  if (reach > 0) timing.reach = reach;
  return times_with<Table>(timing, spec);
}
template <>
inline TableTimes<Lone> table_times_of<Lone>(const Spec& spec) {
  return times_of_scooping<Lone>(spec);
}
template <>
inline TableTimes<HandOver> table_times_of<HandOver>(const Spec& spec) {
  return times_of_scooping<HandOver>(spec);
}

// The seed of the radio for phases: both radios would else lose the same messages.
constexpr std::uint64_t seed_of_phases(std::uint64_t seed) { return seed ^ 0x6C696674; }

// True for a robot that docks after its partner, or not at all.
inline bool stands_by(const Spec& spec, std::size_t side) {
  return spec.docking != Docking::together && side != leader_of(spec);
}

// What the controllers correct, as long as a robot that follows its controller has such a contact. The
// left robot may stand for both.
constexpr CorrectionActivity obeyed(const CorrectionActivity& activity, bool by_left,
                                    bool by_right) {
  const bool is_obeyed =
      (by_left && activity.concerns(left)) || (by_right && activity.concerns(right));
  return is_obeyed ? activity : CorrectionActivity{};
}

// Calls use(table) with the table of a job.
template <class Use>
auto with_job_table(const Spec& spec, Use&& use) {
  if (is_alone(spec)) return use(Lone{});
  if (hands_over(spec)) return use(HandOver{});
  return use(Lifting{});
}

template <class Inner, class TheTable = Lifting>
class LiftTeam {
 public:
  using Table = TheTable;
  using State = Table::State;
  static constexpr bool ends_jobs = true;
  bool half_moves;
  bool expects_turns;
  LinkTotals link_totals{};

  LiftTeam(const Spec& spec, std::uint64_t seed, Inner inner)
      : half_moves(inner.half_moves),
        expects_turns(inner.expects_turns),
        inner_(std::move(inner)),
        phases_(phases_of(spec, seed, measures_time(inner_))) {
    for (const std::size_t side : {left, right}) {
      phases_.wake(side).enter(
          Table::first(spec.begins_on != StandsOn::palms, stands_by(spec, side)));
    }
  }

  // What the robots know besides their observations, before each step.
  void feel(const PerSide<LiftSenses>& senses) {
    for (const std::size_t side : {left, right}) {
      if (phases_.robot(side).clock().own.senses == senses[side]) continue;
      phases_.wake(side).clock().own.senses = senses[side];
    }
  }

  template <class Log>
  const PerSide<Command>& step(std::uint32_t tick, const PerSide<RobotObservation>& sensed,
                               Log&& log) {
    const PerSide<Command> own = phases_.step(tick, sensed, log);
    for (const std::size_t side : {left, right}) runs_[side] = !phases_.faults().stops(tick, side);
    PerSide<RobotObservation> shown = sensed;
    for (const std::size_t side : {left, right}) {
      if (driver(side) == Driver::table) shown[side] = {Sign::zero, true};
      set_in_place(inner_, side, driver(side) != Driver::controller);
    }
    const PerSide<Command>& given = inner_.step(tick, shown, log);
    for (const std::size_t side : {left, right}) {
      commands_[side] = Table::command(state(side), senses(side), own[side], given[side]);
    }
    count_messages();
    return commands_;
  }

  std::uint32_t next_decision_tick(std::uint32_t tick) const { return tick + 1; }
  void close(std::uint32_t tick) {
    inner_.close(tick);
    count_messages();
  }
  void fork(std::uint64_t seed) {
    inner_.fork(seed);
    phases_.fork(seed_of_phases(seed));
  }

  State state(std::size_t side) const { return phases_.robot(side).state(); }
  ArmMove arm(std::size_t side) const { return Table::arm(state(side), runs_[side]); }
  const Inner& inner() const { return inner_; }

  char name(std::size_t side) const { return is_correcting(side) ? inner_.name(side) : ' '; }
  bool waits(std::size_t side) const { return is_correcting(side) && inner_.waits(side); }
  MessageKind awaits(std::size_t side) const { return inner_.awaits(side); }
  CorrectionActivity activity(std::size_t side) const {
    return obeyed(inner_.activity(side), is_correcting(left), is_correcting(right));
  }

 private:
  using Robot = LiftRobot<Table>;
  using Phases = RobotTeam<Robot>;

  // Robots whose controllers measure no time have the clock of the carry.
  static PerSide<double> drift_of(const Spec& spec, bool measures_time) {
    if (!measures_time) return {0, 0};
    return {spec.robots[left].clock_drift, spec.robots[right].clock_drift};
  }

  static Phases phases_of(const Spec& spec, std::uint64_t seed, bool measures_time) {
    return {{Robot(table_robot_of<Table>(spec, left)), Robot(table_robot_of<Table>(spec, right))},
            drift_of(spec, measures_time),
            channel_of(spec),
            seed_of_phases(seed),
            leader_of(spec),
            Faults::of(spec, seed)};
  }

  const LiftSenses& senses(std::size_t side) const {
    return phases_.robot(side).clock().own.senses;
  }
  Driver driver(std::size_t side) const { return Table::driver(state(side), senses(side)); }
  bool is_correcting(std::size_t side) const { return driver(side) != Driver::table; }

  void count_messages() {
    link_totals = inner_.link_totals;
    link_totals += phases_.link_totals;
  }

  Inner inner_;
  Phases phases_;
  PerSide<Command> commands_{};
  PerSide<bool> runs_{true, true};
};

}  // namespace palmbots
