// SPDX-License-Identifier: Apache-2.0
// Numbers as text have the digits of printf.
#include "palmbots/base/number_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

#include "palmbots/base/few_sorted.hpp"
#include "support/check.hpp"

using namespace palmbots;

namespace {

std::string printed(const char* format, int digits, double value) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), format, digits, value);
  return text.data();
}

void check_number(double value) {
  for (const int digits : {0, 1, 2, 3, 6}) {
    CHECK(fixed_text(value, digits) == printed("%.*f", digits, value));
    if (digits > 0) CHECK(short_text(value, digits) == printed("%.*g", digits, value));
  }
}

void check_numbers() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double value : {0.0,
                             -0.0,
                             0.5,
                             1.5,
                             2.5,
                             0.25,
                             0.125,
                             0.05,
                             0.95,
                             9.5,
                             9.995,
                             99999.5,
                             999999.5,
                             1e-4,
                             1e-5,
                             9.99995e-5,
                             123456.0,
                             1234567.0,
                             1e22,
                             1e300,
                             -1e300,
                             5e-324,
                             2.2250738585072014e-308,
                             0.1,
                             -0.04,
                             -74.96,
                             inf,
                             -inf,
                             std::numeric_limits<double>::max()}) {
    check_number(value);
  }
  CHECK(short_text(std::numeric_limits<double>::quiet_NaN()) == "nan");
  std::mt19937_64 random(1);
  for (int i = 0; i < 60; ++i) {
    const auto bits = random();
    check_number(std::bit_cast<double>(bits % 0x7FF0000000000000U));
    check_number((double(bits % 2000001) - 1e6) / 1000.0);  // many halves
    check_number((double(bits % 20001) - 1e4) / 128.0);     // exact halves
  }
}

void check_sort() {
  std::mt19937_64 random(2);
  for (std::size_t n = 0; n < 12; ++n) {
    std::array<int, 12> items{};
    for (std::size_t i = 0; i < n; ++i) items[i] = static_cast<int>(random() % 20);
    std::array<int, 12> other = items;
    sort_few(items.data(), n);
    std::stable_sort(other.begin(), other.begin() + std::ptrdiff_t(n));
    CHECK(items == other);
    // Items that compare equal keep their order.
    sort_few(other.data(), n, [](int item) { return item % 3; });
    std::stable_sort(items.begin(), items.begin() + std::ptrdiff_t(n),
                     [](int a, int b) { return a % 3 < b % 3; });
    CHECK(items == other);
  }
}

}  // namespace

int main() {
  check_numbers();
  check_sort();
  return 0;
}
