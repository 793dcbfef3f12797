// SPDX-License-Identifier: Apache-2.0
// The filter of the reference `kalman`: its formulas against the error function and against sums
// over fine grids, and the whole of it against many simulated pairs with the same model.
#include "palmbots/optimum/sign_filter.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool near(double x, double y, double error) { return std::abs(x - y) <= error; }

void test_normal_share() {
  for (double x = -7; x <= 7; x += 0.0625) {
    CHECK(near(detail::normal_share(x), 0.5 * std::erfc(-x / std::sqrt(2.0)), 1e-13));
  }
  CHECK(detail::normal_share(infinity) == 1);
  CHECK(detail::normal_share(-infinity) == 0);
}

// Share, mean and variance of the part of a normal distribution in an interval, by sums over a
// grid. Weights are relative to the greatest one, so that a far tail has some, too.
void test_restricted(double m, double s, double from, double until) {
  const double high = std::min(until, std::max(from, m) + 12 * s);
  const double start = std::max(from, std::min(until, m) - 12 * s);
  constexpr int cells = 200'000;
  const double cell = (high - start) / cells;
  const double nearest = std::min(std::max(m, start), high);
  const double top = std::pow((nearest - m) / s, 2);
  double sum = 0;
  double first = 0;
  double second = 0;
  for (int i = 0; i < cells; ++i) {
    const double p = start + (i + 0.5) * cell;
    const double weight = std::exp(-0.5 * (std::pow((p - m) / s, 2) - top));
    sum += weight;
    first += weight * p;
    second += weight * p * p;
  }
  const double mean = first / sum;
  const double variance = second / sum - mean * mean;
  const auto found = detail::restricted(m, s, from, until);
  const double share = sum * cell / (s * std::sqrt(2 * 3.14159265358979)) * std::exp(-0.5 * top);
  CHECK(near(found.share, share, 1e-6));
  // The far tail is approximated.
  const bool is_far = share < 1e-8;
  CHECK(near(found.mean, mean, (is_far ? 0.02 : 1e-4) * s));
  CHECK(near(std::sqrt(found.variance), std::sqrt(variance), (is_far ? 0.05 : 1e-3) * s));
}

void test_restricted_to_intervals() {
  for (const double m : {-0.03, -0.004, 0.0, 0.002, 0.02}) {
    for (const double s : {0.002, 0.01}) {
      test_restricted(m, s, -0.005, 0.005);
      test_restricted(m, s, 0.005, infinity);
      test_restricted(m, s, -infinity, -0.005);
    }
  }
}

Spec spec_with_noise(double noise) {
  Spec spec = paper_spec();
  for (RobotSpec& robot : spec.robots) robot.noise = noise;
  return spec;
}

// A pair that follows the filter's model exactly, apart from what it linearizes.
struct Pair {
  std::array<double, 3> state;  // contacts of leader and follower [m], noise [m/s]
};

// Closing at a speed above the noise: the shallower palm's contact slides outward, and what is known
// of it is that of a linear model. Then the readings of both palms are taken in.
void test_against_simulated_pairs() {
  const Spec spec = spec_with_noise(0.01);
  SignFilter filter(spec);
  const std::size_t leader = leader_of(spec);
  const std::size_t follower = other(leader);
  PerSide<PalmAngle<double>> palms{};
  palms[leader] = PalmAngle<double>::at(0.1);
  palms[follower] = PalmAngle<double>::at(0.3);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const double sd = std::sqrt(2.0) * 0.01;
  const double memory = std::exp(-spec.period / spec.robots[0].noise_tau);
  std::vector<Pair> pairs(400'000);
  for (Pair& one : pairs)
    one.state = {1e-3 * normal(random), 1e-3 * normal(random), sd * normal(random)};
  const auto compare = [&](double error_m) {
    std::array<double, 3> mean{};
    for (const Pair& one : pairs) {
      for (std::size_t i = 0; i < 3; ++i) mean[i] += one.state[i] / double(pairs.size());
    }
    CHECK(near(filter.contact(leader), mean[0], error_m));
    CHECK(near(filter.contact(follower), mean[1], error_m));
    CHECK(near(filter.error(), memory * mean[2], 1e-3));
  };
  constexpr double commanded = -0.06;
  for (int tick = 0; tick < 12; ++tick) {
    filter.predict(commanded, palms);
    for (Pair& one : pairs) {
      one.state[2] = memory * one.state[2] + sd * std::sqrt(1 - memory * memory) * normal(random);
      const double change = (commanded + one.state[2]) * spec.period;
      one.state[change < 0 ? 0 : 1] -=
          change / (change < 0 ? palms[leader].cos : palms[follower].cos);
    }
  }
  compare(1e-4);
  // The leader's contact has passed the zone's edge, the follower's has not.
  const auto keep = [&](auto condition) {
    std::vector<Pair> kept;
    for (const Pair& one : pairs) {
      if (condition(one)) kept.push_back(one);
    }
    pairs = kept;
  };
  filter.update(leader, Sign::positive);
  keep([](const Pair& one) { return one.state[0] > 0.005; });
  CHECK(pairs.size() > 10'000);
  compare(2e-4);
  filter.update(follower, Sign::zero);
  keep([](const Pair& one) { return std::abs(one.state[1]) <= 0.005; });
  compare(2e-4);
  CHECK(filter.error() < -1e-4);  // an early passage means that the noise closes
}

// With the other robot in front, the same readings give the same numbers on the other side.
void test_mirrored() {
  Spec spec = spec_with_noise(0.03);
  Spec mirrored = spec;
  mirrored.direction = -spec.direction;
  SignFilter one(spec);
  SignFilter two(mirrored);
  const std::size_t leader = leader_of(spec);
  CHECK(leader_of(mirrored) == other(leader));
  PerSide<PalmAngle<double>> palms{};
  PerSide<PalmAngle<double>> swapped{};
  for (int tick = 0; tick < 300; ++tick) {
    const double angle = 0.1 + 0.0005 * tick;
    palms[leader] = swapped[other(leader)] = PalmAngle<double>::at(angle);
    palms[other(leader)] = swapped[leader] = PalmAngle<double>::at(0.25 - angle / 2);
    const double speed = tick % 90 < 45 ? 0.04 : -0.05;
    one.predict(speed, palms);
    two.predict(speed, swapped);
    const Sign sign = static_cast<Sign>(tick / 40 % 3 - 1);
    const Sign second = tick % 70 < 60 ? Sign::zero : Sign::negative;
    one.update(leader, sign);
    one.update(other(leader), second);
    two.update(other(leader), sign);
    two.update(leader, second);
    CHECK(one.contact(leader) == two.contact(other(leader)));
    CHECK(one.contact(other(leader)) == two.contact(leader));
    CHECK(one.error() == two.error());
    CHECK(std::abs(one.contact(leader)) < 0.2);
  }
}

// A switch that often errs moves the estimate less.
void test_doubt() {
  Spec spec = spec_with_noise(0.02);
  SignFilter sure(spec);
  spec.false_rate = 0.2;
  SignFilter unsure(spec);
  sure.update(left, Sign::positive);
  unsure.update(left, Sign::positive);
  CHECK(sure.contact(left) > 0.004);
  CHECK(unsure.contact(left) < 0.001);
  unsure.update(left, Sign::zero);
  CHECK(std::abs(unsure.contact(left)) < 1e-4);
}

}  // namespace

int main() {
  test_normal_share();
  test_restricted_to_intervals();
  test_against_simulated_pairs();
  test_mirrored();
  test_doubt();
}
