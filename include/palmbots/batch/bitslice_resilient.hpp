// SPDX-License-Identifier: Apache-2.0
// The resilient algorithm for 64 pairs of robots at once, with one bit for each robot and
// bit-sliced numbers.
//
// ResilientTeam (sim/resilient_team.hpp) and Resilient handle single beacons; this header does the
// same with operations on words. The table is the one in control/resilient.hpp. It requires that
// the only faults are reboots of robots, that their clocks run like the carry's, and that all
// beacons of a carry have the same delay or are lost. Then no beacon overtakes another, so every
// arriving beacon is the newest. Of the two stamps in a beacon only the resulting age matters, and
// it is stored with the beacon. An echo of a beacon that a robot sent before its boot is older than
// the time since that boot.
#pragma once

#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/sim/resilient_team.hpp"

namespace palmbots {

// 64 pairs with their radio, and their counts.
class BitslicedResilient {
  using Robot = Resilient;
  using Messages = BitslicedMessage<3>;

 public:
  static constexpr bool can_stop = true;
  static constexpr bool station = false;

  static bool supports(const ResilientTeam& team) {
    const Robot::Times& t = team.times();
    const std::uint32_t longest =
        std::max({std::uint32_t{t.beacon}, t.lease + 1U, std::uint32_t{t.hold},
                  std::uint32_t{t.braking}, t.join + 1U});
    return longest <= BitslicedCounter::most &&
           BitslicedDelay::supports(team.radio().steady_delay()) && team.keeps_time() &&
           team.faults().are_reboots();
  }

  void insert(int i, const ResilientTeam& team) {
    const RobotMask here = both_at(i);
    const Robot::Times& t = team.times();
    limits_.beacon.assign(here, t.beacon);
    limits_.stale.assign(here, t.lease + 1U);
    limits_.hold.assign(here, t.hold);
    limits_.braking.assign(here, t.braking);
    limits_.long_ago.assign(here, t.join + 1U);
    there_and_back_.assign(here, 2 * team.radio().steady_delay());
    delays_.insert(i, team.radio().steady_delay());
    for (const std::size_t side : {left, right}) {
      if (team.robot(side).yields()) lease_.yields[side] |= CarryMask{1} << i;
    }
    there_ |= here;
    boot(here);
    for (BitslicedCounts* counts : {&sent_, &lost_, &late_}) counts->clear(here);
    cases_.insert(i);
  }

  void erase(int i) {
    const RobotMask here = both_at(i);
    robots_.erase(here);
    for (Beacons& beacons : line_) beacons.message.erase(here);
    for (RobotMask* words : {&lease_.yields, &lease_.stopped, &lease_.partner_stopped,
                             &lease_.partner_ready, &there_}) {
      *words &= ~here;
    }
    delays_.erase(i);
    commands_.erase(here);
    cases_.erase(i);
  }

  CarryMask step(std::uint64_t tick, const BitslicedObservation& sensed,
                 const BitslicedProgramState& programs, const BitslicedLoss& lost) {
    if (either(programs.booting) != 0) [[unlikely]]
      boot(programs.booting);
    const RobotMask run = there_ & ~programs.off;
    lease_.pass(1, limits_);
    echo_.increment();
    since_booted_.increment();
    hear(line_[tick % line_.size()], run);
    const RobotMask silence = lease_.silence(limits_);

    const auto met = lease_.template conditions<Robot::Conditions<RobotMask>>(
        run, ~robots_.moving(Move::hold), sensed.palm_at_target, silence, limits_);
    const Heard heard{message_.is(MessageKind::tilt_up) & ~silence,
                      message_.is(MessageKind::ack) & ~silence,
                      message_.is(MessageKind::tilt_down) & ~silence,
                      message_.is(MessageKind::closing) & ~silence, silence};
    RobotMask entered{};
    robots_.step(
        run, [&](const Robot::Row& row) { return Robot::fits<RobotMask>(row, sensed, heard, met); },
        [&](const Robot::Row& row, RobotMask whose) {
          if (row.next != row.state) entered |= whose;
        });
    const Messages said = std::exchange(says_, messages());
    const RobotMask centred = robots_.in(Robot::State::idle) & ~(sensed.positive | sensed.negative);
    const auto [ready, send] = lease_.finish(run, entered, says_.is(MessageKind::tilt_up), centred,
                                             says_.differ(said), silence, limits_);
    post(tick, send & ~lost.from_robot, ready);
    sent_.add(send);
    lost_.add(send & lost.from_robot);
    cases_.note(robots_);
    const BitslicedCommand before = std::exchange(commands_, robots_.commands());
    commands_.stop = lease_.stopped;
    commands_.switch_off(programs.off);
    return commands_.differ(before);
  }

  const BitslicedCommand& commands() const { return commands_; }

  void write_results(int i, std::uint32_t ticks, Metrics& metrics, LinkTotals& link_totals) const {
    cases_.write_results(i, ticks, metrics);
    write_link_totals(i, sent_, lost_, link_totals);
    for (const std::size_t side : {left, right}) link_totals.links[side].late = late_.of(side, i);
  }

