// SPDX-License-Identifier: Apache-2.0
// Multilevel splitting with fixed effort: estimates the probability of a rare event.
//
// A process that rarely reaches the top must first get half-way. Runs that do so are copied, and
// the copies continue with random numbers of their own. With N runs in every stage, of which r_k
// reach the next level and d_k hit the top before they do,
//
//     P = Σ_k (r_0 / N) ⋯ (r_{k−1} / N) · d_k / N
//
// is an unbiased estimate of the probability to hit the top. The levels affect only its variance.
// Sources: Garvels, "The splitting method in rare event simulation" (2000), section 2.2; Botev and
// Kroese, "Efficient Monte Carlo simulation via the generalized splitting method" (2012), section
// 3.
//
// A Process is a value with
//
//     RunStatus step()     one step; `finished` when it can no longer hit
//     double height()      how near to the top it is
//     void fork(seed)      continues with the random numbers of this seed
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "palmbots/base/philox.hpp"

namespace palmbots {

// Whether a process is still running, and whether it hit the top.
enum class RunStatus : std::uint8_t { running, finished, hit };

// The results of the runs of one stage.
struct Stage {
  std::uint32_t reached = 0;  // the next level
  std::uint32_t hits = 0;     // of the top, without reaching the next level first
};

// The seed of a run, and the number of its parent among `parents` many.
struct ResampledRun {
  std::uint64_t seed;
  std::size_t parent;

  static constexpr ResampledRun of(std::uint64_t seed, std::uint32_t replicate, std::uint32_t stage,
                                   std::uint32_t run, std::size_t parents) {
    const Words words = philox({run, stage, replicate, 0x53504C54}, seed);  // "SPLT"
    const std::uint64_t share = std::uint64_t{words[2]} * parents;
    return {std::uint64_t{words[0]} << 32 | words[1], static_cast<std::size_t>(share >> 32)};
  }
};

// make(seed) returns a process at its start.
template <class Process, class Make>
class Splitting {
 public:
  Splitting(Make make, std::uint64_t seed, std::uint32_t effort)
      : make_(std::move(make)), seed_(seed), effort_(effort) {}

  // One estimate. Replicates are independent of each other.
  std::vector<Stage> replicate(std::uint32_t number, const std::vector<double>& levels) {
    std::vector<Stage> stages(levels.size() + 1);
    std::vector<Process> parents;
    for (std::uint32_t k = 0; k < stages.size(); ++k) {
      const double level = k < levels.size() ? levels[k] : never;
      parents = run(number, k, parents, level, stages[k], nullptr);
      if (parents.empty()) break;
    }
    return stages;
  }

  // Chooses the levels such that each is reached by about `share` of the runs from the level
  // before. Returns no levels if that takes more steps than `most`, which is checked only between
  // levels.
  std::vector<double> choose_levels(double share, std::uint64_t most = ~std::uint64_t{0}) {
    std::vector<double> levels;
    std::vector<Process> parents;
    double last = -never;
    for (std::uint32_t k = 0; k < most_levels; ++k) {
      if (steps_ > most) return {};
      std::vector<double> tops;
      Stage stage;
      run(pilot, k, parents, never, stage, &tops);
      std::sort(tops.begin(), tops.end(), std::greater<>());
      const double level = tops[static_cast<std::size_t>(share * effort_)];
      if (!(level < never) || !(level > last)) break;  // the top itself, or unreachable
      stage = {};
      parents = run(pilot, k, parents, level, stage, nullptr);
      if (parents.empty()) break;  // every run that reached the level ended with that step
      last = level;
      levels.push_back(level);
    }
    return levels;
  }

  std::uint64_t steps() const { return steps_; }

 private:
  static constexpr double never = std::numeric_limits<double>::infinity();
  static constexpr std::uint32_t pilot = ~0U;  // the replicate that chooses the levels
  static constexpr std::uint32_t most_levels = 64;

  // Runs all processes of a stage. Returns those that reached the level; `tops` gets the greatest
  // height of each run.
  std::vector<Process> run(std::uint32_t number, std::uint32_t k,
                           const std::vector<Process>& parents, double level, Stage& stage,
                           std::vector<double>* tops) {
    std::vector<Process> reached;
    for (std::uint32_t i = 0; i < effort_; ++i) {
      const ResampledRun resampled = ResampledRun::of(seed_, number, k, i, parents.size());
      Process process = k == 0 ? make_(resampled.seed) : parents[resampled.parent];
      if (k > 0) process.fork(resampled.seed);
      double top = process.height();
      RunStatus status = RunStatus::running;
      while (status == RunStatus::running && !(top >= level)) {
        status = process.step();
        ++steps_;
        top = std::max(top, status == RunStatus::hit ? never : process.height());
      }
      if (status == RunStatus::hit) {
        ++stage.hits;
      } else if (top >= level && status == RunStatus::running) {  // the run can go on
        ++stage.reached;
        reached.push_back(std::move(process));
      }
      if (tops != nullptr) tops->push_back(top);
    }
    return reached;
  }

  Make make_;
  std::uint64_t seed_;
  std::uint32_t effort_;
  std::uint64_t steps_ = 0;
};

}  // namespace palmbots
