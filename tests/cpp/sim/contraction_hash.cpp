// SPDX-License-Identifier: Apache-2.0
// The trace hashes of a few carries of the scene `paper`, one a line, for seeds 0 to 4.
// tests/simulation/test_other_processors.py compiles it with and without fused multiply-add, and
// tests/firmware/test_qemu.py in single precision.
#include <cstdint>
#include <cstdio>

#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/table_team.hpp"
#include "palmbots/sim/team_registry.hpp"
#include "support/paper_spec.hpp"

#ifndef PALMBOTS_REAL
#define PALMBOTS_REAL double
#endif

int main() {
  using namespace palmbots;
  const Spec spec = paper_spec();
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TableTeamMaker<Silent> make;
    Carry carry = Carry<PALMBOTS_REAL, decltype(make(spec, seed)), TraceRecorder>(
        spec, seed, make(spec, seed), TraceRecorder(false));
    carry.run();
    std::printf("%016llx\n", static_cast<unsigned long long>(carry.recorder().hash()));
  }
}
