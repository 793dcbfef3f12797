// SPDX-License-Identifier: Apache-2.0
// What the robots of many carries sense and are commanded, a bit a robot; what becomes of their
// messages; and the teams that there are for many carries at once.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "palmbots/batch/bitslice.hpp"
#include "palmbots/control/transition_table.hpp"

namespace palmbots {

class Metrics;
struct LinkTotals;

// What robots sense, and what they are told.
struct BitslicedObservation : Observation<RobotMask> {
  BitslicedObservation& operator|=(const BitslicedObservation& more) {
    positive |= more.positive;
    negative |= more.negative;
    palm_at_target |= more.palm_at_target;
    return *this;
  }

  // Signs that are false: the next one is read, of −, 0, +, −, …, if that is so once; else the one
  // after.
  void falsify(RobotMask wrong, RobotMask once) {
    const RobotMask zero = ~(positive | negative);
    const RobotMask then_positive = (once & zero) | (~once & negative);
    const RobotMask then_negative = (once & positive) | (~once & zero);
    positive = (positive & ~wrong) | (then_positive & wrong);
    negative = (negative & ~wrong) | (then_negative & wrong);
  }
};

// Whose program does not run, which leaves its robot at rest; and whose runs for the first time
// since.
struct BitslicedProgramState {
  RobotMask off{};
  RobotMask booting{};
};

// Whose messages are lost if they are sent now: those of the robots, and those of the station to
// them.
struct BitslicedLoss {
  RobotMask from_robot{};
  RobotMask from_station{};
};

struct BitslicedCommand {
  RobotMask shallow{};  // otherwise steep
  RobotMask away{};
  RobotMask closer{};  // otherwise hold
  RobotMask stop{};

  void erase(RobotMask whose) {
    for (RobotMask* one : {&shallow, &away, &closer, &stop}) *one &= ~whose;
  }
  // As switched_off().
  void switch_off(RobotMask whose) {
    away &= ~whose;
    closer &= ~whose;
    stop |= whose;
  }
  // The carries in which they are others.
  CarryMask differ(const BitslicedCommand& than) const {
    return either((shallow ^ than.shallow) | (away ^ than.away) | (closer ^ than.closer) |
                  (stop ^ than.stop));
  }
};

// How long the messages of each carry take, where they all take the same time.
class BitslicedDelay {
 public:
  // May be that long [ticks].
  static constexpr std::uint32_t longest = 63;
  static constexpr bool supports(std::uint32_t delay) { return delay > 0 && delay <= longest; }

  void insert(int i, std::uint32_t delay) {
    of_[delay] |= both_at(i);
    there_are_ |= CarryMask{1} << delay;
  }
  void erase(int i) {
    for (std::uint32_t d = 0; d <= longest; ++d) {
      of_[d] &= ~both_at(i);
      if (either(of_[d]) == 0) there_are_ &= ~(CarryMask{1} << d);
    }
  }

  // Calls visit(row, whose) for every delay that there is: the row of a line, a ring of longest + 1
  // rows, at which what is sent in this tick arrives, and whose messages do.
  template <class Visit>
  void each(std::uint64_t tick, Visit&& visit) const {
    for_each_bit(there_are_, [&](int delay) {
      const auto d = static_cast<std::size_t>(delay);
      visit((tick + d) % (longest + 1), of_[d]);
    });
  }

 private:
  std::array<RobotMask, longest + 1> of_{};
  CarryMask there_are_ = 0;  // bit d: some take d ticks
};

// The teams of 64 carries at once, where there are such for a kind of team. Of one that exists
// there are supports(team): whether such a team can decide in bits; insert(i, team): from its first
// tick on as carry i; erase(i): its carry is over; step(): one tick of all, which returns the
// carries whose commands are new; write_results(): what is known of carry i after so many ticks.
template <class Team>
struct BitslicedTeam {
  static constexpr bool exist = false;
};

template <class Bitsliced, class Team>
concept DecidesInBits =
    requires(Bitsliced teams, const Bitsliced& known, const Team& team, int i, std::uint64_t tick,
             const BitslicedObservation& sensed, const BitslicedProgramState& programs,
             const BitslicedLoss& lost, std::uint32_t ticks, Metrics& metrics, LinkTotals& totals) {
      { Bitsliced::exist } -> std::convertible_to<bool>;
      { Bitsliced::can_stop } -> std::convertible_to<bool>;  // whether robots are ever commanded to
      { Bitsliced::station } -> std::convertible_to<bool>;   // whether there is one
      { Bitsliced::supports(team) } -> std::same_as<bool>;
      teams.insert(i, team);
      teams.erase(i);
      { teams.step(tick, sensed, programs, lost) } -> std::same_as<CarryMask>;
      { known.commands() } -> std::same_as<const BitslicedCommand&>;
      known.write_results(i, ticks, metrics, totals);
    };

}  // namespace palmbots
