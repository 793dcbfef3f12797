// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `stability`: over which centres of mass, errors and regions the
// properties hold.
#pragma once

#include "palmbots/stability/com_bounds.hpp"
#include "palmbots/stability/operating_envelope.hpp"
#include "palmbots/stability/safe_reach.hpp"
#include "palmbots/stability/tolerance.hpp"
