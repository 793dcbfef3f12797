// SPDX-License-Identifier: Apache-2.0
// Teams: the interface of controllers and radio to a carry, which passes observations to the team
// every tick and gets commands.
//
// The teams are two robots that decide by themselves (sim/robot_team.hpp), two robots and a station
// (sim/centralized_team.hpp), and no controller (sim/no_controller.hpp).
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "palmbots/base/side.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/sim/radio.hpp"

namespace palmbots {

// A team's observation of one robot at a tick.
struct RobotObservation {
  Sign sign;
  bool palm_at_target;  // the palm has reached the angle last commanded

  constexpr bool operator==(const RobotObservation&) const = default;
};

// A correction as seen from outside: its case, and who takes part. Where the robots agree by
// messages, nobody assists at the start: the partner joins later, or never (Metrics).
struct CorrectionActivity {
  static constexpr std::int8_t nobody = -1;
  static constexpr std::int8_t both = 2;

  char name = ' ';             // 'a'–'d' or '1'–'8'; ' ': none
  std::int8_t robot = nobody;  // whose contact is corrected: 0, 1 or both
  std::int8_t assistant = nobody;
  PerSide<std::int8_t> sense{};  // of each contact: +1 positive, −1 negative, 0 left alone

  constexpr bool concerns(std::size_t side) const {
    return robot == both || robot == static_cast<std::int8_t>(side);
  }
};

// The interface of every team.
template <class T>
concept Team =
    requires(T team, const T& known, std::uint32_t tick, const PerSide<RobotObservation>& sensed,
             void (*log)(const SentMessage&), std::uint64_t seed, std::size_t side) {
      // True if both robots move, at half the correction speed each.
      { known.half_moves } -> std::convertible_to<bool>;
      // True if the team assumes that a palm it has just commanded is not yet at its target in the
      // next tick. In that case only a palm that *is* at its target wakes the controllers.
      { known.expects_turns } -> std::convertible_to<bool>;
      { known.link_totals } -> std::convertible_to<LinkTotals>;
      // One tick: turns observations into commands. `log` is called for every message that is sent.
      { team.step(tick, sensed, log) } -> std::convertible_to<PerSide<Command>>;
      // The next tick at which the team acts even if the observations stay the same.
      { known.next_decision_tick(tick) } -> std::same_as<std::uint32_t>;
      // The carry ends before this tick: counts the messages of ticks that had no step.
      team.close(tick);
      // Continues with the random numbers of another seed.
      team.fork(seed);
      { known.name(side) } -> std::same_as<char>;  // the case, ' ': none
      { known.waits(side) } -> std::same_as<bool>;
      { known.awaits(side) } -> std::same_as<MessageKind>;
      { known.activity(side) } -> std::same_as<CorrectionActivity>;
    };

// What a robot corrects in a case of Table 2. In (c) it assists and makes no correction of its own.
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

// The command of a robot while its program does not run: its wheels stop, its palm stays.
inline Command switched_off(const Command& before) { return {before.palm, Move::hold, true}; }

// True if the controllers of a team measure time.
template <class Team>
bool measures_time(const Team& team) {
  if constexpr (requires { team.has_clock; }) return team.has_clock;
  return false;
}

// States whether a robot corrects where it stands, to controllers for which that makes a difference.
template <class Team>
void set_in_place(Team& team, std::size_t side, bool in_place) {
  if constexpr (requires { team.set_in_place(side, in_place); }) {
    team.set_in_place(side, in_place);
  } else if constexpr (requires { team.wake(side).set_in_place(in_place); }) {
    if (team.robot(side).is_in_place() != in_place) team.wake(side).set_in_place(in_place);
  }
}

}  // namespace palmbots
