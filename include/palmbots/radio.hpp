// A radio link: latency, jitter and loss; a first-in-first-out line that never reorders.
//
// Time is counted in control ticks. A message sent at tick k is there for the receiver at tick
// k + ⌈(latency + jitter u)/T⌉, u uniform in [0, 1), at least one tick later and not before the
// message sent ahead of it.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/philox.hpp"

namespace palmbots {

// How a link delays and loses.
struct Channel {
  double latency_ticks = 0;
  double jitter_ticks = 0;
  std::uint64_t loss_words = 0;  // of 2³²

  static constexpr Channel of(double latency_s, double jitter_s, double loss, double period_s) {
    return {latency_s / period_s, jitter_s / period_s,
            static_cast<std::uint64_t>(loss * 4294967296.0)};
  }

  constexpr bool is_random() const { return loss_words > 0 || jitter_ticks > 0; }
  constexpr bool loses(const Words& words) const { return words[0] < loss_words; }

  // 0.07 / 0.01 is a little more than 7: a billionth of a tick is rounding, not delay.
  constexpr std::uint32_t ticks(const Words& words) const {
    const double delay = latency_ticks + jitter_ticks * unit_uniform<double>(words[1]) - 1e-9;
    const auto whole = static_cast<std::uint32_t>(delay > 0 ? delay : 0);
    return delay > whole ? whole + 1 : (whole > 0 ? whole : 1);
  }
};

// Longest delay in ticks that a link can hold, one message a tick.
inline constexpr std::uint32_t max_delay_ticks = 240;

template <class Payload>
class Link {
 public:
  // Returns the tick of arrival, or 0 if the message is lost. A full line loses the message.
  std::uint32_t send(std::uint32_t now, Payload payload, const Channel& channel,
                     const Words& words) {
    if (channel.loses(words) || tail_ - head_ == capacity) return 0;
    const std::uint32_t due = now + channel.ticks(words);
    last_due_ = due > last_due_ ? due : last_due_;
    line_[tail_ % capacity] = {last_due_, payload};
    ++tail_;
    return last_due_;
  }

  // The oldest message that has arrived, or null.
  const Payload* oldest(std::uint32_t now) const {
    if (head_ == tail_ || line_[head_ % capacity].due > now) return nullptr;
    return &line_[head_ % capacity].payload;
  }

  void pop() { ++head_; }

  // When the oldest message that is still on its way arrives; never, if none is.
  std::uint32_t next_arrival(std::uint32_t now) const {
    constexpr std::uint32_t never = ~0U;
    if (head_ == tail_) return never;
    const std::uint32_t due = line_[head_ % capacity].due;
    return due > now ? due : never;
  }

  // For periodic state packets: takes all that have arrived and copies the newest to `state`.
  // Returns whether there was one.
  bool newest(std::uint32_t now, Payload& state) {
    bool any = false;
    while (const Payload* packet = oldest(now)) {
      state = *packet;
      any = true;
      pop();
    }
    return any;
  }

 private:
  static constexpr std::uint32_t capacity = 256;
  static_assert(capacity > max_delay_ticks);

  struct Waiting {
    std::uint32_t due;
    Payload payload;
  };
  std::array<Waiting, capacity> line_;  // deliberately not cleared: head_ and tail_ say what counts
  std::uint32_t head_ = 0;
  std::uint32_t tail_ = 0;
  std::uint32_t last_due_ = 0;
};

}  // namespace palmbots
