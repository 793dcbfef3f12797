// SPDX-License-Identifier: Apache-2.0
// The arm of a board (firmware/app/arm.hpp) after boots: on its way up and down it goes on at the end of
// its step from which it has come, and boots without a motion between them do not move it.
#include <cstdint>

#include "../../../firmware/app/arm.hpp"
#include "support/check.hpp"

namespace {

using namespace palmbots;
using app::Arm;
using app::Job;

// The arm touches at 1300 µs and is up at 1900 µs, 100 µs are a step, and a tick moves it by 2 µs.
app::Settings settings() {
  app::Settings made{};
  made.arm_floor_us[0] = made.arm_floor_us[1] = 1000;
  made.arm_low_us[0] = made.arm_low_us[1] = 1200;
  made.arm_clear_us = 1400;
  made.arm_top_us = 1900;
  made.arm_slew = 2 * 256;
  made.arm_step = 100 * 256;
  made.job = static_cast<std::uint8_t>(Job::lifts) | static_cast<std::uint8_t>(Job::begins_low) |
             static_cast<std::uint8_t>(Job::from_stand) |
             static_cast<std::uint8_t>(Job::onto_stand);
  return made;
}

// The pulses before a boot after so many ticks of rising, or of sinking from the top, and after it.
struct Pulses {
  std::uint16_t before;
  std::uint16_t after;
};
Pulses boots(bool rises, int ticks, int boots) {
  const app::Settings made = settings();
  Arm arm(made, {}, true);
  const auto move = [&](ArmMove motion, int count) {
    for (int i = 0; i < count; ++i) arm.move(motion, Palm::steep, false, 1);
  };
  move(ArmMove::reach, 50);
  move(ArmMove::hold, 1);
  CHECK(arm.pulse() == 1300 && arm.steps() == 0);
  move(ArmMove::rise, rises ? ticks : 300);
  if (!rises) move(ArmMove::sink, ticks);
  app::StoredArm stored = arm.stored();
  for (int i = 1; i < boots; ++i) stored = Arm(made, stored, false).stored();
  return {arm.pulse(), Arm(made, stored, false).pulse()};
}

void check_boots(int count) {
  constexpr int rounding = 2;  // of the height at which the palm touched [µs]
  for (int ticks = 1; ticks < 300; ++ticks) {
    const Pulses up = boots(true, ticks, count), down = boots(false, ticks, count);
    CHECK(up.after <= up.before + rounding && up.before < up.after + 100 + rounding);
    CHECK(down.after + rounding >= down.before && down.after < down.before + 100 + rounding);
  }
}

// At the end of the job, steps count from below the object there. A robot that has restarted does not
// know at once that it is there, and holds.
void check_end() {
  const app::Settings made = settings();
  for (int ticks = 1; ticks < 400; ++ticks) {
    Arm arm(made, {7, 64, false}, false);
    for (int i = 0; i < ticks; ++i) arm.move(ArmMove::sink, Palm::steep, true, 1);
    app::StoredArm stored = arm.stored();
    const std::uint16_t first = Arm(made, stored, false).pulse();
    for (int i = 0; i < 3; ++i) {
      Arm again(made, stored, false);
      again.move(ArmMove::hold, Palm::steep, false, 1);
      CHECK(again.pulse() == first);
      stored = again.stored();
    }
    CHECK(first >= arm.pulse() && first <= arm.pulse() + 100);
  }
}

}  // namespace

int main() {
  for (const int count : {1, 2, 5}) check_boots(count);
  check_end();
}
