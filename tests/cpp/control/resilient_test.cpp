// SPDX-License-Identifier: Apache-2.0
// The resilient controller step by step against an oracle written as plain conditions, over random
// inputs that reach every state with every sign and message.
//
// resilient_test [WALKS]   WALKS: of 4000 steps each, with every kind of robot; 10 if not given
#include "palmbots/control/resilient.hpp"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "palmbots/base/philox.hpp"
#include "palmbots/control/mailbox.hpp"
#include "support/check.hpp"
#include "support/resilient_oracle.hpp"

using namespace palmbots;

namespace {

using Robot = TableRobot<Resilient>;
using Times = TableTimes<Resilient>;

struct Seen {
  std::uint32_t entered[Resilient::states][Resilient::states]{};
  std::uint32_t with[Resilient::states][3][6]{};  // sign, message heard
  std::uint32_t rested[Resilient::states]{};      // for more than one step
  std::uint32_t cut_short = 0;                    // rests after which nothing happened
};

bool same(const RobotOutput& a, const RobotOutput& b) {
  return a.command == b.command && a.message == b.message && a.ready == b.ready &&
         a.send == b.send && a.assists == b.assists;
}

// quiet() returns a number of steps in which nothing happens. Skipping them at once gives the same
// controller as taking them one by one.
void check_rest(const Robot& now, Sign sign, bool palm_at_target, Seen& seen) {
  const std::uint16_t quiet = now.quiet(sign, palm_at_target);
  const auto step = [&](Robot& robot) {
    return robot.step({sign, palm_at_target, 1, MessageKind::none, false, false, 0});
  };
  Robot slow = now;
  for (std::uint16_t k = 1; k <= quiet; ++k) {
    const RobotOutput out = step(slow);
    CHECK(!out.send && slow.state() == now.state() && slow.stopped() == now.stopped());
    Robot fast = now;
    fast.idle(sign, k);
    CHECK(std::memcmp(&fast, &slow, sizeof fast) == 0);  // copies, so with the same padding
  }
  if (quiet > 1) ++seen.rested[static_cast<int>(now.state())];
  const RobotOutput out = step(slow);
  if (!out.send && slow.state() == now.state() && slow.stopped() == now.stopped()) ++seen.cut_short;
}

void walk(const Times& times, std::uint64_t seed, bool yields, bool assisted, Seen& seen) {
  Robot shipped(times, {.leads = !yields}, assisted);
  ResilientOracle oracle(times, yields, assisted);
  std::uint32_t sign = 0;
  bool fresh = true;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const Words w = draw(seed, i, 3U);
    if (w[0] % 8 == 0) sign = (w[0] >> 8) % 3;  // signs and good spells that last a while
    if (w[1] % 32 == 0) fresh = !fresh;
    RobotInput in{};
    in.sign = static_cast<Sign>(static_cast<int>(sign) - 1);
    in.palm_at_target = (w[2] & 3) != 0;
    in.elapsed = static_cast<std::uint16_t>(w[2] % 64 == 4 ? 1 + (w[2] >> 8) % 9 : 1);
    in.message = static_cast<MessageKind>((w[3] & 0xFF) % 6);
    in.stopped = (w[3] >> 8) % 4 == 0;
    in.ready = (w[3] >> 10) % 4 != 0;
    const std::uint32_t spread = fresh ? times.lease + 1U : 3U * times.lease;
    in.age = static_cast<std::uint16_t>((w[3] >> 16) % spread);
    if (w[1] % 1024 == 1) in.age = unknown_age;
    const auto before = static_cast<int>(shipped.state());
    const auto out = shipped.step(in);
    CHECK(same(out, oracle.step(in)));
    CHECK(out.message == shipped.now().message && out.command.stop == shipped.stopped());
    check_rest(shipped, in.sign, in.palm_at_target, seen);
    const int heard = shipped.silence() ? 0 : static_cast<int>(oracle.newest);
    ++seen.with[before][sign][heard];
    ++seen.entered[before][static_cast<int>(shipped.state())];
  }
}

