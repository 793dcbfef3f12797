// SPDX-License-Identifier: Apache-2.0
// Table 2 as shipped (palmbots/control/distributed.hpp) behind distributed.h.
#include "palmbots/control/distributed.hpp"

#include <type_traits>

#include "palmbots/control/table_robot.hpp"

#define robots robots_as_bytes  // the header declares them as bytes
#include "distributed.h"
#undef robots

using palmbots::Distributed;
using palmbots::MessageKind;
using palmbots::Sign;
using Robot = palmbots::TableRobot<Distributed>;

static_assert(sizeof(Robot) == 1 && std::is_trivially_copyable_v<Robot>);

extern "C" {

Robot robots[2];

void robot_boot(int side) { robots[side] = {}; }

deed robot_step(int side, int sign, int message, int turned) {
  Robot& robot = robots[side];
  const Distributed::State before = robot.state();
  const char case_before = robot.name();
  const auto out =
      robot.step({static_cast<Sign>(sign), turned != 0, 1, static_cast<MessageKind>(message)});
  const char case_after = robot.name();
  const bool stray =
      before == Distributed::State::idle && message != static_cast<int>(MessageKind::tilt_up);
  deed done{};
  done.palm = static_cast<unsigned char>(out.command.palm);
  done.move = static_cast<unsigned char>(out.command.move);
  done.send = static_cast<unsigned char>(out.message);
  done.read = out.read;
  done.confused = out.read && (stray || robot.state() == before);
  done.stirred = robot.state() != before;
  done.row_case = static_cast<unsigned char>(case_after != ' ' ? case_after : case_before);
  return done;
}

int robots_idle() {
  return robots[LEFT].state() == Distributed::State::idle &&
         robots[RIGHT].state() == Distributed::State::idle;
}

int robots_in_d() { return robots[LEFT].name() == 'd' && robots[RIGHT].name() == 'd'; }

char robot_case(int side) { return robots[side].name(); }

const char* robot_doing(int side) {
  const palmbots::TableOutput& now = robots[side].now();
  switch (now.command.move) {
    case palmbots::Move::away: return "moves away";
    case palmbots::Move::closer: return "moves closer";
    case palmbots::Move::hold: break;
  }
  if (!now.waits) return now.name == ' ' ? "" : "turns its palm";
  switch (robots[side].awaits()) {
    case MessageKind::ack: return now.name == 'a' ? "waits for an answer" : "waits for Ack";
    case MessageKind::tilt_down: return "waits for TiltDown";
    default: return "waits";
  }
}

const char* message_name(int message) {
  return message == 0 ? "nothing" : palmbots::name_of(static_cast<MessageKind>(message));
}

}  // extern "C"
