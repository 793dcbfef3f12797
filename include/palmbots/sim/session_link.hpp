// SPDX-License-Identifier: Apache-2.0
// Sessions over the simulated radio: the ends of a link stamp what they send and judge what arrives,
// with the class that the endpoints of robots use (wire/endpoint.hpp).
//
// A packet is judged when it arrives, not when a controller reads it. Copies and packets that were
// overtaken are stale. What a robot says before one round trip after its boot has no session. Such
// packets are dropped; one without a session is answered by the next packet to its sender, a hello
// if there is nothing else to send. Sessions are established before tick 0, as after arming.
#pragma once

#include <cstdint>

#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/radio.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots {

// A packet on a link: its content and the stamps of the wire.
template <class Content>
struct Stamped {
  Content content;
  bool is_hello = false;  // only an answer; its content is not used
  wire::SequenceNumber sent{};
  wire::SequenceNumber heard{};
};

template <class Content>
constexpr wire::Packet packet_of(const Stamped<Content>& packet, wire::PacketHeader header) {
  header.sent = packet.sent;
  header.heard = packet.heard;
  if (!packet.is_hello) return wire::packet_of(packet.content, header);
  return wire::packet_with(header, wire::PacketKind::hello, wire::payload_of(wire::Hello{}));
}

template <class Content>
inline constexpr bool goes_to_station<Stamped<Content>> = goes_to_station<Content>;

// One end of a link.
class SessionEnd {
 public:
  // The memory is lost, except for the number of boots.
  constexpr void boot() {
    session_ = wire::Session(session_.next().epoch + 1);
    must_answer_ = false;
  }

  template <class Content>
  constexpr Stamped<Content> stamp(const Content& content, bool is_hello = false) {
    const Stamped<Content> packet{content, is_hello, session_.next(), session_.heard()};
    session_.advance();
    must_answer_ = false;
    return packet;
  }

  // True if the packet is to be acted upon.
  template <class Content>
  constexpr bool accepts(const Stamped<Content>& packet) {
    const wire::Verdict verdict = session_.receive(packet.sent, packet.heard);
    if (verdict == wire::Verdict::no_session) must_answer_ = true;
    return verdict == wire::Verdict::accepted;
  }

  // True if a packet without a session has come since this end last sent.
  constexpr bool must_answer() const { return must_answer_; }

 private:
  wire::Session session_{1};
  bool must_answer_ = false;
};

// A packet in each direction, after which both ends accept each other's next packet.
constexpr void establish(SessionEnd& one, SessionEnd& other) {
  other.accepts(one.stamp(true));
  one.accepts(other.stamp(true));
}

// True if the verdicts can differ: a packet may come twice, be overtaken, or be sent or received
// after a boot. Otherwise every packet that arrives is accepted and need not be judged.
inline bool needs_sessions(const Channel& channel, const Faults& faults) {
  return channel.has_sessions && (!channel.keeps_order() || faults.any());
}

// Takes in the packets that have arrived, in order of arrival, and calls act(content) for those to
// be acted upon: all of them, or those that the receiving end accepts. Returns true if none was
// rejected.
template <class Content, class Act>
bool receive(Link<Stamped<Content>>& link, std::uint32_t tick, bool judges, SessionEnd& end,
             LinkCounts& counts, Act&& act) {
  if (!judges) {
    for (; const Stamped<Content>* packet = link.oldest(tick); link.pop()) act(packet->content);
    return true;
  }
  bool all_accepted = true;
  for (; const Stamped<Content>* packet = link.oldest(tick); link.pop()) {
    if (!end.accepts(*packet)) {
      ++counts.rejected;
      all_accepted = false;
    } else if (!packet->is_hello) {
      act(packet->content);
    }
  }
  return all_accepted;
}

}  // namespace palmbots
