// SPDX-License-Identifier: Apache-2.0
// Wheels: limits of acceleration and speed, calibration error, noise with its closed forms.
// Wrist: the way to an angle at a finite rate, and an exact end. Both together: the push of their
// acceleration.
#include "palmbots/robot/actuators.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "palmbots/base/philox.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "support/check.hpp"

using palmbots::draw;
using palmbots::Palm;
using palmbots::SpeedErrors;
using palmbots::Stream;
using palmbots::unit_noise;
using palmbots::Wheels;
using palmbots::Wrist;

namespace {

template <class Real>
void test_acceleration_and_speed_limit() {
  Wheels<Real> wheels{Real(0.005), Real(0.1), Real(0), Real(0), Real(0)};
  Real before = Real(0);
  int ticks = 0;
  while (wheels.speed != Real(0.06)) {
    const Real now = wheels.step(Real(0.06), Real(0));
    CHECK(now == wheels.speed && now > before && now <= Real(0.06));
    CHECK(now - before <= Real(0.005) * (1 + 8 * std::numeric_limits<Real>::epsilon()));
    before = now;
    ++ticks;
  }
  CHECK(ticks == 12 || ticks == 13);  // 0.06 / 0.005, one more where the sum is rounded down
  for (int i = 0; i < 100; ++i) wheels.step(wheels.within_limit(Real(9)), Real(0));
  CHECK(wheels.speed == Real(0.1));
  for (int i = 0; i < 39; ++i) wheels.step(wheels.within_limit(Real(-9)), Real(0));
  CHECK(wheels.speed > Real(-0.1));
  for (int i = 0; i < 3; ++i) wheels.step(wheels.within_limit(Real(-9)), Real(0));
  CHECK(wheels.speed == Real(-0.1));
}

// The limits do not apply to the calibration error, which the robot does not know.
void test_calibration_error_is_not_limited() {
  Wheels<double> wheels{1.0, 0.2, 0.013, 0.0, 0.0};
  CHECK(wheels.step(0.06, 0) == 0.06 + 0.013);
  CHECK(wheels.step(0.2, 0) == 0.2 + 0.013);
  CHECK(wheels.step(wheels.within_limit(9.0), 0) == 0.2 + 0.013);
}

// dn = −n dt/τ + σ √(2/τ) dW sampled every T: stationary spread σ, correlation e^(−kT/τ) at lag k.
void test_noise_against_closed_forms() {
  constexpr double sigma = 0.01;
  constexpr double memory = 0.9;
  Wheels<double> wheels{1.0, 1.0, 0.0, memory, sigma * std::sqrt(1 - memory * memory)};
  constexpr int n = 400000;
  std::vector<double> x;
  x.reserve(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto w = draw(11, i, Stream::noise);
    x.push_back(wheels.step(0, unit_noise<double>(w[0])));
  }
  const auto moment = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = lag; i < x.size(); ++i) sum += x[i] * x[i - lag];
    return sum / double(x.size() - lag) / (sigma * sigma);
  };
  // The variance of the estimate of the variance is 2 (1 + m²) / (1 − m²) / n: five of them.
  const double margin = 5 * std::sqrt(2 * (1 + memory * memory) / (1 - memory * memory) / n);
  for (const std::size_t lag : {0UL, 1UL, 5UL, 20UL}) {
    CHECK(std::abs(moment(lag) - std::pow(memory, double(lag))) < margin);
  }
}

// From one angle to the other in ⌈way / gain⌉ ticks, each of them `gain` but the last, and there.
template <class Real>
void test_wrist() {
  const Real degree = palmbots::radians_per_degree<Real>;
  for (const Real rate : {Real(10), Real(50), Real(70), Real(333), Real(2000)}) {
    const Wrist<Real> wrist{Real(15) * degree, Real(5) * degree, rate * degree * Real(0.01)};
    for (const Palm to : {Palm::shallow, Palm::steep}) {
      Real angle = wrist.target(to == Palm::shallow ? Palm::steep : Palm::shallow);
      const Real sense = to == Palm::shallow ? Real(-1) : Real(1);
      int ticks = 0;
      while (angle != wrist.target(to)) {
        const Real next = wrist.step(angle, wrist.target(to));
        const Real turn = sense * (next - angle);
        CHECK(turn > 0);
        CHECK(turn <= wrist.gain * Real(1.002));  // the last one may be longer by rounding
        angle = next;
        ++ticks;
        CHECK(ticks < 1000);
      }
      CHECK(ticks == int(std::ceil(double(Real(10) / (rate * Real(0.01))) - 1e-5)));
      CHECK(wrist.step(angle, wrist.target(to)) == angle);
    }
  }
}

