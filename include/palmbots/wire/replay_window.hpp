// SPDX-License-Identifier: Apache-2.0
// Which packets are new: each sender numbers its packets, each receiver takes only higher numbers.
//
// A packet's stamp is (epoch, sequence), compared in this order. The epoch counts the sender's
// boots and outlives them: a sender keeps the last one in permanent memory and writes the next one
// there *before* its first packet, so no stamp is ever used twice under a key. The sequence starts
// at 1 in every epoch and ends where it would wrap: after 2³² − 1 packets (497 days at 100 a
// second) the next number is 0, which no packet may bear, and the sender is silent until it enters
// the next epoch, as at a boot. After 2²⁴ − 1 epochs, or when the counter is lost, the pair needs a
// new key.
#pragma once

#include <compare>
#include <cstdint>

namespace palmbots::wire {

struct SequenceNumber {
  std::uint32_t epoch = 0;
  std::uint32_t sequence = 0;

  constexpr auto operator<=>(const SequenceNumber&) const = default;
};

// What a receiver remembers of one sender: the newest stamp it took. The first one is newer than
// none. Never goes back.
class ReplayWindow {
 public:
  // Whether the stamp is newer than all taken before; then it is taken.
  constexpr bool accept(const SequenceNumber& stamp) {
    if (stamp <= newest_) return false;
    newest_ = stamp;
    return true;
  }

  constexpr const SequenceNumber& newest() const { return newest_; }

 private:
  SequenceNumber newest_{};
};

}  // namespace palmbots::wire
