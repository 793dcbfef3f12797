// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `runtime`: what a robot decides, without I/O.
#pragma once

#include "palmbots/runtime/controller_registry.hpp"
#include "palmbots/runtime/mode_inputs.hpp"
#include "palmbots/runtime/mode_machine.hpp"
#include "palmbots/runtime/program_maker.hpp"
#include "palmbots/runtime/robot_program.hpp"
#include "palmbots/runtime/robot_runtime.hpp"
#include "palmbots/runtime/station_runtime.hpp"
