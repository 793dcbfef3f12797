// SPDX-License-Identifier: Apache-2.0
// Left and right, which are mirror images.
//
// Everything about one robot is written in its *outward* frame (outward = away from the partner),
// so that one piece of code serves both; only the world's x axis needs to know which is which.
#pragma once

#include <array>
#include <cstddef>

namespace palmbots {

inline constexpr std::size_t left = 0;
inline constexpr std::size_t right = 1;

template <class T>
using PerSide = std::array<T, 2>;

constexpr std::size_t other(std::size_t side) { return 1 - side; }

// Does the same for both sides. Where every tick goes through: unlike a loop over the sides, the
// compiler sees two known sides at once, and keeps what belongs to each in registers.
template <class Visit>
[[gnu::always_inline]] constexpr void on_both_sides(Visit visit) {
  visit(left);
  visit(right);
}

// What is seen from the left as it is, and from the right in the mirror.
template <class Real>
constexpr Real mirrored(std::size_t side, Real value) {
  return Real(1 - 2 * static_cast<int>(side)) * value;
}

// The world x direction that is outward for this side.
template <class Real>
constexpr Real outward(std::size_t side) {
  return side == left ? Real(-1) : Real(1);
}

}  // namespace palmbots
