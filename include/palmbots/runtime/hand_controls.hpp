// SPDX-License-Identifier: Apache-2.0
// Two buttons on a robot: A arms and releases, B starts, and any button stops while anything may move.
//
// A button counts when it is pressed, not while it is held, and only after both have been seen
// released once. So a button that is held or stuck at power-up does nothing.
#pragma once

#include <cstdint>

#include "palmbots/wire/robot_mode.hpp"

namespace palmbots::runtime {

struct Buttons {
  bool a = false;
  bool b = false;

  constexpr bool operator==(const Buttons&) const = default;
};

// What the operator wants who has pressed a button.
struct HandWish {
  bool stop = false;  // as an e-stop
  bool operates = false;
  wire::Operation operation = wire::Operation::disarm;  // if `operates`
};

class HandControls {
 public:
  // Once per tick: which buttons are held, and the robot's mode. A button is held or released when
  // two readings in a row agree.
  constexpr HandWish step(const Buttons& read, wire::RobotMode mode) {
    const bool is_steady = read == read_;
    read_ = read;
    if (!is_steady) return {};
    const Buttons before = held_;
    held_ = read;
    if (!was_released_) {
      was_released_ = !read.a && !read.b;
      return {};
    }
    return wish(read.a && !before.a, read.b && !before.b, mode);
  }

 private:
  static constexpr HandWish wish(bool a, bool b, wire::RobotMode mode) {
    using M = wire::RobotMode;
    using O = wire::Operation;
    if (!a && !b) return {};
    switch (mode) {
      case M::ready:
      case M::carrying:
      case M::holding: return {true};
      case M::armed: return a ? HandWish{false, true, O::disarm} : HandWish{false, true, O::start};
      case M::stopped: return {false, a, O::release};
      case M::off: return {};
      case M::disarmed:
      case M::done:
      case M::fault: break;
    }
    return {false, a, O::arm};
  }

  Buttons read_{true, true};
  Buttons held_{true, true};
  bool was_released_ = false;
};

}  // namespace palmbots::runtime
