// SPDX-License-Identifier: Apache-2.0
// How old what the station says is, as a robot can judge it with its own clock.
//
// A packet names the newest packet of its receiver that its sender had received. It was therefore
// sent after that one, and its age is at most the time since then. The numbers of packets to the
// station are no ticks, so the robot remembers when it sent one of them, the PROBE. As soon as the
// probe is acknowledged, the next packet becomes the probe. In this way two numbers and two ticks
// suffice. The bound exceeds a round trip by at most another one and the periods of both ends.
//
// Somebody in the middle without the key can delay packets but cannot make them look younger.
#pragma once

#include <cstdint>

#include "palmbots/runtime/mode_inputs.hpp"

namespace palmbots::runtime {

class AnswerAge {
 public:
  // A packet with this number was sent in this tick.
  constexpr void sent(std::uint32_t sequence, std::uint32_t tick) {
    if (probe_.sequence == 0) probe_ = {sequence, tick};
  }

  // An accepted packet acknowledges this number. Returns the tick before which it was not sent;
  // `never`: it may have any age, because an older packet has acknowledged a later number.
  constexpr std::uint32_t heard(std::uint32_t acknowledged) {
    if (probe_.sequence != 0 && acknowledged >= probe_.sequence) {
      answered_ = probe_;
      probe_ = {};
    }
    return acknowledged >= answered_.sequence ? answered_.tick : never;
  }

  // The tick before which the newest packet was not sent; `never`: there was none.
  constexpr std::uint32_t newest() const { return answered_.tick; }

 private:
  struct Sent {
    std::uint32_t sequence = 0;  // 0: none
    std::uint32_t tick = 0;
  };
  Sent probe_;
  Sent answered_{never, never};
};

}  // namespace palmbots::runtime
