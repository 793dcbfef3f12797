// SPDX-License-Identifier: Apache-2.0
// How long a robot with a table acts on its partner's last message. The time for `resilient` is in
// control/resilient_timing.hpp.
#pragma once

#include <algorithm>

#include "palmbots/sim/spec.hpp"

namespace palmbots {

// The lease at which a robot just hears a partner whose beacons are never lost: one round trip, as in
// control/resilient_timing.hpp [s].
inline double shortest_table_lease(const Spec& spec) {
  const double step = spec.longest_period();
  return 2 * (std::max(spec.period, spec.longest_delay()) + spec.beacon + step) +
         4 * (step - spec.period);
}

// The lease where the scene gives none: three beacons in a row may be lost. In the default scene it is
// proved for this lease that no contact leaves its palm (docs/theory/verification.md) [s].
inline double table_lease(const Spec& spec) {
  return spec.lease > 0 ? spec.lease : shortest_table_lease(spec) + 3 * spec.beacon;
}

}  // namespace palmbots
