// SPDX-License-Identifier: Apache-2.0
// Recorders: what is stored of a carry besides its metrics, that is nothing, a hash, or every tick.
//
// A row is the state at the start of a tick with the readings, commands and speeds of that tick.
// The last row is the state at the end. The hash covers the bits of every row as doubles, so equal
// hashes mean equal traces (up to collisions).
#pragma once

#include <bit>
#include <cmath>
#include <vector>

#include "palmbots/sim/carry.hpp"

namespace palmbots {

// Stores nothing.
struct NoRecorder {
  void make_room() {}
  void message(const SentMessage&) {}
  template <class Carry>
  void before(const Carry&, const PerSide<RobotObservation>&) {}
  template <class Carry>
  void after(const Carry&) {}
  template <class Carry>
  void end(const Carry&) {}
};

// FNV-1a on 64-bit words, with a final mix so that every bit of the input reaches every bit of the
// hash.
class TraceHash {
 public:
  void add(double value) {
    state_ = (state_ ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001B3ULL;
    state_ ^= state_ >> 29;
  }
  std::uint64_t value() const {
    std::uint64_t x = state_;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
    return x ^ (x >> 31);
  }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};

// One tick, as it goes into the trace.
struct Row {
  PerSide<double> contact;
  PerSide<double> palm;
  PerSide<double> speed;
  PerSide<double> commanded;
  double separation;
  double midpoint;
  double object;  // its angle, in rows that are stored [rad]
  PerSide<std::int8_t> sign;
  PerSide<char> name;  // case
  PerSide<std::int8_t> motion;
  PerSide<double> lift;  // of the contact vertices above their palms [m]

  template <class Visit>
  void numbers(Visit visit) const {
    for (const auto* pair : {&contact, &palm, &speed, &commanded}) {
      visit((*pair)[left]);
      visit((*pair)[right]);
    }
    visit(separation);
    visit(midpoint);
  }
};

// A choice of the world after an ambiguous event: when [ticks], and how each contact that persists
// moves.
struct ChoiceRow {
  struct Contact {
    Carrier carrier;
    Motion motion;
  };
  double when;
  std::vector<Contact> contacts;
};

// The row of the present tick.
template <class Carry>
Row row_of(const Carry& carry, const PerSide<RobotObservation>& sensed) {
  Row row{};
  const auto& configuration = carry.world().configuration();
  for (const std::size_t side : {left, right}) {
    row.contact[side] = double(configuration.contacts[side]);
    row.lift[side] = double(configuration.lift[side]);
    row.palm[side] = double(configuration.palms[side].angle);
    row.speed[side] = double(carry.speeds()[side]);
    row.commanded[side] = double(carry.wanted(side, carry.commands()[side]));
    row.sign[side] = static_cast<std::int8_t>(sensed[side].sign);
    row.name[side] = carry.team().name(side);
  }
  row.separation = double(configuration.separation);
  row.midpoint = double(carry.midpoint());
  return row;
}

// Stores the hash and, if stores_rows, every row and message. Memory grows between ticks, never
// inside one. stores_rows is no template parameter: it would double what has to be compiled.
class TraceRecorder {
 public:
  explicit TraceRecorder(bool stores_rows = true) : stores_rows_(stores_rows) {}

  void make_room() {
    if (!stores_rows_) return;
    grow(rows_, 1);
    grow(sent_messages_, 4);
  }
  void message(const SentMessage& sent) {
    if (stores_rows_) sent_messages_.push_back(sent);
  }
  template <class Carry>
  void before(const Carry& carry, const PerSide<RobotObservation>& sensed) {
    sensed_ = sensed;
    add(carry);
  }
  template <class Carry>
  void after(const Carry& carry) {
    if constexpr (requires { carry.world().choices(); }) note_choices(carry.world(), carry.ticks());
    if (!stores_rows_) return;
    const ContactMode motion = carry.world().last().motion;
    rows_.back().motion = {static_cast<std::int8_t>(motion[left]),
                           static_cast<std::int8_t>(motion[right])};
  }
  template <class Carry>
  void end(const Carry& carry) {
    add(carry);
  }
  std::uint64_t hash() const { return hash_.value(); }
  std::vector<Row> take_rows() { return std::move(rows_); }
  std::vector<SentMessage> take_sent_messages() { return std::move(sent_messages_); }
  std::vector<ChoiceRow> take_choices() { return std::move(choices_); }

 private:
  // Events are rarely ambiguous: this allocates memory inside a tick.
  template <class Real>
  void note_choices(const World<Real>& world, std::uint32_t tick) {
    if (world.ambiguous_events() == ambiguous_) return;
    ambiguous_ = world.ambiguous_events();
    for (const AmbiguousChoice& choice : world.choices()) {
      ChoiceRow row{double(tick) + choice.fraction, {}};
      for (const ActivePair& active : choice.regime.active) {
        row.contacts.push_back({static_cast<Carrier>(active.pair.carrier), active.motion});
      }
      choices_.push_back(std::move(row));
    }
  }
  template <class Carry>
  void add(const Carry& carry) {
    const Row row = row_of(carry, sensed_);
    row.numbers([this](double value) { hash_.add(value); });
    if (!stores_rows_) return;
    rows_.push_back(row);
    if constexpr (requires { carry.object_sine(); }) {  // the pivots may not be level
      rows_.back().object = std::asin(carry.object_sine());
    } else {
      rows_.back().object = carry.world().tilt(carry.spec().width);
    }
  }
  template <class T>
  static void grow(std::vector<T>& list, std::size_t spare) {
    if (list.size() + spare > list.capacity()) list.reserve(2 * list.capacity() + 1024);
  }
  bool stores_rows_;
  PerSide<RobotObservation> sensed_{};
  TraceHash hash_;
  std::vector<Row> rows_;
  std::vector<SentMessage> sent_messages_;
  std::uint32_t ambiguous_ = 0;  // events so far
  std::vector<ChoiceRow> choices_;
};

}  // namespace palmbots
