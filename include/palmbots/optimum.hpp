// SPDX-License-Identifier: Apache-2.0
// The room optimum: the least drop rate that any controller can reach, and a controller with full
// information that comes near it.
#pragma once

#include "palmbots/optimum/opening_policy.hpp"
#include "palmbots/optimum/opening_problem.hpp"
#include "palmbots/optimum/optimal_team.hpp"
#include "palmbots/optimum/value_iteration.hpp"
