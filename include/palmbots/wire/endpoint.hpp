// SPDX-License-Identifier: Apache-2.0
// One end of the wire: what a robot or the station stores between packets, that is its identity,
// its own sequence numbers, the newest stamps received from the others, and counts of verdicts.
//
// A replay window is empty after every boot, so an attacker could replay packets from before the
// boot. Each packet therefore names the newest packet that its sender had received from the
// receiver, and a receiver acts only on packets that name one of its present epoch: these were sent
// after this boot. Other new packets get the verdict `no_session`; they only update the newest
// stamp of their sender. After a boot the first packet of each end is of that kind. The receiver
// replies with any packet (hello if there is nothing else to send), and both ends have a session
// after one round trip.
//
// So an accepted packet was sent by the partner, to this end, after this end's boot. It is accepted
// once and in the order of sending. It was sent after the packet named in `heard`. A receiver that
// stores when it sent that one can bound the age of the packet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/wire/packet.hpp"
#include "palmbots/wire/replay_window.hpp"

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
      : identity_(identity), next_{epoch, first} {}

  // Writes the next packet. Returns false and writes nothing if the packet is not well formed. That
  // is so for every packet once the sequence numbers of this epoch are used up.
  constexpr bool send(Role receiver, PacketKind kind, std::uint8_t payload, Bytes& bytes) {
    if (receiver > Role::station) return false;
    const Packet packet{kind,  identity_.role,  receiver, identity_.pair,
                        next_, heard(receiver), payload};
    if (!encode(packet, identity_.key, bytes)) return false;
    ++next_.sequence;
    return true;
  }

  // Sequence numbers may be skipped, so that they can be another count, such as control ticks. The
  // next packet gets this number, unless one as high has already been used.
  constexpr void skip_to(std::uint32_t sequence) {
    if (next_.sequence != 0 && sequence > next_.sequence) next_.sequence = sequence;
  }

  // Decodes a packet, checks whether it is to be acted upon, and counts the verdict. A packet
  // without a session is returned too, because it is its sender's newest. To keep acting on an
  // older one would mean acting on a message that the sender may have forgotten in a boot
  // (wire/codec.hpp, `hear`).
  constexpr Decoded receive(std::span<const std::uint8_t> bytes) {
    Decoded decoded = decode(bytes, identity_.key, identity_.pair, identity_.role);
    if (decoded.verdict == Verdict::accepted) {
      decoded.verdict = judge(decoded.packet);
      if (decoded.verdict == Verdict::stale) decoded.packet = {};
    }
    ++counts_[static_cast<std::size_t>(decoded.verdict)];
    return decoded;
  }

  constexpr std::uint32_t count(Verdict verdict) const {
    return counts_[static_cast<std::size_t>(verdict)];
  }

  // The newest stamp that this end has received from another since its own boot.
  constexpr const SequenceNumber& heard(Role other) const {
    return windows_[static_cast<std::size_t>(other)].newest();
  }

 private:
  constexpr Verdict judge(const Packet& packet) {
    ReplayWindow& window = windows_[static_cast<std::size_t>(packet.sender)];
    if (!window.accept(packet.sent)) return Verdict::stale;
    // Epoch 0 is no boot. An end that has not counted its boot must not act on packets whose sender
    // had not received anything from it.
    const bool answers = packet.heard.epoch == next_.epoch && packet.heard != SequenceNumber{};
    return answers ? Verdict::accepted : Verdict::no_session;
  }

  Identity identity_;
  SequenceNumber next_;
  std::array<ReplayWindow, role_count> windows_{};
  std::array<std::uint32_t, verdict_count> counts_{};
};

}  // namespace palmbots::wire
