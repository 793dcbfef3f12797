// SPDX-License-Identifier: Apache-2.0
// Metrics of a carry: its outcome, the contact coordinates, the corrections and the contact events.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "palmbots/sim/team.hpp"
#include "palmbots/world/quasistatic_world.hpp"

namespace palmbots {

// How a carry ended.
enum class Outcome : std::uint8_t { running, delivered, dropped, stalled };

constexpr const char* name_of(Outcome outcome) {
  constexpr const char* names[] = {"running", "delivered", "dropped", "stalled"};
  return names[static_cast<int>(outcome)];
}

// One correction, in ticks. `robot` and `assistant` are as in CorrectionActivity. In (a) and (b) of
// the distributed algorithm the partner becomes the assistant when it enters (c), or (b) too.
// Before that, and if a message was lost, nobody assists.
struct Correction {
  char name;
  std::int8_t robot;
  std::int8_t assistant;
  std::uint32_t start;
  std::uint32_t end;
};

// Number of corrections stored one by one; further ones are only counted.
inline constexpr std::size_t max_corrections = 512;

// A period during which the object touches the palms with more than its two contact vertices, or
// with other points: how it began, and when [ticks].
struct ContactEventRow {
  ContactKind kind;
  std::size_t side;
  double start;
  double end;
};

// Number of contact events stored one by one; further ones are only counted.
inline constexpr std::size_t max_contact_events = 128;

// Number of corrections that make a limit cycle: corrections of one robot that alternate in sign
// and follow each other at once. It occurs if the dead band is too narrow for latency and speed, so
// that (a) leads to (d) and back forever (docs/theory/protocols.md, "Hazards").
inline constexpr std::uint32_t limit_cycle_length = 8;

// Statistics taken every tick. Squares are summed in Real over a block of ticks, and the blocks are
// summed in double.
template <class Real>
struct ContactStatistics {
  PerSide<Real> square_sum;  // of the contact coordinates [m²]
  PerSide<Real> peak;        // largest |p| [m]

  constexpr void add(const PerSide<Real>& contacts) {
    on_both_sides([&](std::size_t side) {
      const Real p = contacts[side];
      square_sum[side] = square_sum[side] + p * p;
      peak[side] = larger(magnitude(p), peak[side]);
    });
  }
};

// All metrics of one carry.
class Metrics {
 public:
  Outcome outcome = Outcome::running;
  DropReason reason = DropReason::none;
  double time_ticks = 0;
  PerSide<double> square_sum{};  // of the contact coordinates [m²]
  PerSide<double> peak{};        // largest |p| [m]
  std::uint32_t samples = 0;
  PerSide<std::uint32_t> waiting_ticks{};
  PerSide<std::uint32_t> waits_since{};  // first tick of the present wait
  PerSide<double> stalled_ticks{};
  PerSide<bool> limit_cycle{};
  std::uint32_t bumps = 0;
  std::uint32_t corrections = 0;
  std::uint32_t longest_correction = 0;          // [ticks]
  std::array<Correction, max_corrections> rows;  // not cleared: `corrections` are valid
  std::uint32_t settle_ticks = 0;
  std::uint32_t contact_events = 0;
  std::array<ContactEventRow, max_contact_events>
      contact_event_rows;  // the first of them; the rest is not cleared

  // Root mean square of a contact coordinate [m].
  double rms(std::size_t side) const {
    return samples == 0 ? 0 : std::sqrt(square_sum[side] / samples);
  }

  // Adds the statistics of `ticks` more ticks and resets them.
  template <class Real>
  void collect(ContactStatistics<Real>& statistics, std::uint32_t ticks) {
    samples += ticks;
    for (const std::size_t side : {left, right}) {
      square_sum[side] += double(statistics.square_sum[side]);
      peak[side] = double(statistics.peak[side]);
      statistics.square_sum[side] = Real(0);
    }
  }

  // Counts robots that stalled in a step. Returns by how much less the midpoint has moved, as a
  // displacement along x.
  template <class Real>
  Real note_stalls(const Advance<Real>& step) {
    for (const std::size_t side : {left, right}) stalled_ticks[side] += step.stalled[side];
    return Real(0.5) * (step.lag[left] + step.lag[right]);
  }

  // To be called after the controllers have run. In ticks without a call they do the same as
  // before.
  template <class Team>
  void note(std::uint32_t tick, const Team& team) {
    const PerSide<char> names{team.name(left), team.name(right)};
    const PerSide<bool> waits{team.waits(left), team.waits(right)};
    if (names == names_ && waits == waits_) return;
    const PerSide<char> before = names_;
    if (names != names_) take_note(tick, team, names);
    for (const std::size_t side : {left, right}) {
      if (waits_[side]) waiting_ticks[side] += tick - noted_;
      if (waits[side] && (!waits_[side] || names[side] != before[side])) waits_since[side] = tick;
    }
    waits_ = waits;
    noted_ = tick;
  }

