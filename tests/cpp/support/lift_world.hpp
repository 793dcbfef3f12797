// SPDX-License-Identifier: Apache-2.0
// Two robots that run the table of a job on the floor, in a toy world that knows only where each
// contact is, how high each arm is, and what was said. It checks in every tick what
// docs/guide/lifting.md says.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <initializer_list>
#include <map>
#include <random>
#include <string>
#include <string_view>

#include "palmbots/control/lifting.hpp"
#include "palmbots/control/table_robot.hpp"
#include "support/check.hpp"

namespace palmbots::test {

using LiftRobot = TableRobot<Lifting>;
using Names = std::initializer_list<std::string_view>;

constexpr double period = 0.01;  // [s]
constexpr int half = 60;         // of a palm [mm]; both contacts move by at most 1 mm in a tick
constexpr int zone = 8;          // of the sign 0 [mm]
constexpr int top = 150;         // the height at which arms carry [mm]
constexpr int beacon = 5;        // [ticks]
constexpr int lease = 40;        // [ticks]
constexpr int distance = 300;    // [mm]
constexpr int reach = half;      // [ticks]
constexpr double rate = 0.5;     // of an arm [mm per tick]
constexpr double step = rate * lease;  // of the table [mm]

inline bool is_one_of(std::string_view name, Names names) {
  for (const std::string_view one : names) {
    if (one == name) return true;
  }
  return false;
}

// The phases of the guide in their order. A robot goes to the next one, or stays in a group.
inline int stage(std::string_view name) {
  const Names order[] = {{"stand_by", "dock", "touch", "meet", "poised"},
                         {"under"},
                         {"centre"},
                         {"ready", "recentre"},
                         {"raise", "raise_hold"},
                         {"up"},
                         {"carry"},
                         {"arrived"},
                         {"lower", "lower_hold"},
                         {"down"},
                         {"leave_steep", "leave_shallow", "empty"},
                         {"retreat"},
                         {"done"}};
  int number = 0;
  for (const Names& names : order) {
    if (is_one_of(name, names)) return number;
    ++number;
  }
  return -1;
}

// Whether a robot in this state may have raised the object, as far as its partner knows.
inline bool may_be_up(std::string_view name) {
  return stage(name) >= 3 || is_one_of(name, {"poised", "held"});
}

inline bool may_follow(std::string_view from, std::string_view to) {
  if (from == "under" && to == "poised") return true;  // contacts are centred in the air
  const Names on_stand{"touch", "meet", "poised"};
  if (is_one_of(from, on_stand) || is_one_of(to, on_stand)) {
    const std::string_view order[] = {"dock", "touch", "meet", "poised", "raise"};
    const auto* at = std::find(std::begin(order), std::end(order), from);
    return (at != std::end(order) && at + 1 != std::end(order) && at[1] == to) || to == "back_off";
  }
  if (to == "back_off" && from != "held") return stage(from) >= 0 && stage(from) <= 3;
  if (from == "back_off") return to == "stand_back";
  if (from == "stand_back") return to == "dock" || to == "failed";
  if (from == "failed") return false;
  // What a partner does after a restart is what it said.
  if (from == "held") return is_one_of(to, {"raise_hold", "lower_hold", "back_off"});
  if (from == "raise_hold" && to == "arrived") return true;  // the partner has carried meanwhile
  if (from == "carry" && to == "up") return true;  // it no longer hears that its partner carries
  return stage(to) == stage(from) || stage(to) == stage(from) + 1;
}

// What a job is like.
struct LiftJob {
  double loss = 0;
  int most_delay = 2;              // [ticks]
  int gaps[2] = {30, 30};          // between noses and object [mm]
  bool centres[2] = {true, true};  // whether corrections move the contact
  bool restarts = false;
  bool is_silent = false;
  bool blackouts = false;
  int leader = 0;
  // What happens to the contact of one side as soon as its centred contact has been noticed: something
  // moves it to the heel, and no correction moves it for so long [ticks]; and maybe a restart.
  int knocked = -1;
  int knocked_for = 0;
  bool knocked_in_raise = false;  // once the partner raises
  bool knock_restarts = false;
  int deaf = -1;           // which side hears nothing in `up` until its partner has arrived
  bool is_glued = false;   // the object stays on the palms
  bool one_first = false;  // the robot that follows stands by until its partner is under
  bool stands = false;     // the object is on a stand before and after
  bool level = false;      // contacts are corrected at level pivots only
  unsigned seed = 0;

