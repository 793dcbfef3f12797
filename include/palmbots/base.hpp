// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `base`: gravity, the two sides, and numbers without a
// domain, that is scalar functions, SIMD lanes, random numbers and root finding.
#pragma once

#include "palmbots/base/gravity.hpp"
#include "palmbots/base/philox.hpp"
#include "palmbots/base/root_finding.hpp"
#include "palmbots/base/scalar.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/base/simd_registers.hpp"
#include "palmbots/base/small_linear.hpp"
