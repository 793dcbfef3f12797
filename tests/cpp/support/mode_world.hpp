// SPDX-License-Identifier: Apache-2.0
// Two robots with the shipped mode machine, a radio and an operator, as a graph of states.
//
// The robots step in turn; one step of each is a tick. In its turn a robot hears any packet that is
// under way, or none; never an older one after a newer one, and none from before its own boot
// (wire/endpoint.hpp ensures both, and that a copy is not heard again). The operator, the hardware
// and the clock do what they like. Each step sends one packet, which may be lost.
//
// The names of the robots make no difference. A state therefore lists first the robot whose turn it
// is.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "palmbots/runtime/mode_machine.hpp"

namespace palmbots::test {

using runtime::ModeInputs;
using runtime::ModeSettings;
using runtime::ModeTable;
using runtime::never;
using wire::Operation;
using wire::RobotMode;

constexpr bool carries(RobotMode mode) {
  return mode == RobotMode::carrying || mode == RobotMode::holding;
}
constexpr bool is_under_way(RobotMode mode) { return carries(mode) || mode == RobotMode::ready; }

// Modes of the partner on which a robot acts alike; one of them stands for all. A test shows that it
// does.
constexpr RobotMode as_heard(RobotMode mode) {
  if (is_under_way(mode)) return RobotMode::ready;
  if (mode == RobotMode::disarmed || mode == RobotMode::armed) return RobotMode::fault;
  return mode;
}

// What a robot still needs before its wheels may turn, by the rules for the operator.
enum Needs : std::uint8_t { nothing, a_start, arming, a_release };

// A packet under way; mode off: none.
struct Packet {
  RobotMode mode = RobotMode::off;
  std::uint8_t age = 0;
  bool answers = false;    // its sender knew the receiver's present boot
  bool is_current = true;  // of the sender's present boot

  constexpr bool operator==(const Packet&) const = default;
};

struct Robot {
  RobotMode mode = RobotMode::off;
  std::uint8_t carried = 0;
  RobotMode news = RobotMode::off;  // the partner's mode as heard
  std::uint8_t news_age = 0;
  bool knows = false;  // it has heard the partner's present boot
  bool stored_carry = false;
  bool stored_stop = false;
  Needs needs = arming;          // for the checks only
  std::uint8_t since_ready = 0;  // time since it was under way; for the checks only
  std::array<Packet, 2> to{};    // packets to it, the oldest first

  constexpr bool operator==(const Robot&) const = default;
};

struct Pair {
  Robot now;  // steps next
  Robot other;
  std::uint8_t reboots = 0;  // that may still happen

  constexpr bool operator==(const Pair&) const = default;
};

// What happens in the turn of a robot.
struct Turn {
  int hears = -1;  // which packet
  bool operates = false;
  Operation operation = Operation::disarm;
  bool preflight = true;
  bool stop = false;
  bool driver_ok = true;
  bool covered = false;
  bool station_ok = true;
  bool time_up = false;
  bool travels = true;
};

class ModeWorld {
 public:
  ModeSettings settings;
  const ModeTable* table = &runtime::mode_table;
  std::uint8_t reboots = 1;
  int room = 1;  // packets under way to each robot

  std::uint8_t oldest() const { return static_cast<std::uint8_t>(settings.lease + 1); }

  // Both robots have booted once and know each other.
  Pair start() const {
    Robot robot;
    robot.mode = RobotMode::disarmed;
    robot.news_age = robot.since_ready = oldest();
    robot.knows = settings.has_radio;
    return {robot, robot, reboots};
  }

  // The program of a robot ends. Its next step is a boot.
  Pair reboot(const Pair& from) const {
    const Pair later = aged(from);
    const Robot& old = later.now;
    Robot robot;
    robot.stored_carry = carries(old.mode);
    robot.stored_stop = old.mode == RobotMode::stopped;
    robot.news_age = oldest();
    robot.since_ready = old.since_ready;
    const bool rejoins =
        settings.after_reboot == runtime::AfterReboot::rejoin && robot.stored_carry;
    robot.needs = rejoins ? old.needs : std::max(old.needs, arming);
    robot.to = old.to;
    for (Packet& packet : robot.to) packet.answers = false;
    Robot partner = later.other;
    partner.knows = false;
    for (Packet& packet : partner.to) {
      if (packet.mode != RobotMode::off) packet.is_current = false;
    }
    return {tidy(partner), tidy(robot), static_cast<std::uint8_t>(from.reboots - 1)};
  }

