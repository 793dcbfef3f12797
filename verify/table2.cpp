// Table 2 as shipped (palmbots/protocol.hpp) behind controllers.h.
#include "palmbots/protocol.hpp"

#include <cstdio>
#include <cstdlib>
#include <type_traits>

#define robots robots_as_bytes  // the header declares them as bytes
#include "controllers.h"
#undef robots

using palmbots::Distributed;
using palmbots::Letter;
using palmbots::Sign;

static_assert(sizeof(Distributed) == 1 && std::is_trivially_copyable_v<Distributed>);

extern "C" {

Distributed robots[2];

void robot_boot(int side) { robots[side] = {}; }

deed robot_step(int side, int sign, int letter, int turned) {
  Distributed& robot = robots[side];
  const Distributed::State before = robot.state();
  const char case_before = robot.now().name;
  const auto out = robot.step({static_cast<Sign>(sign), static_cast<Letter>(letter), turned != 0});
  const char case_after = robot.now().name;
  const bool stray =
      before == Distributed::State::idle && letter != static_cast<int>(Letter::tilt_up);
  deed done{};
  done.palm = static_cast<unsigned char>(out.command.palm);
  done.move = static_cast<unsigned char>(out.command.move);
  done.send = static_cast<unsigned char>(out.send);
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

int robots_in_d() { return robots[LEFT].now().name == 'd' && robots[RIGHT].now().name == 'd'; }

char robot_case(int side) { return robots[side].now().name; }

const char* robot_doing(int side) {
  const Distributed::Doing& now = robots[side].now();
  switch (now.command.move) {
    case palmbots::Move::away: return "moves away";
    case palmbots::Move::closer: return "moves closer";
    case palmbots::Move::hold: break;
  }
  if (!now.waits) return now.name == ' ' ? "" : "turns its palm";
  switch (now.awaits) {
    case Letter::ack: return now.name == 'a' ? "waits for an answer" : "waits for Ack";
    case Letter::tilt_down: return "waits for TiltDown";
    default: return "waits";
  }
}

const char* side_name(int side) { return side == LEFT ? "left" : "right"; }

const char* letter_name(int letter) {
  constexpr const char* names[] = {"nothing", "TiltUp", "TiltDown", "Ack"};
  return names[letter];
}

int parameter(const char* name) {
  const char* value = std::getenv(name);
  if (value != nullptr) return std::atoi(value);
  std::fprintf(stderr, "parameter %s is not set\n", name);
  std::exit(2);
}

}  // extern "C"
