// SPDX-License-Identifier: Apache-2.0
// Radio channel: latency and jitter, single losses and bursts, copies, reordering, dead directions,
// and collisions of two stations that send at once.
//
// Time is counted in control ticks. A message sent at tick k is available to the receiver at tick k
// + ⌈(latency + jitter u)/T⌉, with u uniform in [0, 1). That is at least one tick later and, unless
// the link reorders, not before the message sent ahead of it.
//
// Bursts are Gilbert's two-state process in continuous time. A link is dead for periods of mean
// length m, and for a share s of the time, regardless of how often messages are sent. Observed Δ
// later, a link that was dead (x = 1) or not (x = 0) is dead with probability s + (x − s) e^(−Δ/((1
// − s) m)). Sources: E. N. Gilbert, "Capacity of a burst-noise channel", 1960; E. O. Elliott, 1963.
// Losses while a link is not dead are Elliott's addition (`loss`).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/scalar.hpp"
#include "palmbots/sim/recorded_traces.hpp"

namespace palmbots {

// A period, from one tick until before another, in which no message of this sender arrives.
struct Outage {
  std::uint32_t sender = 0;  // 0: the left robot, 1: the right one, 2: the station
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

inline constexpr std::size_t max_outages = 16;

// A scheduled fault of one message: it is lost, delayed, or duplicated with a delay.
enum class MessageEffect : std::uint32_t { lost = 0, late = 1, copied = 2 };

// A scheduled fault of one message.
struct MessageFault {
  // 0: from the left robot, 1: from the right one, 2: from the station to the left one, 3: to the
  // right one
  std::uint32_t link = 0;
  std::uint32_t message = 0;  // number among all on this link, from 1
  MessageEffect effect = MessageEffect::lost;
  std::uint32_t late = 0;  // ticks in addition to the link's own delay
};

inline constexpr std::size_t max_message_faults = 16;

// The delays and losses of what one sender transmits, if they are not those of all links.
struct Direction {
  double latency_ticks = 0;
  double jitter_ticks = 0;
  std::uint64_t loss_words = 0;  // of 2³²
};

// The delays and losses of a link.
struct Channel {
  double latency_ticks = 0;
  double jitter_ticks = 0;
  std::uint64_t loss_words = 0;       // of 2³²
  std::uint64_t duplicate_words = 0;  // of 2³²
  std::uint64_t corrupt_words = 0;    // of 2³²
  bool reorders = false;
  bool has_sessions = true;  // the ends of a link judge packets as the wire does
  double burst_share = 0;
  double burst_rate = 0;     // 1/((1 − s) m), per tick
  double airtime_ticks = 0;  // two messages of one tick collide if they are closer than this
  std::array<Outage, max_outages> outages{};
  std::size_t outage_count = 0;
  std::array<MessageFault, max_message_faults> message_faults{};
  std::size_t message_fault_count = 0;
  bool has_directions = false;
  std::array<Direction, 3> directions{};  // by sender, if has_directions
  std::uint64_t replay_words = 0;         // of 2³²
  double replay_ticks = 0;                // the longest time until a packet is sent again
  const RadioTrace* fates = nullptr;      // a recording that is replayed, or null
  double period = 0;                      // of a tick, for the recording [s]

  static constexpr Channel of(double latency_s, double jitter_s, double loss, double period_s) {
    Channel channel;
    channel.latency_ticks = latency_s / period_s;
    channel.jitter_ticks = jitter_s / period_s;
    channel.loss_words = words_of(loss);
    return channel;
  }

  // A probability as a threshold for 32-bit words.
  static constexpr std::uint64_t words_of(double rate) {
    return static_cast<std::uint64_t>(rate * 4294967296.0);
  }

  constexpr bool is_random() const {
    return loss_words > 0 || jitter_ticks > 0 || duplicate_words > 0 || burst_share > 0 ||
           has_directions || fates != nullptr;
  }
  // True if every message arrives, undamaged and once, after the same delay.
  constexpr bool is_plain() const { return !is_random() && is_steady(); }
  // The same, except that messages may be lost independently of each other.
  constexpr bool is_steady() const {
    const bool is_whole = corrupt_words == 0 && duplicate_words == 0;
    return is_whole && !(jitter_ticks > 0) && !(burst_share > 0) && !(airtime_ticks > 0) &&
           outage_count == 0 && message_fault_count == 0 && !has_directions && replay_words == 0 &&
           fates == nullptr;
  }
  // True if no message arrives twice or after one that was sent later.
  constexpr bool keeps_order() const {
    if (duplicate_words > 0 || reorders || replay_words > 0) return false;
    for (std::size_t i = 0; i < message_fault_count; ++i) {
      if (message_faults[i].effect == MessageEffect::copied) return false;
    }
    return true;
  }
  constexpr bool loses(const Words& words) const { return words[0] < loss_words; }

