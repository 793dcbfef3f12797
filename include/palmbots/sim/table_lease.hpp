// SPDX-License-Identifier: Apache-2.0
// How long a robot with a table acts on its partner's last message. The time for `resilient` is in
// control/resilient_timing.hpp.
#pragma once

#include <algorithm>

#include "palmbots/control/table.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// The lease at which a robot just hears a partner whose beacons, one in each of these periods, are never
// lost: one round trip, as in control/resilient_timing.hpp [s].
inline double round_trip_of(const Spec& spec, double beacon) {
  const double step = spec.longest_period();
  return 2 * (std::max(spec.period, spec.longest_delay()) + beacon + step) +
         4 * (step - spec.period);
}

// The same for a table, which may send every second beacon only [s].
template <class Table>
double shortest_table_lease(const Spec& spec) {
  return round_trip_of(spec, (TableBeacons<Table>::spares ? 2 : 1) * spec.beacon);
}

// The lease where the scene gives none: three beacons in a row may be lost, or spared. In the default
// scene it is proved for this lease that no contact leaves its palm (docs/theory/verification.md) [s].
inline double table_lease(const Spec& spec) {
  return spec.lease > 0 ? spec.lease : round_trip_of(spec, spec.beacon) + 3 * spec.beacon;
}

}  // namespace palmbots
