// SPDX-License-Identifier: Apache-2.0
// The acceleration of free fall, wherever weight acts: in the worlds, in limits of loads and slopes, and
// in the filter that turns accelerations of a robot into pushes of the object.
#pragma once

namespace palmbots {

inline constexpr double standard_gravity = 9.80665;  // [m/s²]

}  // namespace palmbots
