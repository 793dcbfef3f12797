// SPDX-License-Identifier: Apache-2.0
// Packets: messages as bytes. All headers of the room.
#pragma once

#include "palmbots/wire/codec.hpp"
#include "palmbots/wire/endpoint.hpp"
#include "palmbots/wire/packet.hpp"
#include "palmbots/wire/replay_window.hpp"
#include "palmbots/wire/siphash.hpp"
