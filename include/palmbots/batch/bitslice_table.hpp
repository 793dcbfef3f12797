// SPDX-License-Identifier: Apache-2.0
// Bit-sliced evaluation of a controller's table for 64 pairs of robots at once.
//
// Bit i of a word belongs to pair i. Words hold which robots are in a state and which robots have a
// message. A row of the table becomes a few logical operations for all robots, without a branch.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include "palmbots/batch/bitslice_io.hpp"
#include "palmbots/control/messages.hpp"

namespace palmbots {

// A message for each robot, or none, as bit slices of its number.
template <std::size_t bits>
struct BitslicedMessage {
  std::array<RobotMask, bits> bit{};

  RobotMask any() const {
    RobotMask found{};
    for (const RobotMask& one : bit) found |= one;
    return found;
  }
  RobotMask is(MessageKind message) const {
    RobotMask found = ~RobotMask{};
    for (std::size_t k = 0; k < bits; ++k) found &= has(message, k) ? bit[k] : ~bit[k];
    return found;
  }
  RobotMask differ(const BitslicedMessage& than) const {
    RobotMask found{};
    for (std::size_t k = 0; k < bits; ++k) found |= bit[k] ^ than.bit[k];
    return found;
  }
  // Stores a message for these robots, which must have none.
  void insert(RobotMask whose, MessageKind message) {
    for (std::size_t k = 0; k < bits; ++k) {
      if (has(message, k)) bit[k] |= whose;
    }
  }
  template <std::size_t fewer>
    requires(fewer <= bits)
  void insert(RobotMask whose, const BitslicedMessage<fewer>& messages) {
    for (std::size_t k = 0; k < fewer; ++k) bit[k] |= messages.bit[k] & whose;
  }
  // The first bits of its number.
  template <std::size_t some>
  BitslicedMessage<some> first() const {
    BitslicedMessage<some> found;
    std::copy_n(bit.begin(), some, found.bit.begin());
    return found;
  }
  void erase(RobotMask whose) {
    for (RobotMask& one : bit) one &= ~whose;
  }
  // The messages of the partners.
  BitslicedMessage swapped() const {
    BitslicedMessage found;
    for (std::size_t k = 0; k < bits; ++k) found.bit[k] = palmbots::swapped(bit[k]);
    return found;
  }

 private:
  static constexpr bool has(MessageKind message, std::size_t k) {
    return (static_cast<unsigned>(message) >> k & 1) != 0;
  }
};

// Which robots are in which state of a table. The loops over the table are unrolled, so that no
// table remains at run time.
template <class Robot>
class BitslicedTable {
 public:
  using State = typename Robot::State;
  using Row = typename Robot::Row;
  using StateOutput = typename Robot::StateOutput;

  void insert(RobotMask whose, State state) {
    erase(whose);
    in_[static_cast<std::size_t>(state)] |= whose;
  }
  void erase(RobotMask whose) {
    for (RobotMask& state : in_) state &= ~whose;
  }

  // Each of these robots runs the first row that fits. fits(row) returns the robots to which the
  // row applies, and went(row, whose) is called with the robots that ran it.
  template <class Fits, class Went>
  [[gnu::always_inline]] void step(RobotMask these, Fits&& fits, Went&& went) {
    step_all<Robot>(in_, these, fits, went);
  }

  RobotMask in(State state) const { return in_[static_cast<std::size_t>(state)]; }

  // The robots in a state for which the predicate is true.
  template <class Predicate>
  [[gnu::always_inline]] RobotMask where(Predicate predicate) const {
    RobotMask found{};
    [&]<std::size_t... s>(std::index_sequence<s...>) {
      ((predicate(static_cast<State>(s)) ? void(found |= in_[s]) : void()), ...);
    }(std::make_index_sequence<Robot::states>());
    return found;
  }
  // The robots whose state has an output for which the predicate is true.
  template <class Predicate>
  [[gnu::always_inline]] RobotMask who(Predicate predicate) const {
    return where([&](State s) { return predicate(Robot::outputs[static_cast<std::size_t>(s)]); });
  }

  RobotMask moving(Move move) const {
    return who([&](const StateOutput& output) { return output.command.move == move; });
  }
  BitslicedCommand commands() const {
    const RobotMask shallow =
        who([](const StateOutput& output) { return output.command.palm == Palm::shallow; });
    const RobotMask stops = who([](const StateOutput& output) { return output.command.stop; });
    return {shallow, moving(Move::away), moving(Move::closer), stops};
  }

 private:
  RobotMask in_[Robot::states]{};
};

}  // namespace palmbots
