// SPDX-License-Identifier: Apache-2.0
// Bumps are due in the ticks in which there are some, and in no others: more would only cost time.
// When they occur, and what they do, is tested in tests/simulation/test_disturbances.py.
#include "palmbots/sim/bumps.hpp"

#include "support/check.hpp"

using namespace palmbots;

namespace {

std::size_t bumps_in(const Spec& spec, std::uint32_t ticks) {
  std::size_t found = 0;
  Bumps bumps(spec);
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    const double midpoint = 0.5 * spec.period * tick;
    if (tick % block_ticks == 0) bumps.draw_block(spec, 1, tick);
    if (!bumps.due(spec, tick, midpoint, 1.0)) continue;
    const std::uint32_t count = bumps.take(spec, 1, tick, midpoint, 1.0).bumps;
    CHECK(count > 0);
    found += count;
  }
  return found;
}

}  // namespace

int main() {
  Spec spec;
  CHECK(!Bumps::any(spec) && bumps_in(spec, 1000) == 0);
  spec.bump_count = max_bumps - 1;
  for (std::size_t i = 0; i < spec.bump_count; ++i)
    spec.bumps[i] = {i % 2 == 0, 0, 0.1 * double(i), 0.1};
  spec.period = 0.25;
  CHECK(Bumps::any(spec) && bumps_in(spec, 1000) == spec.bump_count);
  spec.bump_count = 0;
  spec.bump_rate = 0.5;
  CHECK(Bumps::any(spec));
  const std::size_t found = bumps_in(spec, 1000);  // 2000 chances of 6.25 %
  CHECK(found > 80 && found < 170);
}
