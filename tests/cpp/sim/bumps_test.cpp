// SPDX-License-Identifier: Apache-2.0
// Bumps of the floor by the tick, worked out by hand; random ones against one draw a tick.
#include "palmbots/sim/bumps.hpp"

#include <vector>

#include "support/check.hpp"

using namespace palmbots;

namespace {

struct Happened {
  std::uint32_t tick;
  double left;
  double right;
  std::uint32_t bumps;

  bool operator==(const Happened&) const = default;
};

// What comes of `ticks` ticks at the speed of both robots together, asked for as a carry does.
std::vector<Happened> happen(const Spec& spec, std::uint64_t seed, std::uint32_t ticks,
                             double together) {
  std::vector<Happened> found;
  Bumps bumps(spec);
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    const double midpoint = together * 0.5 * spec.period * tick;
    if (tick % block_ticks == 0) bumps.draw_block(spec, seed, tick);
    if (!bumps.due(spec, tick, midpoint, together)) continue;
    const auto shift = bumps.take(spec, seed, tick, midpoint, together);
    CHECK(shift.bumps > 0);
    found.push_back({tick, shift.by[left], shift.by[right], shift.bumps});
  }
  return found;
}

Spec scripted() {
  Spec spec;
  spec.period = 0.25;
  spec.bumps[0] = {1, 1, 2.0, 0.5};     // the right robot, after 2 s: in tick 8
  spec.bumps[1] = {0, 0, 0.75, -0.25};  // the left one, after 0.75 m
  spec.bumps[2] = {0, 1, 2.0, 0.125};
  spec.bumps[3] = {1, 1, 0.6, 0.0};  // in tick 3, the first one not before 0.6 s
  spec.bumps[4] = {1, 0, 0.0, 1.0};  // at once
  spec.bumps[5] = {1, 0, 0.75, 2.0};
  spec.bumps[6] = {0, 1, 2.0, 0.0625};
  spec.bumps[7] = {1, 0, 0.875, -1.0};  // in tick 7, where those of tick 8 must wait
  spec.bump_count = 8;
  return spec;
}

// Each comes once, in the first tick at its time or place or beyond; those of one tick add up.
void test_scripted_bumps() {
  Spec spec = scripted();
  // 0.125 m a tick: 0.75 m after six of them.
  const std::vector<Happened> expected{
      {0, 0, 1, 1}, {3, 0, 0, 1}, {6, -0.25, 2, 2}, {7, 0, -1, 1}, {8, 0.1875, 0.5, 3}};
  CHECK(happen(spec, 1, 100, 1.0) == expected);
  spec.direction = -1;  // places lie in the direction of travel
  CHECK(happen(spec, 1, 100, -1.0) == expected);
  CHECK(happen(spec, 1, 100, 1.0).size() == 3);
  spec.bump_count = 1;  // the others do not count
  CHECK(happen(spec, 1, 100, -1.0).size() == 1);
  CHECK(Bumps::any(spec));
  spec.bump_count = 0;
  CHECK(!Bumps::any(spec) && happen(spec, 1, 100, 1.0).empty());
}

// As many bumps as a spec can have.
void test_maximum_number_of_bumps() {
  Spec spec;
  spec.period = 0.5;
  for (std::size_t i = 0; i < max_bumps; ++i) {
    spec.bumps[i] = {0, 1, double(max_bumps - i), double(i + 1)};
  }
  spec.bump_count = max_bumps;
  const auto found = happen(spec, 0, 200, 0.1);
  CHECK(found.size() == max_bumps);
  for (std::size_t i = 0; i < max_bumps; ++i) {
    CHECK(found[i].tick == 2 * (i + 1) && found[i].left == double(max_bumps - i));
  }
}

// A robot's chance in a tick is rate × way. The leader has the first two words of the tick's draw:
// whether there is one, and where between −max and max.
void test_random_bumps() {
  Spec spec;
  spec.bump_rate = 20;
  spec.bump_max = 0.004;
  const double way = 0.06 * spec.period;
  for (const double direction : {1.0, -1.0}) {
    spec.direction = direction;
    const std::size_t leader = direction > 0 ? right : left;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      std::vector<Happened> expected;
      for (std::uint32_t tick = 0; tick < 5000; ++tick) {
        const Words words = draw(seed, tick, Stream::bump);
        PerSide<double> by{};
        std::uint32_t bumps = 0;
        for (const std::size_t i : {0U, 1U}) {
          if (unit_uniform<double>(words[2 * i]) >= 20 * way) continue;
          by[i == 0 ? leader : 1 - leader] =
              (2 * unit_uniform<double>(words[2 * i + 1]) - 1) * spec.bump_max;
          ++bumps;
        }
        if (bumps > 0) expected.push_back({tick, by[left], by[right], bumps});
      }
      // Twice 5000 chances of 1.2 %.
      CHECK(expected.size() > 80 && expected.size() < 160);
      CHECK(happen(spec, seed, 5000, 0.12 * direction) == expected);
    }
  }
  CHECK(happen(spec, 1, 5000, 0).empty());  // who stands meets none
  CHECK(Bumps::any(spec));
}

// Both kinds at once.
void test_scripted_and_random() {
  Spec spec = scripted();
  spec.bump_rate = 0.1;
  spec.bump_max = 1e-6;
  std::uint32_t bumps = 0;
  double shifted = 0;
  for (const Happened& one : happen(spec, 5, 400, 1.0)) {
    bumps += one.bumps;
    shifted += one.left + one.right;
  }
  CHECK(bumps > 8 + 3);
  CHECK(std::abs(shifted - 2.4375) < 1e-3);
}

}  // namespace

int main() {
  test_scripted_bumps();
  test_maximum_number_of_bumps();
  test_random_bumps();
  test_scripted_and_random();
}
