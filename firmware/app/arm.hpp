// SPDX-License-Identifier: Apache-2.0
// The arm of a robot that does jobs on the floor or at stands: a servo that raises the pivot of the palm.
// The arm is where its pulse has commanded it; nothing measures it.
//
// Heights are counted in 1/256 µs of the pulse, upward from where the nose of a steep palm is on the
// floor. Steps are those of the table of the job (palmbots/control/lift_rules.hpp).
#pragma once

#include <cstdint>

#include "palmbots/control/lift_rules.hpp"
#include "settings.hpp"
#include "storage.hpp"

namespace palmbots::app {

class Arm {
 public:
  // An arm that `is_new` begins where its job does: low, or up with the object.
  Arm(const Settings& settings, const StoredArm& stored, bool is_new) : settings_(settings) {
    sense_ = settings.arm_top_us >= settings.arm_floor_us[0] ? 1 : -1;
    if (!is_new) {
      touched_ = stored.touched;
      ends_ = stored.ends;
    }
    lifted_from_ = low(false) + touched_ * share();
    moved_at_end_ = ends_;
    height_ = is_new ? low(false) : zero(ends_) + std::int32_t{stored.edge} * step();
    const bool is_up = is_new && !is_job(settings, Job::begins_low);
    if (is_up || height_ > top()) height_ = top();
    rises_ = height_ == top();
  }

  // One tick: what the arm does, the palm's commanded angle, and whether its lowest height is that at the
  // end of the job.
  void move(ArmMove arm, Palm palm, bool ends, std::uint16_t elapsed) {
    const std::int32_t floor = height_of(settings_.arm_floor_us[static_cast<std::size_t>(palm)]);
    const std::int32_t most = std::int32_t{settings_.arm_slew} * elapsed;
    ends_ = ends;
    if (arm != ArmMove::hold) moved_at_end_ = ends;
    const std::int32_t bottom = is_at_stand() && low(ends) > floor ? low(ends) : floor;
    is_there_ = true;
    switch (arm) {
      case ArmMove::follow: height_ = is_at_stand() ? nearer(bottom, most) : floor; break;
      case ArmMove::reach:
        if (height_ < clear()) height_ = nearer(clear(), most);
        lifted_from_ = height_;
        break;
      case ArmMove::hold: break;
      case ArmMove::rise:
        height_ = nearer(top(), most);
        is_there_ = height_ == top();
        rises_ = true;
        break;
      case ArmMove::sink:
        if (height_ > bottom) height_ = nearer(bottom, most);
        is_there_ = height_ <= bottom;
        rises_ = false;
        break;
    }
    if (height_ < floor) height_ = floor;
    // A height that changes in every tick is not stored in every tick.
    if (arm != ArmMove::reach) touched_ = (lifted_from_ - low(false) + share() / 2) / share();
  }

  // The arm has reached the height last commanded. The floor is at the height for the angle to which the
  // palm turns, so an arm that sinks is down once the palm has turned.
  bool is_there(bool has_turned) const {
    return is_there_ && (has_turned || rises_ || is_at_stand());
  }
  std::uint8_t steps() const {
    const std::int32_t above = height_ - zero(ends_);
    return static_cast<std::uint8_t>(above > 0 ? above / step() : 0);
  }
  // What is stored. Its `edge` is the end of the present step from which the arm has come: there it goes
  // on after a boot. The partner's arm is at most a step from there. An arm that is up goes on at the
  // top. It does not change while the arm holds, so boots do not move an arm that holds.
  StoredArm stored() const {
    const bool is_below = rises_ && height_ != top();
    const std::int32_t way = height_ - zero(moved_at_end_), above = way > 0 ? way : 0;
    const bool is_at_edge = is_below || above % step() == 0;
    const bool has_stand = is_job(settings_, Job::from_stand) || is_job(settings_, Job::onto_stand);
    return {static_cast<std::uint8_t>(above / step() + (is_at_edge ? 0 : 1)),
            static_cast<std::uint8_t>(touched_), has_stand && moved_at_end_};
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
  std::int32_t low(bool ends) const { return height_of(settings_.arm_low_us[ends ? 1 : 0]); }
  std::int32_t clear() const { return height_of(settings_.arm_clear_us); }
  // From where steps count.
  std::int32_t zero(bool ends) const { return ends ? low(true) : lifted_from_; }
  bool is_at_stand() const { return is_job(settings_, ends_ ? Job::onto_stand : Job::from_stand); }
  std::int32_t step() const {
    const auto step = static_cast<std::int32_t>(settings_.arm_step);
    return step > 0 ? step : 1;
  }
  // The unit of a stored height at which the palm touched the object.
  std::int32_t share() const { return (clear() - low(false)) / StoredArm::most_touched + 1; }
  // The next height on the way to another one.
  std::int32_t nearer(std::int32_t goal, std::int32_t most) const {
    const std::int32_t way = goal - height_;
    return height_ + (way > most ? most : way < -most ? -most : way);
  }

  const Settings& settings_;
  std::int32_t sense_;
  std::int32_t height_;
  std::int32_t lifted_from_;  // at which the palm touched the object
  std::int32_t touched_ = 0;  // the same above the lowest height, in shares
  bool ends_ = false;
  bool moved_at_end_ = false;  // the same when the arm moved last: it then holds, also over boots
  bool is_there_ = false;
  bool rises_;  // it has moved upward last
};

}  // namespace palmbots::app
