// SPDX-License-Identifier: Apache-2.0
// Contact modes of many states at once.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>

#include "bindings.hpp"
#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots::bindings {

namespace {

// A number per state: either one array element each, or one for all.
using Column = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Reader {
  const double* data;
  std::size_t step;
  double operator[](std::size_t i) const { return data[i * step]; }
};

// The nine contact modes in the order of their bits: left contact first, each in the order of
// `slip_directions`.
constexpr ContactMode mode_of(std::size_t bit) {
  return {slip_directions[bit / 3], slip_directions[bit % 3]};
}

// The bit of the mode that happens, or −1 if the object is not held, −2 if nothing lets go.
std::int8_t happening(const PerSide<Squeezes<double>>& of, SlipDirection direction) {
  const SelectedMode result = selected_mode(of, direction);
  if (!result.balanced) return -1;
  if (result.jammed) return -2;
  for (std::size_t bit = 0; bit < 9; ++bit) {
    if (mode_of(bit) == result.mode) return static_cast<std::int8_t>(bit);
  }
  return -2;
}

// One state from its 13 numbers: w, COM from left, from right, height, s, and per palm (left,
// right) offset, friction, angle, contact coordinate.
Contacts<double> contacts_of(const double (&v)[13]) {
  Configuration<double> configuration{};
  Contacts<double> at{};
  at.moments = Moments<double>::of({v[0], v[1], v[2], v[3], v[4]});
  for (const std::size_t side : {left, right}) {
    configuration.palms[side] = PalmAngle<double>::at(v[9 + side]);
    configuration.contacts[side] = v[11 + side];
    at.cones[side] = friction_cone<double>(
        {configuration.palms[side].sin, configuration.palms[side].cos}, v[7 + side]);
  }
  const PerSide<double> offset{v[5], v[6]};
  at.dy = contact_vector(configuration, offset).dy;
  at.dx = std::sqrt((v[0] - at.dy) * (v[0] + at.dy));
  return at;
}

template <class T>
auto numpy(std::vector<T>&& values) {
  auto* kept = new std::vector<T>(std::move(values));
  return nb::ndarray<nb::numpy, T, nb::ndim<1>>(kept->data(), {kept->size()}, owner_of(kept));
}

nb::tuple acting_objects(const Spec& spec, const PerSide<Column>& angles,
                         const PerSide<Column>& places) {
  const std::size_t n = angles[left].size();
  for (const Column& column : {angles[right], places[left], places[right]}) {
    if (column.size() != n) throw std::invalid_argument("acting_objects: n numbers of each kind");
  }
  const Model<double> model = model_of<double>(spec);
  std::array<std::vector<double>, 6> out;
  for (auto& column : out) column.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Configuration<double> at{};
    for (const std::size_t side : {left, right}) {
      at.palms[side] = PalmAngle<double>::at(angles[side].data()[i]);
      at.contacts[side] = places[side].data()[i];
    }
    const double rise = contact_vector(at, model.offset).dy;
    const bool reaches = is_pipe(model.object);  // from its one centre to itself
    const double run =
        reaches ? 0 : std::sqrt((model.object.width - rise) * (model.object.width + rise));
    const ActingObject<double> acting =
        acting_object(model.object, contact_radii(model.outline), at.palms, {run, rise});
    const ObjectParams<double>& object = acting.object;
    const double numbers[] = {
        acting.contact_vector.dx, acting.contact_vector.dy, object.width,
        object.com_left,          object.com_right,         object.com_height};
    for (std::size_t k = 0; k < out.size(); ++k) out[k][i] = reaches || run > 0 ? numbers[k] : nan;
  }
  return nb::make_tuple(numpy(std::move(out[0])), numpy(std::move(out[1])),
                        numpy(std::move(out[2])), numpy(std::move(out[3])),
                        numpy(std::move(out[4])), numpy(std::move(out[5])));
}

nb::tuple contact_modes(const std::vector<Column>& columns, std::size_t n) {
  if (columns.size() != 13) throw std::invalid_argument("contact_modes: 13 columns");
  Reader in[13];
  for (std::size_t k = 0; k < 13; ++k) {
    if (columns[k].size() != 1 && columns[k].size() != n) {
      throw std::invalid_argument("contact_modes: a column has one number, or one for each state");
    }
    in[k] = {columns[k].data(), columns[k].size() == 1 ? std::size_t{0} : std::size_t{1}};
  }
  std::vector<double> ends[4];
  for (auto& end : ends) end.resize(n);
  std::vector<std::uint16_t> feasible_bits(n);
  std::vector<std::int8_t> closing(n);
  std::vector<std::int8_t> opening(n);
  {
    const nb::gil_scoped_release release;
    for (std::size_t i = 0; i < n; ++i) {
      double v[13];
      for (std::size_t k = 0; k < 13; ++k) v[k] = in[k][i];
      const PerSide<Squeezes<double>> of = squeezes(contacts_of(v));
      for (const std::size_t side : {left, right}) {
        const Interval<double> h = of[side].all;
        ends[2 * side][i] = h.low;
        ends[2 * side + 1][i] = h.high;
      }
      unsigned bits = 0;
      unsigned bit = 0;
      for (const bool balances : balanced_modes(of)) bits |= (balances ? 1U : 0U) << bit++;
      feasible_bits[i] = static_cast<std::uint16_t>(bits);
      closing[i] = happening(of, SlipDirection::up);
      opening[i] = happening(of, SlipDirection::down);
    }
  }
  return nb::make_tuple(numpy(std::move(ends[0])), numpy(std::move(ends[1])),
                        numpy(std::move(ends[2])), numpy(std::move(ends[3])),
                        numpy(std::move(feasible_bits)), numpy(std::move(closing)),
                        numpy(std::move(opening)));
}

}  // namespace

void bind_mechanics(nb::module_& m) {
  m.def(
      "acting_objects", &acting_objects, nb::arg("spec"), nb::arg("angles"), nb::arg("places"),
      "For n states: vectors (x, y) between the points that touch the palms, their distances, and "
      "those of the COM from the left and the right one along their line and above it [m]; nan: "
      "out "
      "of reach.");
  m.def(
      "clear_cones",
      [](const Spec& spec) {
        const PerSide<ClearCone<double>> clear = model_of<double>(spec).clear;
        return std::array{std::pair(clear[left].low, clear[left].high),
                          std::pair(clear[right].low, clear[right].high)};
      },
      nb::arg("spec"),
      "The tangents of the angles between a palm and the object at which they touch only at the "
      "contact vertex, however long the palm is.");
  m.def("contact_modes", &contact_modes, nb::arg("columns"), nb::arg("n"),
        "For n states: ends of I_L and I_R, bits of the contact modes that balance, and those "
        "that occur on closing and opening (-1: not held, -2: jammed).");
  m.def(
      "margin",
      [](const std::vector<double>& values, double angle_left, double angle_right) {
        if (values.size() != 13) throw std::invalid_argument("margin: 13 numbers");
        double v[13];
        for (std::size_t k = 0; k < 13; ++k) v[k] = values[k];
        const Contacts<double> at = contacts_of(v);
        return friction_margin<double>(at.moments, {sin_cos(v[9]), sin_cos(v[10])},
                                       {angle_left, angle_right}, at.dx, at.dy);
      },
      nb::arg("values"), nb::arg("friction_angle_left"), nb::arg("friction_angle_right"),
      "The angle [rad] by which both friction cones may shrink with the object still held.");
}

}  // namespace palmbots::bindings
