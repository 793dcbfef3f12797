// SPDX-License-Identifier: Apache-2.0
// The messages of 64 pairs of robots that a robot reads one by one: those under way, the unread ones,
// and their counts. All messages of a carry have the same delay or are lost.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/batch/bitslice_table.hpp"

namespace palmbots {

// Messages with so many bits, not all of them zero.
template <std::size_t bits>
class BitslicedQueue {
 public:
  using Messages = BitslicedMessage<bits>;

  void insert(int i, std::uint32_t delay) {
    delays_.insert(i, delay);
    for (BitslicedCounts* counts : {&sent_, &lost_}) counts->clear(both_at(i));
  }
  void erase(int i) {
    for (Messages& messages : line_) messages.erase(both_at(i));
    unread_.erase(both_at(i));
    delays_.erase(i);
  }

  // A tick passes. Returns the messages that the robots have not read.
  [[gnu::always_inline]] const Messages& hear(std::uint64_t tick) {
    Messages& arrived = line_[tick % line_.size()];
    unread_.insert(~RobotMask{}, arrived);
    arrived = {};
    return unread_;
  }
  [[gnu::always_inline]] void read(RobotMask whose) { unread_.erase(whose); }

  [[gnu::always_inline]] void post(std::uint64_t tick, RobotMask lost, const Messages& send) {
    const Messages messages = send.swapped();
    const RobotMask come = ~swapped(lost);
    delays_.each(
        tick, [&](std::size_t row, RobotMask whose) { line_[row].insert(whose & come, messages); });
    sent_.add(send.any());
    lost_.add(send.any() & lost);
  }

  void write_results(int i, LinkTotals& link_totals) const {
    write_link_totals(i, sent_, lost_, link_totals);
  }

 private:
  // Messages under way to a robot, by tick of arrival, and the one that it has not read. In Table 2
  // there is never more than one unread message: if another is under way, the robot reads the first
  // as soon as it arrives (bitslice_test).
  std::array<Messages, BitslicedDelay::longest + 1> line_;
  Messages unread_;
  BitslicedDelay delays_;
  BitslicedCounts sent_;
  BitslicedCounts lost_;
};

}  // namespace palmbots
