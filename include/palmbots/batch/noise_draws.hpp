// SPDX-License-Identifier: Apache-2.0
// The robots' noise for several carries side by side. The draws are the same as a single carry's,
// in lanes.
#pragma once

#include <utility>

#include "palmbots/base/side.hpp"
#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/batch/lane_random_inputs.hpp"
#include "palmbots/sim/random_streams.hpp"

namespace palmbots {

namespace detail {

// The same register as words of half the size.
typedef std::uint32_t Wholes __attribute__((vector_size(sizeof(Halves))));

inline constexpr std::size_t lower_half = std::endian::native == std::endian::little ? 0 : 1;

// The words of as many lanes as a register has numbers.
inline Halves join(const std::array<Halves, 1>& words) { return words[0]; }
inline Wholes join(const std::array<Halves, 2>& words) {
  return [&]<std::size_t... i>(std::index_sequence<i...>) {
    return __builtin_shufflevector((Wholes)words[0], (Wholes)words[1], (2 * i + lower_half)...);
  }(std::make_index_sequence<2 * draws_at_once>{});
}

// unit_noise() of these words.
inline auto noise_of(Halves words) {
  typedef double Doubles __attribute__((vector_size(sizeof(Halves))));
  const Halves sum = (words & 0xFFFF) + (words >> 16 & 0xFFFF);
  // The bit pattern of 2⁵², combined with the bits of a smaller whole number, is that of their sum.
  constexpr double two_52 = 4503599627370496.0;
  const auto number = (Doubles)(sum | std::bit_cast<std::uint64_t>(two_52)) - (two_52 + 65535);
  return number * unit_noise_scale<double>;
}
inline auto noise_of(Wholes words) {
  typedef float Floats __attribute__((vector_size(sizeof(Wholes))));
  typedef std::int32_t Numbers __attribute__((vector_size(sizeof(Wholes))));
  const auto number = (Numbers)((words & 0xFFFF) + (words >> 16)) - 65535;
  return __builtin_convertvector(number, Floats) * unit_noise_scale<float>;
}

}  // namespace detail

// Draws the noise of the ticks from `first` on, in every lane. One draw serves two robots for two
// ticks.
template <class Real, int n, std::size_t ticks>
void draw_noise(const LaneRandomInputs<n>& inputs, std::uint64_t first,
                PerSide<std::array<Lanes<Real, n>, ticks>>& noise) {
  using D = LaneRandomInputs<n>;
  using Raw = decltype(noise[left][0].raw);
  static_assert(ticks % (2 * D::in_turn) == 0);
  const auto joined = [](auto&& part) {
    std::array<detail::Halves, D::parts> all;
    for (std::size_t p = 0; p < D::parts; ++p) all[p] = part(p);
    return detail::join(all);
  };
  const auto left_leads = joined([&](std::size_t p) { return D::part(inputs.left_leads, p); });
  typename D::template LaneDraws<D::in_turn> draws(inputs, Stream::noise, 0, first, 2);
  for (std::size_t k = 0; k < ticks; k += 2 * D::in_turn) {
    const auto drawn = draws.next();
    for (std::size_t i = 0; i < 2 * D::in_turn; ++i) {
      const auto word = [&](std::size_t robot) {
        return joined([&](std::size_t p) { return drawn.word(i / 2, p, i % 2 * 2 + robot); });
      };
      const auto leader = word(0);
      const auto follower = word(1);
      const auto swapped = (leader ^ follower) & ~left_leads;
      noise[left][k + i].raw = (Raw)detail::noise_of(leader ^ swapped);
      noise[right][k + i].raw = (Raw)detail::noise_of(follower ^ swapped);
    }
  }
}

}  // namespace palmbots
