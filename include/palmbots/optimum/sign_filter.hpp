// SPDX-License-Identifier: Apache-2.0
// A Kalman filter on the tactile signs of both palms.
//
// Its state is normally distributed: both contact coordinates p [m] and the noise n of the opening
// speed [m/s]. With the known opening speed c, the separation changes by d = (c + n) T in a control
// period T. Closing (d < 0) moves the contact on the shallower palm outward, and opening that on
// the steeper palm inward, by |d| / cos θ. Where d may have either sign, max(d, 0) is replaced by
// the linear function of d with the same mean and covariance, plus an independent rest that moves
// the contacts in opposite directions.
//
// A sign states an interval in which p lies. The update gives the state the mean and covariance of
// the normal distribution restricted to that interval.
//
// The leading robot comes first in all vectors, so that a mirrored carry gets mirrored numbers.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "palmbots/base/scalar.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/robot/tactile_sensor.hpp"
#include "palmbots/sim/build.hpp"

namespace palmbots {

namespace detail {

// Density of the standard normal distribution.
inline double normal_density(double x) {
  constexpr double scale = 0.39894228040143267794;
  return scale * exp_minus(0.5 * x * x);
}

// The probability that a standard normal number is at most x. Error below 1e-14.
inline double normal_share(double x) {
  if (x > 8) return 1;
  if (x < -8) return 0;
  // Φ(x) − 1/2 = φ(x) (x + x³/3 + x⁵/15 + …)
  double term = x;
  double sum = x;
  for (int n = 3; magnitude(term) > 1e-16; n += 2) {
    term *= x * x / n;
    sum += term;
  }
  return 0.5 + normal_density(x) * sum;
}

// A normal distribution restricted to an interval: its probability, mean and variance.
struct Restricted {
  double share;
  double mean;
  double variance;
};

// Mean m, standard deviation s; either end of the interval may be infinite.
inline Restricted restricted(double m, double s, double from, double until) {
  const double a = (from - m) / s;
  const double b = (until - m) / s;
  const double share = normal_share(b) - normal_share(a);
  constexpr double least = 1e-9;
  if (share < least) {  // far in a tail, where the density falls like an exponential function
    const double out = a > 0 ? larger(a, 1.0) : larger(-b, 1.0);
    const double edge = a > 0 ? from + s / out : until - s / out;
    return {share, edge, s * s / (out * out)};
  }
  const auto at = [](double x) { return magnitude(x) > 30 ? 0.0 : normal_density(x); };
  const auto moment = [&](double x) { return magnitude(x) > 30 ? 0.0 : x * at(x); };
  const double shift = (at(a) - at(b)) / share;
  const double variance = 1 + (moment(a) - moment(b)) / share - shift * shift;
  return {share, m + s * shift, s * s * larger(variance, 1e-6)};
}

}  // namespace detail

class SignFilter {
 public:
  // Before the first reading: at the pivots, within about a millimetre; noise as at any time.
  explicit SignFilter(const Spec& spec) : leader_(leader_of(spec)), period_(spec.period) {
    const RobotSpec& ahead = spec.robots[leader_];
    const RobotSpec& behind = spec.robots[other(leader_)];
    bias_ = ahead.bias - behind.bias;
    const double variance = ahead.noise * ahead.noise + behind.noise * behind.noise;
    const double tau = ahead.noise > 0 ? ahead.noise_tau : behind.noise_tau;
    memory_ = memory_of<double>(period_, tau);
    drive_ = variance * (1 - memory_ * memory_);
    for (std::size_t i = 0; i < 2; ++i) cov_[i][i] = start * start;
    cov_[2][2] = variance;
    false_rate_ = spec.false_rate;
    intervals(spec);
    mean_ = {spec.start[leader_], spec.start[other(leader_)], 0};
  }

  double contact(std::size_t side) const { return mean_[rank(side)]; }
  // Expected difference between the opening speed and the commanded one, in the next tick [m/s].
  double error() const { return memory_ * mean_[2] + bias_; }

  // A tick has passed with this commanded opening speed, and with these palms at its end.
  template <class Real>
  void predict(double commanded, const PerSide<PalmAngle<Real>>& palms) {
    const PerSide<double> angle{double(palms[leader_].angle), double(palms[other(leader_)].angle)};
    const PerSide<double> cosine{double(palms[leader_].cos), double(palms[other(leader_)].cos)};
    if (!has_palms_) cosine_ = cosine;
    has_palms_ = true;
    mean_[2] *= memory_;
    for (std::size_t i = 0; i < 2; ++i) cov_[i][2] = cov_[2][i] = memory_ * cov_[i][2];
    cov_[2][2] = memory_ * memory_ * cov_[2][2] + drive_;
    turn(angle, cosine);
    slide(commanded + bias_ + mean_[2], angle);
    for (std::size_t i = 0; i < 2; ++i) cov_[i][i] += wander * wander * period_;
  }

  // A reading of the palm on this side.
  void update(std::size_t side, Sign reading) {
    const std::size_t i = rank(side);
    const double variance = cov_[i][i];
    const Interval& at = intervals_[static_cast<std::size_t>(static_cast<int>(reading) + 1)];
    if (!(at.from < at.until)) return;  // no contact gives this reading
    auto found = detail::restricted(mean_[i], std::sqrt(variance), at.from, at.until);
    if (false_rate_ > 0) found = doubted(found, mean_[i], variance);
    const double shift = (found.mean - mean_[i]) / variance;
    const double shrink = (found.variance - variance) / (variance * variance);
    const std::array<double, 3> column{cov_[0][i], cov_[1][i], cov_[2][i]};
    for (std::size_t r = 0; r < 3; ++r) {
      mean_[r] += column[r] * shift;
      for (std::size_t c = 0; c < 3; ++c) cov_[r][c] += column[r] * column[c] * shrink;
    }
  }

