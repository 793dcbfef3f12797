// SPDX-License-Identifier: Apache-2.0
// Numbers without a domain: scalar functions, SIMD lanes, random numbers, root finding, sides. All
// headers of the room.
#pragma once

#include "palmbots/base/philox.hpp"
#include "palmbots/base/root_finding.hpp"
#include "palmbots/base/scalar.hpp"
#include "palmbots/base/side.hpp"
#include "palmbots/base/simd_lanes.hpp"
#include "palmbots/base/simd_registers.hpp"
#include "palmbots/base/small_linear.hpp"
