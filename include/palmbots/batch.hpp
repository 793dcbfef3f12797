// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `batch`: up to 64 carries side by side.
#pragma once

#include "palmbots/batch/bitslice.hpp"
#include "palmbots/batch/bitslice_centralized.hpp"
#include "palmbots/batch/bitslice_counters.hpp"
#include "palmbots/batch/bitslice_io.hpp"
#include "palmbots/batch/bitslice_metrics.hpp"
#include "palmbots/batch/bitslice_queue.hpp"
#include "palmbots/batch/bitslice_table.hpp"
#include "palmbots/batch/bitslice_table_team.hpp"
#include "palmbots/batch/bitslice_teams.hpp"
#include "palmbots/batch/event_draws.hpp"
#include "palmbots/batch/lane_carries.hpp"
#include "palmbots/batch/lane_random_inputs.hpp"
#include "palmbots/batch/noise_draws.hpp"
