// SPDX-License-Identifier: Apache-2.0
// Which contact modes balance, for arrays of states.
#include "palmbots/mechanics/contact_modes_batch.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"

namespace palmbots::bindings {

namespace {

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
