// SPDX-License-Identifier: Apache-2.0
// Metrics of the carries whose teams run bit-sliced.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/batch/bitslice_counters.hpp"
#include "palmbots/batch/bitslice_table.hpp"
#include "palmbots/sim/metrics.hpp"

namespace palmbots {

// Writes the counts of messages between two robots.
inline void write_link_totals(int i, const BitslicedCounts& sent, const BitslicedCounts& lost,
                              LinkTotals& link_totals) {
  link_totals.sent = 0;
  link_totals.lost = 0;
  for (const std::size_t side : {left, right}) {
    LinkCounts& link = link_totals.links[side];
    link_totals.sent += link.sent = sent.of(side, i);
    link_totals.lost += link.lost = lost.of(side, i);
  }
}

// Metrics of robots in the cases of Table 2, as in Metrics::note.
class BitslicedCaseMetrics {
 public:
  void insert(int i) {
    for (BitslicedCounts* counts : {&corrections_, &waiting_}) counts->clear(both_at(i));
  }
  void erase(int i) {
    for (RobotMask& names : names_) names &= ~both_at(i);
    waits_ &= ~both_at(i);
  }

  // To be called after a tick.
  template <class Robot>
  [[gnu::always_inline]] void note(const BitslicedTable<Robot>& robots) {
    using StateOutput = typename Robot::StateOutput;
    static constexpr char cases[] = {'a', 'b', 'c', 'd'};
    std::array<RobotMask, 4> names;
    RobotMask renamed{};
    for (std::size_t k = 0; k < 4; ++k) {
      names[k] = robots.who([&](const StateOutput& output) { return output.name == cases[k]; });
      renamed |= names[k] ^ names_[k];
    }
    const auto& [a, b, c, d] = names;
    const RobotMask was_a = names_[0];
    // (a) becomes (b) if the partner asks too. A robot in (c) assists.
    corrections_.add(renamed & (a | (b & ~was_a) | d));
    names_ = names;
    if constexpr (!can_wait<Robot>()) return;
    const RobotMask waits = robots.who([](const StateOutput& output) { return output.waits; });
    waits_now_.clear(waits & (renamed | ~waits_));
    waits_now_.add(waits);
    waiting_.add(waits);
    waits_ = waits;
  }

  // Writes the metrics of pair i after `ticks` ticks.
  void write_results(int i, std::uint32_t ticks, Metrics& metrics) const {
    metrics.corrections = corrections_.of(left, i) + corrections_.of(right, i);
    for (const std::size_t side : {left, right}) {
      const bool waits = (waits_[side] >> i & 1) != 0;
      metrics.waiting_ticks[side] = waiting_.of(side, i);
      metrics.waits_since[side] = waits ? ticks - waits_now_.of(side, i) : ticks;
    }
  }

 private:
  // True if a robot waits in any state.
  template <class Robot>
  static constexpr bool can_wait() {
    for (const auto& output : Robot::outputs) {
      if (output.waits) return true;
    }
    return false;
  }

  std::array<RobotMask, 4> names_{};  // the robots in each case
  RobotMask waits_{};
  BitslicedCounts corrections_;
  BitslicedCounts waiting_;    // ticks in total
  BitslicedCounts waits_now_;  // ticks of the present wait
};

}  // namespace palmbots
