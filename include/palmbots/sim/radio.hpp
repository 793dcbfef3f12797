// SPDX-License-Identifier: Apache-2.0
// The radio between robots and station: sends messages over links and counts them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "palmbots/base/side.hpp"
#include "palmbots/control/centralized.hpp"
#include "palmbots/sim/corruption.hpp"
#include "palmbots/sim/radio_channel.hpp"
#include "palmbots/sim/random_streams.hpp"

namespace palmbots {

// One message, for the log. A message that is lost or arrives damaged has received == 0.
struct SentMessage {
  std::uint32_t sent;
  std::uint32_t received;
  std::uint8_t sender;
  std::uint8_t receiver;
  MessageKind kind;
  bool is_hello = false;  // it only answers a packet that had no session; `kind` is none
};

// The names that the log uses.
constexpr const char* name_of(const SentMessage& message) {
  return message.is_hello ? "Hello" : name_of(message.kind);
}

// True for the content of a packet that a robot sends to the station.
template <class Payload>
inline constexpr bool goes_to_station = std::is_same_v<Payload, Centralized::Report>;

// Counts of messages. Every message that is not lost counts as delivered, and so does each copy,
// damaged or not.
struct LinkCounts {
  std::uint32_t sent = 0;
  std::uint32_t lost = 0;
  std::uint32_t duplicated = 0;
  std::uint32_t late = 0;      // received by the resilient algorithm, but too old to count
  std::uint32_t rejected = 0;  // damaged, stale, or (but for beacons) without a session

  constexpr void operator+=(const LinkCounts& that) {
    sent += that.sent;
    lost += that.lost;
    duplicated += that.duplicated;
    late += that.late;
    rejected += that.rejected;
  }
};

// Counts of messages over all links, and for each link.
struct LinkTotals {
  std::uint32_t sent = 0;
  std::uint32_t lost = 0;
  // In this order: from the left robot, from the right one, from the station to the left one, to
  // the right one.
  std::array<LinkCounts, 4> links{};

  constexpr void operator+=(const LinkTotals& that) {
    sent += that.sent;
    lost += that.lost;
    for (std::size_t i = 0; i < links.size(); ++i) links[i] += that.links[i];
  }
};

// A team's access to the radio: posts messages on links and counts them. Two stations that send in
// one tick do so at random instants of it. If their messages overlap, both are lost.
class Radio {
 public:
  Radio(const Channel& channel, std::uint64_t seed, std::size_t leader)
      : channel_(channel),
        plain_delay_(channel.is_plain() ? channel.longest() : 0),
        seed_(seed),
        leader_(leader) {}

  std::size_t leader() const { return leader_; }

  // Continues with the random numbers of another seed.
  void fork(std::uint64_t seed) { seed_ = seed; }

  // The delay of every message [ticks], if all have the same delay and the only disturbance is
  // loss; else 0.
  std::uint32_t steady_delay() const { return channel_.is_steady() ? channel_.longest() : 0; }
  // A message is lost if a 32-bit random word is below this number.
  std::uint64_t loss_words() const { return channel_.loss_words; }

  // To be called before a tick's messages: true if those of two stations that both send in it
  // collide.
  bool collide(std::uint32_t tick) const {
    if (channel_.airtime_ticks <= 0) return false;
    const Words words = draw(seed_, tick, Stream::collision);
    const double apart = unit_uniform<double>(words[0]) - unit_uniform<double>(words[1]);
    return (apart < 0 ? -apart : apart) < channel_.airtime_ticks;
  }

  // Sends from `sender` (0, 1: robots, 2: station) to a robot or to the station. Returns the tick
  // of arrival, or 0 if the message is lost.
  template <class Payload>
  std::uint32_t post(Link<Payload>& link, std::uint32_t tick, const Payload& payload,
                     std::size_t sender, std::size_t robot, bool collides,
                     LinkTotals& link_totals) const {
    LinkCounts& counts = link_totals.links[robot + (sender == 2 ? 2 : 0)];
    ++link_totals.sent;
    ++counts.sent;
    if (plain_delay_ > 0 && link.has_room()) return link.put(tick + plain_delay_, payload);
    if (channel_.fates != nullptr) [[unlikely]]
      return post_recorded(link, tick, payload, sender, robot, collides, link_totals);
    if (channel_.has_directions) {
      return post(link, tick, payload, sender, robot, collides, link_totals, channel_.from(sender));
    }
    return post(link, tick, payload, sender, robot, collides, link_totals, channel_);
  }

