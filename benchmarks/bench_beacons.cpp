// SPDX-License-Identifier: Apache-2.0
// When should a robot of shared-sign repeat its message? The shipped table with other times between its
// beacons. Reads a Spec from standard input. Prints drops, other carries that were not delivered, and
// for those that were, the mean time [s] and the messages per metre.
//   bench_beacons BUSY EARLY ALONE QUIET ANSWERS OLD CARRIES < spec
// Times in ticks: BUSY between two beacons, or EARLY if a message arrives, ALONE while the robot hears
// nothing, QUIET while both contacts are centred as far as it knows. ANSWERS = 1: after silence the first beacon that arrives is
// answered. A robot that is not quiet sends a beacon every radio.beacon_s while the message that it
// hears is at least OLD ticks old.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/sim/carry.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/table_team.hpp"
#include "support/read_spec.hpp"

namespace {

using namespace palmbots;

struct Rule {
  int busy;
  int early;
  int alone;
  int quiet;
  bool answers;
  int old;
};

// A robot of shared-sign that sends when the rule says so.
class SparingRobot {
 public:
  using Robot = TableRobot<SharedSign>;
  using Times = Robot::Times;
  using State = Robot::State;
  static constexpr Mail mail = Robot::mail;
  static constexpr bool has_clock = Robot::has_clock;

  SparingRobot(const Robot& robot, const Rule& rule) : robot_(robot), rule_(rule) {}
  SparingRobot booted() const { return {robot_.booted(), rule_}; }

  RobotOutput step(const RobotInput& in) {
    Robot before = robot_;
    before.clock().pass(in.elapsed, 0);
    const bool answers =
        rule_.answers && in.message != MessageKind::none && before.clock().silence();
    RobotOutput out = robot_.step(in);
    since_sent_ += in.elapsed;
    const bool arrives = in.message != MessageKind::none;
    out.send = out.message != said_ || since_sent_ >= (answers ? beacon() : interval(arrives));
    if (out.send) since_sent_ = 0;
    said_ = out.message;
    return out;
  }
  std::uint16_t quiet(Sign, bool) const { return 0; }
  void idle(Sign sign, std::uint16_t steps) { robot_.idle(sign, steps); }
  char name() const { return robot_.name(); }
  bool waits() const { return robot_.waits(); }
  MessageKind awaits() const { return robot_.awaits(); }
  bool stopped() const { return robot_.stopped(); }
  const TableClock<SharedSign>& clock() const { return robot_.clock(); }

 private:
  int beacon() const { return robot_.clock().times.beacon; }
  int interval(bool arrives) const {
    if (SharedSign::quiet.has(robot_.state())) return rule_.quiet;
    const int busy = robot_.silence() ? rule_.alone : rule_.busy;
    if (!robot_.silence() && robot_.clock().age >= rule_.old) return beacon();
    return arrives ? std::min(rule_.early, busy) : busy;
  }

  Robot robot_;
  Rule rule_;
  MessageKind said_ = MessageKind::none;
  int since_sent_ = 0;
};

void run(const Spec& spec, const Rule& rule, std::uint64_t carries) {
  std::uint64_t dropped = 0;
  std::uint64_t delivered = 0;
  double time = 0;
  double messages = 0;
  for (std::uint64_t seed = 0; seed < carries; ++seed) {
    auto team =
        robot_team_of<SparingRobot>({SparingRobot(table_robot_of<SharedSign>(spec, left), rule),
                                     SparingRobot(table_robot_of<SharedSign>(spec, right), rule)},
                                    spec, seed);
    Carry<double, decltype(team), NoRecorder> carry(spec, seed, std::move(team), NoRecorder{});
    carry.run();
    dropped += carry.metrics().outcome == Outcome::dropped ? 1 : 0;
    if (carry.metrics().outcome != Outcome::delivered) continue;
    ++delivered;
    time += carry.metrics().time_ticks * spec.period;
    messages += double(carry.team().link_totals.sent) / spec.distance;
  }
  std::printf("%llu %llu %.3f %.1f\n", static_cast<unsigned long long>(dropped),
              static_cast<unsigned long long>(carries - dropped - delivered),
              time / double(delivered), messages / double(delivered));
}

}  // namespace

int main(int count, char** words) {
  const auto spec = read_spec();
  if (count != 8 || !spec) return 2;
  const auto ticks = [&](int k) { return std::atoi(words[k]); };
  run(*spec, {ticks(1), ticks(2), ticks(3), ticks(4), words[5][0] == '1', ticks(6)},
      std::strtoull(words[7], nullptr, 10));
}
