// SPDX-License-Identifier: Apache-2.0
// The age of the station's packets is never taken for less than it is, and never for much more than a
// round trip and the time since the last one.
#include "palmbots/runtime/answer_age.hpp"

#include <cstdint>
#include <vector>

#include "support/check.hpp"

namespace {

using namespace palmbots;
using runtime::AnswerAge;
using runtime::never;

constexpr std::uint32_t period = 5;

// A robot sends in every fifth tick; its packets are answered `delay` ticks later, one in `every`.
void the_age_is_bounded_on_both_sides(std::uint32_t delay, std::uint32_t every) {
  AnswerAge age;
  std::vector<std::uint32_t> sent{0};  // the tick of each packet; numbers begin with 1
  for (std::uint32_t tick = 1; tick < 4000; ++tick) {
    if (tick % period == 0) {
      age.sent(static_cast<std::uint32_t>(sent.size()), tick);
      sent.push_back(tick);
    }
    if (tick <= delay || (tick - delay) % (period * every) != 0) continue;
    const std::uint32_t acknowledged = (tick - delay) / period;
    const std::uint32_t since = age.heard(acknowledged);
    CHECK(since != never);
    CHECK(since <= sent[acknowledged]);
    CHECK(tick - since <= 2 * (delay + period * every) + period);
    CHECK(since == age.newest());
  }
}

void what_was_answered_before_may_have_any_age() {
  AnswerAge age;
  CHECK(age.newest() == never && age.heard(1) == never);
  age.sent(7, 100);
  CHECK(age.heard(6) == never);
  CHECK(age.heard(9) == 100);
  age.sent(10, 130);
  CHECK(age.heard(9) == 100);    // before the new probe
  CHECK(age.heard(6) == never);  // a station that has forgotten, and heard an old packet
  CHECK(age.heard(10) == 130 && age.newest() == 130);
}

}  // namespace

int main() {
  for (const std::uint32_t delay : {0U, 1U, 10U, 600U, 3000U}) {
    for (const std::uint32_t every : {1U, 4U}) the_age_is_bounded_on_both_sides(delay, every);
  }
  what_was_answered_before_may_have_any_age();
}
