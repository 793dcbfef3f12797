// The robots' noise for several carries side by side: the same draws as a single carry's, in lanes.
#pragma once

#include "palmbots/lanes.hpp"
#include "palmbots/philox.hpp"
#include "palmbots/side.hpp"

namespace palmbots {

// What a carry's draws depend on, for n carries side by side.
template <int n>
struct Dice {
  std::array<std::uint64_t, n> seed;
  std::array<std::uint64_t, n> start;       // the tick at which the carry began
  std::array<std::uint64_t, n> left_leads;  // all bits: the left robot leads; none: the right one
};

namespace detail {

// How many draws are made in turn, so that none waits for another: as many as there are registers for.
inline constexpr std::size_t draws_in_turn = draws_at_once == 8 ? 4 : 2;

// The same register as words of half the size.
typedef std::uint32_t Wholes __attribute__((vector_size(sizeof(Halves))));

// How many registers of words are drawn for one of numbers.
template <class Real>
inline constexpr std::size_t parts_of = sizeof(Halves) / sizeof(Real) / draws_at_once;

inline constexpr std::size_t lower_half = std::endian::native == std::endian::little ? 0 : 1;

// The words of as many lanes as a register has numbers.
inline Halves join(const std::array<Halves, 1>& words) { return words[0]; }
inline Wholes join(const std::array<Halves, 2>& words) {
  return [&]<std::size_t... i>(std::index_sequence<i...>) {
    return __builtin_shufflevector((Wholes)words[0], (Wholes)words[1], (2 * i + lower_half)...);
  }(std::make_index_sequence<2 * draws_at_once>{});
}

// unit_noise() of them.
inline auto noise_of(Halves words) {
  typedef double Doubles __attribute__((vector_size(sizeof(Halves))));
  const Halves sum = (words & 0xFFFF) + (words >> 16 & 0xFFFF);
  // The bits of 2⁵² and of a smaller whole number make their sum.
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

// The noise of the ticks from `first` on, in every lane: one draw serves two robots for two ticks.
template <class Real, int n, std::size_t ticks>
void draw_noise(const Dice<n>& dice, std::uint64_t first,
                PerSide<std::array<Lanes<Real, n>, ticks>>& noise) {
  using detail::Halves;
  constexpr std::size_t width = detail::draws_at_once;
  constexpr std::size_t parts = detail::parts_of<Real>;
  constexpr std::size_t pairs = detail::draws_in_turn / parts;  // of ticks
  static_assert(n == width * parts && ticks % (2 * pairs) == 0);
  const auto part = [](const std::array<std::uint64_t, n>& row, std::size_t p) {
    Halves found;
    std::memcpy(&found, row.data() + p * width, sizeof found);
    return found;
  };
  const auto joined = [](auto&& words) {
    std::array<Halves, parts> all;
    for (std::size_t p = 0; p < parts; ++p) all[p] = words(p);
    return detail::join(all);
  };
  const auto left_leads = joined([&](std::size_t p) { return part(dice.left_leads, p); });
  std::array<Halves, pairs * parts> k0;
  std::array<Halves, pairs * parts> k1;
  std::array<Halves, pairs * parts> tick;
  for (std::size_t i = 0; i < pairs * parts; ++i) {
    k0[i] = part(dice.seed, i % parts);
    k1[i] = k0[i] >> 32;
    tick[i] = first + 2 * (i / parts) - part(dice.start, i % parts);
  }
  for (std::size_t k = 0; k < ticks; k += 2 * pairs) {
    std::array<detail::Draws, pairs * parts> counters;
    for (std::size_t i = 0; i < pairs * parts; ++i) {
      counters[i] = {tick[i], Halves{} + static_cast<std::uint32_t>(Stream::noise)};
      tick[i] += 2 * pairs;
    }
    const auto words = detail::philox(counters, k0, k1);
    for (std::size_t i = 0; i < 2 * pairs; ++i) {
      const auto word = [&](std::size_t w) {
        return joined([&](std::size_t p) { return words[i / 2 * parts + p][i % 2 * 2 + w]; });
      };
      const auto leader = word(0);
      const auto follower = word(1);
      const auto swapped = (leader ^ follower) & ~left_leads;
      using Raw = decltype(noise[left][k].raw);
      noise[left][k + i].raw = (Raw)detail::noise_of(leader ^ swapped);
      noise[right][k + i].raw = (Raw)detail::noise_of(follower ^ swapped);
    }
  }
}

}  // namespace palmbots
