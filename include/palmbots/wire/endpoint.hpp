// SPDX-License-Identifier: Apache-2.0
// One end of the wire, what a robot or the station keeps between packets: who it is, how far its
// own numbers are, what it has heard of the others, and how many packets it took or turned away.
//
// A window starts empty at every boot, so a stranger could play back what was sent before it. So
// each packet names the newest that its sender had heard from the receiver, and a receiver acts
// only on packets that name one of its present epoch: these were sent after this boot. Others, if
// new, are `no_session`: all they do is make their sender heard. After a boot the first packet of
// each end is such a one; whoever gets it sends something back, hello if there is nothing else to
// say, and the two are on speaking terms after one round trip.
//
// So what an end accepts was sent by the partner, to this end, after this end's boot, and is
// accepted once and in the order of sending. It was sent after `heard`, so that a receiver who
// remembers when it sent that knows how old the packet can be at most.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/wire/packet.hpp"
#include "palmbots/wire/replay_window.hpp"

namespace palmbots::wire {

struct Identity {
  Key key;
  std::uint16_t pair;
  Role role;
};

class Endpoint {
 public:
  // At a boot: the epoch counts the boots, this one included, and is already in permanent memory.
  constexpr Endpoint(const Identity& identity, std::uint32_t epoch, std::uint32_t first = 1)
      : identity_(identity), next_{epoch, first} {}

  // Writes the next packet. False, and nothing written, if it is not well formed, as every packet
  // is when the numbers of this epoch are used up.
  constexpr bool send(Role receiver, PacketKind kind, std::uint8_t payload, Bytes& bytes) {
    if (receiver > Role::station) return false;
    const Packet packet{kind,  identity_.role,  receiver, identity_.pair,
                        next_, heard(receiver), payload};
    if (!encode(packet, identity_.key, bytes)) return false;
    ++next_.sequence;
    return true;
  }

  // Numbers may be left out, so that they can be a count of something else, as control ticks: the
  // next packet bears this number, unless one as high has been used already.
  constexpr void skip_to(std::uint32_t sequence) {
    if (next_.sequence != 0 && sequence > next_.sequence) next_.sequence = sequence;
  }

  // What a packet says, if it is to be acted upon; counts it in any case. An unanswered one is
  // given too: its sender's newest word, and whoever goes on acting on an older one acts on a word
  // that the sender may have forgotten in a boot (wire/codec.hpp, `hear`).
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

  // The newest that this end has heard of another since its own boot.
  constexpr const SequenceNumber& heard(Role other) const {
    return windows_[static_cast<std::size_t>(other)].newest();
  }

 private:
  constexpr Verdict judge(const Packet& packet) {
    ReplayWindow& window = windows_[static_cast<std::size_t>(packet.sender)];
    if (!window.accept(packet.sent)) return Verdict::stale;
    // Epoch 0 is no boot: whoever has not counted it must not act on what was said to nobody.
    const bool answers = packet.heard.epoch == next_.epoch && packet.heard != SequenceNumber{};
    return answers ? Verdict::accepted : Verdict::no_session;
  }

  Identity identity_;
  SequenceNumber next_;
  std::array<ReplayWindow, role_count> windows_{};
  std::array<std::uint32_t, verdict_count> counts_{};
};

}  // namespace palmbots::wire
