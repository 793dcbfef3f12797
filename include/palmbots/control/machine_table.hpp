// SPDX-License-Identifier: Apache-2.0
// A table that is known at run time only: the form in which an algorithm that was derived from a policy
// file runs.
//
// It is a table with a queue (control/table.hpp) whose rows look at contact, message and palm. It has a
// fixed capacity and owns no memory. A robot refers to its table, which must outlive it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/control/table.hpp"

namespace palmbots {

// The table of one robot, expanded over every state and input. Its bytes are part of the settings page
// of a board.
class MachineTable {
 public:
  static constexpr std::size_t most_states = 32;
  using Row = TableRow<std::uint8_t>;

  // What a robot commands in a state, and for which message it waits.
  struct StateOutput {
    char name;  // the case, as in Table 2; ' ' for none
    Command command;
    bool waits;
    MessageKind awaits;
  };

  // The input of a step, as a number.
  struct Key {
    static constexpr int messages = 4;
    static constexpr int count = 3 * messages * 2;
    Sign sign;
    MessageKind message;  // below `messages`
    bool turned;

    constexpr int number() const {
      return ((static_cast<int>(sign) + 1) * messages + static_cast<int>(message)) * 2 +
             (turned ? 1 : 0);
    }
    static constexpr Key of(int n) {
      return {static_cast<Sign>(n / (2 * messages) - 1), static_cast<MessageKind>(n / 2 % messages),
              n % 2 != 0};
    }
  };

  // What a step results in.
  struct Entry {
    std::uint8_t next;
    MessageKind send;
    bool read;  // the message is consumed
  };

  // Adds a state; its number is how many there were before. False: there is no room.
  constexpr bool add(const StateOutput& output) {
    if (states_ == most_states) return false;
    outputs_[states_] = output;
    for (int k = 0; k < Key::count; ++k) entry(states_, k) = {states_, MessageKind::none, false};
    ++states_;
    return true;
  }

  // Adds a row behind the others. False: it goes to a state that the table does not have.
  constexpr bool add(const Row& row) {
    if (row.next >= states_) return false;
    for (std::uint8_t s = 0; s < states_; ++s) {
      for (int k = 0; row.from.has(s) && k < Key::count; ++k) {
        const Key key = Key::of(k);
        bool& taken = taken_[s * std::size_t{Key::count} + static_cast<std::size_t>(k)];
        if (taken || !fits(row, key)) continue;
        entry(s, k) = {row.next, row.send, row.reads() && key.message != MessageKind::none};
        taken = true;
      }
    }
    return true;
  }

  constexpr std::uint8_t states() const { return states_; }
  constexpr const StateOutput& output(std::uint8_t state) const { return outputs_[state]; }
  constexpr const Entry& at(std::uint8_t state, const Key& key) const {
    return entries_[state * std::size_t{Key::count} + static_cast<std::size_t>(key.number())];
  }

 private:
  static constexpr bool fits(const Row& row, const Key& key) {
    return holds(row.p, observation_of(key.sign, key.turned)) && row.heard.has(key.message) &&
           meets<bool>(row.when, {.turned = key.turned});
  }
  constexpr Entry& entry(std::uint8_t state, int key) {
    return entries_[state * std::size_t{Key::count} + static_cast<std::size_t>(key)];
  }

  std::uint8_t states_ = 0;
  std::array<StateOutput, most_states> outputs_{};
  std::array<Entry, most_states * Key::count> entries_{};
  std::array<bool, most_states * Key::count> taken_{};  // a row fits
};

// The controller of one robot. It starts in state 0.
class MachineRobot {
 public:
  static constexpr Mail mail = Mail::queue;
  static constexpr bool has_clock = false;

  // The table has at least one state.
  constexpr explicit MachineRobot(const MachineTable* table) : table_(table) {}
  constexpr MachineRobot booted() const { return MachineRobot(table_); }

  RobotOutput step(const RobotInput& in) {
    const MachineTable::Entry& entry =
        table_->at(state_, key(in.sign, in.palm_at_target, in.message));
    state_ = entry.next;
    return {table_->output(state_).command, entry.send, entry.send != MessageKind::none,
            entry.read};
  }

  // As in control/table_robot.hpp.
  std::uint16_t quiet(Sign sign, bool palm_at_target, MessageKind unread) const {
    const MachineTable::Entry& entry = table_->at(state_, key(sign, palm_at_target, unread));
    const bool stays = entry.next == state_ && entry.send == MessageKind::none && !entry.read;
    return stays ? 0xFFFF : 0;
  }

  std::uint8_t state() const { return state_; }
  char name() const { return table_->output(state_).name; }
  bool waits() const { return table_->output(state_).waits; }
  MessageKind awaits() const { return table_->output(state_).awaits; }
  static constexpr bool stopped() { return false; }

 private:
  // A message that no table of this kind knows is like none.
  static constexpr MachineTable::Key key(Sign sign, bool turned, MessageKind message) {
    const bool is_known = static_cast<int>(message) < MachineTable::Key::messages;
    return {sign, is_known ? message : MessageKind::none, turned};
  }

  const MachineTable* table_;
  std::uint8_t state_ = 0;
};

}  // namespace palmbots
