// SPDX-License-Identifier: Apache-2.0
// Robots that run a table, sixty-four pairs of them at once: a bit a robot.
//
// Bit i of a word tells of pair i: who is in a state, who has got which message. A row of the table
// becomes a few logical operations, for all robots and without a branch.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include "palmbots/batch/bitslice_io.hpp"
#include "palmbots/control/messages.hpp"

namespace palmbots {

// A message for each robot, or none: its lowest bits.
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
  // To those who have none.
  void insert(RobotMask whose, MessageKind message) {
    for (std::size_t k = 0; k < bits; ++k) {
      if (has(message, k)) bit[k] |= whose;
    }
  }
  void insert(RobotMask whose, const BitslicedMessage& messages) {
    for (std::size_t k = 0; k < bits; ++k) bit[k] |= messages.bit[k] & whose;
  }
  void erase(RobotMask whose) {
    for (RobotMask& one : bit) one &= ~whose;
  }
  // Those of the partners.
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

// Who is in which state of a robot's table, which is unrolled: it is gone when the compiler is
// done.
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

  // Each of these runs the first row that fits: fits(row) says to whom of all it does, and
  // went(row, whose) is told who ran it.
  template <class Fits, class Went>
  [[gnu::always_inline]] void step(RobotMask these, Fits&& fits, Went&& went) {
    step_all<Robot>(in_, these, fits, went);
  }

  RobotMask in(State state) const { return in_[static_cast<std::size_t>(state)]; }

  // Those for whose state it is true.
  template <class Predicate>
  [[gnu::always_inline]] RobotMask where(Predicate predicate) const {
    RobotMask found{};
    [&]<std::size_t... s>(std::index_sequence<s...>) {
      ((predicate(static_cast<State>(s)) ? void(found |= in_[s]) : void()), ...);
    }(std::make_index_sequence<Robot::states>());
    return found;
  }
  // Those of each state of whom it is true there.
  template <class Truth>
  [[gnu::always_inline]] RobotMask where_each(Truth truth) const {
    RobotMask found{};
    [&]<std::size_t... s>(std::index_sequence<s...>) {
      ((found |= in_[s] & truth(static_cast<State>(s))), ...);
    }(std::make_index_sequence<Robot::states>());
    return found;
  }
  // Those of whom it is true what they do.
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
    return {shallow, moving(Move::away), moving(Move::closer), RobotMask{}};
  }

 private:
  RobotMask in_[Robot::states]{};
};

}  // namespace palmbots