  constexpr bool is_dead(std::uint32_t sender, std::uint32_t tick) const {
    for (std::size_t i = 0; i < outage_count; ++i) {
      const Outage& o = outages[i];
      if (o.sender == sender && tick >= o.from && tick < o.to) return true;
    }
    return false;
  }

  // The scheduled fault of the n-th message on a link, or null.
  constexpr const MessageFault* message_fault(std::size_t link, std::uint32_t n) const {
    for (std::size_t i = 0; i < message_fault_count; ++i) {
      if (message_faults[i].link == link && message_faults[i].message == n)
        return &message_faults[i];
    }
    return nullptr;
  }

  constexpr std::uint32_t ticks(const Words& words) const {
    return ticks(unit_uniform<double>(words[1]));
  }

  // The delay for a share of the jitter [ticks]. A billionth of a tick is rounding, not delay: 0.07
  // / 0.01 is a little more than 7.
  constexpr std::uint32_t ticks(double share) const {
    const double delay = latency_ticks + jitter_ticks * share - 1e-9;
    const auto whole = static_cast<std::uint32_t>(delay > 0 ? delay : 0);
    return delay > whole ? whole + 1 : (whole > 0 ? whole : 1);
  }

  // The link of one sender.
  constexpr Channel from(std::size_t sender) const {
    Channel own = *this;
    if (!has_directions) return own;
    own.latency_ticks = directions[sender].latency_ticks;
    own.jitter_ticks = directions[sender].jitter_ticks;
    own.loss_words = directions[sender].loss_words;
    own.has_directions = false;
    return own;
  }

  // The link for a packet with a recorded fate: its delay [s], or RadioTrace::lost.
  Channel with_fate(double delay) const {
    Channel own = *this;
    own.fates = nullptr;
    own.burst_share = 0;
    own.loss_words = delay < 0 ? words_of(1) : 0;
    if (fates->kind == RadioTrace::none) return own;
    own.jitter_ticks = 0;
    if (fates->kind == RadioTrace::whole) own.latency_ticks = 0;
    if (delay > 0) own.latency_ticks += delay / period;
    return own;
  }

  // The longest possible delay [ticks]; recorded ones may be longer.
  constexpr std::uint32_t longest() const {
    if (!has_directions) return ticks(1.0);
    std::uint32_t longest = 0;
    for (std::size_t sender = 0; sender < directions.size(); ++sender) {
      const std::uint32_t delay = from(sender).ticks(1.0);
      longest = delay > longest ? delay : longest;
    }
    return longest;
  }
};

// The longest delay that a link can hold, with one message per tick [ticks].
inline constexpr std::uint32_t max_delay_ticks = 240;

// The state of a link, apart from the messages under way.
struct LinkState {
  static constexpr std::uint32_t never = ~0U;

  std::uint32_t head_ = 0;
  std::uint32_t tail_ = 0;
  std::uint32_t first_due_ = never;  // when the oldest arrives
  std::uint32_t last_due_ = 0;
  std::uint32_t seen_ = 0;  // the tick at which the burst process was last evaluated
  std::uint32_t fate_ = 0;  // of the recorded packets, counted from where the recording begins
  bool observed_ = false;
  bool burst_ = false;
};

// One direction of a radio connection: a queue of messages under way, in order of arrival. Only
// these are copied with a link, because the queue is much larger than most need.
template <class Payload>
class Link : LinkState {
 public:
  Link() = default;
  Link(const Link& that) : LinkState(that) { copy_messages(that); }
  Link& operator=(const Link& that) {
    if (this == &that) return *this;
    LinkState::operator=(that);
    copy_messages(that);
    return *this;
  }

  // Returns the tick of arrival, or 0 if the message is lost. A full queue loses the message.
  std::uint32_t send(std::uint32_t now, Payload payload, const Channel& channel,
                     const Words& words) {
    return takes(now, channel, words) ? put(now, payload, channel, words) : 0;
  }

  // True if a message that is sent now will arrive: no burst, no loss, and room in the queue.
  bool takes(std::uint32_t now, const Channel& channel, const Words& words) {
    if (channel.burst_share > 0 && in_burst(now, channel, words[2])) return false;
    return !channel.loses(words) && has_room();
  }