  // To be called after the world has moved. If several contact events fall into one tick, only
  // the last one is counted and stored.
  template <class Real>
  void observe(std::uint32_t tick, const ContactEventCounter<Real>& now, bool lasts) {
    if (now.count == seen_ && !in_contact_event_) return;
    if (now.count != seen_) {
      if (in_contact_event_) end_contact_event(double(tick) + double(now.began));
      seen_ = now.count;
      in_contact_event_ = true;
      const double start = double(tick) + double(now.began);
      if (contact_events < max_contact_events)
        contact_event_rows[contact_events] = {now.kind, now.side, start, start};
      ++contact_events;
    }
    if (!lasts) end_contact_event(double(tick) + double(now.ended));
  }

  // To be called at the end of the carry: ends what is still open.
  void close(std::uint32_t tick) {
    if (in_contact_event_) end_contact_event(time_ticks);
    for (const std::size_t side : {left, right}) {
      follow(tick, side, {});
      if (waits_[side]) {
        waiting_ticks[side] += tick - noted_;
      } else {
        waits_since[side] = tick;
      }
    }
    noted_ = tick;
  }

 private:
  void end_contact_event(double when) {
    if (contact_events <= max_contact_events) contact_event_rows[contact_events - 1].end = when;
    in_contact_event_ = false;
  }

  struct CorrectionTracker {
    char name = ' ';
    std::uint32_t row = 0;
  };
  struct LimitCycleDetector {
    std::int8_t sense = 0;
    std::uint32_t ended = 0;
    std::uint32_t length = 0;
  };

  // A robot has entered another case than in the tick before.
  template <class Team>
  void take_note(std::uint32_t tick, const Team& team, const PerSide<char>& names) {
    for (const std::size_t side : {left, right}) follow(tick, side, team.activity(side));
    for (const std::size_t side : {left, right}) {
      // A robot still in (c) from an earlier correction does not answer this one.
      const bool answers = names[side] == 'c' && names_[side] != 'c';
      const char helped = open_[other(side)].name;
      if ((answers && (helped == 'a' || helped == 'b')) || (helped == 'b' && names[side] == 'b')) {
        const std::uint32_t row = open_[other(side)].row;
        if (row < max_corrections) rows[row].assistant = static_cast<std::int8_t>(side);
      }
    }
    names_ = names;
  }

  void follow(std::uint32_t tick, std::size_t track, const CorrectionActivity& now) {
    CorrectionTracker& open = open_[track];
    if (now.name == open.name) return;
    if (open.name == 'a' && now.name == 'b') {  // the partner asked too: the case is (b)
      if (open.row < max_corrections) rows[open.row].name = 'b';
      open.name = 'b';
      return;
    }
    if (open.name != ' ') finish(tick, open.row);
    open.name = now.name;
    if (now.name == ' ') return;
    open.row = corrections++;
    if (open.row < max_corrections) {
      rows[open.row] = {now.name, now.robot, now.assistant, tick, tick};
    }
    for (const std::size_t side : {left, right}) {
      if (now.concerns(side)) alternate(tick, side, now.sense[side]);
    }
  }

  void finish(std::uint32_t tick, std::uint32_t row) {
    if (row >= max_corrections) return;
    rows[row].end = tick;
    const std::uint32_t length = tick - rows[row].start;
    if (length > longest_correction) longest_correction = length;
    // Correcting one contact may move the other off centre again: 5, 6, 3, 5, 6, 3, …
    for (LimitCycleDetector& last : last_) last.ended = tick;
  }

  void alternate(std::uint32_t tick, std::size_t side, std::int8_t sense) {
    LimitCycleDetector& last = last_[side];
    const bool goes_on = sense != 0 && last.sense == -sense && tick - last.ended <= settle_ticks;
    last.length = goes_on ? last.length + 1 : 1;
    last.sense = sense;
    if (last.length >= limit_cycle_length) limit_cycle[side] = true;
  }

  bool in_contact_event_ = false;
  std::uint32_t seen_ = 0;  // contact events of the world that have been counted
  PerSide<CorrectionTracker> open_{};
  PerSide<bool> waits_{};
  std::uint32_t noted_ = 0;  // the tick of the last call of note()
  PerSide<char> names_{' ', ' '};
  PerSide<LimitCycleDetector> last_{};
};

}  // namespace palmbots