  bool is_faultless() const { return loss == 0 && !restarts && !is_silent && !blackouts; }
};

struct Packet {
  int due;
  int sent;
  MessageKind message;
  bool low_bit, high_bit;  // of the steps of the sender's arm
};

struct LiftSide {
  LiftRobot robot;
  double p = 0;       // the contact, outward of the middle of the palm [mm]
  double height = 0;  // of the arm [mm]
  double travelled = 0;
  bool steep = true;
  int turning = 0;  // until the palm is where it was commanded [ticks]
  int since = 0;    // in its state [ticks]
  int stuck_until = 0;
  int off_until = 0;  // [ticks]
  bool assisted = false;
  bool arm_there = true;
  bool is_below = false;  // the palm is below an object on a stand, and does not touch it
  bool beneath = false;   // as the robot knows
  std::deque<Packet> inbox{};
  std::map<std::string, int> last{};  // when it was last in each state [ticks]
  std::string phases{};
  int docks = 0;

  std::string_view name() const { return name_of(robot.state()); }
  bool touches() const { return p >= -half && !is_below; }
  bool is_off(int now) const { return now < off_until; }
};

class LiftWorld {
 public:
  explicit LiftWorld(const LiftJob& job)
      : job_(job),
        chance_{std::mt19937(2 * job.seed + (job.leader == 0)),
                std::mt19937(2 * job.seed + (job.leader == 1))},
        sides_{side(0), side(1)} {}

  // True if the job is done, false if both have given up. Anything else is a defect.
  bool run() {
    for (now_ = 0; now_ < 300 * reach + (job_.restarts || job_.blackouts ? 300 * reach : 0);
         ++now_) {
      tick();
      if (both("done")) return is_alone();
      if (both("failed")) return false;
    }
    std::fprintf(stderr, "seed %u: %s | %s\n", job_.seed, sides_[0].phases.c_str(),
                 sides_[1].phases.c_str());
    for (const LiftSide& one : sides_)
      std::fprintf(stderr, "%s %g %g %g\n", one.name().data(), one.p, one.height, one.travelled);
    CHECK(!"the job ends");
    return false;
  }

  const LiftSide& at(int i) const { return sides_[i]; }
  bool was_knocked() const { return was_knocked_; }

 private:
  LiftSide side(int i) const {
    TableTimes<Lifting> times{beacon, lease, {}};
    for (std::size_t k = 0; k < Lifting::limits; ++k) {
      const double s = Lifting::seconds(static_cast<Lifting::Limit>(k), {0, 0, reach * period, 0});
      times.limits[k] = static_cast<std::uint16_t>(std::lround(s / period));
    }
    LiftSide made{LiftRobot(times, {job_.leader == i, false})};
    if (job_.one_first && job_.leader != i) made.robot.enter(Lifting::State::stand_by);
    made.p = -half - job_.gaps[i];
    made.is_below = job_.stands;
    return made;
  }

  // Each robot has its own chance, which goes with its role.
  unsigned below(int i, unsigned n) { return static_cast<unsigned>(chance_[i]()) % n; }
  bool both(std::string_view name) const {
    return sides_[0].name() == name && sides_[1].name() == name;
  }
  bool is_alone() const { return !sides_[0].touches() && !sides_[1].touches(); }

