// SPDX-License-Identifier: Apache-2.0
// Multilevel splitting against closed forms: the gambler's ruin, and a process of two coordinates
// whose height jumps over levels.
//
// multilevel_splitting_test [REPLICATES]   REPLICATES: of each estimate; 200 if not given
#include "palmbots/sim/multilevel_splitting.hpp"

#include <cmath>
#include <cstdlib>
#include <set>

#include "palmbots/sim/random_streams.hpp"
#include "support/check.hpp"

using namespace palmbots;

namespace {

// Goes up with probability p and down otherwise, from 1; the top is n, and at 0 it is over.
struct Ruin {
  double up;
  int top;
  std::uint64_t seed;
  int at = 1;
  std::uint32_t steps = 0;

  RunStatus step() {
    at += unit_uniform<double>(draw(seed, steps++, Stream::noise)[0]) < up ? 1 : -1;
    return at == 0 ? RunStatus::finished : (at == top ? RunStatus::hit : RunStatus::running);
  }
  double height() const { return at; }
  void fork(std::uint64_t other) { seed = other; }

  double chance() const {
    const double odds = (1 - up) / up;
    return (odds - 1) / (std::pow(odds, top) - 1);
  }
};

// Every step it leaps by 1, 2 or 3 or, with probability 0.7, falls for good; the top is 9 or more.
// What it has leapt last counts for nothing, but is kept: copies differ from each other.
struct Leaps {
  std::uint64_t seed;
  int at = 0;
  std::uint32_t steps = 0;

  RunStatus step() {
    const double u = unit_uniform<double>(draw(seed, steps++, Stream::noise)[0]);
    if (u < 0.7) return RunStatus::finished;
    at += 1 + static_cast<int>((u - 0.7) * 10);
    return at >= 9 ? RunStatus::hit : RunStatus::running;
  }
  double height() const { return at; }
  void fork(std::uint64_t other) { seed = other; }

  static double chance(int at) {
    if (at >= 9) return 1;
    return 0.1 * (chance(at + 1) + chance(at + 2) + chance(at + 3));
  }
};

std::uint32_t replicates = 200;

template <class Make>
void check_estimates(Make make, const std::vector<double>& levels, double chance, double scatter) {
  using Process = decltype(make(std::uint64_t{}));
  constexpr std::uint32_t effort = 200;
  Splitting<Process, Make> splitting(make, 7, effort);
  double sum = 0, squares = 0;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    double part = 1, estimate = 0;
    for (const Stage& stage : splitting.replicate(r, levels)) {
      estimate += part * stage.hits / effort;
      part *= double(stage.reached) / effort;
    }
    sum += estimate;
    squares += estimate * estimate;
  }
  const double mean = sum / replicates;
  const double error = std::sqrt((squares / replicates - mean * mean) / replicates);
  CHECK(std::abs(mean - chance) < 4 * error);
  CHECK(error < scatter * chance);  // or the line above says little
  CHECK(error > 0);
}

void test_estimate_is_unbiased_at_any_levels() {
  const auto ruin = [](std::uint64_t seed) { return Ruin{0.3, 16, seed}; };
  const double chance = ruin(0).chance();
  CHECK(chance < 2e-6);
  check_estimates(ruin, {3, 5, 7, 9, 11, 13}, chance, 0.06);
  check_estimates(ruin, {2.5, 9, 10, 15}, chance, 0.4);
  const auto easy = [](std::uint64_t seed) { return Ruin{0.45, 5, seed}; };
  check_estimates(easy, {}, easy(0).chance(), 0.02);
}

void test_leaps_over_levels_are_unbiased() {
  const auto leaps = [](std::uint64_t seed) { return Leaps{seed}; };
  check_estimates(leaps, {1, 2, 3, 4, 5, 6, 7, 8}, Leaps::chance(0), 0.05);
  check_estimates(leaps, {4}, Leaps::chance(0), 0.05);
}

void test_levels_are_reached_by_the_wanted_share() {
  const auto make = [](std::uint64_t seed) { return Ruin{0.4, 40, seed}; };
  Splitting<Ruin, decltype(make)> splitting(make, 3, 1000);
  const std::vector<double> levels = splitting.choose_levels(0.2);
  CHECK(levels.size() >= 5);
  Splitting<Ruin, decltype(make)> stopped(make, 3, 1000);
  CHECK(stopped.choose_levels(0.2, splitting.steps() / 2).empty());
  CHECK(stopped.steps() < splitting.steps());
  for (std::size_t i = 1; i < levels.size(); ++i) CHECK(levels[i] > levels[i - 1]);
  const auto stages = splitting.replicate(0, levels);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double share = stages[i].reached / 1000.0;
    CHECK(share > 0.1 && share < 0.5);  // heights are whole numbers: shares are not exact
  }
}

