// SPDX-License-Identifier: Apache-2.0
// One end of the wire: its identity, a session with each other end, and counts of verdicts.
//
// A SESSION is what one end remembers about another. It numbers the packets to that end and decides
// which of its packets are acted upon: only those with stamps (wire/packet.hpp) higher than all
// before. What it remembers is empty after every boot, so an attacker could replay packets from
// before the boot. Each packet therefore names the newest packet that its sender had received from
// the receiver, and a receiver acts only on packets that name one of its present epoch: these were
// sent after this boot. Other new packets get the verdict `no_session`; they only update the newest
// stamp of their sender. After a boot the first packet of each end is of that kind. The receiver
// replies with any packet (hello if there is nothing else to send), and both ends have a session
// after one round trip. The simulated radio, which passes messages on without encoding them, uses
// the same class (sim/session_link.hpp).
//
// An accepted packet was thus sent by the partner, to this end, after this end's boot. It is accepted
// once and in the order of sending. It was sent after the packet named in `heard`. A receiver that
// stores when it sent that one can bound the age of the packet.
//
// Packets to each receiver have a sequence of their own. Between robots it is the control tick
// (`skip_to`), so an acknowledgement gives an age; packets to the station leave no gaps in it.
// Phases of a job on the floor have a session of their own beside that of the controllers: both may
// be sent in one tick, and either may overtake the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/wire/packet.hpp"

namespace palmbots::wire {

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
  // the newest packet of this end that its sender knew. Returns accepted, stale or no_session.
  constexpr Verdict receive(const SequenceNumber& sent, const SequenceNumber& heard) {
    if (sent <= newest_) return Verdict::stale;
    newest_ = sent;
    if (heard.epoch > claimed_epoch_) claimed_epoch_ = heard.epoch;
    // Epoch 0 is no boot. An end that has not counted its boot must not act on packets whose sender
    // had not received anything from it.
    const bool answers = heard.epoch == next_.epoch && heard != SequenceNumber{};
    return answers ? Verdict::accepted : Verdict::no_session;
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

// The identity of an end: the key and number of its pair, and its role.
struct Identity {
  Key key;
  std::uint16_t pair;
  Role role;
};

// One end of the wire.
class Endpoint {
 public:
  // To be called at a boot. The epoch counts the boots, including this one, and is already stored
  // in permanent memory.
  constexpr Endpoint(const Identity& identity, std::uint32_t epoch, std::uint32_t first = 1)
      : identity_(identity),
        sessions_{Session(epoch, first), Session(epoch, first), Session(epoch, first),
                  Session(epoch, first)} {}

  // Writes the next packet. Returns false and writes nothing if the packet is not well formed. That
  // is so for every packet to this receiver once the sequence numbers of this epoch are used up.
  constexpr bool send(Role receiver, PacketKind kind, const Payload& payload, Bytes& bytes) {
    if (receiver > Role::station) return false;
    Session& session = sessions_[index(receiver, kind)];
    const Packet packet{kind,           identity_.role,  receiver, identity_.pair,
                        session.next(), session.heard(), payload};
    if (!encode(packet, identity_.key, bytes)) return false;
    session.advance();
    return true;
  }

  // The stamp of the newest packet to this receiver; its sequence is 0 if there is none.
  constexpr SequenceNumber newest(Role receiver, PacketKind kind = PacketKind::hello) const {
    const SequenceNumber& next = session(receiver, kind).next();
    return {next.epoch, next.sequence - 1};
  }

  // Sequence numbers may be skipped, so that they can be another count, such as control ticks. The
  // next packet to this receiver gets this number, unless one as high has already been used.
  constexpr void skip_to(Role receiver, std::uint32_t sequence,
                         PacketKind kind = PacketKind::hello) {
    sessions_[index(receiver, kind)].skip_to(sequence);
  }

  // Decodes a packet, checks whether it is to be acted upon, and counts the verdict. Every authentic
  // packet is returned: statistics and logs need its sender and stamp. One without a session is its
  // sender's newest. To keep acting on an older one would mean acting on a message that the sender
  // may have forgotten in a boot (runtime/robot_program.hpp, `hear`).
  constexpr Decoded receive(std::span<const std::uint8_t> bytes) {
    Decoded decoded = decode(bytes, identity_.key, identity_.pair, identity_.role);
    if (decoded.verdict == Verdict::accepted) {
      const Packet& packet = decoded.packet;
      Session& session = sessions_[index(packet.sender, packet.kind)];
      decoded.verdict = session.receive(packet.sent, packet.heard);
    }
    ++counts_[static_cast<std::size_t>(decoded.verdict)];
    return decoded;
  }

  constexpr std::uint32_t count(Verdict verdict) const {
    return counts_[static_cast<std::size_t>(verdict)];
  }

  // The newest stamp that this end has received from another since its own boot.
  constexpr const SequenceNumber& heard(Role other) const { return session(other).heard(); }

  constexpr const Session& session(Role other, PacketKind kind = PacketKind::hello) const {
    return sessions_[index(other, kind)];
  }

  constexpr const Identity& identity() const { return identity_; }

 private:
  // A robot exchanges phases with its partner only.
  static constexpr std::size_t index(Role other, PacketKind kind) {
    return kind == PacketKind::phase ? role_count : static_cast<std::size_t>(other);
  }

  Identity identity_;
  std::array<Session, role_count + 1> sessions_;
  std::array<std::uint32_t, verdict_count> counts_{};
};

}  // namespace palmbots::wire
