// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `control`: what a robot or the station decides.
#pragma once

#include "palmbots/control/centralized.hpp"
#include "palmbots/control/distributed.hpp"
#include "palmbots/control/external.hpp"
#include "palmbots/control/lifting.hpp"
#include "palmbots/control/machine_table.hpp"
#include "palmbots/control/mailbox.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/control/resilient.hpp"
#include "palmbots/control/resilient_memory.hpp"
#include "palmbots/control/resilient_timing.hpp"
#include "palmbots/control/row_policy.hpp"
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/control/table.hpp"
#include "palmbots/control/table_robot.hpp"
#include "palmbots/control/transition_table.hpp"
