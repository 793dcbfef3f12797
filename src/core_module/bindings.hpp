// SPDX-License-Identifier: Apache-2.0
// What the parts of the nanobind module share.
#pragma once

#include <nanobind/nanobind.h>

#include <vector>

#include "palmbots/sim/carry.hpp"
#include "palmbots/sim/scene_values.hpp"

namespace palmbots::bindings {

namespace nb = nanobind;

void bind_spec(nb::module_& m);
void bind_scene(nb::module_& m);
void bind_scene_limits(nb::module_& m);
void bind_polygon(nb::module_& m);
void bind_mechanics(nb::module_& m);
void bind_modes_batch(nb::module_& m);
void bind_stability(nb::module_& m);
void bind_world(nb::module_& m);
void bind_controllers(nb::module_& m);
void bind_tables(nb::module_& m);
void bind_machines(nb::module_& m);
void bind_carry(nb::module_& m);
void bind_splitting(nb::module_& m);
void bind_cosimulation(nb::module_& m);
void bind_episode(nb::module_& m);
void bind_wire(nb::module_& m);
void bind_serial_frames(nb::module_& m);
void bind_runtime(nb::module_& m);
void bind_mode_machine(nb::module_& m);
void bind_multi_contact(nb::module_& m);
void bind_optimum(nb::module_& m);
void bind_displacement_filter(nb::module_& m);

// The values of the tables of a scene, as Python gives them.
SceneValues values_of(const nb::dict& table);

// The names that the core gives to an enumeration of consecutive values from 0 to `last`, in order.
template <class Enum>
nb::tuple names_to(Enum last) {
  nb::list names;
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    names.append(nb::str(name_of(static_cast<Enum>(i))));
  }
  return nb::tuple(names);
}

// A C++ vector handed over to NumPy without a copy.
template <class T>
nb::capsule owner_of(std::vector<T>* values) {
  return nb::capsule(values, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
}

}  // namespace palmbots::bindings
