// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `world`: exact motion of the contacts over a step.
#pragma once

#include "palmbots/world/advance.hpp"
#include "palmbots/world/contact_regime.hpp"
#include "palmbots/world/contact_shapes.hpp"
#include "palmbots/world/contact_step.hpp"
#include "palmbots/world/fast_step.hpp"
#include "palmbots/world/fast_step_tie.hpp"
#include "palmbots/world/general_step.hpp"
#include "palmbots/world/quasistatic_world.hpp"
#include "palmbots/world/regime_choice.hpp"
#include "palmbots/world/regime_conditions.hpp"
#include "palmbots/world/rolling_step.hpp"
#include "palmbots/world/state.hpp"
#include "palmbots/world/travel.hpp"
