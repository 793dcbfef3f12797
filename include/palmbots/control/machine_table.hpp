// SPDX-License-Identifier: Apache-2.0
// A controller whose table is data: the form in which an algorithm that was derived from a policy
// file runs.
//
// The table reads as Table 2 does (control/distributed.hpp). A robot runs the first row that fits its
// state, sign, message and palm; if none fits, it stays in its state. The commands depend on the
// state alone. A row that names a message consumes it. Every other message stays in the inbox.
//
// A table has a fixed capacity and owns no memory. A robot refers to its table, which must outlive
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/control/distributed.hpp"

namespace palmbots {

// The table of one robot, expanded over every state and input.
class MachineTable {
 public:
  static constexpr std::size_t most_states = 32;
  using Key = Distributed::Key;

  struct Row {
    std::uint8_t state;
    ContactCondition p;
    Distributed::Got got;
    Distributed::Tilt tilt;
    std::uint8_t next;
    MessageKind send;
  };

  // What a step results in.
  struct Entry {
    std::uint8_t next;
    MessageKind send;
    bool read;  // the message is consumed
  };

  // Adds a state; its number is how many there were before. False: there is no room.
  constexpr bool add(const Distributed::StateOutput& output) {
    if (states_ == most_states) return false;
    outputs_[states_] = output;
    for (int k = 0; k < Key::count; ++k) entry(states_, k) = {states_, MessageKind::none, false};
    ++states_;
    return true;
  }

  // Adds a row behind the others. False: it names a state that the table does not have.
  constexpr bool add(const Row& row) {
    if (row.state >= states_ || row.next >= states_) return false;
    for (int k = 0; k < Key::count; ++k) {
      const Key key = Key::of(k);
      bool& taken = taken_[row.state * std::size_t{Key::count} + static_cast<std::size_t>(k)];
      if (taken || !fits(row, key)) continue;
      entry(row.state, k) = {row.next, row.send, row.got != Distributed::Got::any};
      taken = true;
    }
    return true;
  }

  constexpr std::uint8_t states() const { return states_; }
  constexpr const Distributed::StateOutput& output(std::uint8_t state) const {
    return outputs_[state];
  }
  constexpr const Entry& at(std::uint8_t state, const Key& key) const {
    return entries_[state * std::size_t{Key::count} + static_cast<std::size_t>(key.number())];
  }

 private:
  static constexpr bool fits(const Row& row, const Key& key) {
    const Observation<bool> seen = key.seen();
    return holds(row.p, seen) && Distributed::got<bool>(row.got, OneMessage{key.in.message}) &&
           (row.tilt == Distributed::Tilt::any || seen.palm_at_target);
  }
  constexpr Entry& entry(std::uint8_t state, int key) {
    return entries_[state * std::size_t{Key::count} + static_cast<std::size_t>(key)];
  }

  std::uint8_t states_ = 0;
  std::array<Distributed::StateOutput, most_states> outputs_{};
  std::array<Entry, most_states * Key::count> entries_{};
  std::array<bool, most_states * Key::count> taken_{};  // a row fits
};

// The program of one robot. It starts in state 0.
class MachineRobot {
 public:
  // The table has at least one state.
  explicit MachineRobot(const MachineTable* table) : table_(table) {}

  Distributed::Output step(Distributed::Input in) {
    const MachineTable::Entry& entry = table_->at(state_, {in});
    state_ = entry.next;
    return {now().command, entry.send, entry.read};
  }

  // True if the robot would stay in its state and send nothing, however often it got this input.
  bool is_quiescent(Distributed::Input in) const {
    const MachineTable::Entry& entry = table_->at(state_, {in});
    return entry.next == state_ && entry.send == MessageKind::none && !entry.read;
  }

  std::uint8_t state() const { return state_; }
  const Distributed::StateOutput& now() const { return table_->output(state_); }

 private:
  const MachineTable* table_;
  std::uint8_t state_ = 0;
};

}  // namespace palmbots
