// SPDX-License-Identifier: Apache-2.0
// The board mps2-an386 of QEMU has neither radio nor servos. Everything that a robot senses and does
// passes through UART0, in the frames of palmbots/wire/serial_frame.hpp with kinds of their own. The
// program at the other end is the world.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palmbots::board::line {

enum class Kind : std::uint8_t {
  packet = 0x01,  // of the radio, in both directions
  tick = 0x41,    // world → board: elapsed ticks (2 bytes), closed switches (2), held buttons (1)
  pulses = 0x42,  // board → world: three widths of 2 bytes [µs]
  done = 0x43,    // board → world: a tick is complete; the record of the tick
};

void start();
// Takes the bytes that have arrived.
void serve();
void write(Kind kind, std::span<const std::uint8_t> content);

// What the newest frame `tick` said.
struct Tick {
  std::uint16_t elapsed = 0;  // not yet taken
  std::uint16_t switches = 0;
  std::uint8_t buttons = 0;
};
Tick& newest_tick();

// A packet has arrived (radio.cpp).
void take_packet(std::span<const std::uint8_t> bytes);

}  // namespace palmbots::board::line
