// SPDX-License-Identifier: Apache-2.0
// The tactile sensor: zones with their ends, which one wins, and false readings.
#include "palmbots/robot/tactile_sensor.hpp"

#include <array>
#include <cmath>
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
  test_false_readings();
}
