// SPDX-License-Identifier: Apache-2.0
// The table of a job on the floor (control/lifting.hpp) against its guide, whatever is lost, late or
// restarted (support/lift_world.hpp).
#include <cstdlib>
#include <random>
#include <string_view>
#include <utility>

#include "support/lift_world.hpp"

namespace {

using namespace palmbots;
using namespace palmbots::test;

void random_jobs(unsigned number) {
  unsigned delivered = 0;
  for (unsigned seed = 0; seed < number; ++seed) {
    std::mt19937 chance(seed);
    LiftJob job;
    job.seed = seed;
    job.leader = static_cast<int>(chance() % 2);
    job.loss = chance() % 2 ? 0 : 0.1 * static_cast<double>(chance() % 5);
    job.most_delay = 1 + static_cast<int>(chance() % 8);
    job.restarts = chance() % 3 == 0;
    job.blackouts = chance() % 4 == 0;
    for (int& gap : job.gaps) gap = 20 + static_cast<int>(chance() % 200);
    job.one_first = chance() % 3 == 0;
    job.stands = chance() % 3 == 0;
    job.level = chance() % 3 == 0;
    LiftWorld world(job);
    const bool done = world.run();
    delivered += done;
    if (job.is_faultless()) {
      CHECK(done);
      CHECK(world.at(0).docks == 0 && world.at(1).docks == 0);  // the first one has begun
    }
  }
  CHECK(delivered * 10 >= number * 9);
}

// The same job with the sides exchanged is the same job.
void mirrored() {
  for (unsigned seed = 0; seed < 20; ++seed) {
    LiftJob job;
    job.gaps[0] = 20 + static_cast<int>(seed) * 9;
    job.most_delay = 1;
    LiftJob other = job;
    std::swap(other.gaps[0], other.gaps[1]);
    other.leader = 1;
    job.centres[0] = job.centres[1] = other.centres[0] = other.centres[1] = seed % 2 == 0;
    LiftWorld one(job), two(other);
    CHECK(one.run() == two.run());
    for (int i = 0; i < 2; ++i) CHECK(one.at(i).phases == two.at(1 - i).phases);
  }
}

// Three attempts, and no more.
void gives_up() {
  for (const bool silent : {false, true}) {
    for (int stuck = 0; stuck < 2; ++stuck) {
      LiftJob job;
      job.is_silent = silent;
      job.centres[stuck] = false;
      job.gaps[1 - stuck] = 60;  // so its contact is at its heel
      LiftWorld world(job);
      CHECK(!world.run());
      for (int i = 0; i < 2; ++i) CHECK(world.at(i).docks == 2 && world.at(i).height == 0);
    }
  }
}

// Something moves a contact that was centred. As long as both noses are on the floor, another attempt
// follows; a partner that has begun to raise waits, and so does a robot that restarts.
void knocked() {
  int knocks = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (int side = 0; side < 2; ++side) {
      for (const bool in_raise : {false, true}) {
        for (const bool restarts : {false, true}) {
          LiftJob job;
          job.seed = seed;
          job.knocked = side;
          job.most_delay = 8;
          const bool waits = in_raise || restarts;
          job.knocked_for = (waits ? 40 : 1000) * reach;
          job.knocked_in_raise = in_raise;
          job.knock_restarts = restarts;
          job.gaps[1 - side] = restarts || in_raise ? 30 : 25;
          job.gaps[side] = 90;  // it is the last one, so its partner centres for longer
          LiftWorld world(job);
          CHECK(world.run() == waits);
          knocks += world.was_knocked();
          CHECK(in_raise || world.was_knocked());
          CHECK(world.at(1 - side).docks == (waits ? 0 : 2));
        }
      }
    }
  }
  CHECK(knocks > 100);  // of 160
}

// An object that stays on the palms does not keep the robots there.
void glued() {
  LiftJob job;
  job.is_glued = true;
  LiftWorld world(job);
  CHECK(!world.run());
  for (int i = 0; i < 2; ++i) CHECK(world.at(i).name() == "done");
}

// A robot that missed all of its partner's carry joins it nevertheless.
void deaf() {
  for (int side = 0; side < 2; ++side) {
    LiftJob job;
    job.deaf = side;
    job.leader = 1 - side;
    LiftWorld world(job);
    CHECK(world.run());
  }
}

// Phases that a partner has to distinguish have different messages, and messages of arms that go up or
// down are those of the phases in which they may.
void messages() {
  const Names same[] = {{"stand_by", "dock"},
                        {"centre", "recentre"},
                        {"ready", "poised"},
                        {"under", "meet"},
                        {"dock", "touch"},
                        {"stand_by", "touch"},
                        {"raise", "raise_hold"},
                        {"lower", "lower_hold"},
                        {"leave_steep", "leave_shallow"},
                        {"empty", "retreat", "done", "stand_back"},
                        {"back_off", "failed"}};
  for (int a = 0; a < Lifting::states; ++a) {
    const std::string_view one = Lifting::meanings[a].name;
    const MessageKind message = Lifting::outputs[a].message;
    const bool goes_up = is_one_of(one, {"ready", "poised", "raise", "raise_hold", "up", "carry"});
    CHECK(Lifting::rises.has(message) == goes_up);
    CHECK(Lifting::assisting.has(static_cast<Lifting::State>(a)) == may_be_up(one));
    CHECK(Lifting::sinks.has(message) ==
          (stage(one) >= 7 || is_one_of(one, {"stand_back", "back_off", "failed"})));
    for (int b = 0; b < a; ++b) {
      const std::string_view other = Lifting::meanings[b].name;
      bool together = false;
      for (const Names& names : same) together |= is_one_of(one, names) && is_one_of(other, names);
      CHECK((message == Lifting::outputs[b].message) == together);
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  random_jobs(count > 1 ? static_cast<unsigned>(std::atoi(arguments[1])) : 300);
  mirrored();
  gives_up();
  knocked();
  glued();
  deaf();
  messages();
}