  // A turn without a step: the robot is still off, or its program is held up.
  Pair wait(const Pair& from) const {
    Pair later = aged(from);
    if (carries(later.now.mode)) age(later.now.carried);  // the next step adds the time
    return {tidy(later.other), tidy(later.now), from.reboots};
  }

  struct Step {
    Pair next;
    Pair lost;  // the same, but the packet of this step is lost
    const char* violates = nullptr;
  };

  // A turn with a step of the shipped machine.
  Step step(const Pair& from, const Turn& turn) const {
    auto [robot, partner, left] = aged(from);
    ModeInputs in;
    bool stop_heard = false;
    if (turn.hears >= 0) stop_heard = hear(robot, static_cast<std::size_t>(turn.hears));
    const bool was_off = robot.mode == RobotMode::off;
    in.partner = {robot.news, robot.news_age > settings.lease ? never : robot.news_age};
    in.partner_stop = stop_heard;
    in.operates = turn.operates;
    in.operation = turn.operation;
    in.stop = turn.stop;
    in.driver_ok = turn.driver_ok;
    in.covered = turn.covered;
    in.station_age = turn.station_ok ? 0 : never;
    in.travels = turn.travels;
    in.preflight = {turn.preflight, true, true, true, 0};
    const runtime::ModeMemory memory{robot.mode, wire::FaultCode::none,
                                     turn.time_up ? settings.time_limit : robot.carried, 0};
    runtime::ModeMachine machine(settings, {robot.stored_carry, robot.stored_stop}, memory, *table);
    const auto out = machine.step(in);
    const RobotMode before = robot.mode;
    robot.mode = out.mode;
    robot.carried =
        static_cast<std::uint8_t>(std::min<std::uint32_t>(machine.memory().carried, oldest()));
    robot.stored_carry = robot.stored_stop = false;
    require(robot, before, in, stop_heard);
    const char* violated = check(robot, partner, before, out, stop_heard, was_off);
    if (is_under_way(robot.mode)) robot.since_ready = 0;
    const Pair lost{tidy(partner), tidy(robot), left};
    if (settings.has_radio) send(robot, partner);
    return {{tidy(partner), lost.other, left}, lost, violated};
  }

  // Every turn that can happen to the robot that is next.
  template <class Visit>
  void each_turn(const Pair& from, Visit&& visit) const {
    for (int hears = -1; hears < 2; ++hears) {
      if (hears >= 0 && from.now.to[static_cast<std::size_t>(hears)].mode == RobotMode::off)
        continue;
      each_event([&](Turn turn) {
        turn.hears = hears;
        visit(turn);
      });
    }
  }

 private:
  // What the operator wants, and what happens besides.
  template <class Visit>
  static void each_event(Visit&& visit) {
    Turn turn;
    const auto also = [&](auto Turn::* what, bool value) {
      Turn other = turn;
      other.*what = value;
      visit(other);
    };
    visit(turn);
    also(&Turn::stop, true);
    also(&Turn::covered, true);
    also(&Turn::driver_ok, false);
    also(&Turn::station_ok, false);
    also(&Turn::time_up, true);
    also(&Turn::travels, false);
    turn.operates = true;
    for (const Operation wish :
         {Operation::arm, Operation::disarm, Operation::start, Operation::release}) {
      turn.operation = wish;
      visit(turn);
      also(&Turn::stop, true);
      also(&Turn::covered, true);
      also(&Turn::driver_ok, false);
      if (wish == Operation::arm) also(&Turn::preflight, false);
    }
  }

  void age(std::uint8_t& time) const {
    if (time < oldest()) ++time;
  }

