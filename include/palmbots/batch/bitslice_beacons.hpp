// SPDX-License-Identifier: Apache-2.0
// The beacons of 64 pairs of robots: those under way, how old each one is when it arrives, and their
// counts.
//
// All beacons of a carry have the same delay or are lost. So no beacon overtakes another, and every
// arriving beacon is the newest. Of the two stamps in a beacon only the resulting age matters, and
// it is stored with the beacon. An echo of a beacon that a robot sent before its boot is older than
// the time since that boot.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/batch/bitslice_io.hpp"
#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/batch/bitslice_table.hpp"

namespace palmbots {

// Beacons with so many bits of content, not all of them zero.
template <std::size_t bits>
class BitslicedBeacons {
 public:
  using Content = BitslicedMessage<bits>;

  void insert(int i, std::uint32_t delay) {
    const RobotMask here = both_at(i);
    there_and_back_.assign(here, 2 * delay);
    delays_.insert(i, delay);
    for (BitslicedCounts* counts : {&sent_, &lost_, &late_}) counts->clear(here);
  }
  void erase(int i) {
    for (Row& row : line_) row.content.erase(both_at(i));
    delays_.erase(i);
  }
  // These robots have received nothing since their boot.
  void boot(RobotMask whose) {
    echo_.assign(whose, BitslicedCounter::most);
    since_booted_.assign(whose, 0);
  }

  // A tick passes, and the robots that run take in what arrives: its content and its age. Returns
  // who received something.
  [[gnu::always_inline]] RobotMask hear(std::uint64_t tick, RobotMask run, Content& newest,
                                        BitslicedCounter& age) {
    echo_.increment();
    since_booted_.increment();
    const Row& row = line_[tick % line_.size()];
    const RobotMask whose = row.content.any() & run;
    newest.erase(whose);
    newest.insert(whose, row.content);
    age.assign(whose, row.age);
    age.assign(whose & age.at_least(since_booted_), BitslicedCounter::most);
    echo_.assign(whose, there_and_back_);
    return whose;
  }
  // What these robots received was too old.
  [[gnu::always_inline]] void count_late(RobotMask whose) {
    if (either(whose) != 0) [[unlikely]]
      late_.add(swapped(whose));
  }

  // These robots send. The age that the partner will assign to a beacon when it arrives is the time
  // since the partner sent the beacon that this robot received last.
  [[gnu::always_inline]] void post(std::uint64_t tick, RobotMask send, RobotMask lost,
                                   const Content& says) {
    line_[tick % line_.size()].content = {};  // delivered
    const RobotMask comes = swapped(send & ~lost);
    const Content content = says.swapped();
    const BitslicedCounter age = echo_.swapped();
    delays_.each(tick, [&](std::size_t at, RobotMask whose) {
      Row& row = line_[at];
      const RobotMask those = comes & whose;
      row.content.insert(those, content);
      row.age.assign(those, age);
    });
    sent_.add(send);
    if (either(lost) != 0) lost_.add(send & lost);
  }

  void write_results(int i, LinkTotals& link_totals) const {
    write_link_totals(i, sent_, lost_, link_totals);
    for (const std::size_t side : {left, right}) link_totals.links[side].late = late_.of(side, i);
  }

 private:
  // The beacons that arrive in a tick.
  struct Row {
    Content content;
    BitslicedCounter age;
  };

  BitslicedCounter there_and_back_;  // the delay of two messages
  // Time since the partner sent the newest beacon, plus the delay of one message.
  BitslicedCounter echo_;
  BitslicedCounter since_booted_;
  std::array<Row, BitslicedDelay::longest + 1> line_;
  BitslicedDelay delays_;
  BitslicedCounts sent_;
  BitslicedCounts lost_;
  BitslicedCounts late_;
};

}  // namespace palmbots
