// SPDX-License-Identifier: Apache-2.0
// The resilient algorithm for 64 pairs of robots at once, with one bit for each robot and
// bit-sliced numbers.
//
// ResilientTeam (sim/beacon_team.hpp) and Resilient handle single beacons; this header does the
// same with operations on words. The table is the one in control/resilient.hpp. It requires that
// the only faults are reboots of robots, that their clocks run like the carry's, and that all
// beacons of a carry have the same delay or are lost (batch/bitslice_beacons.hpp).
#pragma once

#include "palmbots/batch/bitslice_beacons.hpp"
#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/sim/beacon_team.hpp"

namespace palmbots {

// 64 pairs with their radio, and their counts.
class BitslicedResilient {
  using Robot = Resilient;
  using Messages = BitslicedMessage<3>;
  using Content = BitslicedMessage<5>;
  static constexpr std::size_t stops = 3;  // bits of the content, after those of the message
  static constexpr std::size_t is_ready = 4;

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
    beacons_.insert(i, team.radio().steady_delay());
    for (const std::size_t side : {left, right}) {
      if (team.robot(side).yields()) lease_.yields[side] |= CarryMask{1} << i;
    }
    there_ |= here;
    boot(here);
    cases_.insert(i);
  }

  void erase(int i) {
    const RobotMask here = both_at(i);
    robots_.erase(here);
    for (RobotMask* words : {&lease_.yields, &lease_.stopped, &lease_.partner_stopped,
                             &lease_.partner_ready, &there_}) {
      *words &= ~here;
    }
    beacons_.erase(i);
    commands_.erase(here);
    cases_.erase(i);
  }

  CarryMask step(std::uint64_t tick, const BitslicedObservation& sensed,
                 const BitslicedProgramState& programs, const BitslicedLoss& lost) {
    if (either(programs.booting) != 0) [[unlikely]]
      boot(programs.booting);
    const RobotMask run = there_ & ~programs.off;
    lease_.pass(1, limits_);
    hear(tick, run);
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
    beacons_.post(tick, send, lost.from_robot, content(ready));
    cases_.note(robots_);
    const BitslicedCommand before = std::exchange(commands_, robots_.commands());
    commands_.stop = lease_.stopped;
    commands_.switch_off(programs.off);
    return commands_.differ(before);
  }

  const BitslicedCommand& commands() const { return commands_; }

  void write_results(int i, std::uint32_t ticks, Metrics& metrics, LinkTotals& link_totals) const {
    cases_.write_results(i, ticks, metrics);
    beacons_.write_results(i, link_totals);
  }

 private:
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
        default: break;
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
    for (BitslicedCounter* since : {&lease_.age, &lease_.since_ready, &lease_.since_sent}) {
      since->assign(whose, BitslicedCounter::most);
    }
    for (BitslicedCounter* since :
         {&lease_.since_asked, &lease_.since_moved, &lease_.since_turned, &lease_.since_entered}) {
      since->assign(whose, 0);
    }
    beacons_.boot(whose);
    lease_.stopped |= whose;
    lease_.partner_stopped |= whose;
    lease_.partner_ready &= ~whose;
  }

  // Takes in the beacons that arrive while a robot runs.
  void hear(std::uint64_t tick, RobotMask run) {
    const RobotMask whose = beacons_.hear(tick, run, newest_, lease_.age, limits_.stale);
    const auto take = [&](RobotMask& word, RobotMask said) {
      word = (word & ~whose) | (said & whose);
    };
    std::copy_n(newest_.bit.begin(), message_.bit.size(), message_.bit.begin());
    take(lease_.partner_stopped, newest_.bit[stops]);
    take(lease_.partner_ready, newest_.bit[is_ready]);
  }

  // What the robots' beacons contain: message, whether they rest, whether they are ready.
  Content content(RobotMask ready) const {
    Content said;
    std::copy_n(says_.bit.begin(), says_.bit.size(), said.bit.begin());
    said.bit[stops] = lease_.stopped;
    said.bit[is_ready] = ready;
    return said;
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
  Content newest_;    // of the partner's beacons
  Messages message_;  // in it
  Messages says_;     // its own message
  RobotMask there_{};
  LeaseLimits<BitslicedCounter> limits_;
  LeaseState<RobotMask, BitslicedCounter> lease_;
  BitslicedBeacons<5> beacons_;
  BitslicedCommand commands_;
  BitslicedCaseMetrics cases_;
};

template <>
struct BitslicedTeam<ResilientTeam> : BitslicedResilient {
  static constexpr bool exist = true;
};
static_assert(DecidesInBits<BitslicedTeam<ResilientTeam>, ResilientTeam>);

}  // namespace palmbots
