// SPDX-License-Identifier: Apache-2.0
// A radio as real ones are: latency and jitter, losses one by one and in bursts, copies, messages
// that overtake each other, dead directions, and collisions of two that send at once.
//
// Time is counted in control ticks. A message sent at tick k is there for the receiver at tick
// k + ⌈(latency + jitter u)/T⌉, u uniform in [0, 1), at least one tick later and, unless the link
// reorders, not before the message sent ahead of it.
//
// Bursts are Gilbert's two-state process in continuous time: a link is dead for spells of mean
// length m, and is so for a share s of the time, whoever sends how often. Seen Δ later, a link that
// was dead (x = 1) or not (x = 0) is dead with probability s + (x − s) e^(−Δ/((1 − s) m)).
// Source: E. N. Gilbert, "Capacity of a burst-noise channel", 1960; E. O. Elliott, 1963. What is
// lost while a link is not dead is Elliott's addition (`loss`).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/scalar.hpp"

namespace palmbots {

// Nothing that this station sends arrives, from one tick up to another.
struct Outage {
  std::uint32_t sender = 0;  // 0: the left robot, 1: the right one, 2: the station
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

inline constexpr std::size_t max_outages = 16;

// What befalls one message, by plan: it is lost, comes later, or comes once more later.
enum class MessageEffect : std::uint32_t { lost = 0, late = 1, copied = 2 };

struct MessageFault {
  std::uint32_t sender = 0;   // 0: the left robot, 1: the right one
  std::uint32_t message = 0;  // of all that it sends, from 1
  MessageEffect effect = MessageEffect::lost;
  std::uint32_t late = 0;  // ticks on top of the link's own delay
};

inline constexpr std::size_t max_message_faults = 16;

// How a link delays and loses.
struct Channel {
  double latency_ticks = 0;
  double jitter_ticks = 0;
  std::uint64_t loss_words = 0;       // of 2³²
  std::uint64_t duplicate_words = 0;  // of 2³²
  std::uint64_t corrupt_words = 0;    // of 2³²
  bool reorders = false;
  double burst_share = 0;
  double burst_rate = 0;     // 1/((1 − s) m), per tick
  double airtime_ticks = 0;  // two that send in one tick collide if they are closer than that
  std::array<Outage, max_outages> outages{};
  std::size_t outage_count = 0;
  std::array<MessageFault, max_message_faults> message_faults{};
  std::size_t message_fault_count = 0;

  static constexpr Channel of(double latency_s, double jitter_s, double loss, double period_s) {
    Channel channel;
    channel.latency_ticks = latency_s / period_s;
    channel.jitter_ticks = jitter_s / period_s;
    channel.loss_words = words_of(loss);
    return channel;
  }

  // A probability as a number of 32-bit words.
  static constexpr std::uint64_t words_of(double rate) {
    return static_cast<std::uint64_t>(rate * 4294967296.0);
  }

  constexpr bool is_random() const {
    return loss_words > 0 || jitter_ticks > 0 || duplicate_words > 0 || burst_share > 0;
  }
  // Does every message arrive, unharmed and once, after the same time?
  constexpr bool is_plain() const { return !is_random() && is_steady(); }
  // The same but for those that are lost, of which each is by itself?
  constexpr bool is_steady() const {
    const bool is_whole = corrupt_words == 0 && duplicate_words == 0;
    return is_whole && !(jitter_ticks > 0) && !(burst_share > 0) && !(airtime_ticks > 0) &&
           outage_count == 0 && message_fault_count == 0;
  }
  constexpr bool loses(const Words& words) const { return words[0] < loss_words; }

  constexpr bool is_dead(std::uint32_t sender, std::uint32_t tick) const {
    for (std::size_t i = 0; i < outage_count; ++i) {
      const Outage& o = outages[i];
      if (o.sender == sender && tick >= o.from && tick < o.to) return true;
    }
    return false;
  }

  // What befalls the n-th message of a robot, or null.
  constexpr const MessageFault* message_fault(std::size_t sender, std::uint32_t n) const {
    for (std::size_t i = 0; i < message_fault_count; ++i) {
      if (message_faults[i].sender == sender && message_faults[i].message == n)
        return &message_faults[i];
    }
    return nullptr;
  }

  constexpr std::uint32_t ticks(const Words& words) const {
    return ticks(unit_uniform<double>(words[1]));
  }

  // The delay at a share of the jitter. 0.07 / 0.01 is a little more than 7: a billionth of a tick
  // is rounding, not delay.
  constexpr std::uint32_t ticks(double share) const {
    const double delay = latency_ticks + jitter_ticks * share - 1e-9;
    const auto whole = static_cast<std::uint32_t>(delay > 0 ? delay : 0);
    return delay > whole ? whole + 1 : (whole > 0 ? whole : 1);
  }

