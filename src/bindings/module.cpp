// palmbots._core: the C++ core as Python sees it. Thin: no logic of its own.
#include "bindings.hpp"

NB_MODULE(_core, m) {
  m.doc() = "The compiled core of palmbots: mechanics, world, controllers, carries.";
  m.def("tangent", &palmbots::tangent<double>, nanobind::arg("angle"),
        "Tangent of an angle [rad], |angle| < pi/2, the same bits on every system.");
  m.def(
      "has_v3",
      [] {
#if defined(__x86_64__)
        return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi2") != 0 &&
               __builtin_cpu_supports("fma") != 0;
#else
        return false;
#endif
      },
      "Has this processor the instructions of level x86-64-v3?");
  palmbots::bindings::bind_spec(m);
  palmbots::bindings::bind_mechanics(m);
  palmbots::bindings::bind_modes_batch(m);
  palmbots::bindings::bind_stability(m);
  palmbots::bindings::bind_world(m);
  palmbots::bindings::bind_controllers(m);
  palmbots::bindings::bind_run(m);
  palmbots::bindings::bind_splitting(m);
  palmbots::bindings::bind_crew(m);
  palmbots::bindings::bind_episode(m);
  palmbots::bindings::bind_wire(m);
  palmbots::bindings::bind_wrench(m);
}
