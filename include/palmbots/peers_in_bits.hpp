// The resilient algorithm for sixty-four pairs of robots at once: a bit a robot, numbers bit by bit.
//
// What Peers (peers.hpp) and Resilient do beacon by beacon is done here in words; the table is the one in
// resilient.hpp. For pairs whose robots do not fail but by reboots, whose clocks are the carry's and whose
// beacons all take the same time, or are lost. Then none overtakes another, so that what comes is news, and
// of the two stamps in a beacon its age is all that counts: it goes along with it. An echo of what a robot
// sent before it booted is older than its life.
#pragma once

#include "palmbots/peers.hpp"
#include "palmbots/states_in_bits.hpp"

namespace palmbots {

// Sixty-four pairs, their radio, and what is counted of them.
class PeersInBits {
  using Robot = Resilient;
  using Letters = LetterBits<3>;

 public:
  static constexpr bool rest = true;
  static constexpr bool station = false;

  static bool take(const Peers& team) {
    const Robot::Times& t = team.times();
    const std::uint32_t longest =
        std::max({std::uint32_t{t.beacon}, t.lease + 1U, std::uint32_t{t.hold},
                  std::uint32_t{t.braking}, t.join + 1U});
    return longest <= NumberBits::most && DelayBits::take(team.radio().steady_delay()) &&
           team.keeps_time() && team.faults().are_reboots();
  }

  void put(int i, const Peers& team) {
    const BothBits here = both_at(i);
    const Robot::Times& t = team.times();
    beacon_.put(here, t.beacon);
    stale_.put(here, t.lease + 1U);
    hold_.put(here, t.hold);
    braking_.put(here, t.braking);
    long_ago_.put(here, t.join + 1U);
    there_and_back_.put(here, 2 * team.radio().steady_delay());
    delays_.put(i, team.radio().steady_delay());
    for (const std::size_t side : {left, right}) {
      if (team.robot(side).yields()) yields_[side] |= Bits{1} << i;
    }
    there_ |= here;
    boot(here);
    for (BitCounts* counts : {&sent_, &lost_, &late_}) counts->clear(here);
    cases_.put(i);
  }

  void remove(int i) {
    const BothBits here = both_at(i);
    robots_.remove(here);
    for (Beacons& beacons : line_) beacons.letter.remove(here);
    for (BothBits* words : {&yields_, &rests_, &partner_rests_, &partner_ready_, &there_}) {
      *words &= ~here;
    }
    delays_.remove(i);
    commands_.remove(here);
    cases_.remove(i);
  }

  Bits step(std::uint64_t tick, const SensedBits& sensed, const HostBits& hosts,
            const LossBits& lost) {
    if (either(hosts.boots) != 0) [[unlikely]]
      boot(hosts.boots);
    const BothBits run = there_ & ~hosts.off;
    pass();
    hear(line_[tick % line_.size()], run);
    const BothBits silence = age_.at_least(stale_);

    since_moved_.put(~robots_.moving(Move::hold) & run, 0);
    const BothBits settled = sensed.turned & since_moved_.at_least(braking_);
    const BothBits released = ~age_.at_least(since_asked_) & ~silence;
    const BothBits held = since_entered_.at_least(hold_);
    const Heard heard{letter_.are(Letter::tilt_up) & ~silence, letter_.are(Letter::ack) & ~silence,
                      letter_.are(Letter::tilt_down) & ~silence,
                      letter_.are(Letter::closing) & ~silence, silence};
    BothBits entered{};
    robots_.step(
        run,
        [&](const Robot::Row& row) {
          return who_senses(row.p, sensed) & who_hears(row.heard, heard) &
                 who_may(row.when, settled, released, held);
        },
        [&](const Robot::Row& row, BothBits whose) {
          if (row.next != row.state) entered |= whose;
        });
    since_entered_.put(entered, 0);
    const Letters said = std::exchange(says_, letters());
    since_asked_.put(says_.are(Letter::tilt_up) & run, 0);

    const BothBits centred = ~(sensed.positive | sensed.negative);
    const BothBits ready_now = robots_.in(Robot::State::idle) & centred & ~silence & run;
    since_ready_.put(ready_now, 0);
    const BothBits lately_ready = ~since_ready_.at_least(long_ago_);
    const BothBits known = since_turned_.at_least(age_);
    const BothBits may_start =
        ~silence & partner_ready_ &
        ((partner_rests_ & ready_now & known) | (~partner_rests_ & lately_ready));
    const BothBits must_stop = silence | (partner_rests_ & known);
    const BothBits rested =
        std::exchange(rests_, ((rests_ & ~(may_start & run)) | (~rests_ & must_stop & run)));
    since_turned_.put(rests_ ^ rested, 0);

    const BothBits news = says_.differ(said) | (rests_ ^ rested);
    const BothBits send = (news | since_sent_.at_least(beacon_)) & run;
    since_sent_.put(send, 0);
    post(tick, send & ~lost.from_robot, ready_now | (~rests_ & lately_ready));
    sent_.add(send);
    lost_.add(send & lost.from_robot);
    cases_.note(robots_);
    const CommandBits before = std::exchange(commands_, robots_.commands());
    commands_.rest = rests_;
    commands_.switch_off(hosts.off);
    return commands_.differ(before);
  }

  const CommandBits& commands() const { return commands_; }

  void tell(int i, std::uint32_t ticks, Metrics& metrics, Traffic& traffic) const {
    cases_.tell(i, ticks, metrics);
    tell_links(i, sent_, lost_, traffic);
    for (const std::size_t side : {left, right}) traffic.links[side].late = late_.of(side, i);
  }

