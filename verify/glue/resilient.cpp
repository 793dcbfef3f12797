// SPDX-License-Identifier: Apache-2.0
// The resilient controller as shipped (palmbots/control/resilient.hpp, palmbots/control/mailbox.hpp)
// behind resilient.h.
#include "palmbots/control/resilient.hpp"
#include "palmbots/control/resilient_timing.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "resilient.h"
#include "table_robots.hpp"

using namespace glue;
using palmbots::Resilient;
using Robot = TableRobot<Resilient>;

namespace {

TableTimes<Resilient> times{};
bool travels = true;
std::uint8_t stale = 0;  // the first age that is too old

Robot awake(int side) {
  const mind& m = pair.mind[side];
  Robot robot = robot_in<Resilient>(m.state, side, times);
  auto& clock = robot.clock();
  clock.message = static_cast<MessageKind>(m.message);
  clock.age = m.age;
  clock.since_entered = m.since_entered;
  clock.own = {m.stopped != 0, m.partner_stopped != 0, m.partner_ready != 0, m.since_ready,
               m.since_asked,  m.since_moved,          m.since_turned};
  return robot;
}

// What matters of a controller later on. What it heard before it fell silent does not.
mind packed(const Robot& robot) {
  const auto& clock = robot.clock();
  mind p{};
  p.state = static_cast<unsigned char>(robot.state());
  p.message = static_cast<unsigned char>(clock.heard());
  p.age = static_cast<unsigned char>(clock.age);
  p.since_asked = static_cast<unsigned char>(clock.own.since_asked);
  p.since_moved = static_cast<unsigned char>(clock.own.since_moved);
  p.since_entered = static_cast<unsigned char>(clock.since_entered);
  if (travels) {
    p.stopped = clock.own.stopped;
    p.partner_stopped = robot.silence() || clock.own.partner_stopped;
    p.partner_ready = !robot.silence() && clock.own.partner_ready;
    p.since_ready = static_cast<unsigned char>(clock.own.since_ready);
    p.since_turned = static_cast<unsigned char>(clock.own.since_turned);
  }
  return p;
}

// A stamp a cycle later; what is too old to count may as well never have been.
stamp older(stamp s) {
  if (s.life != 0) ++s.age;
  return s.age < stale ? s : stamp{};
}

// A beacon without a fresh echo reports that the partner is silent, whatever else it says.
void shorten(beacon& b, int receiver) {
  if (b.life == 0 || b.heard.life == pair.life[receiver]) return;
  b.heard = {};
  b.message = static_cast<unsigned char>(MessageKind::tilt_down);
  b.stopped = 1;
  b.ready = 0;
}

Beacon beacon_of(const beacon& b, int age) {
  return {static_cast<MessageKind>(b.message),
          b.stopped != 0,
          b.ready != 0,
          {b.life, present - static_cast<std::uint32_t>(age)},
          stamp_of(b.heard)};
}

struct Step {
  BeaconReceiver receiver;
  Robot robot;
  palmbots::RobotOutput out;
};

// A step of the shipped controller; nothing is changed.
Step step_of(int side, int choice, int turned, int elapsed) {
  Step step{receiver_of(pair.life[side], pair.newest[side]), awake(side), {}};
  palmbots::RobotInput in{static_cast<Sign>(choice % SIGNS - 1), turned != 0,
                          static_cast<std::uint16_t>(elapsed)};
  const int heard = choice / SIGNS - 1;
  if (heard >= 0 && step.receiver.accept(beacon_of(pair.air[side][heard], heard))) {
    in.message = step.receiver.newest().message;
    in.stopped = step.receiver.newest().stopped;
    in.ready = step.receiver.newest().ready;
    in.age = step.receiver.age();
  }
  step.out = step.robot.step(in);
  return step;
}

// The effects of a step that can be observed later.
struct Outcome {
  mind after;
  palmbots::Command command;
};

bool same(const Outcome& a, const Outcome& b) {
  return std::memcmp(&a.after, &b.after, sizeof a.after) == 0 && a.command == b.command;
}

}  // namespace

