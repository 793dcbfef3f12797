// SPDX-License-Identifier: Apache-2.0
// Value iteration for the opening problem: the least probability of a drop, and how to reach it.
//
// The state before a decision is (x, n, c). The controller chooses the commanded speed c' within
// the acceleration limit, then the noise moves to n', and the separation to x + (c' + bias + n') T:
//
//   V_k(x, n, c) = min over c' of W_k(x, n, c'),
//   W_k(x, n, c') = E over n' of V_{k−1}(x + (c' + bias + n') T, n', c'),   V = 1 outside, V_0 = 0.
//
// V_k(start) is the probability of a drop within k decisions. Its growth soon becomes a constant
// hazard; the iteration then stops and extrapolates. With a price the same decisions also count the
// expected progress Q, and minimize V − price · Q.
//
// Grids: x is read by cubic interpolation, so little is smeared from one decision to the next,
// although a decision moves x by less than a cell. n' is one of the nodes of n, with the weights of
// NoiseTransition. Everything uses + − × ÷ √ only: the decisions enter traces.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "palmbots/optimum/noise_transition.hpp"
#include "palmbots/optimum/opening_policy.hpp"
#include "palmbots/optimum/opening_problem.hpp"

namespace palmbots {

// How finely the state is divided.
struct OpeningGrid {
  std::size_t positions = 160;  // intervals of the separation
  std::size_t noises = 40;      // intervals of the noise, from −5 to 5 standard deviations
  double speeds = 1;            // intervals of the commanded speed for each change of a decision
};

namespace detail {

inline constexpr std::size_t most_speeds = 64;  // intervals, for `speeds` = 1

}  // namespace detail

// The values of the opening problem with more and more decisions to go.
class ValueIteration {
 public:
  ValueIteration(const OpeningProblem& problem, const OpeningGrid& grid)
      : problem_(problem),
        cells_(grid.positions),
        width_(grid.positions + 4),
        noise_(grid.noises, problem.memory),
        counts_progress_(problem.price > 0) {
    const double span = problem.fastest - problem.slowest;
    const double intervals = std::floor(span / problem.change + 1e-9);
    const double few = clamp(intervals, 2.0, double(detail::most_speeds));
    const auto speeds = static_cast<std::size_t>(larger(std::floor(few * grid.speeds), 2.0));
    for (std::size_t j = 0; j <= speeds; ++j) {
      speeds_.push_back(problem.slowest + span * double(j) / double(speeds));
    }
    for (std::size_t j = 0; j <= speeds; ++j) choices_.push_back(choices_at(j));
    for (const double speed : speeds_) {
      const double gain = problem_.progress(speed) * problem_.period;
      least_gain_ = smaller(least_gain_, gain);
      most_gain_ = larger(most_gain_, gain);
    }
    const std::size_t size = speeds_.size() * noise_.rows.size() * width_;
    drop_.resize(size);
    after_drop_.resize(size);
    shifted_.resize(noise_.rows.size() * width_);
    if (counts_progress_) {
      progress_.resize(size);
      after_progress_.resize(size);
    }
  }

  // One more decision to go. The bits are those of any processor: AVX2 itself fuses nothing.
  void step() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
    if (has_avx2) return step_wide();
#endif
    decide();
  }

  // The probability of a drop, and the expected progress until then [m], from the start: at rest,
  // with stationary noise.
  double drop() const { return from_start(drop_); }
  double progress() const { return counts_progress_ ? from_start(progress_) : 0; }

  // What each commanded speed of the last decision costs.
  OpeningPolicy policy() const {
    OpeningPolicy policy;
    policy.positions = {problem_.lowest, (problem_.highest - problem_.lowest) / double(cells_),
                        cells_ + 1};
    const double cell = noise_.deviations[1] - noise_.deviations[0];
    policy.noises = {-detail::most_deviations * problem_.noise, cell * problem_.noise,
                     noise_.rows.size()};
    policy.speeds = {speeds_[0], speeds_[1] - speeds_[0], speeds_.size()};
    double least = std::numeric_limits<double>::infinity();
    const auto each = [&](auto visit) {
      for (std::size_t row = 0; row < speeds_.size() * noise_.rows.size(); ++row) {
        for (std::size_t x = 0; x <= cells_; ++x) visit(cost_after(row * width_ + 1 + x));
      }
    };
    each([&](double cost) { least = smaller(least, cost); });
    each([&](double cost) { policy.costs.push_back(static_cast<float>(cost - least)); });
    return policy;
  }

 private:
  // A speed that can be commanded next: between two grid speeds, or one of them.
  struct Choice {
    std::size_t below;
    double above;  // weight of the next grid speed
  };

#if defined(__x86_64__) && defined(__GNUC__)
  [[gnu::target("avx2"), gnu::flatten]] void step_wide() { decide(); }
#endif

