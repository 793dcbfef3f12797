// SPDX-License-Identifier: Apache-2.0
// What a finished carry gave, and controllers written in Python: for both ways to run a carry.
#pragma once

#include <nanobind/stl/tuple.h>

#include <vector>

#include "bindings.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/carry_warnings.hpp"
#include "palmbots/sim/lift_carry.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/table_team.hpp"

namespace palmbots::bindings {

// A controller written in Python: an object with
//   step(sign, message, turned, leads) -> (palm, move, stop, message sent, message read, case,
//   waits).
class PythonController {
 public:
  static constexpr Mail mail = Mail::queue;
  static constexpr bool has_clock = false;

  PythonController(nb::object step, bool leads) : step_(std::move(step)), leads_(leads) {}
  PythonController booted() const { return {step_, leads_}; }

  RobotOutput step(const RobotInput& in) {
    const nb::object answer =
        step_(static_cast<int>(in.sign), static_cast<int>(in.message), in.palm_at_target, leads_);
    const auto [palm, move, stop, send, read, name, waits] =
        nb::cast<std::tuple<int, int, bool, int, bool, int, bool>>(answer);
    name_ = static_cast<char>(name);
    waits_ = waits;
    const auto message = static_cast<MessageKind>(send);
    return {{static_cast<Palm>(palm), static_cast<Move>(move), stop},
            message,
            message != MessageKind::none,
            read};
  }
  char name() const { return name_; }
  bool waits() const { return waits_; }
  static constexpr MessageKind awaits() { return MessageKind::none; }
  static constexpr bool stopped() { return false; }

 private:
  nb::object step_;
  bool leads_;
  char name_ = ' ';
  bool waits_ = false;
};

// The controllers of both robots, from their step functions.
inline PerSide<PythonController> python_controllers(const nb::object& pair, const Spec& spec) {
  const auto [l, r] = nb::cast<std::tuple<nb::object, nb::object>>(pair);
  return {PythonController(l, leader_of(spec) == left),
          PythonController(r, leader_of(spec) == right)};
}

// What a carry gave, in seconds and metres.
struct Run {
  Metrics metrics;
  double period = 0;
  double distance = 0;
  LinkTotals link_totals;
  PerSide<MessageKind> awaits{};
  PerSide<bool> stopped{};      // at the end
  std::uint32_t ambiguous = 0;  // events after which the world had a choice
  std::uint64_t hash = 0;
  std::vector<Row> rows;
  std::vector<SentMessage> sent_messages;
  std::vector<ChoiceRow> choices;
  // Of a job that begins or ends on the floor.
  std::vector<LiftPhase> phases;
  std::vector<LiftFall> falls;
  std::vector<PerSide<double>> pivot_heights;  // of each row [m]
  double moved = 0;                            // of the COM along the floor [m]
};

// A carry (or a co-simulation) that is over; what its recorder kept is not in it yet.
template <class Carry>
Run run_of(const Carry& carry) {
  Run run;
  run.metrics = carry.metrics();
  run.period = carry.spec().period;
  run.distance = double(carry.midpoint()) * carry.spec().direction;
  run.link_totals = carry.team().link_totals;
  for (const std::size_t side : {left, right}) {
    run.awaits[side] = carry.team().awaits(side);
    run.stopped[side] = carry.commands()[side].stop;
  }
  return run;
}

// The same of a job that begins or ends on the floor, with all that was recorded.
template <class Job>
Run run_of_lift(Job& job) {
  Run run = run_of(job);
  if (on_one_palm(job.spec())) run.distance = job.travelled()[leader_of(job.spec())];
  run.hash = job.recorder().hash();
  run.rows = job.recorder().take_rows();
  run.sent_messages = job.recorder().take_sent_messages();
  run.choices = job.recorder().take_choices();
  run.pivot_heights = job.take_heights();
  run.phases = job.phases();
  run.moved = job.moved();
  return run;
}

}  // namespace palmbots::bindings
