// SPDX-License-Identifier: Apache-2.0
// One carry of the shipped core with everything that the page draws, as flat arrays of numbers.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "page_scene.hpp"
#include "page_team.hpp"
#include "palmbots/sim/chassis.hpp"
#include "palmbots/sim/lift_carry.hpp"
#include "palmbots/sim/recorder.hpp"

namespace palmbots::page {

using Numbers = std::vector<double>;

// Times in s, lengths in m, angles in rad; pairs are left, right.
struct RecordedCarry {
  // Rows of 26: time, contacts, palm angles, speeds, commanded speeds, separation, midpoint, object
  // angle, signs, cases (character codes), motions, lifts, states (PageTeam::state), whether each
  // robot waits for a message, heights of the pivots (PairPose).
  static constexpr std::size_t row_width = 26;
  Numbers rows;
  // Rows of 7: sent, received (not a number: lost), sender, receiver (2: the station), kind (as
  // MessageKind, or a kind_… below), number among all that the sender transmits to this receiver,
  // content (PageRecorder; 1: of the table of a job on the floor).
  Numbers messages;
  static constexpr double kind_hello = -1;
  static constexpr double kind_report = -2;   // of a robot to the station
  static constexpr double kind_command = -3;  // of the station
  // Rows of 5: robot (2: both), case, assistant (−1: nobody), start, end.
  Numbers corrections;
  // Rows of 4: side, kind, start, end.
  Numbers contact_events;
  // Of a job on the floor, rows of 3: side, phase (phase_number), start.
  Numbers phases;
  // Outcome, drop reason, time, distance, contact rms and peak, messages sent and lost, waiting
  // times, number of corrections, of bumps, the trace hash (high and low word), how far the object
  // moved in the direction of travel in a job on the floor.
  Numbers metrics;
  std::string warnings;  // after the carry, one a line
};

// The team that the controllers are.
inline const PageTeam& controllers_of(const PageTeam& team) { return team; }
template <class Table>
const PageTeam& controllers_of(const LiftTeam<PageTeam, Table>& team) {
  return team.inner();
}

// A TraceRecorder that also stores the packets of a team with a station, of which one goes over each
// link in each tick. One that stores nothing takes no time: many carries are only counted.
class PageRecorder : public TraceRecorder {
 public:
  explicit PageRecorder(bool stores) : TraceRecorder(stores), stores_(stores) {}

  template <class Carry>
  void before(const Carry& carry, const PerSide<RobotObservation>& sensed) {
    if (!stores_) return;
    TraceRecorder::before(carry, sensed);
    store(carry.team());
  }
  template <class Carry>
  void after(const Carry& carry) {
    if (!stores_) return;
    TraceRecorder::after(carry);
    const auto sent = controllers_of(carry.team()).packets(tick_);
    if (sent) store(*sent, carry.spec().period);
    ++tick_;
  }
  template <class Carry>
  void end(const Carry& carry) {
    if (!stores_) return;
    TraceRecorder::end(carry);
    store(carry.team());
  }
  Numbers take_packets() { return std::move(packets_); }
  // Of each row.
  struct Doing {
    PerSide<int> states;
    PerSide<bool> waits;
  };
  const std::vector<Doing>& doings() const { return doings_; }

 private:
  template <class Team>
  void store(const Team& team) {
    const PageTeam& own = controllers_of(team);
    doings_.push_back(
        {{{own.state(left), own.state(right)}}, {{team.waits(left), team.waits(right)}}});
  }
  // A report's content: sign + 1, + 3 if the palm is shallow, + 6 if it has reached its angle. A
  // command's: 1 if the palm is to be shallow, + 2 × the move.
  void store(const StationPackets& sent, double period) {
    for (std::uint32_t link = 0; link < sent.arrivals.size(); ++link) {
      const std::uint32_t arrival = sent.arrivals[link];
      if (arrival == StationPackets::not_sent) continue;
      const bool is_report = link < 2;
      const std::size_t robot = link % 2;
      const auto& report = sent.reports[robot];
      const auto& command = sent.commands[robot];
      const double said = is_report ? (double(report.sign) + 1) + 3 * double(report.palm) +
                                          6 * double(report.palm_at_target)
                                    : double(command.palm) + 2 * double(command.move);
      const double kind = is_report            ? RecordedCarry::kind_report
                          : sent.hellos[robot] ? RecordedCarry::kind_hello
                                               : RecordedCarry::kind_command;
      const double received =
          arrival == 0 ? std::numeric_limits<double>::quiet_NaN() : double(arrival) * period;
      const double station = 2;
      packets_.insert(packets_.end(),
                      {double(tick_) * period, received, is_report ? double(robot) : station,
                       is_report ? station : double(robot), kind, double(++numbers_[link]), said});
    }
  }