extern "C" {

struct pair pair;

void set_times(int lease, int delay, int braking, int naps, int hold_less, int join_less,
               int travels_too) {
  times = palmbots::ResilientTiming::of({.period = 1,
                                         .beacon = 1,
                                         .lease = double(lease),
                                         .watchdog = double(naps),
                                         .delay = double(delay),
                                         .braking = double(braking),
                                         .clock_ratio = 1,
                                         .shift = 0,
                                         .room = 0,
                                         .drift = 0,
                                         .off_zone = 0})
              .times;
  const auto lessen = [](std::uint16_t& limit, int cycles) {
    limit = static_cast<std::uint16_t>(limit - cycles);
  };
  lessen(times.limits[static_cast<int>(Resilient::Limit::hold)], hold_less);
  lessen(times.limits[static_cast<int>(Resilient::Limit::join)], join_less);
  stale = static_cast<std::uint8_t>(lease + 1);
  travels = travels_too != 0;
  if (lease > LONGEST_LEASE) {
    std::fprintf(stderr, "a lease of %d cycles is too long for the model\n", lease);
    std::exit(2);
  }
}

void robot_boot(int side, int again) {
  const bool assists = again != 0 && awake(side).assists();
  pair.mind[side] = packed(robot_in<Resilient>(0, side, times).booted(assists));
  ++pair.life[side];
  pair.newest[side] = {};
  for (beacon& b : pair.air[side]) shorten(b, side);
}

void pass_time() {
  for (int side = 0; side < 2; ++side) {
    pair.newest[side] = older(pair.newest[side]);
    for (int age = stale - 1; age > 0; --age) {
      pair.air[side][age] = pair.air[side][age - 1];
      pair.air[side][age].heard = older(pair.air[side][age].heard);
      shorten(pair.air[side][age], side);
    }
    pair.air[side][0] = {};
  }
}

int choices(int side, int sign, int turned, int elapsed, int delay) {
  Outcome done[NAP] = {};
  int count = 0;
  int mask = 0;
  for (int heard = 0; heard <= stale; ++heard) {
    if (heard > 0 && pair.air[side][heard - 1].life == 0) continue;
    if (heard == 0 && delay >= 0) {
      bool due = false;  // something must come
      for (int age = delay; age < stale; ++age) due = due || pair.air[side][age].life != 0;
      if (due) continue;
    }
    const int first = count;
    for (int s = -1; s <= 1; ++s) {
      if (sign != 2 && s != sign) continue;
      const int choice = SIGNS * heard + s + 1;
      const Step step = step_of(side, choice, turned, elapsed);
      const Outcome outcome{packed(step.robot), step.out.command};
      bool known = false;
      for (int i = first; i < count; ++i) known = known || same(done[i], outcome);
      if (known) continue;
      done[count++] = outcome;
      mask |= 1 << choice;
    }
    // With all well, nothing older comes instead of the newest that is due.
    if (heard > delay && delay >= 0) break;
  }
  return mask;
}

deed robot_step(int side, int choice, int turned, int elapsed) {
  const Step step = step_of(side, choice, turned, elapsed);
  const int heard = choice / SIGNS - 1;
  if (heard >= 0) {
    pair.newest[side] = {pair.air[side][heard].life, static_cast<unsigned char>(heard)};
    // Whatever is older will be rejected.
    for (int age = heard; age < stale; ++age) pair.air[side][age] = {};
  }
  pair.mind[side] = packed(step.robot);
  if (step.out.send) {
    const Beacon said =
        step.receiver.beacon(step.out.message, step.robot.stopped(), step.out.ready);
    pair.air[1 - side][0] = {static_cast<unsigned char>(said.message),
                             static_cast<unsigned char>(travels && said.stopped),
                             static_cast<unsigned char>(travels && said.ready), pair.life[side],
                             pair.newest[side]};
    shorten(pair.air[1 - side][0], 1 - side);
  }
  const auto& command = step.out.command;
  return {static_cast<unsigned char>(command.palm), static_cast<unsigned char>(command.move),
          static_cast<unsigned char>(command.stop)};
}

char robot_case(int side) { return awake(side).name(); }

const char* robot_doing(int side) {
  return palmbots::name_of(static_cast<Resilient::State>(pair.mind[side].state));
}

}  // extern "C"