  // The state at the next turn, before anything happens in it.
  Pair aged(Pair pair) const {
    age(pair.now.news_age);
    for (Packet& packet : pair.now.to) {
      if (packet.mode != RobotMode::off) age(packet.age);
    }
    age(pair.other.since_ready);
    return pair;
  }

  // Returns whether the packet passes on a stop.
  static bool hear(Robot& robot, std::size_t which) {
    const Packet packet = robot.to[which];
    robot.to = {which == 0 ? robot.to[1] : Packet{}, Packet{}};
    if (packet.is_current) robot.knows = true;
    if (!packet.answers) return false;
    robot.news = packet.mode;
    robot.news_age = packet.age;
    return packet.mode == RobotMode::stopped;
  }

  // A packet that says the same as the one before it replaces it. Where there is no room, the
  // oldest is lost.
  void send(const Robot& robot, Robot& partner) const {
    const Packet packet{as_heard(robot.mode), 0, robot.knows, true};
    std::array<Packet, 2>& to = partner.to;
    const bool is_empty = to[0].mode == RobotMode::off;
    const std::size_t last = to[1].mode == RobotMode::off ? 0 : 1;
    const Packet& newest = to[last];
    const bool same = newest.mode == packet.mode && newest.answers == packet.answers &&
                      newest.is_current == packet.is_current;
    if (is_empty || same || room == 1) {
      to[last] = packet;
    } else {
      if (last == 1) to[0] = to[1];
      to[1] = packet;
    }
  }

  // States that behave alike are one state.
  Robot tidy(Robot robot) const {
    if (!carries(robot.mode)) robot.carried = 0;
    if (robot.news_age > settings.lease && is_under_way(robot.news)) robot.news = RobotMode::off;
    if (robot.news == RobotMode::off) robot.news_age = oldest();
    return robot;
  }

  // Follows what the operator has done, without the machine.
  void require(Robot& robot, RobotMode before, const ModeInputs& in, bool stop_heard) const {
    const bool may_arm =
        in.preflight.contact && in.driver_ok &&
        (!settings.has_radio || (in.partner.age != never && in.partner.mode != RobotMode::stopped));
    const bool latches = before != RobotMode::disarmed && before != RobotMode::stopped;
    if (in.stop || (stop_heard && latches)) {
      robot.needs = a_release;
      return;
    }
    // A program that boots has not been asked anything yet.
    if (in.operates && before != RobotMode::off) {
      const bool released = in.operation == Operation::release && robot.needs == a_release;
      const bool armed = in.operation == Operation::arm && robot.needs == arming && may_arm;
      const bool started = in.operation == Operation::start && robot.needs == a_start;
      if (released) robot.needs = arming;
      if (armed) robot.needs = a_start;
      if (started) robot.needs = nothing;
      if (in.operation == Operation::disarm) robot.needs = std::max(robot.needs, arming);
    }
    // A robot that has ended has to be armed again.
    const bool ended = robot.mode == RobotMode::done || robot.mode == RobotMode::fault;
    if (ended) robot.needs = std::max(robot.needs, arming);
  }

  // The properties that one step can violate.
  const char* check(const Robot& robot, const Robot& partner, RobotMode before,
                    const runtime::ModeOutputs& out, bool stop_heard, bool was_off) const {
    if (out.wheels != carries(out.mode)) return "M1";
    if (carries(out.mode) && !carries(before) && !was_off && settings.has_radio &&
        partner.since_ready > settings.lease) {
      return "M2";
    }
    if (out.stop != (out.mode == RobotMode::stopped)) return "M3";
    if (stop_heard && out.mode != RobotMode::stopped && out.mode != RobotMode::disarmed) {
      return "M3";
    }
    if (robot.needs == a_release && out.mode != RobotMode::stopped) return "M3";
    if (out.wheels && robot.needs != nothing) return "M6";
    if (was_off && out.wheels && settings.after_reboot == runtime::AfterReboot::disarm) return "M6";
    return nullptr;
  }
};

}  // namespace palmbots::test