// Called back on the way, it turns round at once.
void test_wrist_turns_round() {
  const Wrist<double> wrist{0.3, 0.1, 0.05};
  const double a = wrist.step(0.3, wrist.target(Palm::shallow));
  const double b = wrist.step(a, wrist.target(Palm::shallow));
  CHECK(std::abs(b - 0.2) < 1e-15);
  CHECK(std::abs(wrist.step(b, wrist.target(Palm::steep)) - 0.25) < 1e-15);
}

using palmbots::actuate;
using palmbots::Actuation;
using palmbots::left;
using palmbots::PalmAngle;
using palmbots::right;
using palmbots::Robots;
using palmbots::robots_of;
using palmbots::Spec;

// Two robots that stand, without noise.
template <class Real>
Robots<Real> standing(double period, double lag) {
  Spec spec;
  spec.period = period;
  spec.inertia_lag = lag;
  for (auto& robot : spec.robots) robot.noise = 0;
  for (auto& palm : spec.palms) palm.rate = 1;
  return robots_of<Real>(spec, 0);
}

template <class Real>
Real push_of(Robots<Real>& robots) {
  const palmbots::PerSide<PalmAngle<Real>> palms{PalmAngle<Real>::at(0), PalmAngle<Real>::at(0)};
  return actuate(robots, palms, {Real(0), Real(0)}).push;
}

// While one robot accelerates with a, the pair does with a/2: a lag that starts from nothing has
// come to 1 − e^(−t/τ) of that, whatever the period, and fades likewise when the robot drives
// evenly.
template <class Real>
void test_push_of_a_steady_acceleration() {
  constexpr double whole = 0.5 / 2 / palmbots::standard_gravity;
  const double exact = 64 * double(std::numeric_limits<Real>::epsilon());
  for (const double period : {0.02, 0.01, 0.0025}) {
    Robots<Real> robots = standing<Real>(period, 0.05);
    robots.goal_speed[left] = Real(0.2);
    const int rising = int(std::lround(0.2 / 0.5 / period));
    double push = 0;
    for (int k = 1; k <= rising; ++k) {
      push = double(push_of(robots));
      CHECK(std::abs(push / whole + std::expm1(-k * period / 0.05)) < exact / period);
    }
    // A last rest of acceleration, by rounding.
    if (robots.wheels[left].speed != Real(0.2)) push = double(push_of(robots));
    for (int k = 1; k <= int(0.2 / period); ++k) {
      const double fading = double(push_of(robots));
      CHECK(std::abs(fading / push - std::exp(-k * period / 0.05)) < exact / period);
    }
    // In the end it is gone altogether: only so a symmetric object stays symmetric.
    for (int k = 0; k < int(0.6 / period); ++k) push = double(push_of(robots));
    CHECK(push == 0);
  }
}

// The brakes hold a robot that stands. Of its noise the stated part is left, of its bias nothing.
void test_a_robot_that_stands() {
  Spec spec;
  for (const double left_over : {0.0, 0.01, 0.04, 0.5}) {
    for (auto& robot : spec.robots) {
      robot.noise = 0.04;
      robot.standing_noise = left_over;
    }
    Robots<double> robots = robots_of<double>(spec, 3);
    for (auto& wheels : robots.wheels) wheels.bias = 0.02;
    robots.held_at = {robots.braked, robots.released};
    const palmbots::PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(0),
                                                     PalmAngle<double>::at(0)};
    for (int k = 0; k < 9; ++k) {
      actuate(robots, palms, {0.3, 0.3});
      const auto noise = [&](std::size_t side) { return robots.wheels[side].noise; };
      CHECK(std::abs(robots.speeds[left] - std::min(left_over / 0.04, 1.0) * noise(left)) < 1e-15);
      CHECK(!std::signbit(robots.speeds[left]) || left_over > 0);
      CHECK(std::abs(robots.speeds[right] - (noise(right) + 0.02)) < 1e-15);
    }
  }
}

