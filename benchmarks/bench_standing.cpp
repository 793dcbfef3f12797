// SPDX-License-Identifier: Apache-2.0
// shared-sign, and a variant whose braking robot stands with its brakes on, instead of keeping its
// correction. Reads a Spec from standard input. Prints drops, other carries that were not delivered,
// the mean time [s] and the mean number of messages of a carry.
//   bench_standing reverses|stands CARRIES < spec
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "palmbots/control/shared_sign.hpp"
#include "palmbots/sim/carry.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/table_team.hpp"
#include "support/read_spec.hpp"

namespace {

using namespace palmbots;

struct Standing : SharedSign {
  static constexpr auto outputs = [] {
    std::array<TableOutput, SharedSign::states> made{};
    std::ranges::copy(SharedSign::outputs, made.begin());
    for (TableOutput& output : made) {
      if (output.brakes) output.command.move = Move::hold;
    }
    return made;
  }();
};

template <class Table>
void run(const Spec& spec, std::uint64_t carries) {
  std::uint64_t dropped = 0;
  std::uint64_t delivered = 0;
  double time = 0;
  double messages = 0;
  for (std::uint64_t seed = 0; seed < carries; ++seed) {
    auto team = TableTeamMaker<Table>{}(spec, seed);
    Carry<double, decltype(team), NoRecorder> carry(spec, seed, std::move(team), NoRecorder{});
    carry.run();
    messages += double(carry.team().link_totals.sent);
    dropped += carry.metrics().outcome == Outcome::dropped ? 1 : 0;
    if (carry.metrics().outcome != Outcome::delivered) continue;
    ++delivered;
    time += carry.metrics().time_ticks * spec.period;
  }
  std::printf("%llu %llu %.3f %.1f\n", static_cast<unsigned long long>(dropped),
              static_cast<unsigned long long>(carries - dropped - delivered),
              time / double(delivered), messages / double(carries));
}

}  // namespace

int main(int count, char** words) {
  const auto spec = read_spec();
  if (count != 3 || !spec) return 2;
  const auto carries = std::strtoull(words[2], nullptr, 10);
  if (std::string_view(words[1]) == "stands") {
    run<Standing>(*spec, carries);
  } else {
    run<SharedSign>(*spec, carries);
  }
}