 private:
  // Beacons that arrive in a tick: for whom there is one, and what it says.
  struct Beacons {
    Letters letter;
    BothBits rests{};
    BothBits ready{};
    NumberBits age;
  };

  // What the newest letter is while it is fresh.
  struct Heard {
    BothBits tilt_up;
    BothBits ack;
    BothBits tilt_down;
    BothBits closing;
    BothBits silence;
  };

  // A robot whose palm was up for its partner keeps it up.
  void boot(BothBits whose) {
    const BothBits assisted =
        robots_.in(Robot::State::c_grant) | robots_.in(Robot::State::c_withdraw);
    robots_.put(whose & ~assisted, Robot::State::c_tilt_down);
    robots_.put(whose & assisted, Robot::State::c_withdraw);
    says_.remove(whose);
    says_.put(whose, letters());
    for (NumberBits* since : {&age_, &echo_, &since_ready_, &since_sent_}) {
      since->put(whose, NumberBits::most);
    }
    for (NumberBits* since :
         {&since_asked_, &since_moved_, &since_turned_, &since_entered_, &since_booted_}) {
      since->put(whose, 0);
    }
    rests_ |= whose;
    partner_rests_ |= whose;
    partner_ready_ &= ~whose;
  }

  void pass() {
    for (NumberBits* since : {&age_, &echo_, &since_asked_, &since_ready_, &since_moved_,
                              &since_turned_, &since_entered_, &since_sent_, &since_booted_}) {
      since->count();
    }
  }

  // Takes in what arrives while a robot runs.
  void hear(const Beacons& beacons, BothBits run) {
    const BothBits whose = beacons.letter.any() & run;
    const auto take = [&](BothBits& word, BothBits said) {
      word = (word & ~whose) | (said & whose);
    };
    letter_.remove(whose);
    letter_.put(whose, beacons.letter);
    take(partner_rests_, beacons.rests);
    take(partner_ready_, beacons.ready);
    age_.put(whose, beacons.age);
    age_.put(whose & age_.at_least(since_booted_), NumberBits::most);
    echo_.put(whose, there_and_back_);
    late_.add(swapped(whose & age_.at_least(stale_)));
  }

  // How old the partner will take a beacon to be when it arrives: as long as it is then since the partner
  // sent what this robot heard last.
  void post(std::uint64_t tick, BothBits send, BothBits ready) {
    line_[tick % line_.size()].letter = {};  // taken in
    const BothBits comes = swapped(send);
    const Letters letter = says_.swapped();
    const BothBits resting = swapped(rests_);
    const BothBits are_ready = swapped(ready);
    const NumberBits age = echo_.swapped();
    delays_.each(tick, [&](std::size_t row, BothBits whose) {
      Beacons& beacons = line_[row];
      const BothBits those = comes & whose;
      beacons.letter.put(those, letter);
      beacons.rests = (beacons.rests & ~those) | (resting & those);
      beacons.ready = (beacons.ready & ~those) | (are_ready & those);
      beacons.age.put(those, age);
    });
  }

  // What robots in their states say.
  Letters letters() const {
    Letters found;
    for (const Letter letter :
         {Letter::tilt_up, Letter::tilt_down, Letter::ack, Letter::closing, Letter::raised}) {
      found.put(robots_.who([&](const Robot::Doing& doing) { return doing.letter == letter; }),
                letter);
    }
    return found;
  }

  [[gnu::always_inline]] static BothBits who_hears(Robot::Heard wanted, const Heard& heard) {
    const BothBits steep = heard.tilt_up | heard.tilt_down | heard.closing;
    switch (wanted) {
      case Robot::Heard::any: break;
      case Robot::Heard::tilt_up: return heard.tilt_up;
      case Robot::Heard::not_tilt_up: return ~heard.tilt_up;
      case Robot::Heard::ack: return heard.ack;
      case Robot::Heard::not_ack: return ~heard.ack;
      case Robot::Heard::other: return ~(heard.silence | heard.tilt_up);
      case Robot::Heard::steep: return steep;
      case Robot::Heard::not_steep: return ~steep;
      case Robot::Heard::silence: return heard.silence;
    }
    return ~BothBits{};
  }

  [[gnu::always_inline]] BothBits who_may(Robot::If when, BothBits settled, BothBits released,
                                          BothBits held) const {
    switch (when) {
      case Robot::If::any: break;
      case Robot::If::settled: return settled;
      case Robot::If::released: return released;
      case Robot::If::yields: return yields_;
      case Robot::If::held: return held;
    }
    return ~BothBits{};
  }

  StatesInBits<Robot> robots_;
  Letters letter_;  // the newest
  Letters says_;    // what it says itself
  BothBits yields_{};
  BothBits rests_{};
  BothBits partner_rests_{};
  BothBits partner_ready_{};
  BothBits there_{};

  // Times, and how long ago what happened, as in Resilient.
  NumberBits beacon_;
  NumberBits stale_;
  NumberBits hold_;
  NumberBits braking_;
  NumberBits long_ago_;
  NumberBits there_and_back_;  // how long two messages take
  NumberBits age_;
  NumberBits echo_;  // since the partner sent the newest beacon, and as long as one takes on top
  NumberBits since_ready_;
  NumberBits since_asked_;
  NumberBits since_moved_;
  NumberBits since_turned_;
  NumberBits since_entered_;
  NumberBits since_sent_;
  NumberBits since_booted_;

  std::array<Beacons, DelayBits::longest + 1> line_;
  DelayBits delays_;
  CommandBits commands_;
  BitCounts sent_;
  BitCounts lost_;
  BitCounts late_;
  CasesInBits cases_;
};

template <>
struct TeamsInBits<Peers> : PeersInBits {
  static constexpr bool exist = true;
};

}  // namespace palmbots
