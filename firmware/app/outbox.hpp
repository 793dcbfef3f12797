// SPDX-License-Identifier: Apache-2.0
// The packets of a tick. The first leaves at a random instant of the tick, the others follow it. With
// equal clocks, two boards that sent at fixed instants would collide for minutes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../board/board.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots::app {

class Outbox {
 public:
  // `seed` is a number that nobody can predict.
  Outbox(std::uint32_t period_us, std::uint32_t seed) : period_us_(period_us), state_(seed | 1) {}

  // A tick begins. The work of the tick, before its packets are released, is part of it.
  void begin_tick() { began_us_ = board::now_us(); }
  // Forgets what has not left: it is older than what comes now.
  void clear() { count_ = sent_ = 0; }
  void add(const wire::Bytes& bytes) {
    board::RadioPacket& packet = packets_[count_++];
    packet.size = static_cast<std::uint8_t>(bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) packet.bytes[i] = bytes[i];
  }
  std::size_t count() const { return count_; }
  // Lets them leave within this tick.
  void release() {
    if (count_ == 0) return;
    // Marsaglia's xorshift.
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    const std::uint32_t span = period_us_ - static_cast<std::uint32_t>(count_) * airtime_us;
    const auto instant = static_cast<std::uint32_t>(std::uint64_t{state_} * span >> 32);
    const std::uint32_t passed = board::now_us() - began_us_;
    board::set_alarm(instant > passed + least_us ? instant - passed : least_us);
  }
  // The instant has come.
  void send_next() {
    if (sent_ < count_ && board::send(packets_[sent_])) ++sent_;
  }
  // To be called whenever the radio may have finished.
  void go_on() {
    if (sent_ > 0 && !board::is_sending()) send_next();
  }

 private:
  // A packet takes 0.34 ms on the air and 0.29 ms for the ramps of the radio; the rest is reserve.
  static constexpr std::uint32_t airtime_us = 1000;
  static constexpr std::uint32_t least_us = 100;

  std::uint32_t period_us_;
  std::uint32_t state_;
  std::uint32_t began_us_ = 0;
  std::size_t count_ = 0;
  std::size_t sent_ = 0;
  board::RadioPacket packets_[wire::role_count + 1];
};

}  // namespace palmbots::app
