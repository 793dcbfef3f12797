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

// unit_noise() of the lower halves, times its scale: whole numbers from −65535 to 65535.
inline auto summed(Halves word) {
  typedef double Doubles __attribute__((vector_size(sizeof(Halves))));
  const Halves sum = (word & 0xFFFF) + (word >> 16 & 0xFFFF);
  // The bits of 2⁵² and of a smaller whole number make their sum.
  constexpr double two_52 = 4503599627370496.0;
  return (Doubles)(sum | std::bit_cast<std::uint64_t>(two_52)) - (two_52 + 65535);
}

template <class Real, int n>
void put_noise(Halves word, Lanes<Real, n>& row, std::size_t first) {
  typedef Real Reals __attribute__((vector_size(draws_at_once * sizeof(Real))));
  const Reals noise = __builtin_convertvector(summed(word), Reals) * unit_noise_scale<Real>;
  std::memcpy(reinterpret_cast<Real*>(&row.raw) + first, &noise, sizeof noise);
}

}  // namespace detail

// The noise of the ticks from `first` on, in every lane: one draw serves two robots for two ticks.
template <class Real, int n, std::size_t ticks>
void draw_noise(const Dice<n>& dice, std::uint64_t first,
                PerSide<std::array<Lanes<Real, n>, ticks>>& noise) {
  using detail::Halves;
  constexpr std::size_t width = detail::draws_at_once;
  static_assert(n % width == 0 && ticks % 2 == 0);
  const auto part = [](const std::array<std::uint64_t, n>& row, std::size_t l) {
    Halves found;
    std::memcpy(&found, row.data() + l, sizeof found);
    return found;
  };
  for (std::size_t l = 0; l < n; l += width) {
    const Halves seed = part(dice.seed, l);
    const Halves left_leads = part(dice.left_leads, l);
    Halves tick = first - part(dice.start, l);
    for (std::size_t k = 0; k < ticks; k += 2, tick += 2) {
      const auto words = detail::philox(
          {tick, Halves{} + static_cast<std::uint32_t>(Stream::noise)}, seed, seed >> 32);
      for (std::size_t i = 0; i < 2; ++i) {
        const Halves leader = words[2 * i];
        const Halves follower = words[2 * i + 1];
        const Halves swapped = (leader ^ follower) & ~left_leads;
        detail::put_noise(leader ^ swapped, noise[left][k + i], l);
        detail::put_noise(follower ^ swapped, noise[right][k + i], l);
      }
    }
  }
}

}  // namespace palmbots
