// SPDX-License-Identifier: Apache-2.0
#include "line.hpp"

#include <array>

#include "../register.hpp"
#include "palmbots/wire/serial_frame.hpp"

namespace palmbots::board::line {

namespace {

// UART0, a CMSDK UART: registers DATA, STATE, CTRL, INTSTATUS and BAUDDIV.
inline constexpr Registers<0x40004000, 4> UART{};
inline constexpr Registers<0xE000E100, 4> NVIC_ISER{};
inline constexpr Registers<0xE000E280, 4> NVIC_ICPR{};
constexpr std::uint32_t is_full_to_send = 1, has_received = 2;

wire::FrameDecoder decoder;
Tick tick;

void take(const wire::Frame& frame) {
  if (frame.kind == static_cast<std::uint8_t>(Kind::packet)) {
    take_packet(frame.content);
  } else if (frame.kind == static_cast<std::uint8_t>(Kind::tick) && frame.content.size() == 5) {
    const auto number = [&](std::size_t at) {
      return static_cast<std::uint16_t>(frame.content[at] | frame.content[at + 1] << 8);
    };
    tick = {number(0), number(2), frame.content[4]};
  }
}

}  // namespace

void start() {
  UART[4] = 16;
  UART[2] = 0b1011;  // sends, receives, and interrupts when a byte has arrived
  NVIC_ISER[0] = 1;
}

void serve() {
  // No byte after a tick is taken before the tick has been: it belongs to the next one.
  while (tick.elapsed == 0 && (UART[1] & has_received) != 0) {
    const auto byte = static_cast<std::uint8_t>(UART[0]);
    UART[3] = 0b10;
    if (decoder.take(byte)) take(decoder.frame());
  }
  NVIC_ICPR[0] = 1;
}

void write(Kind kind, std::span<const std::uint8_t> content) {
  std::array<std::uint8_t, wire::max_frame> frame;
  const std::size_t size = wire::encode_frame(static_cast<wire::FrameKind>(kind), content, frame);
  for (std::size_t i = 0; i < size; ++i) {
    while ((UART[1] & is_full_to_send) != 0) {
    }
    UART[0] = frame[i];
  }
}

Tick& newest_tick() { return tick; }

}  // namespace palmbots::board::line
