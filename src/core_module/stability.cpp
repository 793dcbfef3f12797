// SPDX-License-Identifier: Apache-2.0
// Bands, envelopes and the map over both angles.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <limits>

#include "bindings.hpp"
#include "palmbots/stability/tolerance.hpp"

namespace palmbots::bindings {

namespace {

using Numbers2 = std::pair<double, double>;
using Sides = std::array<Numbers2, 2>;
using Angles = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

Interval<double> interval(Numbers2 ends) { return {ends.first, ends.second}; }
PerSide<Interval<double>> intervals(const Sides& ends) {
  return {interval(ends[left]), interval(ends[right])};
}
Numbers2 ends_of(Interval<double> i) { return {i.low, i.high}; }

// Angles (shallow, steep) of the left and the right palm [rad].
PerSide<AnglePair<double>> angles_of(const Sides& angles) {
  const auto pair = [](Numbers2 a) {
    return AnglePair<double>{PalmAngle<double>::at(a.first), PalmAngle<double>::at(a.second)};
  };
  return {pair(angles[left]), pair(angles[right])};
}

const Property& property_of(int number) {
  if (number < 0 || number > 2) throw std::out_of_range("property is 0, 1 or 2");
  return properties[number];
}

std::size_t side_of(std::size_t side) {
  if (side > 1) throw std::out_of_range("side is 0 (left) or 1 (right)");
  return side;
}

auto grid(std::vector<double>&& values, std::size_t rows, std::size_t columns) {
  auto* kept = new std::vector<double>(std::move(values));
  return nb::ndarray<nb::numpy, double, nb::ndim<2>>(kept->data(), {rows, columns}, owner_of(kept));
}

using ReachMap = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// Tolerance and clearance at every pair of angles. `reach`: how far out the contacts may be there;
// an empty array leaves the envelope's own region. −inf: steep is not above shallow; the clearance
// is looked at only where the tolerance is not negative.
nb::tuple design_map(const OperatingEnvelope<double>& envelope, const Angles& shallow,
                     const Angles& steep, Numbers2 com_x, int quantity, double most,
                     const ReachMap& reach) {
  if (quantity < 0 || quantity > 4) throw std::out_of_range("quantity is 0 to 4");
  const std::size_t rows = shallow.size();
  const std::size_t columns = steep.size();
  const bool own_region = reach.size() == 0;
  if (!own_region && (reach.shape(0) != rows || reach.shape(1) != columns)) {
    throw std::invalid_argument("reach: one number for each pair of angles");
  }
  constexpr double none = -std::numeric_limits<double>::infinity();
  std::vector<double> tolerances(rows * columns, none);
  std::vector<double> clearances(rows * columns, none);
  {
    const nb::gil_scoped_release release;
    std::vector<PalmAngle<double>> across(columns);
    for (std::size_t j = 0; j < columns; ++j) across[j] = PalmAngle<double>::at(steep.data()[j]);
    OperatingEnvelope<double> here = envelope;
    for (std::size_t i = 0; i < rows; ++i) {
      const auto down = PalmAngle<double>::at(shallow.data()[i]);
      for (std::size_t j = 0; j < columns; ++j) {
        if (!(down.angle < across[j].angle)) continue;
        const std::size_t at = i * columns + j;
        if (!own_region) {
          const double far = reach.data()[at];
          here.contacts = {Interval<double>{-far, far}, Interval<double>{-far, far}};
        }
        const AnglePair<double> pair{down, across[j]};
        tolerances[at] = tolerance<double>(here, interval(com_x), static_cast<Quantity>(quantity),
                                           most, {pair, pair});
        if (tolerances[at] >= 0) clearances[at] = clearance_margin<double>(here, {pair, pair});
      }
    }
  }
  return nb::make_tuple(grid(std::move(tolerances), rows, columns),
                        grid(std::move(clearances), rows, columns));
}

}  // namespace

void bind_stability(nb::module_& m) {
  using E = OperatingEnvelope<double>;
  nb::class_<E>(m, "OperatingEnvelope", "Everything under which the properties have to hold.")
      .def(
          "__init__",
          [](E* self, const Spec& spec, Numbers2 com_y, const Sides& friction, bool common,
             Numbers2 slope, const Sides& contacts, double beyond) {
            const Model<double> model = model_of<double>(spec);
            new (self) E{spec.width,
                         model.offset,
                         interval(com_y),
                         {intervals(friction), common},
                         interval(slope),
                         intervals(contacts),
                         beyond,
                         model.clear,
                         contact_radii(model.outline)};
          },
          nb::arg("spec"), nb::arg("com_y"), nb::arg("friction"), nb::arg("common"),
          nb::arg("slope"), nb::arg("contacts"), nb::arg("beyond"))
      .def(
          "com_x_of",
          [](const E& self, int property, std::size_t shallow, const Sides& angles) {
            if (property != 1 && property != 2) throw std::out_of_range("property is 1 or 2");
            return ends_of(com_x_of(self, property, side_of(shallow), angles_of(angles)));
          },
          nb::arg("property"), nb::arg("shallow"), nb::arg("angles"))
      .def(
          "com_x_held",
          [](const E& self, const Sides& angles) {
            return ends_of(com_x_held(self, angles_of(angles)));
          },
          nb::arg("angles"))
      .def(
          "com_x_all",
          [](const E& self, const Sides& angles, Numbers2 wanted) {
            return ends_of(com_x_all(self, angles_of(angles), interval(wanted)));
          },
          nb::arg("angles"), nb::arg("wanted"))
      .def(
          "clearance",
          [](const E& self, const Sides& angles) {
            return clearance_margin(self, angles_of(angles));
          },
          nb::arg("angles"))
      .def(
          "pose",
          [](const E& self, int property, std::size_t shallow, Numbers2 angles, Numbers2 rise) {
            const PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(angles.first),
                                                   PalmAngle<double>::at(angles.second)};
            Clearance<double> clearance(self);
            clearance.look(palms, interval(rise));
            const Interval<double> permitted = detail::com_x_at(
                self, property_of(property), side_of(shallow), palms, interval(rise));
            return std::tuple(permitted.low, permitted.high, clearance.least());
          },
          nb::arg("property"), nb::arg("shallow"), nb::arg("angles"), nb::arg("rise"),
          "At exact angles (left, right) and height differences of the contacts: the lowest and "
          "the "
          "highest c_x that a property permits, and the clearance.")
      .def(
          "map", &design_map, nb::arg("shallow"), nb::arg("steep"), nb::arg("com_x"),
          nb::arg("quantity"), nb::arg("most"), nb::arg("reach"),
          "Tolerance of a quantity (0 COM, 1 friction, 2 slope, 3 contacts, 4 angle) and clearance "
          "[rad] at every pair of angles, alike for both palms.");