  void tick() {
    dark_ = job_.blackouts && (now_ < dark_until_);
    if (job_.blackouts && !dark_ && below(job_.leader, 400) == 0)
      dark_until_ = now_ + static_cast<int>(below(job_.leader, 300));
    const double heights[] = {sides_[0].height, sides_[1].height};
    for (int i = 0; i < 2; ++i) {
      LiftSide& own = sides_[i];
      // Always the same one: two robots that hold after a restart do so for good.
      const bool may_restart = job_.restarts && !own.is_off(now_) && i == job_.leader;
      if (may_restart && below(i, 900) == 0) {
        restart(own, 1 + static_cast<int>(below(i, 100)));
      }
      // An object may tip back.
      if (own.name() == "empty" && sides_[1 - i].touches() && below(i, 100) == 0) own.p = 1 - half;
      knock(i);
      if (!own.is_off(now_)) decide(i);
    }
    for (int i = 0; i < 2; ++i) {
      if (!sides_[i].is_off(now_)) act(i);
    }
    check_heights(heights);
  }

  void restart(LiftSide& own, int lasts) {
    const std::string before(own.name());
    own.off_until = now_ + lasts;
    own.robot = own.robot.booted(own.assisted);
    own.inbox.clear();
    own.since = now_;
    // It holds if its partner may have the object in the air, and else tries again.
    CHECK(own.name() == (may_be_up(before) ? "held" : "back_off"));
  }

  void knock(int i) {
    LiftSide& own = sides_[i];
    const std::string_view other = sides_[1 - i].name();
    if (i != job_.knocked || was_knocked_ || own.name() != "ready") return;
    if (job_.knocked_in_raise && other != "raise") return;
    was_knocked_ = true;
    own.p = half;
    own.stuck_until = now_ + job_.knocked_for;
    if (job_.knock_restarts) restart(own, 1);
  }

  void decide(int i) {
    LiftSide& own = sides_[i];
    const std::string before(own.name());
    if (i == job_.deaf && before == "up" && sides_[1 - i].name() != "arrived") own.inbox.clear();
    RobotInput in{};
    in.sign = !own.touches() || own.p < -zone ? Sign::negative
              : own.p > zone                  ? Sign::positive
                                              : Sign::zero;
    in.palm_at_target = own.turning == 0;
    for (int k = 0; k < static_cast<int>(own.inbox.size()); ++k) {
      if (own.inbox.front().due > now_) break;
      in.message = own.inbox.front().message;
      in.stopped = own.inbox.front().low_bit;
      in.ready = own.inbox.front().high_bit;
      in.age = static_cast<std::uint16_t>(now_ - own.inbox.front().sent);
      own.inbox.pop_front();
    }
    own.beneath = job_.stands && before != "back_off" && (own.beneath || own.p >= 0);
    own.robot.clock().own.senses = {own.touches(),
                                    own.arm_there,
                                    own.travelled >= distance,
                                    static_cast<std::uint8_t>(own.height / step),
                                    own.beneath,
                                    job_.level};
    const RobotOutput out = own.robot.step(in);
    own.assisted = out.assists;
    // What it is about to do fits what it feels.
    if (own.name() == "ready") CHECK(std::abs(own.p) <= zone && own.touches());
    if (own.name() == "raise" && before == "ready") CHECK(std::abs(own.p) <= zone);
    if (before == "empty" && own.touches()) CHECK(own.name().starts_with("leave_"));
    if (own.name() == "carry" && sides_[1 - i].name() == "arrived" && job_.is_faultless())
      CHECK(now_ - sides_[1 - i].since <= job_.most_delay + beacon + 1);
    if (own.name() != before) {
      own.since = now_;
      CHECK(may_follow(before, own.name()));
      enter(i, before);
    }
    own.last[std::string(own.name())] = now_;
    if (out.send && !job_.is_silent && !dark_ && below(i, 1000) >= 1000 * job_.loss) {
      const int late = 1 + static_cast<int>(below(i, static_cast<unsigned>(job_.most_delay)));
      LiftSide& other = sides_[1 - i];
      const int due =
          other.inbox.empty() ? now_ + late : std::max(now_ + late, other.inbox.back().due);
      if (!other.is_off(due))
        other.inbox.push_back({due, now_, out.message, own.robot.stopped(), out.ready});
    }
  }

