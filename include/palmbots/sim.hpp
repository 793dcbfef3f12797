// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `sim`: one carry, with spec, disturbances, teams over a radio,
// metrics and trace.
#pragma once

#include "palmbots/sim/build.hpp"
#include "palmbots/sim/bumps.hpp"
#include "palmbots/sim/carry.hpp"
#include "palmbots/sim/centralized_team.hpp"
#include "palmbots/sim/corruption.hpp"
#include "palmbots/sim/cosimulation.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/metrics.hpp"
#include "palmbots/sim/multilevel_splitting.hpp"
#include "palmbots/sim/no_controller.hpp"
#include "palmbots/sim/pushes.hpp"
#include "palmbots/sim/radio.hpp"
#include "palmbots/sim/radio_channel.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/robot_pair.hpp"
#include "palmbots/sim/robot_team.hpp"
#include "palmbots/sim/spec.hpp"
#include "palmbots/sim/table_team.hpp"
#include "palmbots/sim/team.hpp"
#include "palmbots/sim/team_registry.hpp"
