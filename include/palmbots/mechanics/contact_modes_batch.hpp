// SPDX-License-Identifier: Apache-2.0
// Which of the nine contact modes balance, for many states at once, as one bit for each mode.
//
// Bit k is set iff `feasible` of mechanics/contact_modes.hpp holds for mode k. The left contact
// counts first, and both follow the order of `slip_directions`. The answers equal those of
// `feasible` for every input, in a tenth of the time: several states are evaluated in lanes
// (base/simd_lanes.hpp).
//
// Usually every edge bounds the squeeze from its own side (a w > 0 in mechanics/equilibrium.hpp).
// Then the ends of I_L and I_R are the squeezes at the edges, and each mode takes one or two
// comparisons of these four numbers. Any other reachable state has a wedged edge, a palm without
// friction or a bound that is not a number. It is left to `feasible`. Where the object cannot
// reach, dx is not a number, no comparison holds, and no mode balances, as in `feasible`.
#pragma once

#include <algorithm>
#include <cstdint>

#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// One quantity of each state: an array with one number for each state, or one number for all.
struct Column {
  const double* data;
  bool each;  // the array holds a number for each state
};

// The quantities that define a state, as in `ObjectParams` and `Configuration`, in the order of
// their columns. The last four are pairs, left and right.
namespace state {
enum Number : std::size_t {
  width,
  com_left,
  com_right,
  com_height,
  slope,
  offset,
  friction = offset + 2,
  angle = friction + 2,
  contact = angle + 2,
  count = contact + 2
};
}  // namespace state

// The columns of all quantities, in the order of state::Number.
using StateColumns = std::array<Column, state::count>;

namespace detail {

// The bits of the contact modes that balance in several states, and where they are those of
// `feasible`. With an empty interval none balances, whatever the other numbers are.
template <class V>
struct PlainModes {
  typename MaskOf<V>::Raw bits;
  std::uint32_t valid;  // a bit for each lane
};

template <class V>
[[gnu::always_inline]] inline PlainModes<V> plain_modes(const Contacts<V>& at) {
  PerSide<Interval<V>> ends;
  MaskOf<V> plain = at.dx == at.dx;
  on_both_sides([&](std::size_t side) {
    const FrictionCone<V>& cone = at.cones[side];
    const Bound<V> up = bound(at.moments, side, cone.up, at.dx, at.dy);
    const Bound<V> down = bound(at.moments, side, cone.down, at.dx, at.dy);
    const V up_a = up.a * at.moments.width;
    const V down_a = down.a * at.moments.width;
    ends[side] = {down.b / down_a, up.b / up_a};
    plain = plain & (up_a > V(0)) & (down_a > V(0)) & (ends[side].high == ends[side].high) &
            (cone.up.lateral > cone.down.lateral);
  });
  const auto& [l, r] = ends;
  const auto held = (l.low <= l.high) & (r.low <= r.high);
  const auto meet = [&](V p, V q) {
    const V size = magnitude(p) + magnitude(q);
    return held & (magnitude(p - q) <= V(squeeze_tolerance<typename ScalarOf<V>::type>) * size);
  };
  const auto l_under = held & (l.low <= r.high);
  const auto r_under = held & (r.low <= l.high);
  const MaskOf<V> modes[] = {l_under & r_under,          l_under & (r.high <= l.high),
                             r_under & (l.low <= r.low), r_under & (l.high <= r.high),
                             meet(l.high, r.high),       meet(l.high, r.low),
                             l_under & (r.low <= l.low), meet(l.low, r.high),
                             meet(l.low, r.low)};
  PlainModes<V> found{{}, (plain | (at.dx != at.dx)).bits()};
  typename V::In::Int bit = 1;
  for (const MaskOf<V>& balances : modes) {
    found.bits |= balances.raw & bit;
    bit *= 2;
  }
  return found;
}

// The modes of any state, by `feasible`.
template <class Real>
std::uint16_t feasible_bits(const Contacts<Real>& at) {
  unsigned bits = 0;
  unsigned bit = 0;
  for (const SlipDirection l : slip_directions) {
    for (const SlipDirection r : slip_directions) bits |= (feasible(at, {l, r}) ? 1U : 0U) << bit++;
  }
  return static_cast<std::uint16_t>(bits);
}

}  // namespace detail

// Writes the bits of the contact modes that balance, for n states.
inline void feasible_modes(const StateColumns& columns, std::size_t n, std::uint16_t* out) {
  using V = Lanes<double, 2>;  // for the registers of all 64-bit processors
  const auto several = [&](std::size_t which, std::size_t first) {
    const Column& column = columns[which];
    V numbers(*column.data);
    if (column.each)
      numbers.raw = typename V::Raw{column.data[first], column.data[std::min(first + 1, n - 1)]};
    return numbers;
  };
  // States often differ only in the contact coordinates.
  const auto contact = columns.begin() + state::contact;
  const bool alike = std::none_of(columns.begin(), contact, [](const Column& c) { return c.each; });
  Contacts<V> at{};
  PerSide<PalmAngle<V>> palms{};
  PerSide<V> offset{};
  for (std::size_t first = 0; first < n; first += V::count) {
    if (first == 0 || !alike) {
      const auto number = [&](std::size_t which) { return several(which, first); };
      at.moments =
          Moments<V>::of({number(state::width), number(state::com_left), number(state::com_right),
                          number(state::com_height), number(state::slope)});
      on_both_sides([&](std::size_t side) {
        palms[side] = PalmAngle<V>::at(number(state::angle + side));
        offset[side] = number(state::offset + side);
        at.cones[side] =
            friction_cone<V>({palms[side].sin, palms[side].cos}, number(state::friction + side));
      });
    }
    const PerSide<V> contacts{several(state::contact, first), several(state::contact + 1, first)};
    const V w = at.moments.width;
    at.dy = contact_vector<V>({V(0), palms, contacts}, offset).dy;
    at.dx = square_root((w - at.dy) * (w + at.dy));
    const auto plain = detail::plain_modes(at);
    for (std::size_t l = 0; l < V::count && first + l < n; ++l) {
      out[first + l] = (plain.valid >> l & 1) != 0 ? static_cast<std::uint16_t>(plain.bits[l])
                                                   : detail::feasible_bits(take_lane(at, int(l)));
    }
  }
}

}  // namespace palmbots