// With a gain, a robot does exactly so many times what it would do without: while it speeds up, at its
// speed, and beyond the limit of the commanded speed. A gain that is a power of two keeps all bits.
template <class Real>
void test_gain_multiplies_the_motion() {
  Spec spec;
  spec.robots[left].gain = 2;
  spec.robots[right].gain = 0.5;
  for (auto& robot : spec.robots) robot.noise = 0;
  Robots<Real> robots = robots_of<Real>(spec, 3);
  Spec usual = spec;
  for (auto& robot : usual.robots) robot.gain = 1;
  Robots<Real> others = robots_of<Real>(usual, 3);
  const palmbots::PerSide<PalmAngle<Real>> palms{PalmAngle<Real>::at(Real(0)),
                                                 PalmAngle<Real>::at(Real(0))};
  for (int k = 0; k < 120; ++k) {
    for (const std::size_t side : {left, right}) {
      const Wheels<Real>& wheels = robots.wheels[side];
      const Real wanted = k < 60 ? Real(9) : Real(-0.01);
      robots.goal_speed[side] = wheels.gain * wheels.within_limit(wanted);
      others.goal_speed[side] = others.wheels[side].within_limit(wanted);
    }
    actuate(robots, palms, {Real(0), Real(0)});
    actuate(others, palms, {Real(0), Real(0)});
    CHECK(robots.speeds[left] == 2 * others.speeds[left]);
    CHECK(robots.speeds[right] == Real(0.5) * others.speeds[right]);
  }
  CHECK(others.speeds[left] == Real(-0.01));
}

// The gain of a carry has the mean and the spread of its keys, is that of the leading robot on either
// side, and is independent of the partner's.
void test_gains_of_many_carries() {
  Spec spec;
  spec.robots[left].gain = 0.9;
  for (auto& robot : spec.robots) robot.gain_sd = 0.1;
  Spec mirrored = spec;
  mirrored.direction = -1;
  constexpr int count = 40000;
  double sum = 0, squares = 0, products = 0, least = 1;
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const double one = SpeedErrors::gain(spec, seed, left) - 0.9;
    const double other = SpeedErrors::gain(spec, seed, right) - 1;
    CHECK(std::abs(SpeedErrors::gain(mirrored, seed, left) - 0.9 - other) < 1e-15);
    sum += one;
    squares += one * one;
    products += one * other;
    least = std::min(least, 0.5 + other);
  }
  CHECK(std::abs(sum / count) < 4 * 0.1 / std::sqrt(count));
  CHECK(std::abs(squares / count - 0.01) < 4 * 0.01 * std::sqrt(2.0 / count));
  CHECK(std::abs(products / count) < 4 * 0.01 / std::sqrt(count));
  CHECK(least > 0);  // the least gain and the greatest spread that keys allow
}

// The white part displaces a robot by q √t, whatever the control period, and differs between robots
// and between ticks.
void test_white_noise_displaces_by_the_root_of_time() {
  for (const double period : {0.01, 0.0025}) {
    Spec spec;
    spec.period = period;
    spec.robots[left].white_noise = 0.02;
    const auto ticks = static_cast<std::uint32_t>(2 / period);
    constexpr int count = 2000;
    double squares = 0, neighbours = 0;
    for (std::uint64_t seed = 0; seed < count; ++seed) {
      double way = 0, before = 0;
      for (std::uint32_t tick = 0; tick < ticks; ++tick) {
        const auto speeds = SpeedErrors::white(spec, seed, tick);
        CHECK(speeds[right] == 0);
        way += speeds[left] * period;
        neighbours += speeds[left] * before * period * period;
        before = speeds[left];
      }
      squares += way * way;
    }
    const double expected = 0.02 * 0.02 * 2;
    CHECK(std::abs(squares / count / expected - 1) < 4 * std::sqrt(2.0 / count));
    CHECK(std::abs(neighbours / count / expected) < 4 / std::sqrt(double(count) * ticks));
  }
}

