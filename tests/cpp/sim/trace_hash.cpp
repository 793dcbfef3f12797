// SPDX-License-Identifier: Apache-2.0
// The trace hash of one carry, from a Spec as bytes on standard input:
//   trace_hash CONTROLLER SEED double|float < spec
// tests/laws/test_trace_hashes.py compiles it in several ways and compares what it prints.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/team_registry.hpp"
#include "support/read_spec.hpp"

namespace {

using namespace palmbots;

template <class Real, class Team>
std::uint64_t hash_of(const Spec& spec, std::uint64_t seed, Team team) {
  Carry<Real, Team, TraceRecorder> carry(spec, seed, std::move(team), TraceRecorder(false));
  carry.run();
  return carry.recorder().hash();
}

template <class Real>
std::uint64_t hash_named(const Spec& spec, std::uint64_t seed, std::string_view controller) {
  return visit_team(controller,
                    [&](auto make) { return hash_of<Real>(spec, seed, make(spec, seed)); });
}

}  // namespace

int main(int count, char** words) {
  const auto given = read_spec();
  if (count != 4 || !given) return 2;
  const Spec& spec = *given;
  const std::uint64_t seed = std::strtoull(words[2], nullptr, 10);
  const std::uint64_t hash = std::string_view(words[3]) == "float"
                                 ? hash_named<float>(spec, seed, words[1])
                                 : hash_named<double>(spec, seed, words[1]);
  std::printf("%016" PRIx64 "\n", hash);
}