  bool stores_;
  std::uint32_t tick_ = 0;
  std::array<std::uint32_t, 4> numbers_{};
  Numbers packets_;
  std::vector<Doing> doings_;
};

using PageCarry = Carry<double, PageTeam, PageRecorder>;
template <class Table>
using PageJob = LiftCarry<PageTeam, PageRecorder, Table>;

namespace detail {

inline void append_row(const Row& row, const PageRecorder::Doing& doing, double time,
                       const PerSide<double>& height, Numbers& out) {
  out.push_back(time);
  for (const auto* pair : {&row.contact, &row.palm, &row.speed, &row.commanded}) {
    out.insert(out.end(), {(*pair)[left], (*pair)[right]});
  }
  out.insert(out.end(), {row.separation, row.midpoint, row.object});
  out.insert(out.end(), {double(row.sign[left]), double(row.sign[right])});
  out.insert(out.end(), {double(row.name[left]), double(row.name[right])});
  out.insert(out.end(), {double(row.motion[left]), double(row.motion[right])});
  out.insert(out.end(), {row.lift[left], row.lift[right]});
  out.insert(out.end(), {double(doing.states[left]), double(doing.states[right])});
  out.insert(out.end(), {double(doing.waits[left]), double(doing.waits[right])});
  out.insert(out.end(), {height[left], height[right]});
}

}  // namespace detail

// All that is kept of a carry or a job that is over. `heights`: of the pivots in each row; none: 0.
inline RecordedCarry kept_of(const Spec& spec, const CarryEnd& finished, double midpoint,
                             bool stops_in_silence, PageRecorder& recorder,
                             const std::vector<PerSide<double>>& heights = {}) {
  RecordedCarry kept;
  const Metrics& m = finished.metrics;
  const double period = spec.period;
  const std::uint64_t hash = recorder.hash();
  kept.metrics = {double(m.outcome),
                  double(m.reason),
                  m.time_ticks * period,
                  midpoint * spec.direction,
                  m.rms(left),
                  m.rms(right),
                  m.peak[left],
                  m.peak[right],
                  double(finished.links.sent),
                  double(finished.links.lost),
                  m.waiting_ticks[left] * period,
                  m.waiting_ticks[right] * period,
                  double(m.corrections),
                  double(m.bumps),
                  double(hash >> 32),
                  double(hash & 0xFFFFFFFFU),
                  0.0};
  kept.warnings = warning_lines(spec, finished, stops_in_silence);
  const std::vector<Row> rows = recorder.take_rows();
  const double end = m.time_ticks * spec.period;
  const double floor = heights.empty() ? 0.0 : floor_level(spec);
  kept.rows.reserve(rows.size() * RecordedCarry::row_width);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double time = k + 1 < rows.size() ? double(k) * spec.period : end;
    PerSide<double> height{};
    if (!heights.empty()) height = {heights[k][left] + floor, heights[k][right] + floor};
    detail::append_row(rows[k], recorder.doings()[k], time, height, kept.rows);
  }
  kept.messages = recorder.take_packets();
  PerSide<std::uint32_t> numbers{};
  for (const SentMessage& message : recorder.take_sent_messages()) {
    const double received = message.received == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                  : double(message.received) * spec.period;
    const double kind = message.is_hello ? RecordedCarry::kind_hello : double(message.kind);
    const bool is_of_table = message.kind >= MessageKind::docking;
    kept.messages.insert(kept.messages.end(),
                         {double(message.sent) * spec.period, received, double(message.sender),
                          double(message.receiver), kind, double(++numbers[message.sender % 2]),
                          double(is_of_table)});
  }
  const std::uint32_t listed = m.corrections < max_corrections ? m.corrections : max_corrections;
  for (std::uint32_t i = 0; i < listed; ++i) {
    const Correction& c = m.rows[i];
    const double stop = double(c.end) < m.time_ticks ? double(c.end) : m.time_ticks;
    kept.corrections.insert(kept.corrections.end(),
                            {double(c.robot), double(c.name), double(c.assistant),
                             double(c.start) * spec.period, stop * spec.period});
  }
  const std::uint32_t events =
      m.contact_events < max_contact_events ? m.contact_events : max_contact_events;
  for (std::uint32_t i = 0; i < events; ++i) {
    const ContactEventRow& e = m.contact_event_rows[i];
    kept.contact_events.insert(
        kept.contact_events.end(),
        {double(e.side), double(e.kind), e.start * spec.period, e.end * spec.period});
  }
  return kept;
}

namespace detail {

template <class Carry>
CarryEnd end_of(const Carry& carry) {
  const auto& team = carry.team();
  return {carry.metrics(),
          team.link_totals,
          {team.awaits(left), team.awaits(right)},
          {carry.commands()[left].stop, carry.commands()[right].stop}};
}

}  // namespace detail

// Runs one carry to its end. `stops_in_silence`: of the controller (ControllerInfo).
inline RecordedCarry record(const Spec& spec, std::uint64_t seed, PageTeam team,
                            const std::vector<Fork>& forks, bool stops_in_silence) {
  PageCarry carry(spec, seed, std::move(team), PageRecorder(true));
  carry.run(forks);
  return kept_of(spec, detail::end_of(carry), carry.midpoint(), stops_in_silence, carry.recorder());
}

// The same of a job that begins or ends on the floor.
RecordedCarry record_job(const Spec& spec, std::uint64_t seed, PageTeam team,
                         bool stops_in_silence);

// Counts of many carries, one after the other.
struct Tally {
  double carries = 0;
  double dropped = 0;
  double stalled = 0;
  double square_sum = 0;  // of both contact coordinates, as the rate of each carry [m²]
  double messages = 0;
  double way = 0;  // [m]
  double corrections = 0;

  void add(const Spec& spec, std::uint64_t seed, PageTeam team) {
    PageCarry carry(spec, seed, std::move(team), PageRecorder(false));
    carry.run();
    add(spec, carry.metrics(), carry.team().link_totals, carry.midpoint());
  }
  // A job that begins or ends on the floor.
  void add_job(const Spec& spec, std::uint64_t seed, PageTeam team);

 private:
  void add(const Spec& spec, const Metrics& m, const LinkTotals& links, double midpoint) {
    carries += 1;
    dropped += m.outcome == Outcome::dropped ? 1 : 0;
    stalled += m.outcome == Outcome::stalled ? 1 : 0;
    square_sum += m.rms(left) * m.rms(left) + m.rms(right) * m.rms(right);
    messages += links.sent;
    way += midpoint * spec.direction;
    corrections += m.corrections;
  }
};

}  // namespace palmbots::page
