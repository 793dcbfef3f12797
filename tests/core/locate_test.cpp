// Events inside a step: where they are known in closed form, and on which side of them one stops.
#include "palmbots/locate.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>

#include "check.hpp"

using namespace palmbots;

namespace {

// To the last bit: it still holds there, and no more in the next number.
template <class Real>
void test_last_holding() {
  for (const Real at : {Real(0.1), Real(0.5), Real(0.75), Real(0.999)}) {
    const auto before = [&](Real t) { return t < at; };
    const Real found = last_holding(Real(0), Real(1), before);
    CHECK(before(found) && !before(std::nextafter(found, Real(2))));
    const auto until = [&](Real t) { return t <= at; };
    CHECK(last_holding(Real(0), Real(1), until) == at);
  }
  CHECK(last_holding(Real(0.25), Real(1), [](Real t) { return t <= Real(0.25); }) == Real(0.25));
  // Near 0 numbers are dense: still the last of them within the bound on work.
  const Real tiny = Real(1e-30);
  CHECK(last_holding(Real(0), Real(1), [&](Real t) { return t <= tiny; }) == tiny);
}

// How often f is asked for.
int asked = 0;

// At or just before the root: never behind it, within the tolerance that is told.
template <class Real, class Function>
void check_root(Real exact, Function f, int most) {
  asked = 0;
  const auto counted = [&](Real t) {
    ++asked;
    return f(t);
  };
  const Real found = root(Real(0), Real(1), f(Real(1)), counted);
  const Real tolerance = Real(4096) * std::numeric_limits<Real>::epsilon();
  CHECK(f(found) >= Real(0));
  CHECK(std::abs(found - exact) <= 2 * tolerance);
  CHECK(asked <= most);
}

template <class Real>
void test_root() {
  check_root(Real(0.3), [](Real t) { return Real(0.3) - t; }, 60);
  // Curved either way: plain regula falsi would keep one end and crawl.
  check_root(Real(0.2), [](Real t) { return Real(0.04) - t * t; }, 40);
  check_root(std::cbrt(Real(0.5)), [](Real t) { return Real(0.5) - t * t * t; }, 40);
  check_root(Real(0.01), [](Real t) { return Real(0.1) - std::sqrt(t); }, 60);
  check_root(Real(0.25), [](Real t) { return std::exp(Real(8) * (Real(0.25) - t)) - Real(1); }, 40);
  // No number to draw a line to.
  check_root(Real(0.3), [](Real t) { return std::log((Real(1) - t) / Real(0.7)); }, 60);
  // Already over at the good end, or just there: no search.
  asked = 0;
  const auto over = [](Real t) {
    ++asked;
    return t < Real(0.5) ? -t : Real(1);
  };
  CHECK(root(Real(0.25), Real(1), Real(-1), over) == Real(0.25) && asked == 1);
  CHECK(root(Real(0), Real(1), Real(-1), [](Real t) { return -t; }) == Real(0));
  // Exactly met: that is where the regime ends.
  const auto met = [](Real t) {
    ++asked;
    return Real(1) - 2 * t;
  };
  asked = 0;
  CHECK(root(Real(0), Real(1), Real(-1), met) == Real(0.5) && asked == 2);
  // A jump has no root: the last number before it, within the tolerance.
  const Real jump =
      root(Real(0), Real(1), Real(-3), [](Real t) { return t < Real(0.7) ? Real(1) : Real(-3); });
  CHECK(jump < Real(0.7) && jump > Real(0.699));
}

}  // namespace

int main() {
  test_last_holding<double>();
  test_last_holding<float>();
  test_root<double>();
  test_root<float>();
}
