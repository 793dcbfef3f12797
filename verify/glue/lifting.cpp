// SPDX-License-Identifier: Apache-2.0
// The table of jobs on the floor as shipped (palmbots/control/lifting.hpp) behind lifting.h.
#include "palmbots/control/lifting.hpp"

#include "palmbots/sim/table_team.hpp"

#include "leased_radio.hpp"
#include "lifting.h"
#include "table_robots.hpp"

using namespace glue;
using palmbots::ArmMove;
using palmbots::Driver;
using palmbots::Lifting;
using palmbots::Move;

namespace {

TableTimes<Lifting> times{};
int top = 0;
int step_height = 1;
bool on_stand = false;
bool level_only = false;
constexpr int kinds = 32;  // of messages; a word is one, and the steps of an arm
static_assert(palmbots::all_message_kinds <= kinds);

TableRobot<Lifting> awake(int side) {
  const mind& m = pair.mind[side];
  auto robot = robot_in<Lifting>(m.state, side, times);
  robot.clock().since_entered = m.since_entered;
  robot.clock().own.tries = m.tries;
  robot.clock().own.was_backing = m.backs != 0;
  return robot;
}

mind packed(TableRobot<Lifting> robot) {
  const auto& own = robot.clock().own;
  return {static_cast<unsigned char>(robot.state()),
          static_cast<unsigned char>(robot.clock().since_entered), own.tries, own.was_backing};
}

Lifting::State state(int side) { return static_cast<Lifting::State>(pair.mind[side].state); }
const palmbots::LiftRole& role(int side) { return Lifting::role(state(side)); }
const palmbots::TableOutput& output(int side) { return Lifting::outputs[pair.mind[side].state]; }

// The arm has reached the height commanded in the last cycle.
bool is_there(int side) {
  const ArmMove arm = role(side).arm;
  if (arm == ArmMove::rise) return pair.height[side] == top;
  return arm != ArmMove::sink || pair.height[side] == 0;
}

std::uint8_t steps(int side) { return static_cast<std::uint8_t>(pair.height[side] / step_height); }

// The robot after a step.
mind stepped(int side, int heard, int reading) {
  TableRobot<Lifting> robot = awake(side);
  const bool is_beneath = reading == BENEATH || reading == FAR_THERE;
  robot.clock().own.senses = {reading != NOTHING && reading != BENEATH,
                              is_there(side),
                              reading == FAR_THERE,
                              steps(side),
                              on_stand && is_beneath,
                              level_only};
  const Sign sign = reading == OUTWARD                           ? Sign::positive
                    : reading == CENTRED || reading == FAR_THERE ? Sign::zero
                                                                 : Sign::negative;
  // A palm that still turns makes the same difference as a contact that is not centred yet.
  const unsigned bits = static_cast<unsigned>(heard) / kinds;
  robot.step({sign, true, 1, static_cast<MessageKind>(heard % kinds), (bits & 1) != 0,
              (bits & 2) != 0, 0});
  return packed(robot);
}

void move_arm(int side) {
  unsigned char& height = pair.height[side];
  switch (role(side).arm) {
    case ArmMove::rise: height = static_cast<unsigned char>(height + (height < top)); break;
    case ArmMove::sink: height = static_cast<unsigned char>(height - (height > 0)); break;
    case ArmMove::hold:
    case ArmMove::reach:  // heights are measured from where it touches
    case ArmMove::follow: break;
  }
}

bool same(const mind& a, const mind& b) {
  return a.state == b.state && a.since_entered == b.since_entered && a.tries == b.tries &&
         a.backs == b.backs;
}

}  // namespace

extern "C" {

struct pair pair;

void set_program(int cycles, int reach, int height, int step, int from_stand, int level) {
  set_lease(cycles);
  on_stand = from_stand != 0;
  level_only = level != 0;
  // Ages are counted here; a controller gets a fresh message or none.
  times = {1, 1, palmbots::table_limits<Lifting>({0, 0, 0.1 * reach, 0}, 1)};
  top = height;
  step_height = step;
}

void begin(int side) {
  TableRobot<Lifting> robot = awake(side).booted();
  robot.enter(Lifting::initial);
  pair.mind[side] = packed(robot);
  forget(side);
}

void one_first(void) {
  TableRobot<Lifting> robot = awake(LEFT);
  robot.enter(Lifting::State::stand_by);
  pair.mind[LEFT] = packed(robot);
}

void robot_boot(int side) {
  pair.mind[side] = packed(awake(side).booted());
  forget(side);
}

int readings(int side, int choice, int helps) {
  const struct radio before = radio;
  const int heard = hear(side, choice);
  radio = before;
  const bool leaving = Lifting::leaving.has(state(side)) || state(side) == Lifting::State::empty;
  const bool docking = Lifting::docking.has(state(side));
  mind known[READINGS];
  int mask = 0;
  for (int reading = 0; reading < READINGS; ++reading) {
    if (helps && !docking && reading != (leaving ? NOTHING : FAR_THERE)) continue;
    known[reading] = stepped(side, heard, reading);
    bool is_new = true;
    for (int other = 0; other < reading; ++other) {
      is_new &= (mask >> other & 1) == 0 || !same(known[other], known[reading]);
    }
    mask |= int{is_new} << reading;
  }
  return mask;
}

int robot_step(int side, int choice, int reading) {
  const int said = steps(side) % 4 * kinds;
  pair.mind[side] = stepped(side, hear(side, choice), reading);
  say(side, said + static_cast<int>(output(side).message));
  move_arm(side);
  return role(side).driver == Driver::controller;
}

int arm_moves(int side) {
  return role(side).arm == ArmMove::rise || role(side).arm == ArmMove::sink;
}

int arm_may_move(int side) {
  const auto heard = static_cast<MessageKind>(radio.message[side] % kinds);
  const bool rises = role(side).arm == ArmMove::rise;
  return (rises ? Lifting::rises : Lifting::sinks).has(heard);
}

int arm_follows_floor(int side) { return role(side).arm == ArmMove::follow; }
int leaves(int side) {
  return role(side).driver == Driver::table && output(side).command.move == Move::away;
}
int corrects(int side) {
  palmbots::LiftSenses senses{.touches = true};
  senses.level_only = level_only;
  return Lifting::driver(state(side), senses) != Driver::table;
}
int is_over(int side) {
  return state(side) == Lifting::State::done || state(side) == Lifting::State::failed;
}
int is_held(int side) { return state(side) == Lifting::State::held; }

char robot_case(int) { return ' '; }
const char* robot_doing(int side) { return palmbots::name_of(state(side)); }

}  // extern "C"
