// SPDX-License-Identifier: Apache-2.0
// Beacons and leases of a table's robot as shipped behind beacons.h.
#include "palmbots/control/shared_sign.hpp"

#include <cstdio>
#include <cstdlib>

#include "beacons.h"
#include "table_robots.hpp"

using namespace glue;
using palmbots::SharedSign;

namespace {

int lease = 0;
unsigned char stale() { return static_cast<unsigned char>(lease + 1); }

TableRobot<SharedSign> awake(int side) {
  auto robot = robot_in<SharedSign>(static_cast<unsigned>(SharedSign::State::rest_steep), side,
                                    {1, static_cast<std::uint16_t>(lease), {}});
  robot.clock().age = pair.robot[side].age;
  if (!robot.silence()) robot.clock().message = MessageKind::zero;
  return robot;
}

unsigned char older(unsigned char age) {
  return age < stale() ? static_cast<unsigned char>(age + 1) : stale();
}

// A stamp a cycle later; what is too old to count may as well never have been.
stamp older(stamp s) {
  s.age = older(s.age);
  return s.life != 0 && s.age <= lease ? s : stamp{};
}

}  // namespace

extern "C" {

struct pair pair;

void set_lease(int cycles) {
  lease = cycles;
  if (lease > LONGEST_LEASE) {
    std::fprintf(stderr, "a lease of %d cycles is too long for the model\n", lease);
    std::exit(2);
  }
}

void robot_boot(int side) {
  robot& r = pair.robot[side];
  r = {static_cast<unsigned char>(r.life + 1), stale(), 0, 0, stale(), stale(), 0, 0};
}

void pass_time(void) {
  for (int side = 0; side < 2; ++side) {
    robot& r = pair.robot[side];
    const stamp newest = older(stamp{r.newest_life, r.newest_age});
    r.newest_life = newest.life;
    r.newest_age = newest.age;
    r.true_age = older(r.true_age);
    r.true_bound = older(r.true_bound);
    r.since_boot = older(r.since_boot);
    for (int age = lease; age > 0; --age) {
      pair.air[side][age] = pair.air[side][age - 1];
      pair.air[side][age].sent.age = static_cast<unsigned char>(age);
      pair.air[side][age].heard = older(pair.air[side][age].heard);
    }
    pair.air[side][0] = {};
  }
}

int choices(int side) {
  int mask = 1;
  for (int age = 0; age <= lease; ++age) {
    if (pair.air[side][age].sent.life != 0) mask |= 2 << age;
  }
  return mask;
}

void robot_step(int side, int age) {
  robot& r = pair.robot[side];
  BeaconReceiver receiver = receiver_of(r.life, stamp{r.newest_life, r.newest_age});
  TableRobot<SharedSign> controller = awake(side);
  palmbots::RobotInput in{Sign::zero, true, 1, MessageKind::none, false, false, 0};
  if (age >= 0) {
    const beacon& b = pair.air[side][age];
    const Beacon heard{MessageKind::zero, false, false, stamp_of(b.sent), stamp_of(b.heard)};
    if (receiver.accept(heard)) {
      in.message = heard.message;
      in.age = receiver.age();
      r.newest_life = b.sent.life;
      r.newest_age = b.sent.age;
      r.true_age = static_cast<unsigned char>(age);
      r.true_bound = b.heard.life == r.life ? b.heard.age : stale();
    }
  }
  const palmbots::RobotOutput out = controller.step(in);
  r.age = static_cast<unsigned char>(controller.clock().age);
  if (!out.send) return;
  const Beacon said = receiver.beacon(out.message, false, false);
  const bool heard_any = said.heard.epoch != 0;
  pair.air[1 - side][0] = {{r.life, 0},
                           {static_cast<unsigned char>(said.heard.epoch),
                            static_cast<unsigned char>(heard_any ? present - said.heard.tick : 0)}};
}

int is_silent(int side) { return awake(side).silence(); }

void note_links(void) {
  for (int side = 0; side < 2; ++side) {
    robot& r = pair.robot[side];
    r.lone = !is_silent(side) && is_silent(1 - side) ? older(r.lone) : 0;
  }
}

char robot_case(int side) { return awake(side).name(); }

const char* robot_doing(int side) {
  return is_silent(side) ? "hears nothing" : "hears its partner";
}

}  // extern "C"
