// The trace hash of one carry, from a Spec as bytes on standard input:
//   trace_hash none|centralized|distributed|resilient SEED double|float < spec
// tests/test_determinism.py compiles it in several ways and compares what it prints.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "palmbots/recorder.hpp"
#include "palmbots/resilient_bounds.hpp"

namespace {

using namespace palmbots;

template <class Real, class Team>
std::uint64_t hash_of(const Spec& spec, std::uint64_t seed, Team team) {
  Carry<Real, Team, HashRecorder> carry(spec, seed, std::move(team), HashRecorder{});
  carry.run();
  return carry.recorder().hash();
}

template <class Real>
std::uint64_t hash_named(const Spec& spec, std::uint64_t seed, std::string_view controller) {
  const Channel channel = channel_of(spec);
  const Faults faults = Faults::of(spec, seed);
  const std::size_t leader = leader_of(spec);
  if (controller == "none") return hash_of<Real>(spec, seed, Unattended{});
  if (controller == "centralized") {
    return hash_of<Real>(spec, seed, Station(channel, seed, leader, faults));
  }
  if (controller == "distributed") {
    return hash_of<Real>(spec, seed, Pair<Distributed>({}, channel, seed, leader, faults));
  }
  const PerSide<double> drift{spec.robots[left].clock_drift, spec.robots[right].clock_drift};
  return hash_of<Real>(spec, seed,
                       Peers(Bounds::of(spec).times, drift, channel, seed, leader, faults));
}

}  // namespace

int main(int count, char** words) {
  Spec spec;
  if (count != 4 || std::fread(&spec, sizeof spec, 1, stdin) != 1) return 2;
  const std::uint64_t seed = std::strtoull(words[2], nullptr, 10);
  const std::uint64_t hash = std::string_view(words[3]) == "float"
                                 ? hash_named<float>(spec, seed, words[1])
                                 : hash_named<double>(spec, seed, words[1]);
  std::printf("%016" PRIx64 "\n", hash);
}
