// SPDX-License-Identifier: Apache-2.0
// Replay protection: each sender numbers its packets, and each receiver accepts only higher
// numbers.
//
// A packet's stamp is (epoch, sequence), compared in this order. The epoch counts the sender's
// boots and survives them. A sender stores the last epoch in permanent memory, and writes the next
// one there *before* its first packet, so no stamp is ever used twice under a key. The sequence
// starts at 1 in every epoch. After 2³² − 1 packets (497 days at 100 per second) the next number
// would be 0, which is not valid. The sender then stays silent until it enters the next epoch, as
// at a boot. After 2²⁴ − 1 epochs, or when the counter is lost, the pair needs a new key.
#pragma once

#include <compare>
#include <cstdint>

namespace palmbots::wire {

// A packet's stamp. Epoch 0 stands for "never".
struct SequenceNumber {
  std::uint32_t epoch = 0;
  std::uint32_t sequence = 0;

  constexpr auto operator<=>(const SequenceNumber&) const = default;
};

// The newest stamp accepted from one sender. It never goes back. Initially any valid stamp is
// newer.
class ReplayWindow {
 public:
  // Accepts the stamp if it is newer than all accepted before. Returns true if it was accepted.
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
