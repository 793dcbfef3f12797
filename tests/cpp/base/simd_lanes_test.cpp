// SPDX-License-Identifier: Apache-2.0
// Lanes do in each lane what a single number does.
#include "palmbots/base/simd_lanes.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "palmbots/mechanics/loop_closure.hpp"
#include "support/check.hpp"

namespace {

using namespace palmbots;

template <class Real>
bool same_bits(Real a, Real b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

template <class Real, int n>
void test_every_operation() {
  using V = Lanes<Real, n>;
  constexpr Real inf = std::numeric_limits<Real>::infinity();
  constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
  const Real numbers[] = {0,   -Real(0), 1,           -1, Real(0.1), Real(-3.7),
                          inf, -inf,     Real(1e-30), 6,  nan};
  for (const Real x : numbers) CHECK(same_bits(V(x).raw[n - 1], x) || x != x);
  for (const Real x : numbers) {
    for (const Real y : numbers) {
      V a(Real(2));
      V b(Real(3));
      a.raw[n - 1] = x;
      b.raw[n - 1] = y;
      const auto last = [](V v) { return Real(v.raw[n - 1]); };
      const auto bit = [](LaneMask<Real, n> m) { return (m.bits() >> (n - 1) & 1) != 0; };
      const auto equal = [](Real p, Real q) { return same_bits(p, q) || (p != p && q != q); };
      CHECK(equal(last(a + b), x + y) && equal(last(a - b), x - y));
      CHECK(equal(last(a * b), x * y) && equal(last(a / b), x / y) && equal(last(-a), -x));
      CHECK(bit(a < b) == (x < y) && bit(a <= b) == (x <= y) && bit(a == b) == (x == y));
      CHECK(bit(a > b) == (x > y) && bit(a >= b) == (x >= y) && bit(a != b) == (x != y));
      CHECK(same_bits(last(select(a < b, a, b)), x < y ? x : y));
      CHECK(same_bits(last(larger(a, b)), larger(x, y)));
      CHECK(same_bits(last(smaller(a, b)), smaller(x, y)));
      CHECK(same_bits(last(magnitude(a)), std::fabs(x)));
      CHECK(bit(within(a, b)) == (x >= -y && x <= y));
      CHECK(bit((a < b) & (a == a)) == (x < y) && bit((a < b) | (a > b)) == (x < y || x > y));
      CHECK(bit(!(a < b)) == !(x < y));
      CHECK(any(a < b) && all(a < b) == (x < y));
      CHECK(any(a > b) == (x > y) && !all(a > b));
      auto put = a < b;
      put.put(n - 1, x >= y);
      constexpr std::uint32_t others = (1U << (n - 1)) - 1;
      CHECK(bit(put) == (x >= y) && (put.bits() & others) == ((a < b).bits() & others));
    }
  }
}

template <class Real, int n>
void test_functions() {
  using V = Lanes<Real, n>;
  for (int i = 0; i <= 400; ++i) {
    V x(Real(0.3));
    const Real angle = Real(i - 200) * Real(0.0314159);
    x.raw[n - 1] = angle;
    const SinCos<V> at = sin_cos(x);
    const SinCos<Real> alone = sin_cos(angle);
    CHECK(same_bits(Real(at.sin.raw[n - 1]), alone.sin));
    CHECK(same_bits(Real(at.cos.raw[n - 1]), alone.cos));
    CHECK(same_bits(Real(at.sin.raw[0]), sin_cos(Real(0.3)).sin));
    x.raw[n - 1] = Real(i);
    CHECK(same_bits(Real(square_root(x).raw[n - 1]), std::sqrt(Real(i))));
  }
}

// A lane comes back as it was put in, and its neighbours are left alone.
void test_lanes_of_structs() {
  using V = Lanes<double, lanes_of<double>>;
  ContactVector<V> spans{V(1.0), V(2.0)};
  put_lane(spans, 1, ContactVector<double>{5.0, -0.0});
  const ContactVector<double> back = take_lane(spans, 1);
  CHECK(same_bits(back.dx, 5.0) && same_bits(back.dy, -0.0));
  for (int l = 0; l < V::count; ++l) {
    if (l != 1) CHECK(take_lane(spans, l).dx == 1 && take_lane(spans, l).dy == 2);
  }
}

}  // namespace

int main() {
  constexpr int doubles = lanes_of<double>;
  constexpr int floats = lanes_of<float>;
  test_every_operation<double, doubles>();
  test_every_operation<float, floats>();
  test_functions<double, doubles>();
  test_functions<float, floats>();
  test_lanes_of_structs();
}
