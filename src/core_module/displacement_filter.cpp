// SPDX-License-Identifier: Apache-2.0
// The likelihood of measured displacements, for arrays of chains and models.
#include "palmbots/robot/displacement_filter.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>

#include "bindings.hpp"

namespace palmbots::bindings {

namespace {

template <class T, std::size_t Dimensions>
using Array = nb::ndarray<const T, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<nb::numpy, double, nb::ndim<3>>;

std::pair<Result, Result> filtered(const Array<double, 3>& models, const Array<double, 2>& steps,
                                   const Array<double, 3>& measured, const Array<bool, 2>& starts,
                                   const Array<std::int64_t, 1>& lengths) {
  const std::size_t chains = steps.shape(0), most = steps.shape(1), count = models.shape(1);
  if (models.shape(0) != chains || models.shape(2) != 4 || measured.shape(0) != chains ||
      measured.shape(1) != most || measured.shape(2) != 2 || starts.shape(0) != chains ||
      starts.shape(1) != most || lengths.shape(0) != chains) {
    throw std::invalid_argument("filter_displacements: the shapes do not fit");
  }
  auto* sums = new std::vector<double>(4 * count * chains);
  auto* errors = new std::vector<double>(3 * most * chains);
  const nb::capsule of_sums = owner_of(sums), of_errors = owner_of(errors);
  {
    const nb::gil_scoped_release release;
    for (std::size_t chain = 0; chain < chains; ++chain) {
      std::vector<DisplacementModel> all(count);
      for (std::size_t i = 0; i < count; ++i) {
        const double* one = models.data() + 4 * (chain * count + i);
        all[i] = {one[0], one[1], one[2], one[3]};
      }
      const std::int64_t length = lengths.data()[chain];
      if (length < 0 || static_cast<std::size_t>(length) > most) continue;
      const auto found = DisplacementFilter(all).filter(
          {static_cast<std::size_t>(length), steps.data() + chain * most,
           measured.data() + 2 * chain * most,
           reinterpret_cast<const unsigned char*>(starts.data()) + chain * most},
          errors->data() + 3 * chain * most);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t part = 0; part < 4; ++part) {
          (*sums)[(part * count + i) * chains + chain] = found[i][part];
        }
      }
    }
  }
  return {Result(sums->data(), {4, count, chains}, of_sums),
          Result(errors->data(), {chains, most, 3}, of_errors)};
}

}  // namespace

void bind_displacement_filter(nb::module_& m) {
  m.def("filter_displacements", &filtered, nb::arg("models"), nb::arg("steps"), nb::arg("measured"),
        nb::arg("starts"), nb::arg("lengths"),
        "Σ log T, Σ y²/T, Σ y t/T and Σ t²/T of each model and chain; T, y and t of the first "
        "model, for each chain and position. Models: for each chain in rows τ, and the variances "
        "of the noise, of the white part in a second, and of the positions.");
}

}  // namespace palmbots::bindings
