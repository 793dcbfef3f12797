// SPDX-License-Identifier: Apache-2.0
// Which of the nine contact modes balance, for many states at once, as one bit for each mode: bit k
// for the k-th of `balanced_modes` (mechanics/contact_modes.hpp). Several states are evaluated in
// lanes (base/simd_lanes.hpp). Where the object cannot reach, dx is not a number, and no mode balances.
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>

#include "bindings.hpp"
#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots::bindings {

namespace {

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

// Writes the bits of the contact modes that balance, for n states.
void feasible_modes(const StateColumns& columns, std::size_t n, std::uint16_t* out) {
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
    V::Mask::Raw bits{};
    V::In::Int bit = 1;
    for (const V::Mask& balances : balanced_modes(squeezes(at))) {
      bits |= balances.raw & bit;
      bit *= 2;
    }
    for (std::size_t l = 0; l < V::count && first + l < n; ++l)
      out[first + l] = static_cast<std::uint16_t>(bits[l]);
  }
}

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using BitsArray = nb::ndarray<nb::numpy, std::uint16_t, nb::ndim<1>>;

BitsArray feasible_of(const std::vector<Numbers>& columns, std::size_t n) {
  StateColumns states{};
  if (columns.size() != states.size()) throw std::invalid_argument("feasible_modes: 13 columns");
  for (std::size_t k = 0; k < states.size(); ++k) {
    const std::size_t size = columns[k].size();
    if (size != 1 && size != n) {
      throw std::invalid_argument("feasible_modes: a column has one number, or one for each state");
    }
    states[k] = {columns[k].data(), size != 1};
  }
  auto* bits = new std::uint16_t[n];
  const nb::capsule owner(bits, [](void* p) noexcept { delete[] static_cast<std::uint16_t*>(p); });
  {
    const nb::gil_scoped_release release;
    feasible_modes(states, n, bits);
  }
  return {bits, {n}, owner};
}

}  // namespace

void bind_modes_batch(nb::module_& m) {
  m.def("feasible_modes", &feasible_of, nb::arg("columns"), nb::arg("n"),
        "For n states: bits of the contact modes that balance. Columns as in `modes`.");
}

}  // namespace palmbots::bindings
