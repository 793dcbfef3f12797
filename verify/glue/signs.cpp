// SPDX-License-Identifier: Apache-2.0
// The controllers silent and shared-sign as shipped (palmbots/control/table_robot.hpp) behind signs.h.
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/sim/table_team.hpp"

#include "leased_radio.hpp"
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

// What a robot says in this cycle.
void say(int side) {
  if (talks) glue::say(side, static_cast<int>(output_of(side).message));
}

}  // namespace

extern "C" {

struct pair pair;

void set_program(int talks_too, int may_stop, int longest, int turn, int delay, int reach,
                 int crossing) {
  talks = talks_too != 0;
  brake = may_stop != 0;
  set_lease(longest);
  const palmbots::TableTiming timing{double(turn), double(delay), double(reach), double(crossing)};
  times<Silent> = {1, fresh, palmbots::table_limits<Silent>(timing, 1)};
  times<SharedSign> = {1, fresh, palmbots::table_limits<SharedSign>(timing, 1)};
}

void robot_boot(int side) {
  pair.mind[side] =
      talks ? packed(awake<SharedSign>(side).booted()) : packed(awake<Silent>(side).booted());
  forget(side);
}

void start_by_touch(void) {
  for (int side = 0; side < 2; ++side) {
    pair.mind[side] = talks ? packed(first<SharedSign>(side)) : packed(first<Silent>(side));
  }
}

deed robot_step(int side, int sign, int choice) {
  const auto message = static_cast<MessageKind>(hear(side, choice));
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
