// SPDX-License-Identifier: Apache-2.0
// Wilson's score interval of a rate: all rates p that differ from k / n, the observed one, by at most
// z standard deviations, |k / n − p| ≤ z √(p (1 − p) / n). The command line and the page share it.
#pragma once

#include <cmath>
#include <limits>

namespace palmbots {

// 97.5 % quantile of the normal distribution: an interval of this many standard deviations contains
// 95 %.
inline constexpr double z95 = 1.959963984540054;

struct RateInterval {
  double low;
  double high;
};

// The interval for k events in n trials; NaN where n is 0.
inline RateInterval wilson(double k, double n, double z = z95) {
  if (n == 0) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    return {unknown, unknown};
  }
  const double rate = k / n;
  const double spread = z * std::sqrt(rate * (1 - rate) / n + z * z / (4 * n * n));
  const double centre = rate + z * z / (2 * n);
  const double scale = 1 + z * z / n;
  return {k == 0 ? 0.0 : (centre - spread) / scale, k == n ? 1.0 : (centre + spread) / scale};
}

// The 95 % interval of a rate that reports print. It is Wilson's, except where none or all of n
// trials are events: then it is the exact one-sided bound. With a rate above 1 − 0.05^(1/n), the
// probability that none of n trials is an event is less than 5 %.
inline RateInterval rate_interval(double k, double n) {
  const double bound = 1 - std::pow(0.05, 1 / n);
  if (k == 0) return {0, bound};
  return k == n ? RateInterval{1 - bound, 1} : wilson(k, n);
}

}  // namespace palmbots
