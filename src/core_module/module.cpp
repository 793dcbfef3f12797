// SPDX-License-Identifier: Apache-2.0
// palmbots._core: the C++ core as Python sees it. Thin: no logic of its own.
#include <nanobind/stl/pair.h>

#include "bindings.hpp"
#include "palmbots/base/wilson.hpp"

NB_MODULE(_core, m) {
  m.doc() = "The compiled core of palmbots: mechanics, world, controllers, carries.";
  m.attr("z95") = palmbots::z95;
  m.def(
      "wilson",
      [](double events, double n, double z) {
        const auto [low, high] = palmbots::wilson(events, n, z);
        return std::pair{low, high};
      },
      nanobind::arg("events"), nanobind::arg("n"), nanobind::arg("z") = palmbots::z95,
      "Wilson's score interval of the rate of `events` in `n`; NaN where `n` is 0.");
  m.def(
      "rate_interval",
      [](double events, double n) {
        const auto [low, high] = palmbots::rate_interval(events, n);
        return std::pair{low, high};
      },
      nanobind::arg("events"), nanobind::arg("n"),
      "The 95 % interval of the rate of `events` in `n`; one-sided where none or all are events.");
  m.def(
      "supports_x86_level",
      []([[maybe_unused]] int level) {
#if defined(__x86_64__)
        const bool v3 = __builtin_cpu_supports("avx2") != 0 &&
                        __builtin_cpu_supports("bmi2") != 0 && __builtin_cpu_supports("fma") != 0;
        const bool v4 =
            v3 && __builtin_cpu_supports("avx512f") != 0 &&
            __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512cd") != 0 &&
            __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
        return level == 3 ? v3 : level == 4 && v4;
#else
        return false;
#endif
      },
      nanobind::arg("level"),
      "Has this processor the instructions of that level of x86-64, 3 (AVX2) or 4 (AVX-512)?");
  palmbots::bindings::bind_spec(m);
  palmbots::bindings::bind_scene(m);
  palmbots::bindings::bind_scene_limits(m);
  palmbots::bindings::bind_polygon(m);
  palmbots::bindings::bind_mechanics(m);
  palmbots::bindings::bind_modes_batch(m);
  palmbots::bindings::bind_stability(m);
  palmbots::bindings::bind_world(m);
  palmbots::bindings::bind_controllers(m);
  palmbots::bindings::bind_tables(m);
  palmbots::bindings::bind_machines(m);
  palmbots::bindings::bind_carry(m);
  palmbots::bindings::bind_splitting(m);
  palmbots::bindings::bind_cosimulation(m);
  palmbots::bindings::bind_episode(m);
  palmbots::bindings::bind_wire(m);
  palmbots::bindings::bind_serial_frames(m);
  palmbots::bindings::bind_runtime(m);
  palmbots::bindings::bind_mode_machine(m);
  palmbots::bindings::bind_multi_contact(m);
  palmbots::bindings::bind_optimum(m);
  palmbots::bindings::bind_displacement_filter(m);
}
