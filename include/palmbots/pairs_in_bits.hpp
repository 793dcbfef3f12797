// The distributed algorithm for sixty-four pairs of robots at once: a bit a robot.
//
// What Pair<Distributed> (team.hpp) does letter by letter is done here in words, bit i of which tells of
// pair i: who is in a state, who senses what, who has got which letter. A row of Table 2 becomes a few
// logical operations, for all robots and without a branch; the table is the one in protocol.hpp. For
// pairs whose robots never fail and whose messages all take the same time.
#pragma once

#include "palmbots/bits.hpp"
#include "palmbots/team.hpp"

namespace palmbots {

// A letter for each robot, or none: the two bits of Letter.
struct LetterBits {
  std::array<BothBits, 2> bit{};

  BothBits any() const { return bit[0] | bit[1]; }
  BothBits are(Letter letter) const {
    const auto code = static_cast<unsigned>(letter);
    return ((code & 1) != 0 ? bit[0] : ~bit[0]) & ((code & 2) != 0 ? bit[1] : ~bit[1]);
  }
  // To those who have none.
  void put(BothBits whose, Letter letter) {
    const auto code = static_cast<unsigned>(letter);
    if ((code & 1) != 0) bit[0] |= whose;
    if ((code & 2) != 0) bit[1] |= whose;
  }
  void put(BothBits whose, const LetterBits& letters) {
    for (std::size_t k = 0; k < 2; ++k) bit[k] |= letters.bit[k] & whose;
  }
  void remove(BothBits whose) {
    for (BothBits& one : bit) one &= ~whose;
  }
  // Those of the partners.
  LetterBits swapped() const {
    return {{BothBits{bit[0][right], bit[0][left]}, BothBits{bit[1][right], bit[1][left]}}};
  }
};

// The robots themselves. Distributed::step() for all of them.
class RobotsInBits {
  using Robot = Distributed;
  using State = Robot::State;

 public:
  struct Output {
    LetterBits send;
    BothBits read;
  };

  void put(int i) {
    remove(i);
    in_[static_cast<std::size_t>(State::idle)] |= both_at(i);
  }
  void remove(int i) {
    for (BothBits& state : in_) state &= ~both_at(i);
  }

  Output step(const SensedBits& sensed, const LetterBits& got) {
    Output out{{}, got.any() & who_reads(sensed)};
    std::array<BothBits, Robot::states> stay = in_;
    std::array<BothBits, Robot::states> come{};
    each_row([&](const Robot::Row& row) {
      const auto from = static_cast<std::size_t>(row.state);
      BothBits go = stay[from] & who_fits(row.p, sensed);
      if (row.got != Robot::Got::any) go &= got.are(letter_of(row.got));
      if (row.tilt == Robot::Tilt::done) go &= sensed.turned;
      stay[from] &= ~go;  // a row further down is for those that none above has fitted
      come[static_cast<std::size_t>(row.next)] |= go;
      out.send.put(go, row.send);
    });
    for (std::size_t s = 0; s < Robot::states; ++s) in_[s] = stay[s] | come[s];
    return out;
  }

  // Those of whom it is true what they do.
  template <class Predicate>
  BothBits who(Predicate predicate) const {
    BothBits found{};
    each_state([&](std::size_t s) {
      if (predicate(Robot::doing[s])) found |= in_[s];
    });
    return found;
  }

 private:
  // Unrolled, so that the table itself is gone when the compiler is done.
  template <class Visit>
  [[gnu::always_inline]] static void each_row(Visit visit) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      (visit(Robot::table[i]), ...);
    }(std::make_index_sequence<std::size(Robot::table)>());
  }
  template <class Visit>
  [[gnu::always_inline]] static void each_state(Visit visit) {
    [&]<std::size_t... s>(std::index_sequence<s...>) {
      (visit(s), ...);
    }(std::make_index_sequence<Robot::states>());
  }

  static BothBits who_fits(Robot::P p, const SensedBits& sensed) {
    switch (p) {
      case Robot::P::any: break;
      case Robot::P::positive: return sensed.positive;
      case Robot::P::not_positive: return ~sensed.positive;
      case Robot::P::negative: return sensed.negative;
      case Robot::P::not_negative: return ~sensed.negative;
    }
    return ~BothBits{};
  }

  static Letter letter_of(Robot::Got got) {
    switch (got) {
      case Robot::Got::any: break;
      case Robot::Got::tilt_up: return Letter::tilt_up;
      case Robot::Got::tilt_down: return Letter::tilt_down;
      case Robot::Got::ack: return Letter::ack;
    }
    return Letter::none;
  }

  BothBits who_reads(const SensedBits& sensed) const {
    BothBits found{};
    each_state([&](std::size_t s) {
      const auto reads = [&](Sign sign) {
        return Robot::reads(static_cast<State>(s), sign) ? in_[s] : BothBits{};
      };
      found |= (reads(Sign::positive) & sensed.positive) |
               (reads(Sign::negative) & sensed.negative) |
               (reads(Sign::zero) & ~(sensed.positive | sensed.negative));
    });
    return found;
  }

  std::array<BothBits, Robot::states> in_{};  // who is in it
};