 private:
  // The same with the fate of a recorded packet, once the message is counted. Out of line: it would
  // slow down the radios of all other carries.
  template <class Payload>
  [[gnu::noinline]] std::uint32_t post_recorded(Link<Payload>& link, std::uint32_t tick,
                                                const Payload& payload, std::size_t sender,
                                                std::size_t robot, bool collides,
                                                LinkTotals& link_totals) const {
    const Channel own = channel_.from(sender);
    const Words words = draw(seed_, 0, Stream::radio_trace, lane(sender, robot));
    const double delay = link.fate(tick, *own.fates, own.period, words[0]);
    return post(link, tick, payload, sender, robot, collides, link_totals, own.with_fate(delay));
  }

  // The leading robot has the first lane, so that the mirrored carry draws the mirrored numbers.
  std::uint32_t lane(std::size_t sender, std::size_t robot) const {
    return (robot == leader_ ? 0U : 1U) + (sender == 2 ? 2U : 0U);
  }

  // The same on the link of this sender, once the message is counted.
  template <class Payload>
  std::uint32_t post(Link<Payload>& link, std::uint32_t tick, const Payload& payload,
                     std::size_t sender, std::size_t robot, bool collides, LinkTotals& link_totals,
                     const Channel& channel) const {
    LinkCounts& counts = link_totals.links[robot + (sender == 2 ? 2 : 0)];
    const std::uint32_t own = lane(sender, robot);
    const Words words =
        channel.is_random() ? draw(seed_, tick, Stream::radio, own) : Words{~0U, 0, 0, ~0U};
    // The attacker hears every packet, whatever becomes of it on its way.
    if (channel.replay_words > 0) replay(link, tick, payload, channel, own, counts);
    const MessageFault* message_fault =
        channel.message_fault(robot + (sender == 2 ? 2 : 0), counts.sent);
    const bool lost = message_fault != nullptr && message_fault->effect == MessageEffect::lost;
    const bool late = message_fault != nullptr && message_fault->effect == MessageEffect::late;
    if (collides || lost || channel.is_dead(static_cast<std::uint32_t>(sender), tick) ||
        !link.takes(tick, channel, words)) {
      ++link_totals.lost;
      ++counts.lost;
      return 0;
    }
    std::uint32_t received = 0;
    if (channel.corrupt_words > 0 && damages(payload, tick, sender, robot, own, counts.sent)) {
      ++counts.rejected;
    } else {
      received = link.put(late ? tick + message_fault->late : tick, payload, channel, words);
    }
    if (channel.duplicate_words > 0 && link.send_copy(tick, payload, channel, words)) {
      ++counts.duplicated;
    }
    if (message_fault != nullptr && message_fault->effect == MessageEffect::copied) {
      link.send_again(tick + message_fault->late, payload, channel, words);
      ++counts.duplicated;
    }
    return received;
  }

  template <class Payload>
  void replay(Link<Payload>& link, std::uint32_t tick, const Payload& payload,
              const Channel& channel, std::uint32_t lane, LinkCounts& counts) const {
    const Words words = draw(seed_, tick, Stream::replay, lane);
    if (words[0] >= channel.replay_words) return;
    const auto late =
        1 + static_cast<std::uint32_t>(unit_uniform<double>(words[1]) * channel.replay_ticks);
    if (link.replay(tick + channel.longest() + late, payload)) ++counts.duplicated;
  }

  // True if the message arrives damaged and is rejected. The message is encoded as a packet, some
  // of its bytes are replaced by noise, and the receiver's decoder reads the result.
  template <class Payload>
  bool damages(const Payload& payload, std::uint32_t tick, std::size_t sender, std::size_t robot,
               std::uint32_t lane, std::uint32_t number) const {
    const Words words = draw(seed_, tick, Stream::corruption, lane);
    if (words[0] >= channel_.corrupt_words) return false;
    if constexpr (std::is_same_v<Payload, wire::Bytes>) {
      // From a program that runs elsewhere, under a key that only the robots know: damage is
      // rejected, up to one packet in 2⁶⁴.
      return true;
    } else {
      const std::size_t receiver =
          goes_to_station<Payload> ? 2 : (sender == 2 ? robot : other(sender));
      const wire::PacketHeader header{
          static_cast<wire::Role>(sender), static_cast<wire::Role>(receiver), 0, {1, number}, {}};
      return damaged(packet_of(payload, header), words) != wire::Verdict::accepted;
    }
  }

  Channel channel_;
  std::uint32_t plain_delay_;
  std::uint64_t seed_;
  std::size_t leader_;
};

}  // namespace palmbots
