// SPDX-License-Identifier: Apache-2.0
// Which of the nine contact modes balance, for many states at once, as one bit for each mode.
//
// Bit k is set iff `feasible` of mechanics/contact_modes.hpp holds for mode k. The left contact
// counts first, and both follow the order of `slip_directions`. The answers equal those of
// `feasible` for every input, in a tenth of the time.
//
// Usually every edge bounds the squeeze from its own side (a w > 0 in mechanics/equilibrium.hpp).
// Then the ends of I_L and I_R are the squeezes at the edges, and each mode takes one or two
// comparisons of these four numbers. Any other reachable state has a wedged edge, a palm without
// friction or a bound that is not a number. It gets a tenth bit and is left to the slower
// `feasible`. Where the object cannot reach, dx is not a number, no comparison holds, and no mode
// balances, as in `feasible`.
//
// States are processed in blocks that fit into the first-level cache, in short loops without
// branches. Compilers turn these loops into vector instructions even for the first 64-bit
// processors. Those processors can select between two doubles but not between two 64-bit integers,
// so the loops use & instead of && and add up bits as numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// One quantity of each state: an array with one number for each state, or one number for all.
template <class Real>
struct Column {
  const Real* data;
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
template <class Real>
using StateColumns = std::array<Column<Real>, state::count>;

namespace batch {

inline constexpr std::size_t block = 256;  // states
inline constexpr int modes = 9;

template <class Real>
using BlockColumn = std::array<Real, block>;

// Reads a column block by block.
template <class Real>
class Reader {
 public:
  explicit Reader(Column<Real> column) : column_(column) {
    if (!column.each) filled_.fill(*column.data);
  }
  bool each() const { return column_.each; }
  const Real* from(std::size_t first) const {
    return column_.each ? column_.data + first : filled_.data();
  }

 private:
  Column<Real> column_;
  BlockColumn<Real> filled_;
};

// States that differ only in the contact coordinates. The loops take a block of them by value, so
// that the compiler sees that no result overwrites it.
template <class Real>
class Alike {
 public:
  struct StateBlock {
    Moments<Real> same_moments;
    PerSide<FrictionCone<Real>> cones;
    PerSide<PalmAngle<Real>> palms;
    PerSide<Real> offset;
    PerSide<const Real*> contacts;

    const Moments<Real>& moments(std::size_t) const { return same_moments; }
    const FrictionCone<Real>& cone(std::size_t side, std::size_t) const { return cones[side]; }
    Real rise(std::size_t i) const {
      return contact_vector<Real>({Real(0), palms, {contacts[left][i], contacts[right][i]}}, offset)
          .dy;
    }
  };

  explicit Alike(const StateColumns<Real>& columns)
      : same_{},
        contacts_{Reader<Real>(columns[state::contact]),
                  Reader<Real>(columns[state::contact + 1])} {
    const auto number = [&](std::size_t which) { return *columns[which].data; };
    same_.same_moments =
        Moments<Real>::of({number(state::width), number(state::com_left), number(state::com_right),
                           number(state::com_height), number(state::slope)});
    for (const std::size_t side : {left, right}) {
      const PalmAngle<Real> palm = PalmAngle<Real>::at(number(state::angle + side));
      same_.palms[side] = palm;
      same_.cones[side] = friction_cone<Real>({palm.sin, palm.cos}, number(state::friction + side));
      same_.offset[side] = number(state::offset + side);
    }
  }

  StateBlock from(std::size_t first, std::size_t) {
    same_.contacts = {contacts_[left].from(first), contacts_[right].from(first)};
    return same_;
  }

 private:
  StateBlock same_;
  PerSide<Reader<Real>> contacts_;
};

// States that may differ in every quantity.
template <class Real>
class Varied {
 public:
  struct StateBlock {
    std::array<const Real*, state::count> in;
    PerSide<const Real*> sin;
    PerSide<const Real*> cos;