// Sixty-four pairs, their radio, and what is counted of them (metrics.hpp).
class PairsInBits {
 public:
  // Pair i begins; its messages take `delay` ticks, at least one.
  void put(int i, std::uint32_t delay) {
    remove(i);
    robots_.put(i);
    delays_.put(i, delay);
    for (BitCounts* counts : {&sent_, &corrections_, &waiting_}) counts->clear(both_at(i));
  }

  // Pair i is over, and does nothing any more.
  void remove(int i) {
    const BothBits those = ~both_at(i);
    robots_.remove(i);
    for (LetterBits& letters : line_) letters.remove(~those);
    inbox_.remove(~those);
    delays_.remove(i);
    commands_.remove(~those);
    for (BothBits& names : names_) names &= those;
    waits_ &= those;
  }

  // One tick of all of them. Tells in which pairs commands are new.
  Bits step(std::uint64_t tick, const SensedBits& sensed) {
    LetterBits& arrived = line_[tick % line_.size()];
    inbox_.put(~BothBits{}, arrived);
    arrived = {};
    const RobotsInBits::Output out = robots_.step(sensed, inbox_);
    inbox_.remove(out.read);
    const LetterBits letters = out.send.swapped();
    delays_.each(tick, [&](std::size_t row, BothBits whose) { line_[row].put(whose, letters); });
    sent_.add(out.send.any());
    count();
    return command();
  }

  const CommandBits& commands() const { return commands_; }

  // What is known of pair i after `ticks` ticks.
  void tell(int i, std::uint32_t ticks, Metrics& metrics, Traffic& traffic) const {
    metrics.corrections = corrections_.of(left, i) + corrections_.of(right, i);
    traffic.sent = 0;
    for (const std::size_t side : {left, right}) {
      const bool waits = (waits_[side] >> i & 1) != 0;
      metrics.waiting_ticks[side] = waiting_.of(side, i);
      metrics.waits_since[side] = waits ? ticks - waits_now_.of(side, i) : ticks;
      traffic.links[side].sent = sent_.of(side, i);
      traffic.sent += traffic.links[side].sent;
    }
  }

 private:
  // As Metrics::note.
  void count() {
    static constexpr char cases[] = {'a', 'b', 'c', 'd'};
    std::array<BothBits, 4> names;
    BothBits renamed{};
    for (std::size_t k = 0; k < 4; ++k) {
      names[k] = robots_.who([&](const Distributed::Doing& d) { return d.name == cases[k]; });
      renamed |= names[k] ^ names_[k];
    }
    const auto& [a, b, c, d] = names;
    const BothBits was_a = names_[0];
    // When the partner asks too, (a) turns out to be (b); who is in (c) assists.
    corrections_.add(renamed & (a | (b & ~was_a) | d));
    const BothBits waits = robots_.who([](const Distributed::Doing& doing) { return doing.waits; });
    waits_now_.clear(waits & (renamed | ~waits_));
    waits_now_.add(waits);
    waiting_.add(waits);
    waits_ = waits;
    names_ = names;
  }

  Bits command() {
    const auto who_moves = [&](Move move) {
      return robots_.who([&](const Distributed::Doing& d) { return d.command.move == move; });
    };
    const CommandBits before = commands_;
    commands_.shallow =
        robots_.who([](const Distributed::Doing& d) { return d.command.palm == Palm::shallow; });
    commands_.away = who_moves(Move::away);
    commands_.closer = who_moves(Move::closer);
    return commands_.differ(before);
  }

  RobotsInBits robots_;
  // Letters on their way to a robot, by the tick of their arrival, and the one that it has not read. There is
  // never more than one: if another is on its way, the robot reads the first as soon as it is there (bits_test).
  std::array<LetterBits, DelayBits::longest + 1> line_;
  LetterBits inbox_;
  DelayBits delays_;
  CommandBits commands_;
  std::array<BothBits, 4> names_{};  // who is in which case
  BothBits waits_{};
  BitCounts sent_;
  BitCounts corrections_;
  BitCounts waiting_;    // ticks, in all …
  BitCounts waits_now_;  // … and without a break, of those who wait
};

template <>
struct TeamsInBits<Pair<Distributed>> : PairsInBits {
  static constexpr bool exist = true;
};

}  // namespace palmbots
