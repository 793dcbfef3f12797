// SPDX-License-Identifier: Apache-2.0
// The controllers silent and shared-sign as shipped (palmbots/control/table_robot.hpp) behind signs.h.
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/sim/table_team.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "signs.h"
#include "table_robots.hpp"

using namespace glue;
using palmbots::SharedSign;
using palmbots::Silent;

namespace {

constexpr std::uint16_t fresh =
    1;  // ages are counted here; a controller gets a fresh message or none

bool talks = true;
bool brake = true;
int lease = 0;
template <class Table>
TableTimes<Table> times{};

// The controller of a robot, awake and without a message of its partner.
template <class Table>
TableRobot<Table> awake(int side) {
  auto robot = robot_in<Table>(pair.mind[side].state, side, times<Table>, brake);
  robot.clock().since_entered = pair.mind[side].since_entered;
  return robot;
}

// The controller of a robot that starts by touch.
template <class Table>
TableRobot<Table> first(int side) {
  return TableRobot<Table>(times<Table>, {side == RIGHT, brake, true});
}

template <class Table>
mind packed(const TableRobot<Table>& robot) {
  return {static_cast<unsigned char>(robot.state()),
          static_cast<unsigned char>(robot.clock().since_entered)};
}

// A step of the shipped controller.
template <class Table>
palmbots::Command step(int side, Sign sign, MessageKind heard) {
  TableRobot<Table> robot = awake<Table>(side);
  const palmbots::Command command = robot.step({sign, true, 1, heard, false, false, 0}).command;
  pair.mind[side] = packed(robot);
  return command;
}

const palmbots::TableOutput& output_of(int side) {
  const unsigned state = pair.mind[side].state;
  return talks ? SharedSign::outputs[state] : Silent::outputs[state];
}

// What a robot says in this cycle. Of equal messages in a row only the newest is kept: its bound is
// not the greater one, so that hearing it leaves an adversary all that hearing an older one leaves.
// A robot that acts on no message may have heard one just now.
void say(int side) {
  if (!talks) return;
  unsigned char* said = pair.said[1 - side];
  unsigned char* echo = pair.echo[1 - side];
  said[0] = static_cast<unsigned char>(output_of(side).message);
  echo[0] = pair.message[side] != 0 ? pair.age[side] : 0;
  for (int age = 1; age <= lease; ++age) {
    if (said[age] == 0) continue;
    if (said[age] == said[0]) said[age] = echo[age] = 0;
    break;
  }
}

// A robot has heard what its partner said so many cycles ago. Older messages will be rejected.
void hear(int side, int age) {
  unsigned char* said = pair.said[side];
  unsigned char* echo = pair.echo[side];
  pair.message[side] = said[age];
  pair.age[side] = static_cast<unsigned char>(age);
  pair.bound[side] = static_cast<unsigned char>(age + echo[age]);
  for (; age <= lease; ++age) said[age] = echo[age] = 0;
}

// Where the next message is the one that a robot has, it may as well have heard it.
void refresh(int side) {
  const unsigned char* said = pair.said[side];
  if (pair.message[side] == 0) return;
  int next = pair.age[side] - 1;
  while (next >= 0 && said[next] == 0) --next;
  if (next >= 0 && said[next] == pair.message[side]) hear(side, next);
}

void fall_silent(int side) { pair.message[side] = pair.age[side] = pair.bound[side] = 0; }

}  // namespace

extern "C" {

struct pair pair;

void set_program(int talks_too, int may_stop, int longest, int turn, int delay, int reach,
                 int crossing) {
  talks = talks_too != 0;
  brake = may_stop != 0;
  lease = longest;
  const palmbots::TableTiming timing{double(turn), double(delay), double(reach), double(crossing)};
  times<Silent> = {1, fresh, palmbots::table_limits<Silent>(timing, 1)};
  times<SharedSign> = {1, fresh, palmbots::table_limits<SharedSign>(timing, 1)};
  if (lease > OLDEST) {
    std::fprintf(stderr, "a lease of %d cycles is too long for the model\n", lease);
    std::exit(2);
  }
}

void robot_boot(int side) {
  pair.mind[side] =
      talks ? packed(awake<SharedSign>(side).booted()) : packed(awake<Silent>(side).booted());
  fall_silent(side);
  // A beacon counts only if it echoes a message of this life.
  std::fill_n(pair.said[side], lease + 1, 0);
  std::fill_n(pair.echo[side], lease + 1, 0);
}

void start_by_touch(void) {
  for (int side = 0; side < 2; ++side) {
    pair.mind[side] = talks ? packed(first<SharedSign>(side)) : packed(first<Silent>(side));
  }
}

void pass_time(void) {
  for (int side = 0; side < 2; ++side) {
    unsigned char* said = pair.said[side];
    unsigned char* echo = pair.echo[side];
    for (int age = lease; age >= 0; --age) {
      const bool counts = age > 0 && said[age - 1] != 0 && age + echo[age - 1] <= lease;
      said[age] = counts ? said[age - 1] : 0;
      echo[age] = counts ? echo[age - 1] : 0;
    }
    if (pair.message[side] == 0) continue;
    ++pair.age[side];
    ++pair.bound[side];
  }
}

int choices(int side, int delay, int quiet) {
  refresh(side);
  int mask = 0;
  if (pair.message[side] != 0 && pair.bound[side] <= lease && pair.age[side] <= delay) {
    mask |= 1 << KEEP;
  }
  for (int age = 0; age <= lease && age <= delay; ++age) {
    if (pair.said[side][age] != 0) mask |= 1 << (HEAR + age);
  }
  if (mask == 0 || quiet) mask |= 1 << SILENCE;
  return mask;
}

deed robot_step(int side, int sign, int choice) {
  if (choice == SILENCE) fall_silent(side);
  if (choice >= HEAR) hear(side, choice - HEAR);
  refresh(side);
  const auto message = static_cast<MessageKind>(pair.message[side]);
  const auto felt = static_cast<Sign>(sign);
  const palmbots::Command command =
      talks ? step<SharedSign>(side, felt, message) : step<Silent>(side, felt, message);
  say(side);
  return {static_cast<unsigned char>(command.palm), static_cast<unsigned char>(command.move),
          static_cast<unsigned char>(command.stop)};
}

void robot_skip(int side) { say(side); }

int is_quiet(int side) {
  return talks && SharedSign::quiet.has(static_cast<SharedSign::State>(pair.mind[side].state));
}

char robot_case(int side) { return output_of(side).name; }

const char* robot_doing(int side) {
  const unsigned state = pair.mind[side].state;
  return talks ? palmbots::name_of(static_cast<SharedSign::State>(state))
               : palmbots::name_of(static_cast<Silent::State>(state));
}

}  // extern "C"