    Moments<Real> moments(std::size_t i) const {
      return Moments<Real>::of({in[state::width][i], in[state::com_left][i],
                                in[state::com_right][i], in[state::com_height][i],
                                in[state::slope][i]});
    }
    PalmAngle<Real> palm(std::size_t side, std::size_t i) const {
      return {in[state::angle + side][i], sin[side][i], cos[side][i]};
    }
    FrictionCone<Real> cone(std::size_t side, std::size_t i) const {
      return friction_cone<Real>({sin[side][i], cos[side][i]}, in[state::friction + side][i]);
    }
    Real rise(std::size_t i) const {
      const Configuration<Real> configuration{Real(0),
                                              {palm(left, i), palm(right, i)},
                                              {in[state::contact][i], in[state::contact + 1][i]}};
      return contact_vector<Real>(configuration, {in[state::offset][i], in[state::offset + 1][i]})
          .dy;
    }
  };

  explicit Varied(const StateColumns<Real>& columns) : columns_(columns.begin(), columns.end()) {}

  StateBlock from(std::size_t first, std::size_t n) {
    StateBlock here{
        {}, {sin_[left].data(), sin_[right].data()}, {cos_[left].data(), cos_[right].data()}};
    for (std::size_t k = 0; k < state::count; ++k) here.in[k] = columns_[k].from(first);
    for (const std::size_t side : {left, right}) {
      const std::size_t angle = state::angle + side;
      if (first > 0 && !columns_[angle].each()) continue;  // same for all blocks
      const Real* angles = here.in[angle];
      for (std::size_t i = 0; i < n; ++i) {
        const SinCos<Real> at = sin_cos(angles[i]);
        sin_[side][i] = at.sin;
        cos_[side][i] = at.cos;
      }
    }
    return here;
  }

