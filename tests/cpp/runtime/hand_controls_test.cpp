// SPDX-License-Identifier: Apache-2.0
// What the two buttons of a board mean: in each mode, pressed alone or together, held for long, held
// while the board boots, and bouncing.
#include "palmbots/runtime/hand_controls.hpp"

#include <initializer_list>

#include "support/check.hpp"

namespace {

using namespace palmbots;
using runtime::Buttons;
using runtime::HandControls;
using runtime::HandWish;
using M = wire::RobotMode;
using O = wire::Operation;

bool is_nothing(const HandWish& wish) { return !wish.stop && !wish.operates; }

// The only wish in ten readings of these buttons.
HandWish wish_of(HandControls& controls, const Buttons& held, M mode) {
  HandWish found;
  int wishes = 0;
  for (int reading = 0; reading < 10; ++reading) {
    const HandWish wish = controls.step(held, mode);
    if (is_nothing(wish)) continue;
    CHECK(reading == 1);  // the second that agrees
    found = wish;
    ++wishes;
  }
  CHECK(wishes <= 1);
  return found;
}

struct Meaning {
  M mode;
  bool stops;  // each button
  bool a_operates;
  O a;
  bool b_operates;
  O b;
};
constexpr Meaning meanings[] = {
    {M::ready, true, false, {}, false, {}},
    {M::carrying, true, false, {}, false, {}},
    {M::holding, true, false, {}, false, {}},
    {M::armed, false, true, O::disarm, true, O::start},
    {M::stopped, false, true, O::release, false, {}},
    {M::disarmed, false, true, O::arm, false, {}},
    {M::done, false, true, O::arm, false, {}},
    {M::fault, false, true, O::arm, false, {}},
    {M::off, false, false, {}, false, {}},
};

void a_press_is_one_wish() {
  for (const Meaning& meaning : meanings) {
    HandControls controls;
    CHECK(is_nothing(wish_of(controls, {true, true}, meaning.mode)));  // since the boot
    CHECK(is_nothing(wish_of(controls, {false, false}, meaning.mode)));
    for (const Buttons held : {Buttons{true, false}, Buttons{false, true}, Buttons{true, true}}) {
      const bool operates = held.a ? meaning.a_operates : meaning.b_operates;
      const HandWish wish = wish_of(controls, held, meaning.mode);
      CHECK(wish.stop == meaning.stops && wish.operates == operates);
      if (operates) CHECK(wish.operation == (held.a ? meaning.a : meaning.b));
      CHECK(is_nothing(wish_of(controls, {false, false}, meaning.mode)));
    }
    // The other button is pressed while one is held.
    wish_of(controls, {true, false}, meaning.mode);
    const HandWish second = wish_of(controls, {true, true}, meaning.mode);
    CHECK(second.stop == meaning.stops && second.operates == meaning.b_operates);
  }
}

// Neither it nor the other one counts before both have been released.
void a_button_stuck_since_the_boot_means_nothing() {
  for (const Meaning& meaning : meanings) {
    HandControls controls;
    for (const Buttons held : {Buttons{true, false}, Buttons{true, true}, Buttons{true, false}}) {
      CHECK(is_nothing(wish_of(controls, held, meaning.mode)));
    }
  }
}

void a_button_that_bounces_means_nothing() {
  HandControls controls;
  wish_of(controls, {false, false}, M::ready);
  for (int reading = 0; reading < 20; ++reading) {
    CHECK(is_nothing(controls.step({reading % 2 == 0, false}, M::ready)));
  }
}

}  // namespace

int main() {
  a_press_is_one_wish();
  a_button_stuck_since_the_boot_means_nothing();
  a_button_that_bounces_means_nothing();
}
