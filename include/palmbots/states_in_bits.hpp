// Robots that run a table, sixty-four pairs of them at once: a bit a robot.
//
// Bit i of a word tells of pair i: who is in a state, who has got which letter. A row of the table becomes
// a few logical operations, for all robots and without a branch.
#pragma once

#include "palmbots/bit_counts.hpp"

namespace palmbots {

// A letter for each robot, or none: its lowest bits.
template <std::size_t bits>
struct LetterBits {
  std::array<BothBits, bits> bit{};

  BothBits any() const {
    BothBits found{};
    for (const BothBits& one : bit) found |= one;
    return found;
  }
  BothBits are(Letter letter) const {
    BothBits found = ~BothBits{};
    for (std::size_t k = 0; k < bits; ++k) found &= has(letter, k) ? bit[k] : ~bit[k];
    return found;
  }
  BothBits differ(const LetterBits& than) const {
    BothBits found{};
    for (std::size_t k = 0; k < bits; ++k) found |= bit[k] ^ than.bit[k];
    return found;
  }
  // To those who have none.
  void put(BothBits whose, Letter letter) {
    for (std::size_t k = 0; k < bits; ++k) {
      if (has(letter, k)) bit[k] |= whose;
    }
  }
  void put(BothBits whose, const LetterBits& letters) {
    for (std::size_t k = 0; k < bits; ++k) bit[k] |= letters.bit[k] & whose;
  }
  void remove(BothBits whose) {
    for (BothBits& one : bit) one &= ~whose;
  }
  // Those of the partners.
  LetterBits swapped() const {
    LetterBits found;
    for (std::size_t k = 0; k < bits; ++k) found.bit[k] = palmbots::swapped(bit[k]);
    return found;
  }

 private:
  static constexpr bool has(Letter letter, std::size_t k) {
    return (static_cast<unsigned>(letter) >> k & 1) != 0;
  }
};

// Who senses what a row of a table asks for.
template <class P>
[[gnu::always_inline]] inline BothBits who_senses(P p, const SensedBits& sensed) {
  switch (p) {
    case P::any: break;
    case P::positive: return sensed.positive;
    case P::not_positive: return ~sensed.positive;
    case P::negative: return sensed.negative;
    case P::not_negative: return ~sensed.negative;
  }
  return ~BothBits{};
}

// Who is in which state of a robot's table, which is unrolled: it is gone when the compiler is done.
template <class Robot>
class StatesInBits {
 public:
  using State = typename Robot::State;
  using Row = typename Robot::Row;
  using Doing = typename Robot::Doing;

  void put(BothBits whose, State state) {
    remove(whose);
    in_[static_cast<std::size_t>(state)] |= whose;
  }
  void remove(BothBits whose) {
    for (BothBits& state : in_) state &= ~whose;
  }

  // Each of these runs the first row that fits: fits(row) says to whom of all it does, and went(row, whose)
  // is told who ran it.
  template <class Fits, class Went>
  [[gnu::always_inline]] void step(BothBits these, Fits&& fits, Went&& went) {
    std::array<BothBits, Robot::states> stay = in_;
    std::array<BothBits, Robot::states> come{};
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      const auto run = [&](const Row& row) {
        const auto from = static_cast<std::size_t>(row.state);
        const BothBits go = stay[from] & fits(row) & these;
        stay[from] &= ~go;
        come[static_cast<std::size_t>(row.next)] |= go;
        went(row, go);
      };
      (run(Robot::table[i]), ...);
    }(std::make_index_sequence<std::size(Robot::table)>());
    for (std::size_t s = 0; s < Robot::states; ++s) in_[s] = stay[s] | come[s];
  }

  BothBits in(State state) const { return in_[static_cast<std::size_t>(state)]; }

  // Those for whose state it is true.
  template <class Predicate>
  [[gnu::always_inline]] BothBits where(Predicate predicate) const {
    BothBits found{};
    [&]<std::size_t... s>(std::index_sequence<s...>) {
      ((predicate(static_cast<State>(s)) ? void(found |= in_[s]) : void()), ...);
    }(std::make_index_sequence<Robot::states>());
    return found;
  }
  // Those of whom it is true what they do.
  template <class Predicate>
  [[gnu::always_inline]] BothBits who(Predicate predicate) const {
    return where([&](State s) { return predicate(Robot::doing[static_cast<std::size_t>(s)]); });
  }

  BothBits moving(Move move) const {
    return who([&](const Doing& doing) { return doing.command.move == move; });
  }
  CommandBits commands() const {
    const BothBits shallow =
        who([](const Doing& doing) { return doing.command.palm == Palm::shallow; });
    return {shallow, moving(Move::away), moving(Move::closer), BothBits{}};
  }

 private:
  std::array<BothBits, Robot::states> in_{};
};

// What is counted of robots that are in the cases of Table 2, as Metrics::note does.
class CasesInBits {
 public:
  void put(int i) {
    for (BitCounts* counts : {&corrections_, &waiting_}) counts->clear(both_at(i));
  }
  void remove(int i) {
    for (BothBits& names : names_) names &= ~both_at(i);
    waits_ &= ~both_at(i);
  }

  // After a tick.
  template <class Robot>
  [[gnu::always_inline]] void note(const StatesInBits<Robot>& robots) {
    using Doing = typename Robot::Doing;
    static constexpr char cases[] = {'a', 'b', 'c', 'd'};
    std::array<BothBits, 4> names;
    BothBits renamed{};
    for (std::size_t k = 0; k < 4; ++k) {
      names[k] = robots.who([&](const Doing& doing) { return doing.name == cases[k]; });
      renamed |= names[k] ^ names_[k];
    }
    const auto& [a, b, c, d] = names;
    const BothBits was_a = names_[0];
    // When the partner asks too, (a) turns out to be (b); who is in (c) assists.
    corrections_.add(renamed & (a | (b & ~was_a) | d));
    const BothBits waits = robots.who([](const Doing& doing) { return doing.waits; });
    waits_now_.clear(waits & (renamed | ~waits_));
    waits_now_.add(waits);
    waiting_.add(waits);
    waits_ = waits;
    names_ = names;
  }

  // What is known of pair i after `ticks` ticks.
  void tell(int i, std::uint32_t ticks, Metrics& metrics) const {
    metrics.corrections = corrections_.of(left, i) + corrections_.of(right, i);
    for (const std::size_t side : {left, right}) {
      const bool waits = (waits_[side] >> i & 1) != 0;
      metrics.waiting_ticks[side] = waiting_.of(side, i);
      metrics.waits_since[side] = waits ? ticks - waits_now_.of(side, i) : ticks;
    }
  }

 private:
  std::array<BothBits, 4> names_{};  // who is in which case
  BothBits waits_{};
  BitCounts corrections_;
  BitCounts waiting_;    // ticks, in all …
  BitCounts waits_now_;  // … and without a break, of those who wait
};

}  // namespace palmbots