 private:
  std::vector<Reader<Real>> columns_;
  PerSide<BlockColumn<Real>> sin_;
  PerSide<BlockColumn<Real>> cos_;
};

// What one loop passes to the next: contact vectors, the ends of I_L and I_R, and the bits.
template <class Real>
struct BlockColumns {
  BlockColumn<Real> dx;
  BlockColumn<Real> dy;
  PerSide<BlockColumn<Real>> low;
  PerSide<BlockColumn<Real>> high;
  BlockColumn<Real> bits;
};

// The number with one bit set, or 0.
template <int bit, class Real>
constexpr Real flag(bool condition) {
  constexpr Real set = 1 << bit;
  constexpr Real none = 0;
  return condition ? set : none;
}

// The vectors from the left contacts to the right ones [m].
template <class Real, class StateBlock>
void place(const StateBlock states, std::size_t n, BlockColumns<Real>& __restrict at) {
  for (std::size_t i = 0; i < n; ++i) {
    const Real w = states.moments(i).width;
    const Real dy = states.rise(i);
    at.dy[i] = dy;
    at.dx[i] = std::sqrt((w - dy) * (w + dy));
  }
}

// The squeezes at the four edges. States where they are not the ends of I_L and I_R get the tenth
// bit.
template <class Real, class StateBlock>
void squeeze(const StateBlock states, std::size_t n, BlockColumns<Real>& __restrict at) {
  constexpr Real zero = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Real dx = at.dx[i];
    const Real dy = at.dy[i];
    const Moments<Real>& moments = states.moments(i);
    const FrictionCone<Real>& l = states.cone(left, i);
    const FrictionCone<Real>& r = states.cone(right, i);
    const Bound<Real> l_up = bound(moments, left, l.up, dx, dy);
    const Bound<Real> l_down = bound(moments, left, l.down, dx, dy);
    const Bound<Real> r_up = bound(moments, right, r.up, dx, dy);
    const Bound<Real> r_down = bound(moments, right, r.down, dx, dy);
    const Real l_up_a = l_up.a * moments.width;
    const Real l_down_a = l_down.a * moments.width;
    const Real r_up_a = r_up.a * moments.width;
    const Real r_down_a = r_down.a * moments.width;
    const Real l_high = l_up.b / l_up_a;
    const Real r_high = r_up.b / r_up_a;
    at.low[left][i] = l_down.b / l_down_a;
    at.high[left][i] = l_high;
    at.low[right][i] = r_down.b / r_down_a;
    at.high[right][i] = r_high;
    const bool plain = (l_up_a > zero) & (l_down_a > zero) & (r_up_a > zero) & (r_down_a > zero) &
                       (l_high == l_high) & (r_high == r_high) & (l.up.lateral > l.down.lateral) &
                       (r.up.lateral > r.down.lateral);
    const bool reached = dx == dx;
    at.bits[i] = flag<modes, Real>(reached & !plain);
  }
}

// True if two sliding contacts need the same squeeze, up to rounding.
template <class Real>
constexpr bool meet(Real l, Real r) {
  return std::abs(l - r) <= squeeze_tolerance<Real> * (std::abs(l) + std::abs(r));
}

// The modes of states without the tenth bit. With an empty interval no mode balances, whatever the
// other numbers are.
template <class Real>
void balance(std::size_t n, BlockColumns<Real>& at) {
  for (std::size_t i = 0; i < n; ++i) {
    const Interval<Real> l{at.low[left][i], at.high[left][i]};
    const Interval<Real> r{at.low[right][i], at.high[right][i]};
    const bool held = (l.low <= l.high) & (r.low <= r.high);
    const bool l_under = held & (l.low <= r.high);
    const bool r_under = held & (r.low <= l.high);
    at.bits[i] +=
        flag<0, Real>(l_under & r_under) + flag<1, Real>(l_under & (r.high <= l.high)) +
        flag<2, Real>(r_under & (l.low <= r.low)) + flag<3, Real>(r_under & (l.high <= r.high)) +
        flag<4, Real>(held & meet(l.high, r.high)) + flag<5, Real>(held & meet(l.high, r.low)) +
        flag<6, Real>(l_under & (r.low <= l.low)) + flag<7, Real>(held & meet(l.low, r.high)) +
        flag<8, Real>(held & meet(l.low, r.low));
  }
}

// Stores the bits. Returns true if some states are left to `feasible`.
template <class Real>
bool store(std::size_t n, const BlockColumns<Real>& at, std::uint16_t* __restrict out) {
  int any = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const int bits = static_cast<int>(at.bits[i]);
    any |= bits;
    out[i] = static_cast<std::uint16_t>(bits);
  }
  return any >> modes != 0;
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

template <class States, class Real>
void run(const StateColumns<Real>& columns, std::size_t n, std::uint16_t* out) {
  States all(columns);
  BlockColumns<Real> at;
  for (std::size_t first = 0; first < n; first += block) {
    const std::size_t count = std::min(block, n - first);
    const auto states = all.from(first, count);
    place(states, count, at);
    squeeze(states, count, at);
    balance(count, at);
    if (!store(count, at, out + first)) continue;
    for (std::size_t i = 0; i < count; ++i) {
      if (out[first + i] >> modes == 0) continue;
      out[first + i] = feasible_bits<Real>(
          {states.moments(i), {states.cone(left, i), states.cone(right, i)}, at.dx[i], at.dy[i]});
    }
  }
}

}  // namespace batch

// Writes the bits of the contact modes that balance, for n states.
template <class Real>
void feasible_modes(const StateColumns<Real>& columns, std::size_t n, std::uint16_t* out) {
  const auto contacts = columns.begin() + state::contact;
  const bool alike = std::none_of(columns.begin(), contacts, [](const auto& c) { return c.each; });
  if (alike) {
    batch::run<batch::Alike<Real>>(columns, n, out);
  } else {
    batch::run<batch::Varied<Real>>(columns, n, out);
  }
}

}  // namespace palmbots