  m.def(
      "com_interval",
      [](int property, std::size_t shallow, double width, double slope, const Sides& friction,
         bool common, std::array<double, 2> angles, double rise, std::array<double, 2> radius) {
        const PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(angles[left]),
                                               PalmAngle<double>::at(angles[right])};
        const ComInterval<double> bounds = com_interval<double>(
            property_of(property), side_of(shallow), palms, {intervals(friction), common}, width,
            slope, contact_vector_at(rise, width), {radius[left], radius[right]});
        return std::tuple(bounds.x, bounds.y, bounds.low, bounds.high,
                          static_cast<int>(bounds.low_by), static_cast<int>(bounds.high_by));
      },
      nb::arg("property"), nb::arg("shallow"), nb::arg("width"), nb::arg("slope"),
      nb::arg("friction"), nb::arg("common"), nb::arg("angles"), nb::arg("rise"), nb::arg("radius"),
      "The permitted COMs (x, y, low, high, what binds at low, at high) at one height difference.");
  m.def(
      "rise_over",
      [](int property, std::size_t shallow, const Sides& contacts, double beyond,
         std::array<double, 2> angles, std::array<double, 2> offset) {
        property_of(property);
        const PerSide<PalmAngle<double>> palms{PalmAngle<double>::at(angles[left]),
                                               PalmAngle<double>::at(angles[right])};
        return ends_of(rise_over<double>(
            region_of<double>(property, side_of(shallow), intervals(contacts), beyond), palms,
            {offset[left], offset[right]}));
      },
      nb::arg("property"), nb::arg("shallow"), nb::arg("contacts"), nb::arg("beyond"),
      nb::arg("angles"), nb::arg("offset"),
      "The height differences of the contacts over a property's region.");
}

}  // namespace palmbots::bindings