  void decide() {
    ++steps_;
    for (std::size_t j = 0; j < speeds_.size(); ++j) {
      move(j, drop_, after_drop_, 1, 0);
      if (counts_progress_) {
        const double gain = problem_.progress(speeds_[j]) * problem_.period;
        move(j, progress_, after_progress_, 0, gain);
      }
    }
    for (std::size_t j = 0; j < speeds_.size(); ++j) {
      for (std::size_t i = 0; i < noise_.rows.size(); ++i) choose(j, i);
    }
  }

  std::vector<Choice> choices_at(std::size_t j) const {
    std::vector<Choice> choices;
    const double cell = speeds_[1] - speeds_[0];
    const double reach = problem_.change / cell;  // in cells
    const double whole = std::floor(reach + 1e-9);
    const double rest = larger(reach - whole, 0.0);
    const double last = double(speeds_.size() - 1);
    const double low = larger(double(j) - whole, 0.0);
    const double high = smaller(double(j) + whole, last);
    for (double k = low; k <= high; k += 1) choices.push_back({static_cast<std::size_t>(k), 0});
    if (rest > 1e-9 && low > 0) choices.push_back({static_cast<std::size_t>(low - 1), 1 - rest});
    if (rest > 1e-9 && high < last) choices.push_back({static_cast<std::size_t>(high), rest});
    return choices;
  }

  // A row holds the values at all positions for one commanded speed and one noise, after one value
  // that is extrapolated, and before another one and a spare.
  std::size_t row(std::size_t j, std::size_t i) const {
    return (j * noise_.rows.size() + i) * width_;
  }

  double cost_after(std::size_t k) const {
    return counts_progress_ ? after_drop_[k] - problem_.price * after_progress_[k] : after_drop_[k];
  }

  // after = E over n' of the values where the commanded speed j leads; `outside` beyond the ends.
  void move(std::size_t j, std::vector<double>& values, std::vector<double>& after, double outside,
            double gain) {
    const double cell = (problem_.highest - problem_.lowest) / double(cells_);
    for (std::size_t i = 0; i < noise_.rows.size(); ++i) {
      const double speed = speeds_[j] + problem_.bias + problem_.noise * noise_.deviations[i];
      double* from = values.data() + row(j, i);
      extrapolate(from);
      shift(from, speed * problem_.period / cell, outside, gain, shifted_.data() + i * width_);
    }
    for (std::size_t i = 0; i < noise_.rows.size(); ++i) {
      double* to = after.data() + row(j, i);
      std::fill(to, to + width_, 0.0);
      const auto& weights = noise_.rows[i].weights;
      const double* from = shifted_.data() + noise_.rows[i].first * width_;
      std::size_t k = 0;
      for (; k + 8 <= weights.size(); k += 8) add<8>(&weights[k], from + k * width_, to);
      for (; k < weights.size(); ++k) add<1>(&weights[k], from + k * width_, to);
    }
  }

  // Adds `count` rows, each times its weight, one after the other.
  template <std::size_t count>
  void add(const double* weights, const double* __restrict from, double* __restrict to) const {
    std::array<double, count> w;
    std::copy_n(weights, count, w.begin());
    const std::size_t width = width_;
    for (std::size_t x = 0; x < width; ++x) {
      double sum = to[x];
      for (std::size_t k = 0; k < count; ++k) sum += w[k] * from[k * width + x];
      to[x] = sum;
    }
  }

  void extrapolate(double* v) const {
    v[0] = 4 * (v[1] + v[3]) - 6 * v[2] - v[4];
    double* end = v + cells_ + 1;
    end[1] = 4 * (end[0] + end[-2]) - 6 * end[-1] - end[-3];
    end[2] = 0;
  }

  // to(x) = from(x + by) + gain, or `outside`; `by` in cells.
  void shift(const double* from, double by, double outside, double gain, double* to) const {
    const double floored = std::floor(by);
    const auto w = detail::cubic_weights(by - floored);
    const auto whole = static_cast<std::ptrdiff_t>(floored);
    const auto last = static_cast<std::ptrdiff_t>(cells_);
    const bool is_whole = by == floored;
    const auto begin = std::clamp(-whole, std::ptrdiff_t{0}, last + 1);
    const auto end = std::clamp(last - whole + (is_whole ? 1 : 0), begin, last + 1);
    std::fill(to, to + width_, outside);
    const double* v = from + whole;
    double* out = to + 1;
    for (auto x = begin; x < end; ++x) {
      out[x] = gain + (w[0] * v[x] + w[1] * v[x + 1]) + (w[2] * v[x + 2] + w[3] * v[x + 3]);
    }
  }

  void choose(std::size_t j, std::size_t i) {
    const std::size_t to = row(j, i) + 1;
    bool is_first = true;
    for (const Choice& choice : choices_[j]) {
      const std::size_t from = row(choice.below, i) + 1;
      const std::size_t next = choice.above > 0 ? from + row(1, 0) : from;
      if (!counts_progress_) {
        choose(choice.above, after_drop_.data() + from, after_drop_.data() + next, is_first,
               drop_.data() + to);
      } else {
        choose(choice.above, after_drop_.data() + from, after_drop_.data() + next,
               after_progress_.data() + from, after_progress_.data() + next, is_first,
               drop_.data() + to, progress_.data() + to);
      }
      is_first = false;
    }
  }

