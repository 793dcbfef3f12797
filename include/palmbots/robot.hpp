// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `robot`: sensor and actuator models.
#pragma once

#include "palmbots/robot/actuators.hpp"
#include "palmbots/robot/tactile_sensor.hpp"
