// SPDX-License-Identifier: Apache-2.0
// How controllers and radio are wired together: what every team provides. The teams are two robots
// that exchange messages (sim/distributed_team.hpp), two and a station (sim/centralized_team.hpp),
// two that broadcast beacons (sim/resilient_team.hpp), and none (sim/no_controller.hpp). A carry
// gives a team the signs and the state of the palms every tick and gets commands.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "palmbots/base/side.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/sim/radio.hpp"

namespace palmbots {

// What a team sees of one robot at a tick.
struct RobotObservation {
  Sign sign;
  bool palm_at_target;  // the palm has reached the angle last commanded

  constexpr bool operator==(const RobotObservation&) const = default;
};

// A correction as far as it shows from outside: its case, and who takes part. Where the robots
// agree by messages nobody assists when it starts: the partner comes in later, or never (Metrics).
struct CorrectionActivity {
  static constexpr std::int8_t nobody = -1;
  static constexpr std::int8_t both = 2;

  char name = ' ';             // 'a'–'d' or '1'–'8'; ' ': none
  std::int8_t robot = nobody;  // whose contact is corrected: 0, 1 or both
  std::int8_t assistant = nobody;
  PerSide<std::int8_t> sense{};  // of each contact: +1 positive, −1 negative, 0 left alone
};

// What every team provides.
template <class T>
concept Team =
    requires(T team, const T& known, std::uint32_t tick, const PerSide<RobotObservation>& sensed,
             void (*log)(const SentMessage&), std::uint64_t seed, std::size_t side) {
      // Both robots move, at half the correction speed each.
      { T::half_moves } -> std::convertible_to<bool>;
      // Takes it that a palm that it commands to turn is not there yet in the next tick: then it is
      // news only if it is.
      { T::expects_turns } -> std::convertible_to<bool>;
      { known.link_totals } -> std::convertible_to<LinkTotals>;
      // One tick: observations to commands; log gets every message that is sent.
      { team.step(tick, sensed, log) } -> std::convertible_to<PerSide<Command>>;
      // The next tick at which it has something to do even if the robots sense what they sense now.
      { known.next_decision_tick(tick) } -> std::same_as<std::uint32_t>;
      // The carry ends before this tick: counts what went on in ticks that had no step.
      team.close(tick);
      // From here on the random numbers of another seed.
      team.fork(seed);
      { known.name(side) } -> std::same_as<char>;  // the case, ' ': none
      { known.waits(side) } -> std::same_as<bool>;
      { known.awaits(side) } -> std::same_as<MessageKind>;
      { known.activity(side) } -> std::same_as<CorrectionActivity>;
    };

// What a robot in a case of Table 2 corrects. (c) assists and is no correction of its own.
inline CorrectionActivity activity_of(char name, std::size_t side) {
  PerSide<std::int8_t> sense{};
  const auto self = static_cast<std::int8_t>(side);
  switch (name) {
    case 'a':
    case 'b': sense[side] = 1; return {name, self, CorrectionActivity::nobody, sense};
    case 'd': sense[side] = -1; return {name, self, CorrectionActivity::nobody, sense};
    default: return {};
  }
}

// What a robot does while its program does not run: its wheels stop, its palm stays.
inline Command switched_off(const Command& before) { return {before.palm, Move::hold, true}; }

}  // namespace palmbots
