// SPDX-License-Identifier: Apache-2.0
// Sensor and actuator models. All headers of the room.
#pragma once

#include "palmbots/robot/actuators.hpp"
#include "palmbots/robot/tactile_sensor.hpp"
