// SPDX-License-Identifier: Apache-2.0
// The resilient controller as shipped (palmbots/control/resilient.hpp, palmbots/control/beacon.hpp)
// behind resilient.h.
#include "palmbots/control/resilient.hpp"

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "palmbots/control/beacon.hpp"
#include "resilient.h"

using palmbots::Beacon;
using palmbots::BeaconReceiver;
using palmbots::BeaconStamp;
using palmbots::MessageKind;
using palmbots::Resilient;
using palmbots::Sign;

namespace {

constexpr std::uint32_t present = 1000;  // what every clock reads, whatever the time

Resilient::Times times{1, 0, 0, 0, 0};
bool travels = true;
std::uint8_t stale = 0;  // the first age that is too old

// The members of a Resilient, one by one.
struct Members {
  Resilient::Times times;
  Resilient::State state;
  MessageKind message;
  bool yields;
  bool stopped;
  bool partner_stopped;
  bool partner_ready;
  std::uint16_t age;
  std::uint16_t since_ready;
  std::uint16_t since_asked;
  std::uint16_t since_moved;
  std::uint16_t since_turned;
  std::uint16_t since_entered;
  std::uint16_t since_sent;
};
static_assert(sizeof(Members) == sizeof(Resilient));

Resilient awake(int side) {
  const mind& m = pair.mind[side];
  return std::bit_cast<Resilient>(Members{
      times, static_cast<Resilient::State>(m.state), static_cast<MessageKind>(m.message),
      side == LEFT, m.stopped != 0, m.partner_stopped != 0, m.partner_ready != 0, m.age,
      m.since_ready, m.since_asked, m.since_moved, m.since_turned, m.since_entered, times.beacon});
}

// What matters of a controller later on. What it heard while it was not silent, and how long it has
// been in a state that does not ask how long, does not.
mind packed(const Resilient& robot) {
  const auto m = std::bit_cast<Members>(robot);
  mind p{};
  p.state = static_cast<unsigned char>(m.state);
  p.message = robot.silence() ? 0 : static_cast<unsigned char>(m.message);
  p.age = static_cast<unsigned char>(m.age);
  p.since_asked = static_cast<unsigned char>(m.since_asked);
  p.since_moved = static_cast<unsigned char>(m.since_moved);
  p.since_entered =
      m.state == Resilient::State::c_withdraw ? static_cast<unsigned char>(m.since_entered) : 0;
  if (travels) {
    p.stopped = m.stopped;
    p.partner_stopped = robot.silence() || m.partner_stopped;
    p.partner_ready = !robot.silence() && m.partner_ready;
    p.since_ready = static_cast<unsigned char>(m.since_ready);
    p.since_turned = static_cast<unsigned char>(m.since_turned);
  }
  return p;
}

BeaconStamp stamp_of(stamp s) {
  return s.life == 0 ? BeaconStamp{} : BeaconStamp{s.life, present - std::uint32_t{s.age}};
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

// An receiver at this moment: its own clock reads `present`, and so does the partner's.
BeaconReceiver receiver_of(int side) {
  BeaconReceiver receiver(pair.life[side]);
  receiver.tick(static_cast<std::uint16_t>(present));
  Beacon newest;
  newest.sent = stamp_of(pair.newest[side]);
  receiver.accept(newest);
  return receiver;
}

struct Step {
  BeaconReceiver receiver;
  Resilient robot;
  Resilient::Output out;
};

// A step of the shipped controller; nothing is changed.
Step step_of(int side, int choice, int turned, int elapsed) {
  Step step{receiver_of(side), awake(side), {}};
  Resilient::Input in{static_cast<Sign>(choice % SIGNS - 1),
                      turned != 0,
                      static_cast<std::uint16_t>(elapsed),
                      MessageKind::none,
                      false,
                      false,
                      0};
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

void set_times(int lease, int hold, int braking, int join, int travels_too) {
  times = {1, static_cast<std::uint16_t>(lease), static_cast<std::uint16_t>(hold),
           static_cast<std::uint16_t>(braking), static_cast<std::uint16_t>(join)};
  stale = static_cast<std::uint8_t>(lease + 1);
  travels = travels_too != 0;
  if (lease > LONGEST_LEASE) {
    std::fprintf(stderr, "a lease of %d cycles is too long for the model\n", lease);
    std::exit(2);
  }
}

void robot_boot(int side, int again) {
  using enum Resilient::State;
  const auto state = static_cast<Resilient::State>(pair.mind[side].state);
  const bool assists = state == c_grant || state == c_withdraw;  // Resilient::Output::assists
  pair.mind[side] = packed(Resilient(times, side == LEFT, again != 0 && assists));
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

char robot_case(int side) { return awake(side).now().name; }

const char* robot_doing(int side) {
  return palmbots::name_of(static_cast<Resilient::State>(pair.mind[side].state));
}

}  // extern "C"
