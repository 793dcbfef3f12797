// SPDX-License-Identifier: Apache-2.0
// Beacons: what two robots send over a radio that loses, duplicates, delays and reorders, and which
// beacons count.
//
// A beacon carries a message and a stamp of when it was sent: the boot epoch and the sender's own
// count of ticks since boot, which serves as sequence number. It also carries an *echo*: the newest
// stamp that the sender had received from its partner. The echo serves three purposes:
//   * Liveness: if my beacons do not arrive, the partner's echo stops advancing, so both robots
//     know.
//   * Age: a beacon that echoes what I sent at my tick s was sent after s. By my own clock it is
//     at most now − s old. No delay bound is trusted and no clocks are compared.
//   * Acknowledgement: it states which of my messages the partner knew when it sent the beacon.
// Only the newest beacon counts. An older one that arrives later, or a duplicate, is rejected. A
// reboot raises the epoch and outdates everything sent before it. Time is in control ticks.
#pragma once

#include <cstdint>

#include "palmbots/control/messages.hpp"

namespace palmbots {

// When something was sent: the sender's boot epoch, and the tick since that boot.
struct BeaconStamp {
  std::uint32_t epoch = 0;  // 0: never
  std::uint32_t tick = 0;

  constexpr bool after(const BeaconStamp& that) const {
    return epoch > that.epoch || (epoch == that.epoch && tick > that.tick);
  }
};

// A beacon: the sender's message and readiness, with its stamp and echo.
struct Beacon {
  MessageKind message = MessageKind::none;
  bool stopped = false;  // the sender does not travel
  bool ready = false;    // no condition keeps it from travelling
  BeaconStamp sent;
  BeaconStamp heard;  // the newest stamp received from the partner
};

// Age reported before any beacon was received; it always exceeds the lease [ticks].
inline constexpr std::uint16_t unknown_age = 0xFFFF;

// Receives the partner's beacons and stamps this robot's own.
class BeaconReceiver {
 public:
  // `epoch` counts the boots of this robot from 1. It must be stored where it survives a reboot.
  // `tick` is the time since the boot [ticks].
  constexpr explicit BeaconReceiver(std::uint32_t epoch, std::uint32_t tick = 0)
      : now_{epoch, tick} {}

  constexpr void tick(std::uint16_t elapsed) { now_.tick += elapsed; }

  // Accepts a beacon if it is newer than all before it. Returns true if it was accepted.
  constexpr bool accept(const Beacon& beacon) {
    if (!beacon.sent.after(newest_.sent)) return false;
    newest_ = beacon;
    return true;
  }

  constexpr const Beacon& newest() const { return newest_; }

  // Upper bound on the time since the newest beacon was sent [ticks].
  constexpr std::uint16_t age() const {
    if (newest_.heard.epoch != now_.epoch || newest_.heard.tick > now_.tick) return unknown_age;
    const std::uint32_t age = now_.tick - newest_.heard.tick;
    return age < unknown_age ? static_cast<std::uint16_t>(age) : unknown_age;
  }

  // The beacon to send now.
  constexpr Beacon beacon(MessageKind message, bool stopped, bool ready) const {
    return {message, stopped, ready, now_, newest_.sent};
  }

 private:
  BeaconStamp now_;
  Beacon newest_;
};

}  // namespace palmbots
