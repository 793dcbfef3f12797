// SPDX-License-Identifier: Apache-2.0
// Inputs and outputs of bit-sliced teams: observations, commands, losses and delays, with one bit
// for each robot, and the trait that states which teams exist in this form.
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

// The observations of the robots.
struct BitslicedObservation : Observation<RobotMask> {
  BitslicedObservation& operator|=(const BitslicedObservation& more) {
    positive |= more.positive;
    negative |= more.negative;
    palm_at_target |= more.palm_at_target;
    return *this;
  }

  // Replaces the signs of the robots in `wrong` by a false one. In the cyclic order −, 0, +, − it
  // is the next sign where `once` is set, else the one after it.
  void falsify(RobotMask wrong, RobotMask once) {
    const RobotMask zero = ~(positive | negative);
    const RobotMask then_positive = (once & zero) | (~once & negative);
    const RobotMask then_negative = (once & positive) | (~once & zero);
    positive = (positive & ~wrong) | (then_positive & wrong);
    negative = (negative & ~wrong) | (then_negative & wrong);
  }
};

// Robots whose program does not run, so that they rest, and robots whose program runs for the first
// time since.
struct BitslicedProgramState {
  RobotMask off{};
  RobotMask booting{};
};

// Loss of messages that are sent now: those of the robots, and those of the stations to them.
struct BitslicedLoss {
  RobotMask from_robot{};
  RobotMask from_station{};
};

// The commands of the robots. The palm is steep and the wheels hold where no bit is set.
struct BitslicedCommand {
  RobotMask shallow{};  // otherwise steep
  RobotMask away{};
  RobotMask closer{};  // otherwise hold
  RobotMask stop{};

  void erase(RobotMask whose) {
    for (RobotMask* one : {&shallow, &away, &closer, &stop}) *one &= ~whose;
  }
  // The commands of switched_off() for these robots.
  void switch_off(RobotMask whose) {
    away &= ~whose;
    closer &= ~whose;
    stop |= whose;
  }
  // The carries whose commands differ.
  CarryMask differ(const BitslicedCommand& than) const {
    return either((shallow ^ than.shallow) | (away ^ than.away) | (closer ^ than.closer) |
                  (stop ^ than.stop));
  }
};

// The delay of messages for each carry, if all messages of the carry have the same delay.
class BitslicedDelay {
 public:
  // The longest delay that is supported [ticks].
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

  // Calls visit(row, whose) for every delay that occurs. The messages of the carries `whose` that
  // are sent in this tick arrive at this row of the queue, a ring of longest + 1 rows.
  template <class Visit>
  void each(std::uint64_t tick, Visit&& visit) const {
    for_each_bit(there_are_, [&](int delay) {
      const auto d = static_cast<std::size_t>(delay);
      visit((tick + d) % (longest + 1), of_[d]);
    });
  }

 private:
  std::array<RobotMask, longest + 1> of_{};
  CarryMask there_are_ = 0;  // bit d is set if some messages take d ticks
};

// The bit-sliced form of a kind of team, for 64 carries. If `exist` is true it provides
//   supports(team)   true if such a team can run bit-sliced
//   insert(i, team)  adds it as carry i before its first tick
//   erase(i)         removes carry i
//   step()           one tick of all; returns the carries whose commands are new
//   write_results()  writes the metrics of carry i after so many ticks
template <class Team>
struct BitslicedTeam {
  static constexpr bool exist = false;
};

// The interface of a bit-sliced form.
template <class Bitsliced, class Team>
concept DecidesInBits =
    requires(Bitsliced teams, const Bitsliced& known, const Team& team, int i, std::uint64_t tick,
             const BitslicedObservation& sensed, const BitslicedProgramState& programs,
             const BitslicedLoss& lost, std::uint32_t ticks, Metrics& metrics, LinkTotals& totals) {
      { Bitsliced::exist } -> std::convertible_to<bool>;
      { Bitsliced::can_stop } -> std::convertible_to<bool>;  // robots may be commanded to stop
      { Bitsliced::station } -> std::convertible_to<bool>;   // whether there is a station
      { Bitsliced::supports(team) } -> std::same_as<bool>;
      teams.insert(i, team);
      teams.erase(i);
      { teams.step(tick, sensed, programs, lost) } -> std::same_as<CarryMask>;
      { known.commands() } -> std::same_as<const BitslicedCommand&>;
      known.write_results(i, ticks, metrics, totals);
    };

}  // namespace palmbots
