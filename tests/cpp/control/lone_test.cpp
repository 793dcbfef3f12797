// SPDX-License-Identifier: Apache-2.0
// The table of a job that one robot does alone (control/lone.hpp), model checked: every state that it
// reaches if an adversary chooses in each cycle whether something presses the palm and when the palm
// has turned, and may restart the program once. Wheels, arm and palm do what they are commanded.
#include <cstdint>
#include <cstdlib>
#include <map>
#include <tuple>
#include <vector>

#include "palmbots/control/lone.hpp"
#include "palmbots/control/table_robot.hpp"
#include "support/check.hpp"

namespace {

using namespace palmbots;
using State = Lone::State;
using Robot = TableRobot<Lone>;

constexpr int top = 3;      // cycles in which the arm rises
constexpr int way = 2;      // cycles of the carry
constexpr int turning = 2;  // cycles in which a palm turns, at most

struct Situation {
  Robot robot;
  int height = 0;
  int gone = 0;
  int turns = 0;  // cycles since the palm was commanded otherwise
  int reboots = 0;

  auto key() const {
    const auto& clock = robot.clock();
    return std::tuple(robot.state(), clock.since_entered, clock.own.tries, clock.own.was_backing,
                      height, gone, turns, reboots);
  }
};
using Key = decltype(std::declval<Situation>().key());

ArmMove arm(const Robot& robot) { return Lone::role(robot.state()).arm; }
bool is_over(State state) { return state == State::done || state == State::failed; }

Robot first_robot() {
  const TableTimes<Lone> times{1, 1, {2, 2, 2, 2, 2}};
  return {times, {true, false}};
}

Situation moved(Situation at, bool touches, bool turned) {
  const ArmMove before = arm(at.robot);
  const Palm palm = at.robot.now().command.palm;
  LiftSenses& senses = at.robot.clock().own.senses;
  senses.touches = touches;
  senses.arm_there = before == ArmMove::rise   ? at.height == top
                     : before == ArmMove::sink ? at.height == 0
                                               : true;
  senses.far_enough = at.gone >= way;
  at.robot.step({Sign::zero, turned, 1, MessageKind::none, false, false, 0});
  at.turns = at.robot.now().command.palm == palm ? at.turns + (at.turns < turning) : 0;
  switch (arm(at.robot)) {
    case ArmMove::reach:
    case ArmMove::rise: at.height += at.height < top; break;
    case ArmMove::sink: at.height -= at.height > 0; break;
    case ArmMove::hold:
    case ArmMove::follow: break;
  }
  if (Lone::is_carrying(at.robot.state()) && at.gone < way) ++at.gone;
  return at;
}

void check(const Situation& at) {
  const State state = at.robot.state();
  const Command& command = at.robot.now().command;
  const bool drives = command.move != Move::hold || !command.stop;
  // No arm that is up is commanded to follow the floor, which would drop it.
  CHECK(arm(at.robot) != ArmMove::follow || at.height == 0);
  // It drives with the nose on the floor, or with the arm at the height of the carry.
  CHECK(!drives || at.height == 0 || (state == State::haul && at.height == top));
  // The palm is steep on the floor only.
  CHECK(command.palm == Palm::shallow || at.height == 0);
  // The palm under the object leaves it only after the carry.
  if (state == State::tip_out || state == State::leave_steep) CHECK(at.gone >= way);
}

// Visits everything that follows. Without a cycle, every wait ends.
class Search {
 public:
  int ends = 0, situations = 0, failed_after_boot = 0;

  void visit(const Situation& at) {
    const auto [place, is_new] = colours_.try_emplace(at.key(), 1);
    if (!is_new) {
      CHECK(place->second == 2);  // 1: a cycle
      return;
    }
    ++situations;
    check(at);
    if (is_over(at.robot.state())) {
      ++ends;
      if (at.reboots > 0 && at.robot.state() == State::failed) ++failed_after_boot;
    } else {
      for (const bool touches : {false, true}) {
        for (const bool turned : {false, true}) {
          if (!turned && at.turns >= turning) continue;
          visit(moved(at, touches, turned));
        }
      }
      if (at.reboots == 0) {
        Situation booted = at;
        booted.robot = at.robot.booted();
        booted.reboots = 1;
        booted.turns = 0;
        visit(booted);
      }
    }
    colours_[at.key()] = 2;
  }

 private:
  std::map<Key, int> colours_;
};

// A robot that restarts with the object on its palm lowers it and stops.
void stops_after_boot() {
  for (const State state : {State::lift, State::haul, State::set_down, State::tip_out}) {
    Situation at{first_robot()};
    at.robot.enter(state);
    at.height = state == State::haul ? top : 0;
    at.robot = at.robot.booted();
    for (int i = 0; i < 2 * top; ++i) at = moved(at, true, true);
    CHECK(at.robot.state() == State::failed && at.height == 0);
  }
}

}  // namespace

int main() {
  Search search;
  search.visit({first_robot()});
  CHECK(search.ends > 0 && search.failed_after_boot > 0);
  stops_after_boot();
  return EXIT_SUCCESS;
}
