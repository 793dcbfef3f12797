// SPDX-License-Identifier: Apache-2.0
// A million steps of the resilient controller over random inputs, for callgrind to count
// instructions: see docs/reference/benchmarks.md and tests/control/test_resilient_cost.py.
#include <cstdint>
#include <cstdlib>

#include "palmbots/base/philox.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/control/table_robot.hpp"

using namespace palmbots;
using Robot = TableRobot<Resilient>;

[[gnu::noinline, gnu::flatten]] RobotOutput resilient_step(Robot& robot, const RobotInput& in);

RobotOutput resilient_step(Robot& robot, const RobotInput& in) { return robot.step(in); }

int main(int count, char** words) {
  const auto steps = static_cast<std::uint32_t>(count > 1 ? std::atoi(words[1]) : 0);
  const auto only = static_cast<std::uint32_t>(count > 2 ? std::atoi(words[2]) : 0);
  Robot robot({5, 52, {69, 6, 6}}, {});
  int sum = 0;
  for (std::uint32_t i = 0; i < steps; ++i) {
    const Words w = draw(only, i, 3U);
    const RobotInput in{static_cast<Sign>(static_cast<int>(w[0] % 3) - 1),
                        (w[1] & 3) != 0,
                        1,
                        static_cast<MessageKind>(w[2] % 6),
                        (w[2] >> 8) % 2 == 0,
                        (w[2] >> 9) % 2 == 0,
                        static_cast<std::uint16_t>(w[3] % 60)};
    sum += resilient_step(robot, in).send ? 1 : 0;
  }
  return sum > 0 ? 0 : 1;
}
