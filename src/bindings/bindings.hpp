// What the parts of the nanobind module share.
#pragma once

#include <nanobind/nanobind.h>

#include <vector>

#include "palmbots/carry.hpp"

namespace palmbots::bindings {

namespace nb = nanobind;

inline constexpr const char* result_names[] = {"running", "delivered", "dropped", "stalled"};
inline constexpr const char* touch_names[] = {"", "flush", "tip"};
inline constexpr const char* end_names[] = {"",    "off-palm", "sliding", "flush",
                                            "tip", "tipping",  "jammed",  "lifting"};
inline constexpr const char* letter_names[] = {"",    "TiltUp",  "TiltDown",
                                               "Ack", "Closing", "Raised"};

void bind_spec(nb::module_& m);
void bind_mechanics(nb::module_& m);
void bind_modes_batch(nb::module_& m);
void bind_stability(nb::module_& m);
void bind_world(nb::module_& m);
void bind_controllers(nb::module_& m);
void bind_run(nb::module_& m);
void bind_splitting(nb::module_& m);
void bind_crew(nb::module_& m);
void bind_episode(nb::module_& m);
void bind_wire(nb::module_& m);
void bind_wrench(nb::module_& m);

// A C++ vector handed over to NumPy without a copy.
template <class T>
nb::capsule owner_of(std::vector<T>* values) {
  return nb::capsule(values, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
}

}  // namespace palmbots::bindings
