// SPDX-License-Identifier: Apache-2.0
// Events inside a step: how near to one what is found lies, on functions smooth and nasty, and how
// few looks it takes where the function is as smooth as a tick's.
#include "palmbots/base/root_finding.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "palmbots/base/simd_lanes.hpp"
#include "support/check.hpp"

using palmbots::bisect_last_true;
using palmbots::bracketed_root;

namespace {

using palmbots::instant_tolerance;

double uniform() {
  static std::uint64_t state = 1;
  state = state * 6364136223846793005 + 1442695040888963407;
  return double(state >> 11) / 9007199254740992.0;
}

constexpr double any_slope = 0;

// What root() promises of any function that is ≥ 0 at 0, and < 0 at 1 for good from some instant
// on, and of one that is at most `steeper` times steeper in one place than in another; returns how
// often it looked.
template <class Real, class Function>
int looks_at(Function f, double steeper) {
  int looks = 0;
  const Real found =
      bracketed_root(true, Real(0), Real(f(Real(0))), Real(1), Real(f(Real(1))), [&](Real t) {
        CHECK(t > Real(0) && t < Real(1));
        ++looks;
        return Real(f(t));
      });
  CHECK(found >= Real(0) && found < Real(1));
  CHECK(f(found) >= Real(0));
  if (steeper != any_slope && Real(f(found)) != Real(0)) {
    const Real beyond = found + Real(1.001 * steeper) * instant_tolerance<Real>;
    CHECK(f(std::min(Real(1), beyond)) <= Real(0));
  }
  return looks;
}

// The condition of a tick is nearly linear; its curvature is a thousandth.
template <class Real>
void test_smooth_functions_need_few_evaluations(int most) {
  for (int i = 0; i < 20000; ++i) {
    const auto at = Real(uniform());
    const auto bend = Real(0.002 * (uniform() - 0.5));
    const auto twist = Real(0.0002 * (uniform() - 0.5));
    const auto scale = Real(std::pow(10.0, -8.0 * uniform()));
    const int looks = looks_at<Real>(
        [=](Real t) {
          const Real x = at - t;
          return scale * (x + bend * x * x + twist * x * x * x);
        },
        1.01);
    CHECK(looks <= most || at < instant_tolerance<Real>);
  }
}

// Much more curved than the condition of a tick.
template <class Real>
void test_strongly_curved_functions() {
  for (int i = 0; i < 20000; ++i) {
    const auto at = Real(uniform());
    const auto bend = Real(std::pow(10.0, 2.0 - 4.0 * uniform()));
    const auto scale = Real(std::pow(10.0, -8.0 * uniform()));
    const double steeper = std::exp(double(bend));
    const auto grows = [=](Real t) { return scale * (std::exp(bend * at) - std::exp(bend * t)); };
    const auto fades = [=](Real t) { return scale * (std::exp(-bend * t) - std::exp(-bend * at)); };
    if (std::isfinite(grows(Real(1)))) CHECK(looks_at<Real>(grows, steeper) < 30);
    if (fades(Real(1)) < Real(0)) CHECK(looks_at<Real>(fades, steeper) < 30);
  }
}

template <class Real>
void test_steep_and_discontinuous_functions() {
  for (int i = 0; i < 2000; ++i) {
    const auto at = Real(uniform());
    if (at == Real(0)) continue;
    const auto high = Real(std::pow(10.0, -30.0 * uniform()));
    const auto low = Real(std::pow(10.0, -30.0 * uniform()));
    const auto monitor = Real(1 + 20 * uniform());
    const auto curve = [=](Real t) {
      return t <= at ? high * std::pow(at - t, monitor) : -low * std::pow(t - at, monitor);
    };
    const auto looks_nasty = [](auto f) { return looks_at<Real>(f, any_slope); };
    CHECK(looks_nasty([=](Real t) { return t <= at ? high : -low; }) < 200);
    CHECK(looks_nasty([=](Real t) { return (at - t) * (t < at ? high : low); }) < 200);
    CHECK(looks_nasty([=](Real t) { return std::atan((at - t) / high); }) < 200);
    if (curve(Real(1)) < Real(0)) CHECK(looks_nasty(curve) < 200);
  }
}

template <class Real>
void test_bracket_that_starts_at_a_root() {
  const auto never = [](Real) -> Real {
    CHECK(false);
    return Real(0);
  };
  CHECK(bracketed_root(true, Real(0.25), Real(0), Real(1), Real(-1), never) == Real(0.25));
  // Rounding may have made it negative already.
  CHECK(bracketed_root(true, Real(0.25), Real(-1e-20), Real(1), Real(-1), never) == Real(0.25));
  // It rises before it falls: the root is the one at the end of the bracket.
  const auto hump = [](Real t) { return t < Real(0.5) ? t + Real(1e-12) : Real(0.75) - t; };
  CHECK(std::abs(bracketed_root(true, Real(0), hump(0), Real(1), hump(1), hump) - Real(0.75)) <=
        Real(1.5) * instant_tolerance<Real>);
}

// Every lane finds the root that it finds alone, if it is wanted, and none is ever looked at
// elsewhere than in its bracket.
template <class Real, int n>
void test_lanes() {
  using V = palmbots::Lanes<Real, n>;
  for (int i = 0; i < 2000; ++i) {
    V at;
    V bend;
    typename V::Mask wanted = V(0) > V(0);
    for (int l = 0; l < n; ++l) {
      at.raw[l] = Real(uniform());
      bend.raw[l] = Real(4 * uniform() * uniform());
      V lane(0);
      lane.raw[l] = Real(uniform() < 0.7 ? 1 : 0);
      wanted = wanted | (lane > V(0));
      if (lane.raw[l] == Real(0)) at.raw[l] += Real(1);  // there is none
    }
    const auto condition = [](auto t, auto root_at, auto bent) {
      using T = decltype(t);
      return (root_at - t) * (T(1) + bent * t * t);
    };
    const V found = bracketed_root(wanted, V(0), condition(V(0), at, bend), V(1),
                                   condition(V(1), at, bend), [&](V t) {
                                     CHECK(all((t >= V(0)) & (t <= V(1))));
                                     return condition(t, at, bend);
                                   });
    for (int l = 0; l < n; ++l) {
      const auto alone = [&](Real t) { return condition(t, Real(at.raw[l]), Real(bend.raw[l])); };
      const bool is_wanted = (wanted.bits() >> l & 1) != 0;
      const Real own = bracketed_root(is_wanted, Real(0), alone(0), Real(1), alone(1), alone);
      CHECK(Real(found.raw[l]) == own && (is_wanted || own == Real(0)));
    }
  }
}

template <class Real>
void test_bisect_last_true() {
  for (int i = 0; i < 1000; ++i) {
    const auto last = Real(uniform());
    const auto holds = [=](Real t) { return t <= last; };
    CHECK(bisect_last_true(Real(0), Real(1), holds) == last);
  }
}

template <class Real>
void test_all(int most_looks) {
  test_smooth_functions_need_few_evaluations<Real>(most_looks);
  test_strongly_curved_functions<Real>();
  test_steep_and_discontinuous_functions<Real>();
  test_bracket_that_starts_at_a_root<Real>();
  test_bisect_last_true<Real>();
}

}  // namespace

int main() {
  test_all<double>(3);
  test_all<float>(2);
  test_lanes<double, palmbots::register_bytes / 8>();
  test_lanes<float, palmbots::register_bytes / 4>();
}