  void enter(int i, std::string_view before) {
    LiftSide& own = sides_[i];
    own.phases += " " + std::string(own.name());
    if (own.name() == "dock" && before == "stand_by")
      CHECK(heard_of(i, {"under", "meet"}));
    else if (own.name() == "dock")
      ++own.docks;
    if (own.name() == "under" && before == "dock" && job_.one_first && job_.is_faultless())
      CHECK(job_.leader == i || heard_of(i, {"under"}));
    // An arm never begins to move, nor wheels to leave, while the contact is not on the palm.
    if (own.name() == "ready") CHECK(std::abs(own.p) <= zone + 1 && own.turning == 0);
    if (own.name() == "centre")
      CHECK(heard_of(i, {"under", "meet", "poised", "centre", "ready", "recentre", "raise",
                         "raise_hold", "up"}));
    if (own.name() == "under") CHECK(own.p >= -zone - 1);
    if (own.name() == "touch") CHECK(job_.stands && own.p >= 0);
    if (own.name() == "meet") CHECK(own.touches());
    if (own.name() == "poised")
      CHECK(heard_of(i, {"meet", "under", "poised", "raise", "raise_hold", "up", "held"}));
    if (own.name() == "centre") CHECK(!job_.level);
    if (own.name() == "up") CHECK(own.height == top);
    if (own.name() == "down") CHECK(own.height == 0);
    if (own.name() == "empty") CHECK(!own.touches());
    if (own.name() == "carry") CHECK(heard_of(i, {"up", "carry", "arrived"}));
    if (own.name() == "arrived" && before == "carry")
      CHECK(own.travelled >= distance || heard_of(i, {"arrived", "lower", "lower_hold"}));
    // Nothing takes too long if nothing goes wrong.
    if (own.name() == "retreat" && job_.is_faultless() && !job_.is_glued)
      CHECK(before == "empty" && heard_of(i, {"empty", "retreat", "done"}));
    // A partner that hears nothing may push the object after it.
    if (own.name() == "stand_back") CHECK(!own.touches() || job_.blackouts || job_.loss > 0);
    if (is_one_of(own.name(), {"back_off", "dock"})) {
      CHECK(own.height == 0 && sides_[1 - i].height == 0);
    }
    if (own.name() == "leave_steep" && before == "down") CHECK(job_.leader == i);
    if (own.name() == "leave_shallow") CHECK(job_.leader != i);
  }

  // Whether the partner was in one of these states in the last lease, as far as it can have said so.
  bool heard_of(int i, Names names) const {
    const LiftSide& other = sides_[1 - i];
    for (const std::string_view name : names) {
      const auto found = other.last.find(std::string(name));
      if (found != other.last.end() && found->second >= now_ - lease - 1) return true;
    }
    return false;
  }

