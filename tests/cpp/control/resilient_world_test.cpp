// SPDX-License-Identifier: Apache-2.0
// Two robots that run the resilient algorithm in an abstract world that is against them: a radio
// that loses, doubles and delays beacons without limit, in spells; bumps; reboots; and, wherever
// the two properties of the mechanics leave it open, the wrong contact slides. Random, many times
// over. What must never happen is looked for at every tick, and that it is looked for is shown by a
// hold that is too short.
//
// resilient_world_test [WORLDS]   WORLDS: random worlds; 1000 if not given
#include <cstdint>
#include <cstdlib>
#include <deque>

#include "palmbots/base/philox.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/control/mailbox.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/control/table_robot.hpp"
#include "support/check.hpp"

using namespace palmbots;

namespace {

using Robot = TableRobot<Resilient>;

constexpr int tilt = 4;  // ticks that a palm takes to turn
constexpr int zone = 2;  // |p| up to this reads 0 [units]
constexpr std::uint16_t beacon = 2;
constexpr int run_on =
    3;  // ticks that wheels run on after a move; not those of a robot that reboots
constexpr std::uint16_t lease = 18;  // 2 (D + B) + 2 with D = 3, and three lost beacons

struct Packet {
  std::uint32_t due;
  Beacon beacon;
};

struct Broken {
  int away_against_closer = 0;  // S1
  int away_unassisted = 0;  // S2: moves away, and its palm is not steep or the other not shallow
  int closer_unsafe = 0;    // S3: moves closer, and the other palm is up, but not in its own (d)
  int alone_too_long = 0;
  int never_settles = 0;
};

class World {
 public:
  World(std::uint64_t seed, std::uint16_t hold)
      : seed_(seed),
        times_{beacon, lease, {hold, run_on, 4}},
        robots_{make(left, false), make(right, false)} {}

  void run(std::uint32_t ticks, bool faults, Broken& broken) {
    for (std::uint32_t end = tick_ + ticks; tick_ < end; ++tick_) tick(faults, broken);
  }

  bool at_goal() const {
    for (const std::size_t s : {left, right}) {
      if (std::abs(p_[s]) > zone || robots_[s].state() != Resilient::State::idle) return false;
      if (robots_[s].stopped() || raised_[s] != 0) return false;
    }
    return true;
  }

 private:
  Robot make(std::size_t s, bool assisted) const { return {times_, {s == right}, assisted}; }

  std::uint32_t random(std::uint32_t below) {
    if (used_ == 4) {
      words_ = draw(seed_, drawn_++, 3U);
      used_ = 0;
    }
    return words_[used_++] % below;
  }

  void tick(bool faults, Broken& broken) {
    // Spells of radio: good, bad one way, bad both ways.
    if (random(40) == 0) {
      for (const std::size_t s : {left, right}) loss_[s] = random(3) == 0 ? 100 : random(3) * 30;
    }
    for (const std::size_t s : {left, right}) {
      if (faults && random(400) == 0) {
        robots_[s] = make(s, out_[s].assists);
        receivers_[s] = BeaconReceiver(++epoch_[s]);
        runs_on_[s] = 0;
      }
      if (faults && random(200) == 0) p_[s] += static_cast<int>(random(9)) - 4;
      step(s, faults);
    }
    turn_palms();
    judge(broken);
    move();
  }

  void step(std::size_t s, bool faults) {
    receivers_[s].tick(1);
    bool news = false;
    for (std::size_t i = 0; i < air_[s].size();) {
      if (air_[s][i].due > tick_) {
        ++i;
        continue;
      }
      news = receivers_[s].accept(air_[s][i].beacon) || news;
      air_[s].erase(air_[s].begin() + static_cast<std::ptrdiff_t>(i));
    }
    const Beacon& newest = receivers_[s].newest();
    const Sign sign = p_[s] > zone ? Sign::positive : p_[s] < -zone ? Sign::negative : Sign::zero;
    out_[s] =
        robots_[s].step({sign, raised_[s] == goal_[s], 1, news ? newest.message : MessageKind::none,
                         newest.stopped, newest.ready, receivers_[s].age()});
    goal_[s] = out_[s].command.palm == Palm::shallow ? tilt : 0;
    if (out_[s].command.move != Move::hold) {
      wheels_[s] = out_[s].command.move;
      runs_on_[s] = run_on;
    } else if (runs_on_[s]-- <= 0) {
      wheels_[s] = Move::hold;
      runs_on_[s] = 0;
    }
    if (!out_[s].send) return;
    for (int copy = 0; copy < 2; ++copy) {
      if (copy == 1 && (!faults || random(10) != 0)) break;
      if (faults && random(100) < loss_[s]) continue;
      const std::uint32_t delay = faults && random(10) == 0 ? 1 + random(60) : 1 + random(3);
      air_[other(s)].push_back(
          {tick_ + delay,
           receivers_[s].beacon(out_[s].message, robots_[s].stopped(), out_[s].ready)});
    }
  }

