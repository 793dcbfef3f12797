// SPDX-License-Identifier: Apache-2.0
// The tactile sensor: zones with their ends, which one wins, and false readings.
#include "palmbots/robot/tactile_sensor.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "palmbots/base/philox.hpp"
#include "support/check.hpp"

using palmbots::draw;
using palmbots::max_zones;
using palmbots::Sign;
using palmbots::TactileSensor;
using palmbots::Zone;

namespace {

template <class Real>
constexpr Real inf = std::numeric_limits<Real>::infinity();

template <class Real>
TactileSensor<Real> sensor(std::initializer_list<Zone<Real>> list, double false_rate = 0) {
  std::array<Zone<Real>, max_zones> zones{};
  std::size_t n = 0;
  for (const auto& zone : list) zones[n++] = zone;
  return TactileSensor<Real>(zones, n, false_rate);
}

template <class Real>
TactileSensor<Real> usual(double false_rate = 0) {
  return sensor<Real>({{Sign::negative, -inf<Real>, Real(-0.005)},
                       {Sign::zero, Real(-0.005), Real(0.005)},
                       {Sign::positive, Real(0.005), inf<Real>}},
                      false_rate);
}

template <class Real>
void test_usual_layout() {
  const auto s = usual<Real>();
  const Real edge = Real(0.005);
  CHECK(s.sign(0) == Sign::zero);
  CHECK(s.sign(edge) == Sign::zero);  // the zero zone is closed
  CHECK(s.sign(-edge) == Sign::zero);
  CHECK(s.sign(std::nextafter(edge, Real(1))) == Sign::positive);
  CHECK(s.sign(std::nextafter(-edge, Real(-1))) == Sign::negative);
  CHECK(s.sign(Real(9)) == Sign::positive);
  CHECK(s.sign(Real(-9)) == Sign::negative);
  CHECK(!s.has_false_readings());
}

// Figure 7: zero wins wherever it overlaps, in whatever order the switches are listed.
template <class Real>
void test_overlaps() {
  const Zone<Real> minus{Sign::negative, Real(-3), Real(0)};
  const Zone<Real> zero{Sign::zero, Real(-1), Real(1)};
  const Zone<Real> plus{Sign::positive, Real(0), Real(3)};
  for (const auto& s : {sensor<Real>({minus, zero, plus}), sensor<Real>({zero, plus, minus}),
                        sensor<Real>({plus, minus, zero})}) {
    CHECK(s.sign(Real(-2)) == Sign::negative);
    CHECK(s.sign(Real(-0.5)) == Sign::zero);
    CHECK(s.sign(Real(0)) == Sign::zero);
    CHECK(s.sign(Real(0.5)) == Sign::zero);
    CHECK(s.sign(Real(2)) == Sign::positive);
    CHECK(s.sign(Real(4)) == Sign::zero);  // no switch is pressed
    CHECK(s.sign(Real(-4)) == Sign::zero);
  }
  CHECK(sensor<Real>({minus, plus}).sign(Real(0)) == Sign::positive);  // a shared end: the later
  CHECK(sensor<Real>({plus, minus}).sign(Real(0)) == Sign::negative);
  CHECK(sensor<Real>({}).sign(Real(1)) == Sign::zero);
}

// A stretch holds p and ends where the sign changes, at edges, beside them and far away.
template <class Real>
void test_stretches() {
  const auto with_gap = sensor<Real>({{Sign::negative, Real(-3), Real(-1)},
                                      {Sign::zero, Real(-0.5), Real(0.5)},
                                      {Sign::positive, Real(0.5), Real(3)}});
  for (const auto& s : {usual<Real>(), with_gap}) {
    for (const Real edge : {Real(-3), Real(-1), Real(-0.5), Real(-0.005), Real(0), Real(0.005),
                            Real(0.5), Real(3), Real(9)}) {
      for (const Real p : {edge, std::nextafter(edge, Real(9)), std::nextafter(edge, Real(-9))}) {
        const auto found = s.stretch(p);
        CHECK(found.from <= p && p < found.until);
        CHECK(found.sign == s.sign(p));
        if (found.until < inf<Real>) CHECK(s.sign(found.until) != found.sign);
        if (found.from > -inf<Real>) {
          CHECK(s.sign(found.from) == found.sign);
          CHECK(s.sign(std::nextafter(found.from, -inf<Real>)) != found.sign);
        }
      }
    }
  }
}

// Only a reading that never decreases outward has steps.
template <class Real>
void test_steps() {
  const auto steps = usual<Real>().steps();
  CHECK(steps.has_value() && steps->not_negative == Real(-0.005));
  CHECK(steps->positive == std::nextafter(Real(0.005), Real(1)));
  const auto bare = sensor<Real>({}).steps();
  CHECK(bare.has_value() && bare->not_negative == -inf<Real> && bare->positive == inf<Real>);
  // Beyond its last switch this one reads 0 again.
  CHECK(!sensor<Real>({{Sign::positive, Real(0), Real(3)}}).steps().has_value());
}

// At rate 0 no draw is false.
void test_no_false_reading() {
  for (const std::uint32_t chance : {0U, 1U, ~0U}) {
    CHECK(usual<double>(0).sign(0.0, chance, 1) == Sign::zero);
  }
}

// A false reading is one of the two other signs, each as often; as many as the rate says.
void test_false_readings() {
  constexpr int n = 200000;
  for (const double rate : {0.02, 0.3, 1.0}) {
    const auto s = usual<double>(rate);
    CHECK(s.has_false_readings());
    for (const double p : {-0.02, 0.0, 0.02}) {
      int seen[3]{};
      for (std::uint32_t i = 0; i < n; ++i) {
        const auto w = draw(9, i, 1U);
        ++seen[static_cast<int>(s.sign(p, w[0], w[1])) + 1];
      }
      const int truth = p < 0 ? 0 : (p > 0 ? 2 : 1);
      for (int k = 0; k < 3; ++k) {
        const double share = k == truth ? 1 - rate : rate / 2;
        CHECK(std::abs(seen[k] - n * share) <= 5 * std::sqrt(n * share * (1 - share)));
      }
    }
  }
}

}  // namespace

int main() {
  test_usual_layout<double>();
  test_usual_layout<float>();
  test_overlaps<double>();
  test_overlaps<float>();
  test_stretches<double>();
  test_stretches<float>();
  test_steps<double>();
  test_steps<float>();
  test_no_false_reading();
  test_false_readings();
}
