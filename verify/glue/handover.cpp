// SPDX-License-Identifier: Apache-2.0
// The table of jobs in which one robot hands the object to the other one, as shipped
// (palmbots/control/hand_over.hpp), behind handover.h.
#include "handover.h"

#include "palmbots/control/hand_over.hpp"
#include "palmbots/sim/table_team.hpp"

#include "leased_radio.hpp"
#include "table_robots.hpp"

using namespace glue;
using palmbots::ArmMove;
using palmbots::HandOver;
using palmbots::Move;
using palmbots::Palm;
using State = HandOver::State;
using States = HandOver::Set;

namespace {

TableTimes<HandOver> times{};
int top = 0;

TableRobot<HandOver> awake(int side) {
  const mind& m = pair.mind[side];
  auto robot = robot_in<HandOver>(m.state, side, times);
  robot.clock().since_entered = m.since_entered;
  robot.clock().own.tries = m.tries;
  robot.clock().own.was_backing = m.backs != 0;
  return robot;
}

mind packed(const TableRobot<HandOver>& robot) {
  const auto& own = robot.clock().own;
  return {static_cast<unsigned char>(robot.state()),
          static_cast<unsigned char>(robot.clock().since_entered), own.tries, own.was_backing};
}

State state(int side) { return static_cast<State>(pair.mind[side].state); }
ArmMove arm(int side) { return HandOver::role(state(side)).arm; }
const palmbots::TableOutput& output(int side) { return HandOver::outputs[pair.mind[side].state]; }

// The arm has reached the height commanded in the last cycle.
bool is_there(int side) {
  if (arm(side) == ArmMove::rise) return pair.height[side] == top;
  return arm(side) != ArmMove::sink || pair.height[side] == 0;
}

// The robot after a step.
mind stepped(int side, int heard, int reading) {
  TableRobot<HandOver> robot = awake(side);
  auto& senses = robot.clock().own.senses;
  senses.touches = (reading & TOUCHES) != 0;
  senses.arm_there = is_there(side);
  senses.far_enough = (reading & FAR) != 0;
  robot.step(
      {Sign::zero, (reading & TURNED) != 0, 1, static_cast<MessageKind>(heard), false, false, 0});
  return packed(robot);
}

void move_arm(int side) {
  unsigned char& height = pair.height[side];
  if (arm(side) == ArmMove::rise) height = static_cast<unsigned char>(height + (height < top));
  if (arm(side) == ArmMove::sink) height = static_cast<unsigned char>(height - (height > 0));
}

bool same(const mind& a, const mind& b) {
  return a.state == b.state && a.since_entered == b.since_entered && a.tries == b.tries &&
         a.backs == b.backs;
}

}  // namespace

extern "C" {

struct pair pair;

void set_program(int cycles, int reach, int height) {
  set_lease(cycles);
  // Ages are counted here; a controller gets a fresh message or none.
  times = {1, 1, palmbots::table_limits<HandOver>({0, 0, 0.1 * reach, 0}, 1)};
  top = height;
}

void robot_boot(int side, int stores) {
  const TableRobot<HandOver> robot = awake(side);
  pair.mind[side] = packed(robot.booted(stores != 0 && robot.assists()));
  forget(side);
}

int readings(int side, int choice, int helps) {
  const struct radio before = radio;
  const int heard = hear(side, choice);
  radio = before;
  mind known[READINGS];
  int mask = 0;
  for (int reading = 0; reading < READINGS; ++reading) {
    if (helps && (reading & (FAR | TURNED)) != (FAR | TURNED)) continue;
    known[reading] = stepped(side, heard, reading);
    bool is_new = true;
    for (int other = 0; other < reading; ++other) {
      is_new &= (mask >> other & 1) == 0 || !same(known[other], known[reading]);
    }
    mask |= int{is_new} << reading;
  }
  return mask;
}

void robot_step(int side, int choice, int reading) {
  pair.mind[side] = stepped(side, hear(side, choice), reading);
  say(side, static_cast<int>(output(side).message));
  move_arm(side);
}

int picks_up(int side) {
  return States{State::scoop, State::seat, State::ease, State::lift}.has(state(side));
}
int drives(int side) {
  return output(side).command.move != Move::hold || !output(side).command.stop;
}
int arm_follows_floor(int side) { return arm(side) == ArmMove::follow; }
int is_steep(int side) { return output(side).command.palm == Palm::steep; }
int leaves_wall(int side) {
  return (side == LEFT ? States{State::retreat} : States{State::clear, State::ahead})
      .has(state(side));
}
int needs_no_wall(int side) {
  return (side == LEFT ? States{State::hold_up, State::land, State::failed}
                       : States{State::haul, State::set_down, State::tip_out, State::leave_steep,
                                State::retreat, State::done, State::land, State::failed})
      .has(state(side));
}
int is_over(int side) { return States{State::done, State::failed}.has(state(side)); }

char robot_case(int) { return ' '; }
const char* robot_doing(int side) { return palmbots::name_of(state(side)); }

}  // extern "C"