  void turn_palms() {
    for (const std::size_t s : {left, right}) {
      if (robots_[s].name() == 'd') by_d_[s] = true;
      raised_[s] += raised_[s] < goal_[s] ? 1 : (raised_[s] > goal_[s] ? -1 : 0);
      if (raised_[s] == 0 && goal_[s] == 0) by_d_[s] = false;
    }
  }

  void judge(Broken& broken) {
    const Move l = wheels_[left];
    const Move r = wheels_[right];
    broken.away_against_closer +=
        (l == Move::away && r == Move::closer) || (r == Move::away && l == Move::closer) ? 1 : 0;
    for (const std::size_t s : {left, right}) {
      const Move move = wheels_[s];
      const std::size_t o = other(s);
      if (move == Move::away && (raised_[s] != 0 || raised_[o] != tilt)) ++broken.away_unassisted;
      if (move == Move::closer && raised_[o] != 0 && !by_d_[o]) ++broken.closer_unsafe;
    }
    for (const std::size_t s : {left, right}) {
      alone_[s] = robots_[other(s)].stopped() && !robots_[s].stopped() ? alone_[s] + 1 : 0;
      broken.alone_too_long += alone_[s] > lease + 1 ? 1 : 0;
    }
  }

  // Now and then one unit of opening or closing for each move, and one for travel apart.
  void move() {
    if (tick_ % 6 != 0) return;
    for (const std::size_t s : {left, right}) {
      if (wheels_[s] != Move::hold) slide(wheels_[s] == Move::closer);
    }
    if (robots_[left].stopped() != robots_[right].stopped()) {
      slide(robots_[right].stopped());  // the right robot leads
    }
  }

  void slide(bool closing) {
    std::size_t s = random(2);
    const bool settled = raised_[left] % tilt == 0 && raised_[right] % tilt == 0;
    if (settled && raised_[left] != raised_[right]) {
      const bool left_up = raised_[left] != 0;
      s = left_up == closing ? left
                             : right;  // closing slides the shallow one, opening the steep one
    }
    p_[s] += closing ? 1 : -1;
  }

  std::uint64_t seed_;
  TableTimes<Resilient> times_;
  PerSide<Robot> robots_;
  PerSide<BeaconReceiver> receivers_{BeaconReceiver(1), BeaconReceiver(1)};
  PerSide<std::uint16_t> epoch_{1, 1};
  PerSide<RobotOutput> out_{};
  PerSide<Move> wheels_{};           // what they do
  PerSide<int> runs_on_{};           // for so many ticks more
  PerSide<std::deque<Packet>> air_;  // to each robot
  PerSide<std::uint32_t> loss_{};    // of what each robot sends, in percent
  PerSide<int> p_{};
  PerSide<int> raised_{};  // 0: steep, tilt: shallow
  PerSide<int> goal_{};
  PerSide<bool> by_d_{};  // raised, or last raised, in its own (d)
  std::uint32_t tick_ = 0;
  PerSide<int> alone_{};  // travels while the other rests, for so long
  std::uint32_t drawn_ = 0;
  std::size_t used_ = 4;
  Words words_{};
};

Broken explore(std::uint16_t hold, int worlds) {
  Broken broken;
  for (int i = 0; i < worlds; ++i) {
    World world(static_cast<std::uint64_t>(i), hold);
    world.run(1500, true, broken);
    // Faults stop: the goal is reached, and kept.
    world.run(1500, false, broken);
    bool kept = world.at_goal();
    for (int k = 0; k < 50 && kept; ++k) {
      world.run(1, false, broken);
      kept = world.at_goal();
    }
    broken.never_settles += kept ? 0 : 1;
  }
  return broken;
}

}  // namespace

int main(int argc, char** argv) {
  const int worlds = argc > 1 ? std::atoi(argv[1]) : 150;
  const Broken safe = explore(lease + 1 + run_on, worlds);
  CHECK(safe.away_against_closer == 0);
  CHECK(safe.away_unassisted == 0);
  CHECK(safe.closer_unsafe == 0);
  CHECK(safe.alone_too_long == 0);
  CHECK(safe.never_settles == 0);
  CHECK(explore(lease / 2, 100).away_unassisted > 0);
}