void test_agrees_with_oracle(std::uint64_t walks) {
  Seen seen;
  std::uint64_t seed = 0;
  for (const Times& times : {Times{1, 2, {3, 0, 0}}, Times{5, 50, {67, 6, 6}},
                             Times{3, 9, {4, 1, 2}}, Times{4, 9, {6, 1, 2}}}) {
    for (const bool yields : {false, true}) {
      for (const bool assisted : {false, true}) {
        for (std::uint64_t i = 0; i < walks; ++i) walk(times, seed++, yields, assisted, seen);
      }
    }
  }
  for (const auto& state : seen.with) {
    for (const auto& sign : state) {
      for (const std::uint32_t n : sign) CHECK(n > 0);
    }
  }
  for (const std::uint32_t n : seen.rested) CHECK(n > 0);
  // Every row was taken: each pair of states that the table connects.
  for (const auto& row : Resilient::rows) {
    CHECK(seen.entered[std::countr_zero(row.from.bits)][static_cast<int>(row.next)] > 0);
  }
}

// Counters stop, they do not wrap: a robot left alone for days is as silent as after a second.
void test_counters_do_not_wrap() {
  Robot robot({5, 50, {67, 6, 6}}, {.leads = true});
  RobotInput in{Sign::zero, true, 60000, MessageKind::none, true, false, 0};
  for (int i = 0; i < 100; ++i) {
    const auto out = robot.step(in);
    CHECK(robot.silence() && out.command.stop && out.send);
  }
}

// Duplicates, older beacons and beacons of an earlier boot are rejected; a new boot is newer.
void test_receiver_accepts_newest_beacon_only() {
  BeaconReceiver receiver(1);
  receiver.tick(10);
  CHECK(receiver.age() == unknown_age);
  const auto beacon = [](std::uint16_t epoch, std::uint32_t tick, BeaconStamp heard) {
    return Beacon{MessageKind::ack, false, false, {epoch, tick}, heard};
  };
  CHECK(receiver.accept(beacon(1, 5, {})));
  CHECK(receiver.age() == unknown_age);  // it has not heard me
  CHECK(receiver.accept(beacon(1, 7, {1, 4})));
  CHECK(receiver.age() == 6);
  CHECK(!receiver.accept(beacon(1, 7, {1, 9})));
  CHECK(!receiver.accept(beacon(1, 6, {1, 9})));
  CHECK(receiver.age() == 6 && receiver.newest().sent.tick == 7);
  receiver.tick(3);
  CHECK(receiver.age() == 9);
  CHECK(receiver.accept(beacon(2, 1, {1, 12})));
  CHECK(!receiver.accept(beacon(1, 8, {1, 13})));
  CHECK(receiver.age() == 1);
  CHECK(receiver.accept(beacon(2, 2, {1, 14})));  // it cannot have heard the future
  CHECK(receiver.age() == unknown_age);
  CHECK(receiver.accept(beacon(2, 3, {1, 13})) && receiver.age() == 0);  // in this very tick
  receiver.tick(60000);
  receiver.tick(60000);
  CHECK(receiver.age() == unknown_age);         // longer ago than an age can state
  CHECK(!Beacon{}.ready && !Beacon{}.stopped);  // what is not said is not true
  const Beacon mine = receiver.beacon(MessageKind::tilt_up, true, false);
  CHECK(mine.sent.epoch == 1 && mine.sent.tick == 120013);
  CHECK(mine.heard.epoch == 2 && mine.heard.tick == 3 && mine.stopped && !mine.ready);
  CHECK(!receiver.beacon(MessageKind::tilt_down, false, true).stopped);
  CHECK(receiver.beacon(MessageKind::tilt_down, false, true).ready);
  // After a boot, what echoes the life before is no answer.
  BeaconReceiver booted(2);
  CHECK(booted.accept(beacon(2, 4, {1, 13})) && booted.age() == unknown_age);
}

}  // namespace

int main(int argc, char** argv) {
  test_agrees_with_oracle(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 10);
  test_counters_do_not_wrap();
  test_receiver_accepts_newest_beacon_only();
}