// Half of them end in the very step in which they come to the level, and can no longer hit: a resampling
// that continues one of those would see it hit at once. The others hit every fourth time.
struct Lapse {
  std::uint64_t seed;
  int at = 0;
  bool ended = false;

  RunStatus step() {
    CHECK(!ended);
    const double u =
        unit_uniform<double>(draw(seed, static_cast<std::uint32_t>(at), Stream::noise)[0]);
    if (at++ == 0) {
      ended = u < 0.5;
      return ended ? RunStatus::finished : RunStatus::running;
    }
    ended = true;
    return u < 0.25 ? RunStatus::hit : RunStatus::finished;
  }
  double height() const { return at; }
  void fork(std::uint64_t other) { seed = other; }
};

void test_finished_runs_are_not_resampled() {
  const auto make = [](std::uint64_t seed) { return Lapse{seed}; };
  check_estimates(make, {1}, 0.125, 0.05);
  Splitting<Lapse, decltype(make)> splitting(make, 3, 1000);
  CHECK(splitting.choose_levels(0.2).size() <= 1);
}

// Where there is no way up, levels end.
struct Flat {
  std::uint64_t seed;
  int steps = 0;

  RunStatus step() { return ++steps == 3 ? RunStatus::finished : RunStatus::running; }
  double height() const { return 0; }
  void fork(std::uint64_t other) {
    seed = other;
    steps = 0;
  }
};

void test_levels_rise_or_the_run_ends() {
  const auto make = [](std::uint64_t seed) { return Flat{seed}; };
  Splitting<Flat, decltype(make)> splitting(make, 3, 50);
  CHECK(splitting.choose_levels(0.2).size() <= 1);
}

// Every step is counted; and the pilot's runs are none of a replicate's, or levels would suit them.
void test_steps_are_counted_and_the_pilot_is_apart() {
  static std::set<std::uint64_t> begun;
  static std::uint64_t taken;
  struct Counted : Ruin {
    RunStatus step() {
      ++taken;
      return Ruin::step();
    }
  };
  const auto make = [](std::uint64_t seed) {
    begun.insert(seed);
    return Counted{{0.4, 12, seed}};
  };
  Splitting<Counted, decltype(make)> splitting(make, 3, 100);
  const std::vector<double> levels = splitting.choose_levels(0.3);
  CHECK(levels.size() >= 2 && begun.size() == 100);
  CHECK(splitting.steps() == taken && taken > 0);
  for (std::uint32_t r = 0; r < 20; ++r) splitting.replicate(r, levels);
  CHECK(begun.size() == 100 + 20 * 100);
  CHECK(splitting.steps() == taken);
}

void test_a_replicate_depends_on_its_number_alone() {
  const auto make = [](std::uint64_t seed) { return Ruin{0.4, 10, seed}; };
  Splitting<Ruin, decltype(make)> one(make, 3, 100), other(make, 3, 100);
  const std::vector<double> levels{3, 5, 8};
  one.replicate(0, levels);
  const auto a = one.replicate(5, levels), b = other.replicate(5, levels);
  const auto c = other.replicate(6, levels);
  bool differs = false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].reached == b[i].reached && a[i].hits == b[i].hits);
    differs = differs || a[i].reached != c[i].reached;
  }
  CHECK(differs);
}

// No two runs have one seed, whatever distinguishes them, and every parent has its share of them.
void test_branches() {
  constexpr std::size_t parents = 7;
  std::set<std::uint64_t> seeds;
  std::vector<int> chosen(parents);
  int runs = 0;
  for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 40}) {
    for (std::uint32_t replicate = 0; replicate < 5; ++replicate) {
      for (std::uint32_t stage = 0; stage < 5; ++stage) {
        for (std::uint32_t run = 0; run < 280; ++run, ++runs) {
          const ResampledRun resampled = ResampledRun::of(seed, replicate, stage, run, parents);
          seeds.insert(resampled.seed);
          CHECK(resampled.parent < parents);
          ++chosen[resampled.parent];
        }
      }
    }
  }
  CHECK(seeds.size() == static_cast<std::size_t>(runs));
  for (const int n : chosen) CHECK(std::abs(n - 3000) < 5 * 51);  // the deviation is 50.7
  // Of the other half of a seed's bits, too: no two in 2³² would be alike by chance.
  std::set<std::uint64_t> halves[2];
  for (const std::uint64_t seed : seeds) {
    halves[0].insert(seed >> 32);
    halves[1].insert(seed & 0xFFFFFFFF);
  }
  for (const auto& half : halves) CHECK(half.size() + 10 > seeds.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) replicates = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10));
  test_branches();
  test_estimate_is_unbiased_at_any_levels();
  test_leaps_over_levels_are_unbiased();
  test_finished_runs_are_not_resampled();
  test_levels_rise_or_the_run_ends();
  test_steps_are_counted_and_the_pilot_is_apart();
  test_levels_are_reached_by_the_wanted_share();
  test_a_replicate_depends_on_its_number_alone();
}
