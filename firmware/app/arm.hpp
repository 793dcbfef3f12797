// SPDX-License-Identifier: Apache-2.0
// The arm of a robot that does jobs on the floor: a servo that raises the pivot of the palm. The arm is
// where its pulse has commanded it; nothing measures it.
//
// Heights are counted in 1/256 µs of the pulse, upward from where the nose of a steep palm is on the
// floor. Steps are those of the table that lifts (palmbots/control/lifting.hpp).
#pragma once

#include <cstdint>

#include "palmbots/control/lifting.hpp"
#include "settings.hpp"

namespace palmbots::app {

class Arm {
 public:
  // `edge`: what was stored (below). An arm that `is_new` begins where its job does: low, or up with the
  // object.
  Arm(const Settings& settings, std::uint8_t edge, bool is_new) : settings_(settings) {
    sense_ = settings.arm_top_us >= settings.arm_floor_us[0] ? 1 : -1;
    const std::int32_t stored = std::int32_t{edge} * step();
    const bool is_up = is_new && !is_job(settings, Job::begins_low);
    height_ = is_up || stored > top() ? top() : stored;
    rises_ = height_ == top();
  }

  // One tick: what the arm does, and the palm's commanded angle.
  void move(ArmMove arm, Palm palm, std::uint16_t elapsed) {
    const std::int32_t floor = height_of(settings_.arm_floor_us[static_cast<std::size_t>(palm)]);
    const std::int32_t most = std::int32_t{settings_.arm_slew} * elapsed;
    is_there_ = true;
    switch (arm) {
      case ArmMove::follow: height_ = floor; break;
      case ArmMove::reach:  // for stands, which `palmbots firmware` refuses
      case ArmMove::hold: break;
      case ArmMove::rise:
        height_ = top() - height_ > most ? height_ + most : top();
        is_there_ = height_ == top();
        rises_ = true;
        break;
      case ArmMove::sink:
        height_ = height_ - floor > most ? height_ - most : floor;
        is_there_ = height_ == floor;
        rises_ = false;
        break;
    }
    if (height_ < floor) height_ = floor;
  }

  // The arm has reached the height last commanded. The floor is at the height for the angle to which the
  // palm turns, so an arm that sinks is down once the palm has turned.
  bool is_there(bool has_turned) const { return is_there_ && (has_turned || rises_); }
  std::uint8_t steps() const {
    return static_cast<std::uint8_t>(height_ > 0 ? height_ / step() : 0);
  }
  // The end of the present step from which the arm has come: there it goes on after a boot. The partner's
  // arm is at most a step from there. An arm that is up goes on at the top.
  std::uint8_t edge() const {
    const bool is_below = rises_ && height_ != top();
    return static_cast<std::uint8_t>(steps() + (is_below || height_ <= 0 ? 0 : 1));
  }
  // [µs]
  std::uint16_t pulse() const {
    return static_cast<std::uint16_t>(settings_.arm_floor_us[0] + sense_ * (height_ / 256));
  }

 private:
  std::int32_t height_of(std::uint16_t pulse) const {
    return 256 * sense_ * (std::int32_t{pulse} - std::int32_t{settings_.arm_floor_us[0]});
  }
  std::int32_t top() const { return height_of(settings_.arm_top_us); }
  std::int32_t step() const {
    const auto step = static_cast<std::int32_t>(settings_.arm_step);
    return step > 0 ? step : 1;
  }

  const Settings& settings_;
  std::int32_t sense_;
  std::int32_t height_;
  bool is_there_ = false;
  bool rises_;  // it has moved upward last
};

}  // namespace palmbots::app
