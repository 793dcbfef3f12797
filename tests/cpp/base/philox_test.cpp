// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10 against the known answers of its authors, and what is made of its words.
#include "palmbots/base/philox.hpp"

#include <cstdint>
#include <cstdio>
#include <set>

#include "support/check.hpp"

using palmbots::draw;
using palmbots::philox;
using palmbots::Words;

namespace {

// The three lines "philox4x32 10" of kat_vectors in Random123 (Salmon et al.).
void test_known_answers() {
  CHECK((philox({0, 0, 0, 0}, 0) == Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  CHECK((philox({~0U, ~0U, ~0U, ~0U}, ~std::uint64_t{0}) ==
         Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  // Key words a4093822 299f31d0, the first one in the low half.
  CHECK((philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0x299f31d0a4093822) ==
         Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// The counter's words are tick, stream, lane and 0, and the key is the seed.
void test_draw_is_philox_of_what_it_is_for() {
  CHECK((draw(0, 0, 0U) == philox({0, 0, 0, 0}, 0)));
  CHECK((draw(~std::uint64_t{0}, 7, 3U, 3) == philox({7, 3, 3, 0}, ~std::uint64_t{0})));
  CHECK((draw(5, 7, 1U) == philox({7, 1, 0, 0}, 5)));
  CHECK((draw(5, 7, 2U) == philox({7, 2, 0, 0}, 5)));
  std::set<Words> seen;
  for (std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32}) {
    for (std::uint32_t tick : {0U, 1U, ~0U}) {
      for (auto stream : {0U, 1U, 2U, 3U}) {
        for (std::uint32_t lane = 0; lane < 4; ++lane) seen.insert(draw(seed, tick, stream, lane));
      }
    }
  }
  CHECK(seen.size() == 3 * 3 * 4 * 4);
}

template <class Real>
void test_unit_uniform() {
  CHECK(palmbots::unit_uniform<Real>(0) == Real(0));
  CHECK(palmbots::unit_uniform<Real>(0x80000000) == Real(0.5));
  CHECK(palmbots::unit_uniform<Real>(~0U) < Real(1));
  CHECK(palmbots::unit_uniform<Real>(~0U) == Real(1) - Real(1) / Real(16777216));
}

// Symmetric bit by bit: the complement of the words gives the negative.
template <class Real>
void test_unit_noise() {
  CHECK(palmbots::unit_noise<Real>(0) == -palmbots::unit_noise<Real>(~0U));
  double sum = 0;
  double square = 0;
  double fourth = 0;
  constexpr int n = 400000;
  for (int i = 0; i < n; ++i) {
    const Words w = draw(1, static_cast<std::uint32_t>(i), 0U);
    const Real x = palmbots::unit_noise<Real>(w[0]);
    CHECK(x == -palmbots::unit_noise<Real>(~w[0]));
    CHECK(x > Real(-2.45) && x < Real(2.45));
    const auto d = double(x);
    sum += d;
    square += d * d;
    fourth += d * d * d * d;
  }
  // Five standard errors; the fourth moment of a sum of two uniforms is 3 − 1.2 / 2 = 2.4.
  CHECK(sum / n > -0.008 && sum / n < 0.008);
  CHECK(square / n > 0.9895 && square / n < 1.0105);
  CHECK(fourth / n > 2.36 && fourth / n < 2.44);
}

}  // namespace

// Draws made at once are those made one by one, also where the tick wraps around.
void test_many_draws_at_once() {
  constexpr std::size_t n = 32;
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    for (const std::uint32_t tick : {0U, 64U, ~0U - 20}) {
      for (const std::uint32_t apart : {1U, 2U}) {
        const auto rows = palmbots::draw_row<n>(seed, tick, 0U, apart);
        for (std::uint32_t i = 0; i < n; ++i) {
          const auto one = draw(seed, tick + apart * i, 0U);
          for (std::size_t word = 0; word < 4; ++word) CHECK(rows[word][i] == one[word]);
        }
      }
    }
  }
}

int main() {
  test_known_answers();
  test_draw_is_philox_of_what_it_is_for();
  test_many_draws_at_once();
  test_unit_uniform<double>();
  test_unit_uniform<float>();
  test_unit_noise<double>();
  test_unit_noise<float>();
}
