// SPDX-License-Identifier: Apache-2.0
// What two robots say over a radio that loses, doubles, delays and reorders, and which of it
// counts.
//
// A beacon carries a message, who sent it when (boot epoch, and the sender's own count of ticks
// since boot, which serves as sequence number), and an *echo*: the newest such pair that the sender
// had heard from its partner. The echo does three things at once:
//   * "I hear you": where the way out is dead, the partner's echo stands still, so both robots
//   know; * an age: a beacon that echoes what I sent at my tick s was sent after s. So it is at
//     most now − s old, by my own clock alone: no delay bound is trusted and no clocks are
//   compared; * an answer: it tells which of my messages the partner knew when it wrote.
// Only the newest beacon counts. An older one that comes later, or twice, is rejected; a reboot has
// a higher epoch and outdates all that was sent before. Time is in control ticks.
#pragma once

#include <cstdint>

#include "palmbots/control/messages.hpp"

namespace palmbots {

// When something was sent: in which life of the sender, and at which tick of it.
struct BeaconStamp {
  std::uint32_t epoch = 0;  // 0: never
  std::uint32_t tick = 0;

  constexpr bool after(const BeaconStamp& that) const {
    return epoch > that.epoch || (epoch == that.epoch && tick > that.tick);
  }
};

struct Beacon {
  MessageKind message = MessageKind::none;
  bool stopped = false;  // the sender does not travel
  bool ready = false;    // nothing keeps it from travelling
  BeaconStamp sent;
  BeaconStamp heard;  // the newest of the partner's that the sender had heard
};

// "Older than anything": an age that no lease reaches.
inline constexpr std::uint16_t unknown_age = 0xFFFF;

// The receiver of one robot.
class BeaconReceiver {
 public:
  // A robot in its `epoch`-th life, from 1: the number must outlive a reboot.
  constexpr explicit BeaconReceiver(std::uint32_t epoch) : now_{epoch, 0} {}

  constexpr void tick(std::uint16_t elapsed) { now_.tick += elapsed; }

  // Takes a beacon if it is newer than all before it, and says whether it was.
  constexpr bool accept(const Beacon& beacon) {
    if (!beacon.sent.after(newest_.sent)) return false;
    newest_ = beacon;
    return true;
  }

  constexpr const Beacon& newest() const { return newest_; }

  // For how long at most the newest beacon has been under way or here [ticks].
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
