// SPDX-License-Identifier: Apache-2.0
// The room optimum: the least drop rate that a controller can reach whose robots keep driving, and
// references with more information than robots have.
#pragma once

#include "palmbots/optimum/linear_team.hpp"
#include "palmbots/optimum/opening_policy.hpp"
#include "palmbots/optimum/opening_problem.hpp"
#include "palmbots/optimum/optimal_team.hpp"
#include "palmbots/optimum/reference_team.hpp"
#include "palmbots/optimum/sign_filter.hpp"
#include "palmbots/optimum/standing_team.hpp"
#include "palmbots/optimum/value_iteration.hpp"