// Brakes hold only wheels that have come to rest. On the way back, the remaining noise has the other
// sign.
void test_brakes_and_the_sense_of_travel() {
  Spec spec;
  for (auto& robot : spec.robots) {
    robot.noise = 0.04;
    robot.standing_noise = 0.02;
  }
  const palmbots::PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(0),
                                                   PalmAngle<double>::at(0)};
  Robots<double> robots = robots_of<double>(spec, 3);
  for (auto& wheels : robots.wheels) wheels.bias = 0.02;
  robots.travel_sense = -1;
  robots.held_at = {robots.braked, robots.braked};
  robots.wheels[right].speed = 3.5 * robots.wheels[right].ramp;
  robots.goal_speed = {0.0, 0.0};
  for (int k = 0; k < 6; ++k) {
    const auto done = actuate(robots, palms, {0.3, 0.3});
    const double noise = robots.wheels[right].noise;
    const double rolls = robots.wheels[right].speed;
    CHECK((rolls > 0) == (k < 3));
    const double wanted = rolls > 0 ? -(rolls + 0.02 + noise) : -0.5 * noise;
    CHECK(std::abs(robots.speeds[right] - wanted) < 1e-15);
    CHECK(std::abs(robots.speeds[left] + 0.5 * robots.wheels[left].noise) < 1e-15);
    const double mean = (robots.speeds[left] + robots.speeds[right]) / 2;
    CHECK(std::abs(done.travel - mean * robots.period) < 1e-15);
  }
}

// Without a lag the acceleration of each period counts as it is.
void test_push_without_lag() {
  Robots<double> robots = standing<double>(0.01, 0.0);
  robots.goal_speed[right] = -0.2;
  for (int k = 0; k < 39; ++k) {
    CHECK(std::abs(push_of(robots) * 2 * palmbots::standard_gravity + 0.5) < 1e-12);
  }
  push_of(robots);
  push_of(robots);
  CHECK(push_of(robots) == 0);
}

// Noise of speed σ makes pushes whose spread does not grow without end as periods get shorter, as
// that of plain differences does: by the closed form of two first-order lags in a row.
void test_push_of_noise() {
  constexpr double sigma = 0.04;
  for (const double period : {0.01, 0.0025}) {
    Spec spec;
    spec.period = period;
    spec.robots[0].noise = sigma;
    spec.robots[1].noise = 0;
    for (auto& palm : spec.palms) palm.rate = 1;
    Robots<double> robots = robots_of<double>(spec, 3);
    const palmbots::PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(0),
                                                     PalmAngle<double>::at(0)};
    constexpr int n = 400000;
    double sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto w = draw(5, i, Stream::noise);
      const double push = actuate(robots, palms, {unit_noise<double>(w[0]), 0.0}).push;
      if (i >= 1000) sum += push * push;
    }
    // y' = p y + (1 − p) (v' − v) / T of a v with memory m has the variance
    // σ² (1 − p)² / T² × 2 (1 − m) / ((1 + p) (1 − p m)): as T → 0, σ² / (τ (τ + τ_noise)).
    const double m = std::exp(-period / 0.5);
    const double p = std::exp(-period / 0.05);
    const double exact =
        sigma * (1 - p) / period * std::sqrt(2 * (1 - m) / ((1 + p) * (1 - p * m)));
    const double limit = sigma / std::sqrt(0.05 * (0.05 + 0.5));
    CHECK(std::abs(exact / limit - 1) < 0.06);
    const double found = std::sqrt(sum / (n - 1000)) * 2 * palmbots::standard_gravity;
    CHECK(std::abs(found / exact - 1) < 0.03);
  }
}

}  // namespace

int main() {
  test_push_of_a_steady_acceleration<double>();
  test_push_of_a_steady_acceleration<float>();
  test_push_without_lag();
  test_a_robot_that_stands();
  test_gain_multiplies_the_motion<double>();
  test_gain_multiplies_the_motion<float>();
  test_gains_of_many_carries();
  test_white_noise_displaces_by_the_root_of_time();
  test_brakes_and_the_sense_of_travel();
  test_push_of_noise();
  test_acceleration_and_speed_limit<double>();
  test_acceleration_and_speed_limit<float>();
  test_calibration_error_is_not_limited();
  test_noise_against_closed_forms();
  test_wrist<double>();
  test_wrist<float>();
  test_wrist_turns_round();
}