  void act(int i) {
    LiftSide& own = sides_[i];
    LiftSide& other = sides_[1 - i];
    const LiftRole role = Lifting::role(own.robot.state());
    const std::string_view meaning = Lifting::meanings[static_cast<int>(own.robot.state())].meaning;
    const bool says_drives = meaning.find("drives") != std::string_view::npos;
    const Command command = own.robot.now().command;
    if (own.turning > 0) --own.turning;
    CHECK((role.driver == Driver::controller) == (own.name() == "carry"));
    // Contacts are corrected as long as both palms are under the object.
    const int place = stage(own.name());
    CHECK((role.driver == Driver::table) == ((place < 2 || place > 8) && own.name() != "held"));
    const bool waits = job_.level && is_one_of(own.name(), {"raise", "raise_hold", "up", "arrived",
                                                            "lower", "lower_hold", "held"});
    if (role.driver == Driver::table || waits) {
      CHECK((command.move != Move::hold) == says_drives);
      CHECK((command.move == Move::closer) == (own.name() == "dock"));
      CHECK((command.palm == Palm::shallow) ==
            is_one_of(own.name(), {"leave_shallow", "stand_by"}));
      turn(own, command.palm == Palm::steep);
      drive(own, other, command.move);
    } else {
      CHECK(!says_drives);
      turn(own, true);
      CHECK(!job_.level || (own.height == top && (other.height == top || job_.restarts)));
      correct(i);
    }
    CHECK((Lifting::driver(own.robot.state(), {.touches = true, .level_only = job_.level}) ==
           Driver::table) == (role.driver == Driver::table || waits));
    // Arms.
    const double before = own.height;
    switch (role.arm) {
      case ArmMove::follow: CHECK(own.height == 0); break;
      case ArmMove::reach: own.is_below = below(i, 20) != 0; break;
      case ArmMove::hold: break;
      case ArmMove::rise: own.height = std::min<double>(top, own.height + rate); break;
      case ArmMove::sink: own.height = std::max<double>(0, own.height - rate); break;
    }
    own.arm_there = role.arm == ArmMove::rise   ? own.height == top
                    : role.arm == ArmMove::sink ? own.height == 0
                                                : true;
    if (own.height > before) {
      CHECK(heard_of(i, {"ready", "poised", "raise", "raise_hold", "up", "carry"}));
      CHECK(own.touches());
    }
    if (own.height < before) {
      own.is_below = own.is_below || (job_.stands && own.height < 5);
      CHECK(heard_of(i, {"arrived", "lower", "lower_hold", "down", "leave_steep", "leave_shallow",
                         "empty", "retreat", "done"}));
    }
    if (own.name() == "carry") {
      CHECK(own.height == top);
      own.travelled += i == job_.leader ? 1 : 0.5;
    }
  }

  static void turn(LiftSide& own, bool steep) {
    if (own.steep == steep) return;
    own.steep = steep;
    own.turning = 10;
  }

  void drive(LiftSide& own, LiftSide& other, Move move) {
    if (move == Move::hold) return;
    CHECK(own.height == 0 && other.height == 0);
    if (move == Move::closer) {
      // A nose that touches the edge pushes the object along the partner's palm, to its heel.
      if (own.p >= -half - 1 && own.p < -half && other.touches() && other.p < half) {
        other.p += 1;
      } else if (own.p < half) {
        own.p += 1;
      }
      return;
    }
    // A palm that is not steep takes the object along, and the partner's slides off.
    const bool was = own.touches();
    if (job_.stands && own.p < -half) own.is_below = true;
    if (was && job_.is_glued) return;
    if (!own.steep && own.touches() && other.touches()) return;
    own.p -= 1;
    if (was && !own.touches() && job_.is_faultless()) {
      CHECK(own.steep || other.touches());
    }
  }

  // The contact moves towards the middle on the floor, and anywhere near it.
  void correct(int i) {
    LiftSide& own = sides_[i];
    if (!own.touches() || now_ < own.stuck_until) return;
    if (own.turning == 0 && below(i, 50) == 0) own.turning = 10;  // as corrections do
    const double to = own.p > 0 ? -0.5 : 0.5;
    if (job_.centres[i] && std::abs(own.p) > 2) own.p += to;
    if (job_.centres[i] && below(i, 200) == 0)
      own.p += static_cast<double>(below(i, 2 * zone)) - zone;
  }

  void check_heights(const double (&before)[2]) const {
    const double apart = std::abs(sides_[0].height - sides_[1].height);
    CHECK(apart <= step + rate);
    if (job_.is_faultless()) CHECK(apart <= rate * (beacon + job_.most_delay + 2));
    for (int i = 0; i < 2; ++i) CHECK(std::abs(sides_[i].height - before[i]) <= rate);
  }

  LiftJob job_;
  std::mt19937 chance_[2];
  LiftSide sides_[2];
  int now_ = 0;
  int dark_until_ = 0;
  bool dark_ = false;
  bool was_knocked_ = false;
};

}  // namespace palmbots::test
