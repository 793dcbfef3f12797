// The distributed algorithm for sixty-four pairs of robots at once: a bit a robot.
//
// What Pair<Distributed> (team.hpp) does letter by letter is done here in words; the table is the one in
// protocol.hpp. For pairs whose robots never fail and whose messages all take the same time, or are lost.
#pragma once

#include "palmbots/states_in_bits.hpp"
#include "palmbots/team.hpp"

namespace palmbots {

// Sixty-four pairs, their radio, and what is counted of them.
class PairsInBits {
  using Robot = Distributed;
  using Letters = LetterBits<2>;

 public:
  static constexpr bool rest = false;
  static constexpr bool station = false;

  static bool take(const Pair<Robot>& team) {
    return DelayBits::take(team.radio().steady_delay()) && !team.faults().any();
  }

  void put(int i, const Pair<Robot>& team) {
    robots_.put(both_at(i), Robot::State::idle);
    delays_.put(i, team.radio().steady_delay());
    for (BitCounts* counts : {&sent_, &lost_}) counts->clear(both_at(i));
    cases_.put(i);
  }

  void remove(int i) {
    robots_.remove(both_at(i));
    for (Letters& letters : line_) letters.remove(both_at(i));
    inbox_.remove(both_at(i));
    delays_.remove(i);
    commands_.remove(both_at(i));
    cases_.remove(i);
  }

  Bits step(std::uint64_t tick, const SensedBits& sensed, const HostBits&, const LossBits& lost) {
    Letters& arrived = line_[tick % line_.size()];
    inbox_.put(~BothBits{}, arrived);
    arrived = {};
    const BothBits read = inbox_.any() & who_read(sensed);
    Letters send;
    robots_.step(
        ~BothBits{}, [&](const Robot::Row& row) { return who_fits(row, sensed, inbox_); },
        [&](const Robot::Row& row, BothBits whose) { send.put(whose, row.send); });
    inbox_.remove(read);
    const Letters letters = send.swapped();
    const BothBits come = ~swapped(lost.from_robot);
    delays_.each(tick,
                 [&](std::size_t row, BothBits whose) { line_[row].put(whose & come, letters); });
    sent_.add(send.any());
    lost_.add(send.any() & lost.from_robot);
    cases_.note(robots_);
    const CommandBits before = std::exchange(commands_, robots_.commands());
    return commands_.differ(before);
  }

  const CommandBits& commands() const { return commands_; }

  void tell(int i, std::uint32_t ticks, Metrics& metrics, Traffic& traffic) const {
    cases_.tell(i, ticks, metrics);
    tell_links(i, sent_, lost_, traffic);
  }

 private:
  [[gnu::always_inline]] static BothBits who_fits(const Robot::Row& row, const SensedBits& sensed,
                                                  const Letters& got) {
    const BothBits all = ~BothBits{};
    const auto letter = [&] {
      switch (row.got) {
        case Robot::Got::any: break;
        case Robot::Got::tilt_up: return got.are(Letter::tilt_up);
        case Robot::Got::tilt_down: return got.are(Letter::tilt_down);
        case Robot::Got::ack: return got.are(Letter::ack);
      }
      return all;
    };
    return who_senses(row.p, sensed) & letter() &
           (row.tilt == Robot::Tilt::done ? sensed.turned : all);
  }

  // Those who look at their letters.
  [[gnu::always_inline]] BothBits who_read(const SensedBits& sensed) const {
    const auto reading = [&](Sign sign) {
      return robots_.where([&](Robot::State state) { return Robot::reads(state, sign); });
    };
    return (reading(Sign::positive) & sensed.positive) |
           (reading(Sign::negative) & sensed.negative) |
           (reading(Sign::zero) & ~(sensed.positive | sensed.negative));
  }

  StatesInBits<Robot> robots_;
  // Letters on their way to a robot, by the tick of their arrival, and the one that it has not read. There is
  // never more than one: if another is on its way, the robot reads the first as soon as it is there (bits_test).
  std::array<Letters, DelayBits::longest + 1> line_;
  Letters inbox_;
  DelayBits delays_;
  CommandBits commands_;
  BitCounts sent_;
  BitCounts lost_;
  CasesInBits cases_;
};

template <>
struct TeamsInBits<Pair<Distributed>> : PairsInBits {
  static constexpr bool exist = true;
};

}  // namespace palmbots