  // The longest delay there is.
  constexpr std::uint32_t longest() const { return ticks(1.0); }
};

// Longest delay in ticks that a link can hold, one message a tick.
inline constexpr std::uint32_t max_delay_ticks = 240;

template <class Payload>
class Link {
 public:
  // Returns the tick of arrival, or 0 if the message is lost. A full line loses the message.
  std::uint32_t send(std::uint32_t now, Payload payload, const Channel& channel,
                     const Words& words) {
    return takes(now, channel, words) ? put(now, payload, channel, words) : 0;
  }

  // Whether a message that is sent now will arrive: no burst, no loss, and there is room.
  bool takes(std::uint32_t now, const Channel& channel, const Words& words) {
    if (channel.burst_share > 0 && in_burst(now, channel, words[2])) return false;
    return !channel.loses(words) && has_room();
  }

  bool has_room() const { return tail_ - head_ < capacity; }

  // Puts one that will on its way; returns the tick of arrival.
  std::uint32_t put(std::uint32_t now, const Payload& payload, const Channel& channel,
                    const Words& words) {
    return put(now + channel.ticks(words), payload, channel.reorders);
  }

  // The same, at a given tick.
  std::uint32_t put(std::uint32_t due, const Payload& payload) { return put(due, payload, false); }

  // The same message once more, by plan. What is sent later waits for it, unless the link reorders.
  void send_again(std::uint32_t now, Payload payload, const Channel& channel, const Words& words) {
    if (has_room()) put(now + channel.ticks(words), payload, channel.reorders);
  }

  // The same message once more, if it is doubled; returns whether it is. Of the words below the
  // threshold, where the word lies is as good as another draw.
  bool send_copy(std::uint32_t now, Payload payload, const Channel& channel, const Words& words) {
    if (words[3] >= channel.duplicate_words || !has_room()) return false;
    const double share = double(words[3]) / double(channel.duplicate_words);
    put(now + channel.ticks(share), payload, channel.reorders);
    return true;
  }

  // The oldest message that has arrived, or null.
  const Payload* oldest(std::uint32_t now) const {
    if (first_due_ > now || head_ == tail_) return nullptr;
    return &line_[head_ % capacity].payload;
  }

  void pop() {
    ++head_;
    first_due_ = head_ == tail_ ? never : line_[head_ % capacity].due;
  }

  // When the oldest message that is still on its way arrives; never, if none is. Nothing arrives
  // before it: the line is in order of arrival.
  std::uint32_t next_arrival(std::uint32_t now) const {
    return first_due_ > now ? first_due_ : never;
  }

  // Forgets all that has arrived: nobody listened.
  void drop(std::uint32_t now) {
    while (oldest(now) != nullptr) pop();
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
  static constexpr std::uint32_t never = ~0U;
  static constexpr std::uint32_t capacity = 256;
  static_assert(capacity > max_delay_ticks);

  struct Waiting {
    std::uint32_t due;
    Payload payload;
  };

  bool in_burst(std::uint32_t now, const Channel& channel, std::uint32_t word) {
    const double share = channel.burst_share;
    // Before the first message nothing is known.
    const double memory = told_ ? exp_minus(channel.burst_rate * double(now - seen_)) : 0.0;
    const double chance = share + ((burst_ ? 1.0 : 0.0) - share) * memory;
    told_ = true;
    seen_ = now;
    burst_ = unit_uniform<double>(word) < chance;
    return burst_;
  }

  std::uint32_t put(std::uint32_t due, const Payload& payload, bool reorders) {
    std::uint32_t place = tail_++;
    if (reorders) {
      for (; place != head_ && line_[(place - 1) % capacity].due > due; --place) {
        line_[place % capacity] = line_[(place - 1) % capacity];
      }
    } else {
      last_due_ = due = due > last_due_ ? due : last_due_;
    }
    Waiting& last = line_[place % capacity];
    last.due = due;
    last.payload = payload;
    if (place == head_) first_due_ = due;
    return due;
  }

  std::array<Waiting, capacity> line_;  // deliberately not cleared: head_ and tail_ say what counts
  std::uint32_t head_ = 0;
  std::uint32_t tail_ = 0;
  std::uint32_t first_due_ = never;  // when the oldest arrives
  std::uint32_t last_due_ = 0;
  std::uint32_t seen_ = 0;  // when the burst process was last looked at
  bool told_ = false;
  bool burst_ = false;
};

}  // namespace palmbots
