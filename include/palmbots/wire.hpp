// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `wire`: packets, that is messages as bytes, and serial frames.
#pragma once

#include "palmbots/wire/device_frames.hpp"
#include "palmbots/wire/endpoint.hpp"
#include "palmbots/wire/packet.hpp"
#include "palmbots/wire/payload.hpp"
#include "palmbots/wire/robot_mode.hpp"
#include "palmbots/wire/serial_frame.hpp"
#include "palmbots/wire/siphash.hpp"
