// SPDX-License-Identifier: Apache-2.0
// The two sides, left and right, which are mirror images.
//
// Everything about one robot is expressed in its *outward* frame (outward = away from the partner),
// so that the same code serves both sides. Only the world's x axis distinguishes them.
#pragma once

#include <array>
#include <cstddef>

namespace palmbots {

inline constexpr std::size_t left = 0;
inline constexpr std::size_t right = 1;

// One value for each side, indexed by `left` and `right`.
template <class T>
using PerSide = std::array<T, 2>;

// The opposite side.
constexpr std::size_t other(std::size_t side) { return 1 - side; }

// Calls visit(left) and visit(right). Used in code that runs every tick: unlike in a loop over the
// sides, the side is a constant in each call, so the compiler keeps the values of each side in
// registers.
template <class Visit>
[[gnu::always_inline]] constexpr void on_both_sides(Visit visit) {
  visit(left);
  visit(right);
}

// A value as seen from a side: unchanged on the left, negated on the right.
template <class Real>
constexpr Real mirrored(std::size_t side, Real value) {
  return Real(1 - 2 * static_cast<int>(side)) * value;
}

// The sign of the world's x direction that points outward on this side.
template <class Real>
constexpr Real outward(std::size_t side) {
  return side == left ? Real(-1) : Real(1);
}

}  // namespace palmbots
