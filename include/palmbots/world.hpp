// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `world`: exact motion of the contacts over a step.
#pragma once

#include "palmbots/world/contact_constraints.hpp"
#include "palmbots/world/fast_step.hpp"
#include "palmbots/world/fast_step_tie.hpp"
#include "palmbots/world/general_step.hpp"
#include "palmbots/world/instant_motions.hpp"
#include "palmbots/world/multi_contact_step.hpp"
#include "palmbots/world/quasistatic_world.hpp"
#include "palmbots/world/state.hpp"