 private:
  struct Interval {
    double from;
    double until;
  };
  static constexpr double start = 1e-3;   // uncertainty of a contact at the start [m]
  static constexpr double wander = 1e-3;  // what the model neglects [m/√s]

  std::size_t rank(std::size_t side) const { return side == leader_ ? 0 : 1; }

  // For each reading, the part of the palm in which the sensor can give it.
  void intervals(const Spec& spec) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (Interval& one : intervals_) one = {infinity, -infinity};
    const auto sensor = tactile_of<double>(spec);
    const double half = 0.5 * larger(spec.palms[left].length, spec.palms[right].length);
    for (double p = -half; p <= half;) {
      const auto stretch = sensor.stretch(p);
      Interval& one = intervals_[static_cast<std::size_t>(static_cast<int>(stretch.sign) + 1)];
      one.from = smaller(one.from, p == -half ? -infinity : stretch.from);
      one.until = larger(one.until, stretch.until > half ? infinity : stretch.until);
      p = stretch.until;
    }
  }

  // A palm that turns about its pivot shifts a contact that is off the pivot.
  void turn(const PerSide<double>& angle, const PerSide<double>& cosine) {
    double change = 0;
    for (std::size_t i = 0; i < 2; ++i) change += mean_[i] * (cosine[i] - cosine_[i]);
    cosine_ = cosine;
    if (change == 0) return;
    const std::size_t steeper = angle[0] > angle[1] ? 0 : 1;
    const std::size_t slides = change > 0 ? steeper : 1 - steeper;
    mean_[slides] -= change / cosine[slides];
  }

  // The contacts slide at an opening speed whose mean is given [m/s].
  void slide(double speed, const PerSide<double>& angle) {
    const double spread = std::sqrt(cov_[2][2]);
    const bool parallel = magnitude(angle[0] - angle[1]) < 1e-9;
    const std::size_t steeper = angle[0] > angle[1] ? 0 : 1;
    double opens = 0.5;                  // how much of the motion moves the steeper palm's contact
    double opening = 0.5 * speed;        // mean of that part [m/s]
    double rest = 0.25 * speed * speed;  // variance of what the linear function leaves [m²/s²]
    if (!parallel && spread > 0) {
      const double r = speed / spread;
      const double density = magnitude(r) > 30 ? 0 : detail::normal_density(r);
      opens = detail::normal_share(r);
      opening = speed * opens + spread * density;
      const double square = (speed * speed + spread * spread) * opens + speed * spread * density;
      rest = larger(square - opening * opening - opens * opens * spread * spread, 0.0);
    } else if (!parallel) {
      opens = speed > 0 ? 1 : 0;
      opening = speed > 0 ? speed : 0;
      rest = 0;
    }
    std::array<double, 2> share{};
    std::array<double, 2> moves{};
    share[steeper] = -opens * period_ / cosine_[steeper];
    share[1 - steeper] = -(1 - opens) * period_ / cosine_[1 - steeper];
    moves[steeper] = -opening * period_ / cosine_[steeper];
    moves[1 - steeper] = -(speed - opening) * period_ / cosine_[1 - steeper];
    // p ← p + share · n: the noise is the only part of the speed that is uncertain.
    const std::array<double, 3> with{cov_[0][2], cov_[1][2], cov_[2][2]};
    for (std::size_t i = 0; i < 2; ++i) {
      mean_[i] += moves[i];
      for (std::size_t j = 0; j < 2; ++j) {
        cov_[i][j] += share[i] * with[j] + share[j] * with[i] + share[i] * share[j] * with[2];
      }
    }
    for (std::size_t i = 0; i < 2; ++i) cov_[i][2] = cov_[2][i] = with[i] + share[i] * with[2];
    const double apart = rest * period_ * period_;
    cov_[0][0] += apart;
    cov_[1][1] += apart;
    cov_[0][1] -= apart;
    cov_[1][0] -= apart;
  }

  // A reading that may be false: one of the two wrong signs, each with half of the rate.
  detail::Restricted doubted(const detail::Restricted& found, double mean, double variance) const {
    const double inside = (1 - false_rate_) * found.share;
    const double outside = 0.5 * false_rate_ * (1 - found.share);
    const double weight = inside / (inside + outside);
    const double rest = larger(1 - found.share, 1e-12);
    const double other_mean = (mean - found.share * found.mean) / rest;
    const double square =
        (variance + mean * mean - found.share * (found.variance + found.mean * found.mean)) / rest;
    const double mixed = weight * found.mean + (1 - weight) * other_mean;
    const double second =
        weight * (found.variance + found.mean * found.mean) + (1 - weight) * square;
    return {found.share, mixed, larger(second - mixed * mixed, 1e-6 * variance)};
  }

  std::size_t leader_;
  double period_;
  double bias_ = 0;    // of the opening speed [m/s]
  double memory_ = 0;  // e^(−T/τ)
  double drive_ = 0;   // variance that the noise gains in a tick [m²/s²]
  double false_rate_ = 0;
  std::array<Interval, 3> intervals_{};
  bool has_palms_ = false;
  PerSide<double> cosine_{1, 1};
  std::array<double, 3> mean_{};
  std::array<std::array<double, 3>, 3> cov_{};
};

}  // namespace palmbots