  // Between a and b, u of the way; kept where it drops less than what is there.
  void choose(double u, const double* a, const double* b, bool is_first,
              double* __restrict drop) const {
    for (std::size_t x = 0; x <= cells_; ++x) {
      const double found = clamp((1 - u) * a[x] + u * b[x], 0.0, 1.0);
      drop[x] = is_first ? found : smaller(found, drop[x]);
    }
  }

  // The same with the progress between c and d.
  void choose(double u, const double* a, const double* b, const double* c, const double* d,
              bool is_first, double* __restrict drop, double* __restrict progress) const {
    const double lowest = least_gain_ * double(steps_);
    const double highest = most_gain_ * double(steps_);
    const double price = problem_.price;
    const std::size_t count = cells_ + 1;
    for (std::size_t x = 0; x < count; ++x) {
      const double found = clamp((1 - u) * a[x] + u * b[x], 0.0, 1.0);
      // Interpolation overshoots; what no decisions can reach is cut off, as for the drops.
      const double gained = clamp((1 - u) * c[x] + u * d[x], lowest, highest);
      const double kept = drop[x];
      const double had = progress[x];
      const bool is_better = is_first || (found - kept) - price * (gained - had) < 0;
      drop[x] = is_better ? found : kept;
      progress[x] = is_better ? gained : had;
    }
  }

  double from_start(const std::vector<double>& values) const {
    const double cell = (problem_.highest - problem_.lowest) / double(cells_);
    const double place = (problem_.start - problem_.lowest) / cell;
    const auto stencil = detail::CubicStencil::at(place, cells_);
    const double speed_cell = speeds_[1] - speeds_[0];
    const double at = clamp(-speeds_[0] / speed_cell, 0.0, double(speeds_.size() - 1));
    const auto below =
        static_cast<std::size_t>(smaller(std::floor(at), double(speeds_.size() - 2)));
    const double above = at - double(below);
    double sum = 0;
    for (std::size_t i = 0; i < noise_.rows.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t x = 1 + stencil.first + k;
        const double value =
            (1 - above) * values[row(below, i) + x] + above * values[row(below + 1, i) + x];
        sum += noise_.stationary[i] * stencil.weights[k] * value;
      }
    }
    return sum;
  }

  OpeningProblem problem_;
  std::size_t cells_;
  std::size_t width_;
  detail::NoiseTransition noise_;
  bool counts_progress_;
  std::size_t steps_ = 0;
  double least_gain_ = 0;  // progress of a decision, or none after a drop [m]
  double most_gain_ = 0;   // [m]
  std::vector<double> speeds_;
  std::vector<std::vector<Choice>> choices_;
  std::vector<double> drop_, after_drop_, progress_, after_progress_, shifted_;
};

// What value iteration found.
struct OpeningSolution {
  double drop = 0;            // probability in a carry
  double hazard = 0;          // probability of a drop per second, in the long run
  double speed = 0;           // of the midpoint in the long run [m/s]; 0: progress does not count
  double duration = 0;        // of the carry [s]
  std::size_t decisions = 0;  // after which the hazard was constant
  OpeningPolicy policy;
};

// Solves the opening problem. poll() is called before each decision; what it throws ends the work.
template <class Poll>
OpeningSolution solve(const OpeningProblem& problem, const OpeningGrid& grid, Poll&& poll) {
  constexpr double tolerance = 1e-5;    // of the hazard, relative, over a stretch
  constexpr double negligible = 1e-12;  // hazard of a decision
  ValueIteration values(problem, grid);
  const auto stretch = static_cast<std::size_t>(larger(std::ceil(0.5 / problem.period), 20.0));
  const auto all = static_cast<std::size_t>(larger(problem.duration / problem.period + 0.5, 1.0));
  OpeningSolution found;
  double before = -1;  // hazard a stretch ago
  double hazard = 0;
  double speed = 0;
  double drop = 0;
  double progress = 0;
  for (std::size_t k = 1; k <= all; ++k) {
    poll();
    values.step();
    const double next = values.drop();
    const double gone = values.progress();
    hazard = next < 1 ? larger((next - drop) / (1 - drop), 0.0) : 1;
    speed = next < 1 ? (gone - progress) / ((1 - next) * problem.period) : 0;
    drop = next;
    progress = gone;
    found.decisions = k;
    // At first no noise has had the time to drop the object.
    if (k % stretch != 0 || hazard <= negligible) continue;
    if (magnitude(hazard - before) <= tolerance * hazard) break;
    before = hazard;
  }
  found.hazard = hazard / problem.period;
  found.speed = speed;
  found.duration = speed > 0 ? problem.distance / speed : problem.duration;
  const double left_over = found.duration / problem.period - double(found.decisions);
  found.drop = 1 - (1 - drop) * std::pow(1 - hazard, left_over);
  found.policy = values.policy();
  return found;
}

}  // namespace palmbots
