// SPDX-License-Identifier: Apache-2.0
// A session: what one end of the wire remembers about another end, without the bytes. It numbers
// the packets to that end and decides which of its packets are acted upon.
//
// It accepts only stamps (wire/packet.hpp) that are higher than all before. What it remembers is empty after every boot, so an attacker could replay packets from before the
// boot. Each packet therefore names the newest packet that its sender had received from the
// receiver, and a receiver acts only on packets that name one of its present epoch: these were sent
// after this boot. Other new packets get the verdict `no_session`; they only update the newest
// stamp of their sender. After a boot the first packet of each end is of that kind. The receiver
// replies with any packet (hello if there is nothing else to send), and both ends have a session
// after one round trip.
//
// The simulated radio, which passes messages on without encoding them, uses the same class as the
// endpoints of robots (wire/endpoint.hpp).
#pragma once

#include <cstdint>

#include "palmbots/wire/packet.hpp"

namespace palmbots::wire {

// The verdict on the stamps of a packet.
enum class Freshness : std::uint8_t {
  accepted,
  stale,       // older than the newest, or a repetition of it
  no_session,  // new, but not sent in answer to this end's present boot
};

// One end's memory of another.
class Session {
 public:
  // To be called at a boot of this end, with the number of its boots.
  constexpr explicit Session(std::uint32_t epoch = 0, std::uint32_t first = 1)
      : next_{epoch, first} {}

  // The stamp of the next packet to the other end. Its sequence is 0 once the numbers of this epoch
  // are used up; such a packet must not be sent.
  constexpr const SequenceNumber& next() const { return next_; }

  // The next packet has been sent.
  constexpr void advance() {
    if (next_.sequence != 0) ++next_.sequence;
  }

  // Sequence numbers may be skipped, so that they can be another count, such as control ticks. The
  // next packet gets this number, unless one as high has already been used.
  constexpr void skip_to(std::uint32_t sequence) {
    if (next_.sequence != 0 && sequence > next_.sequence) next_.sequence = sequence;
  }

  // Judges a packet that came from the other end, and remembers its stamp if it is new. `heard` is
  // the newest packet of this end that its sender knew.
  constexpr Freshness receive(const SequenceNumber& sent, const SequenceNumber& heard) {
    if (sent <= newest_) return Freshness::stale;
    newest_ = sent;
    if (heard.epoch > claimed_epoch_) claimed_epoch_ = heard.epoch;
    // Epoch 0 is no boot. An end that has not counted its boot must not act on packets whose sender
    // had not received anything from it.
    const bool answers = heard.epoch == next_.epoch && heard != SequenceNumber{};
    return answers ? Freshness::accepted : Freshness::no_session;
  }

  // The newest stamp received from the other end since this end's boot.
  constexpr const SequenceNumber& heard() const { return newest_; }

  // The highest epoch of this end that the other end has named. If it exceeds the present one, this
  // end's counter of boots is behind: it runs elsewhere too, or on another machine than before.
  constexpr std::uint32_t claimed_epoch() const { return claimed_epoch_; }

 private:
  SequenceNumber next_;
  SequenceNumber newest_;
  std::uint32_t claimed_epoch_ = 0;
};

}  // namespace palmbots::wire
