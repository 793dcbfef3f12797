// SPDX-License-Identifier: Apache-2.0
// One end of the wire: its identity, a session with each other end (wire/session.hpp), and counts
// of verdicts.
//
// An accepted packet was sent by the partner, to this end, after this end's boot. It is accepted
// once and in the order of sending. It was sent after the packet named in `heard`. A receiver that
// stores when it sent that one can bound the age of the packet.
//
// Packets to each receiver have a sequence of their own. Between robots it is the control tick
// (`skip_to`), so an acknowledgement gives an age; packets to the station leave no gaps in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/wire/packet.hpp"
#include "palmbots/wire/session.hpp"

namespace palmbots::wire {

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
        sessions_{Session(epoch, first), Session(epoch, first), Session(epoch, first)} {}

  // Writes the next packet. Returns false and writes nothing if the packet is not well formed. That
  // is so for every packet to this receiver once the sequence numbers of this epoch are used up.
  constexpr bool send(Role receiver, PacketKind kind, const Payload& payload, Bytes& bytes) {
    if (receiver > Role::station) return false;
    Session& session = sessions_[static_cast<std::size_t>(receiver)];
    const Packet packet{kind,           identity_.role,  receiver, identity_.pair,
                        session.next(), session.heard(), payload};
    if (!encode(packet, identity_.key, bytes)) return false;
    session.advance();
    return true;
  }

  // The stamp of the newest packet to this receiver; its sequence is 0 if there is none.
  constexpr SequenceNumber newest(Role receiver) const {
    const SequenceNumber& next = session(receiver).next();
    return {next.epoch, next.sequence - 1};
  }

  // Sequence numbers may be skipped, so that they can be another count, such as control ticks. The
  // next packet to this receiver gets this number, unless one as high has already been used.
  constexpr void skip_to(Role receiver, std::uint32_t sequence) {
    sessions_[static_cast<std::size_t>(receiver)].skip_to(sequence);
  }

  // Decodes a packet, checks whether it is to be acted upon, and counts the verdict. Every authentic
  // packet is returned: statistics and logs need its sender and stamp. One without a session is its
  // sender's newest. To keep acting on an older one would mean acting on a message that the sender
  // may have forgotten in a boot (runtime/robot_program.hpp, `hear`).
  constexpr Decoded receive(std::span<const std::uint8_t> bytes) {
    Decoded decoded = decode(bytes, identity_.key, identity_.pair, identity_.role);
    if (decoded.verdict == Verdict::accepted) decoded.verdict = judge(decoded.packet);
    ++counts_[static_cast<std::size_t>(decoded.verdict)];
    return decoded;
  }

  constexpr std::uint32_t count(Verdict verdict) const {
    return counts_[static_cast<std::size_t>(verdict)];
  }

  // The newest stamp that this end has received from another since its own boot.
  constexpr const SequenceNumber& heard(Role other) const { return session(other).heard(); }

  constexpr const Session& session(Role other) const {
    return sessions_[static_cast<std::size_t>(other)];
  }

  constexpr const Identity& identity() const { return identity_; }

 private:
  constexpr Verdict judge(const Packet& packet) {
    Session& session = sessions_[static_cast<std::size_t>(packet.sender)];
    switch (session.receive(packet.sent, packet.heard)) {
      case Freshness::stale: return Verdict::stale;
      case Freshness::no_session: return Verdict::no_session;
      case Freshness::accepted: break;
    }
    return Verdict::accepted;
  }

  Identity identity_;
  std::array<Session, role_count> sessions_;
  std::array<std::uint32_t, verdict_count> counts_{};
};

}  // namespace palmbots::wire
