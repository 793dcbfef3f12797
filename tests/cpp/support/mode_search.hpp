// SPDX-License-Identifier: Apache-2.0
// A breadth-first search through all states of two robots with mode machines (mode_world.hpp).
//
// The properties, by the names under which a violation is reported:
//   M1  the wheels may turn only in carrying and holding
//   M2  a robot begins a carry only if its partner was ready or carried within the lease
//   M3  a stop that arrives stops; no robot leaves `stopped` without a release, and none carries
//       then without being armed and started
//   M4  when one robot has ended, the other ends too as soon as packets arrive again, and, if the
//       settings say so, after the lease without any packet
//   M5  from every state an operator brings both robots to a carry: it releases, arms and starts
//   M6  no wheels turn without an arming and a start, also after a boot, except to rejoin a carry
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <unordered_map>
#include <vector>

#include "support/mode_world.hpp"

namespace palmbots::test {

class ModeSearch {
 public:
  explicit ModeSearch(const ModeWorld& world) : world_(world) {}

  // The first violation, or none.
  const char* run() {
    add(world_.start());
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const Pair from = states_[i];
      from_ = i;
      if (!partner_ends(from)) return "M4";
      add(world_.wait(from));
      if (from.reboots > 0) add(world_.reboot(from));
      const char* violated = nullptr;
      world_.each_turn(from, [&](const Turn& turn) {
        if (violated != nullptr) return;
        const ModeWorld::Step step = world_.step(from, turn);
        add(step.next);
        add(step.lost);
        if (step.violates != nullptr) violated = step.violates;
        ++transitions_;
      });
      if (violated != nullptr) return violated;
    }
    return operator_succeeds() ? nullptr : "M5";
  }

  // Prints the modes on a shortest way to the state from which the violation was found: first the
  // robot whose turn it is.
  void print_trail() const {
    std::vector<std::size_t> trail{from_};
    while (trail.back() != 0) trail.push_back(parents_[trail.back()]);
    for (std::size_t i = trail.size(); i-- > 0;) {
      const Pair& pair = states_[trail[i]];
      std::printf("  %-9s hears %-8s | %-9s hears %s\n", name_of(pair.now.mode),
                  name_of(pair.now.news), name_of(pair.other.mode), name_of(pair.other.news));
    }
  }

  std::size_t states() const { return states_.size(); }
  std::size_t transitions() const { return transitions_; }
  // The longest that a robot carried on after its partner had ended [turns].
  int longest() const { return longest_; }

 private:
  using Key = std::array<std::uint64_t, 2>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      const std::uint64_t mixed = key[0] * 0x9E3779B97F4A7C15 ^ key[1] * 0xC2B2AE3D27D4EB4F;
      return mixed ^ mixed >> 29;
    }
  };

  static std::uint64_t packed(const Robot& robot) {
    std::uint64_t bits = 0;
    const auto put = [&](unsigned value, unsigned width) { bits = bits << width | value; };
    put(static_cast<unsigned>(robot.mode), 4);
    put(robot.carried, 3);
    put(static_cast<unsigned>(robot.news), 4);
    put(robot.news_age, 3);
    put(robot.knows, 1);
    put(robot.stored_carry, 1);
    put(robot.stored_stop, 1);
    put(robot.needs, 2);
    put(robot.since_ready, 3);
    for (const Packet& packet : robot.to) {
      put(static_cast<unsigned>(packet.mode), 4);
      put(packet.age, 3);
      put(packet.answers, 1);
      put(packet.is_current, 1);
    }
    return bits;
  }
  static Key key_of(const Pair& pair) {
    return {packed(pair.now) << 1 | pair.reboots, packed(pair.other)};
  }

  void add(const Pair& pair) {
    if (!numbers_.try_emplace(key_of(pair), states_.size()).second) return;
    states_.push_back(pair);
    parents_.push_back(from_);
  }

  // A turn without faults; the newest packet arrives.
  static Turn prompt(const Pair& pair) {
    Turn turn;
    for (int i = 0; i < 2; ++i) {
      if (pair.now.to[static_cast<std::size_t>(i)].mode != RobotMode::off) turn.hears = i;
    }
    return turn;
  }

  static bool has_ended(RobotMode mode) {
    return mode == RobotMode::done || mode == RobotMode::stopped || mode == RobotMode::fault;
  }

  // M4.
  bool partner_ends(const Pair& state) {
    if (!world_.settings.has_radio || !carries(state.now.mode)) return true;
    if (has_ended(state.other.mode)) {
      Pair pair = state;
      for (int turns = 0; turns % 2 == 1 || carries(pair.now.mode); ++turns) {
        if (turns > 3) return false;
        longest_ = turns > longest_ ? turns : longest_;
        pair = world_.step(pair, prompt(pair)).next;
      }
    }
    if (world_.settings.partner_lost == runtime::PartnerLost::stop) {
      Pair pair = state;
      for (std::uint32_t tick = 0; tick <= world_.settings.lease; ++tick) {
        pair = world_.step(pair, {}).next;
        pair = world_.step(pair, {}).next;
      }
      if (carries(pair.now.mode)) return false;
    }
    return true;
  }

  // M5: the operator does for each robot what its mode asks for, and serves one after the other, so
  // that each robot hears several packets of the other between two wishes.
  bool operator_succeeds() {
    constexpr std::size_t period = 6;  // turns until a robot is served again
    enum : char { unknown, on_the_way, leads_to_a_carry };
    std::vector<char> known(states_.size() * period, unknown);
    for (std::size_t first = 0; first < known.size(); ++first) {
      std::vector<std::size_t> path;
      std::size_t at = first;
      while (known[at] == unknown && !both_carry(states_[at / period])) {
        known[at] = on_the_way;
        path.push_back(at);
        const std::size_t phase = at % period;
        const Pair next = operated(states_[at / period], phase % (period / 2) == 0);
        const auto found = numbers_.find(key_of(next));
        if (found == numbers_.end()) return false;
        at = found->second * period + (phase + 1) % period;
      }
      if (known[at] == on_the_way) {  // for ever without a carry
        from_ = at / period;
        return false;
      }
      known[at] = leads_to_a_carry;
      for (const std::size_t passed : path) known[passed] = leads_to_a_carry;
    }
    return true;
  }

  static bool both_carry(const Pair& pair) {
    return carries(pair.now.mode) && carries(pair.other.mode);
  }

  Pair operated(const Pair& pair, bool is_served) const {
    Turn turn = prompt(pair);
    const RobotMode mode = pair.now.mode;
    const auto wish = [&](bool fits, Operation operation) {
      if (!fits || !is_served) return;
      turn.operates = true;
      turn.operation = operation;
    };
    wish(mode == RobotMode::stopped, Operation::release);
    wish(mode == RobotMode::armed, Operation::start);
    wish(mode == RobotMode::disarmed || mode == RobotMode::done || mode == RobotMode::fault,
         Operation::arm);
    return world_.step(pair, turn).next;
  }

  const ModeWorld& world_;
  std::vector<Pair> states_;
  std::vector<std::size_t> parents_;  // from which each state was found first
  std::size_t from_ = 0;              // the state whose turns are visited
  std::unordered_map<Key, std::size_t, Hash> numbers_;
  std::size_t transitions_ = 0;
  int longest_ = 0;
};

}  // namespace palmbots::test