 private:
  // The beacons that arrive in a tick: who gets one, and its content.
  struct Beacons {
    Messages message;
    RobotMask stops{};
    RobotMask ready{};
    BitslicedCounter age;
  };

  // The newest message while it is fresh.
  struct Heard {
    RobotMask tilt_up;
    RobotMask ack;
    RobotMask tilt_down;
    RobotMask closing;
    RobotMask silence;

    [[gnu::always_inline]] RobotMask is(MessageKind kind) const {
      switch (kind) {
        case MessageKind::tilt_up: return tilt_up;
        case MessageKind::ack: return ack;
        case MessageKind::tilt_down: return tilt_down;
        case MessageKind::closing: return closing;
        case MessageKind::none: return silence;
        case MessageKind::raised: break;
      }
      return ~(tilt_up | ack | tilt_down | closing | silence);
    }
  };

  // A robot whose palm was up for its partner keeps it up after a boot.
  void boot(RobotMask whose) {
    const RobotMask assisted =
        robots_.in(Robot::State::c_grant) | robots_.in(Robot::State::c_withdraw);
    robots_.insert(whose & ~assisted, Robot::State::c_tilt_down);
    robots_.insert(whose & assisted, Robot::State::c_withdraw);
    says_.erase(whose);
    says_.insert(whose, messages());
    for (BitslicedCounter* since : {&lease_.age, &echo_, &lease_.since_ready, &lease_.since_sent}) {
      since->assign(whose, BitslicedCounter::most);
    }
    for (BitslicedCounter* since : {&lease_.since_asked, &lease_.since_moved, &lease_.since_turned,
                                    &lease_.since_entered, &since_booted_}) {
      since->assign(whose, 0);
    }
    lease_.stopped |= whose;
    lease_.partner_stopped |= whose;
    lease_.partner_ready &= ~whose;
  }

  // Takes in the beacons that arrive while a robot runs.
  void hear(const Beacons& beacons, RobotMask run) {
    const RobotMask whose = beacons.message.any() & run;
    const auto take = [&](RobotMask& word, RobotMask said) {
      word = (word & ~whose) | (said & whose);
    };
    message_.erase(whose);
    message_.insert(whose, beacons.message);
    take(lease_.partner_stopped, beacons.stops);
    take(lease_.partner_ready, beacons.ready);
    lease_.age.assign(whose, beacons.age);
    lease_.age.assign(whose & lease_.age.at_least(since_booted_), BitslicedCounter::most);
    echo_.assign(whose, there_and_back_);
    late_.add(swapped(whose & lease_.age.at_least(limits_.stale)));
  }

  // The age that the partner will assign to a beacon when it arrives: the time since the partner
  // sent the message that this robot received last.
  void post(std::uint64_t tick, RobotMask send, RobotMask ready) {
    line_[tick % line_.size()].message = {};  // delivered
    const RobotMask comes = swapped(send);
    const Messages message = says_.swapped();
    const RobotMask resting = swapped(lease_.stopped);
    const RobotMask are_ready = swapped(ready);
    const BitslicedCounter age = echo_.swapped();
    delays_.each(tick, [&](std::size_t row, RobotMask whose) {
      Beacons& beacons = line_[row];
      const RobotMask those = comes & whose;
      beacons.message.insert(those, message);
      beacons.stops = (beacons.stops & ~those) | (resting & those);
      beacons.ready = (beacons.ready & ~those) | (are_ready & those);
      beacons.age.assign(those, age);
    });
  }

  // The messages that the robots broadcast in their states.
  Messages messages() const {
    Messages found;
    for (const MessageKind message :
         {MessageKind::tilt_up, MessageKind::tilt_down, MessageKind::ack, MessageKind::closing,
          MessageKind::raised}) {
      found.insert(
          robots_.who([&](const Robot::StateOutput& output) { return output.message == message; }),
          message);
    }
    return found;
  }

  BitslicedTable<Robot> robots_;
  Messages message_;  // the newest
  Messages says_;     // its own message
  RobotMask there_{};
  LeaseLimits<BitslicedCounter> limits_;
  LeaseState<RobotMask, BitslicedCounter> lease_;
  BitslicedCounter there_and_back_;  // the delay of two messages
  BitslicedCounter
      echo_;  // time since the partner sent the newest beacon, plus the delay of one message
  BitslicedCounter since_booted_;

  std::array<Beacons, BitslicedDelay::longest + 1> line_;
  BitslicedDelay delays_;
  BitslicedCommand commands_;
  BitslicedCounts sent_;
  BitslicedCounts lost_;
  BitslicedCounts late_;
  BitslicedCaseMetrics cases_;
};

template <>
struct BitslicedTeam<ResilientTeam> : BitslicedResilient {
  static constexpr bool exist = true;
};
static_assert(DecidesInBits<BitslicedTeam<ResilientTeam>, ResilientTeam>);

}  // namespace palmbots