  // The recorded fate of a packet that is sent now: that of the packet which was sent as long after
  // the first one, but never the same one twice. `word` draws where the recording begins.
  double fate(std::uint32_t now, const RadioTrace& fates, double period, std::uint32_t word) {
    const auto at = static_cast<std::uint32_t>(now * period / fates.interval + 1e-6);
    fate_ = at > fate_ ? at : fate_;
    const std::size_t count = fates.delays.size();
    return fates.delays[(place_of(word, count) + std::size_t{fate_++}) % count];
  }

  bool has_room() const { return tail_ - head_ < capacity; }

  // Queues a message that will arrive. Returns the tick of arrival.
  std::uint32_t put(std::uint32_t now, const Payload& payload, const Channel& channel,
                    const Words& words) {
    return put(now + channel.ticks(words), payload, channel.reorders);
  }

  // The same, with a given tick of arrival.
  std::uint32_t put(std::uint32_t due, const Payload& payload) { return put(due, payload, false); }

  // Sends a scheduled copy of the message. Later messages wait for it, unless the link reorders.
  void send_again(std::uint32_t now, Payload payload, const Channel& channel, const Words& words) {
    if (has_room()) put(now + channel.ticks(words), payload, channel.reorders);
  }

  // Sends a copy of the message if it is duplicated by chance, and returns true if so. The position
  // of the word below the threshold is uniform, so it serves as a further draw.
  bool send_copy(std::uint32_t now, Payload payload, const Channel& channel, const Words& words) {
    if (words[3] >= channel.duplicate_words || !has_room()) return false;
    const double share = double(words[3]) / double(channel.duplicate_words);
    put(now + channel.ticks(share), payload, channel.reorders);
    return true;
  }

  // Puts a recorded message among those under way. It delays no other one.
  bool replay(std::uint32_t due, const Payload& payload) {
    if (tail_ - head_ > capacity / 2) return false;
    put(due, payload, true);
    return true;
  }

  // The oldest message that has arrived, or null.
  const Payload* oldest(std::uint32_t now) const {
    if (first_due_ > now || head_ == tail_) return nullptr;
    return &at(head_).payload;
  }

  void pop() {
    ++head_;
    first_due_ = head_ == tail_ ? never : at(head_).due;
  }

  // The tick at which the oldest message still under way arrives, or `never`. No other message
  // arrives before it, because the queue is in order of arrival.
  std::uint32_t next_arrival(std::uint32_t now) const {
    return first_due_ > now ? first_due_ : never;
  }

  // The i-th of the messages that have arrived, from 0, or null.
  const Payload* arrived(std::uint32_t now, std::uint32_t i) const {
    if (i >= tail_ - head_) return nullptr;
    const Waiting& waiting = at(head_ + i);
    return waiting.due <= now ? &waiting.payload : nullptr;
  }

  // Discards everything that has arrived while the receiver was off.
  void drop(std::uint32_t now) {
    while (oldest(now) != nullptr) pop();
  }

 private:
  static constexpr std::uint32_t capacity = 256;
  static_assert(capacity > max_delay_ticks);

  struct Waiting {
    std::uint32_t due;
    Payload payload;
  };
  // A place in the queue, not initialized until a message is put there.
  union Place {
    Waiting waiting;
    Place() {}
  };
  static_assert(std::is_trivially_copyable_v<Waiting>);

  void copy_messages(const Link& that) {
    for (std::uint32_t place = head_; place != tail_; ++place) at(place) = that.at(place);
  }

  const Waiting& at(std::uint32_t place) const { return line_[place % capacity].waiting; }
  Waiting& at(std::uint32_t place) { return line_[place % capacity].waiting; }

  bool in_burst(std::uint32_t now, const Channel& channel, std::uint32_t word) {
    const double share = channel.burst_share;
    // Before the first message the state of the burst process is unknown.
    const double memory = observed_ ? exp_minus(channel.burst_rate * double(now - seen_)) : 0.0;
    const double chance = share + ((burst_ ? 1.0 : 0.0) - share) * memory;
    observed_ = true;
    seen_ = now;
    burst_ = unit_uniform<double>(word) < chance;
    return burst_;
  }

  std::uint32_t put(std::uint32_t due, const Payload& payload, bool reorders) {
    if (!reorders) last_due_ = due = due > last_due_ ? due : last_due_;
    std::uint32_t place = tail_++;
    for (; place != head_ && at(place - 1).due > due; --place) at(place) = at(place - 1);
    at(place) = {due, payload};
    if (place == head_) first_due_ = due;
    return due;
  }

  std::array<Place, capacity> line_;  // head_ and tail_ delimit the valid part
};

}  // namespace palmbots
