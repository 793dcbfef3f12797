// SPDX-License-Identifier: Apache-2.0
// QEMU's machine mps2-an386, a Cortex-M4F with a real interrupt controller and SysTick, but neither radio
// nor servos. Everything that a robot senses and does passes through UART0, in the frames of
// palmbots/wire/serial_frame.hpp with kinds of their own. The program at the other end is the world
// (firmware/emulator/qemu.py); the control tick comes from it, so that both boards keep step with it.
#include "../board.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../../app/tick_record.hpp"
#include "../cortex_m4.hpp"
#include "../register.hpp"
#include "palmbots/wire/serial_frame.hpp"

extern "C" [[gnu::section(".vectors"), gnu::used]] constinit const auto vectors =
    palmbots::board::make_vectors<32>();

namespace palmbots::board {

namespace {

enum class Kind : std::uint8_t {
  packet = 0x01,  // of the radio, in both directions
  tick = 0x41,    // world → board: elapsed ticks (2 bytes), closed switches (2), held buttons (1)
  pulses = 0x42,  // board → world: three widths of 2 bytes [µs]
  done = 0x43,    // board → world: a tick is complete; the record of the tick
};

// UART0, a CMSDK UART: registers DATA, STATE, CTRL, INTSTATUS and BAUDDIV.
inline constexpr Registers<0x40004000, 4> UART{};
inline constexpr Registers<0xE000E100, 4> NVIC_ISER{};
inline constexpr Registers<0xE000E280, 4> NVIC_ICPR{};
constexpr std::uint32_t is_full_to_send = 1, has_received = 2;
// Control, reload and current value of SysTick, which counts slots of a fifth of a tick.
inline constexpr Registers<0xE000E010, 4> SYST{};
inline constexpr Register<0xE000ED04> SCB_ICSR{};
constexpr std::uint32_t cycles_per_us = 25, slots_per_tick = 5, counted = 1U << 16;
constexpr std::uint32_t clear_pending = 1U << 25;
// Permanent memory lasts until QEMU ends: RAM beyond that of the program, which is blank at power-up.
constexpr std::uintptr_t storage = 0x20010000;

wire::FrameDecoder decoder;
std::uint16_t elapsed, switches;  // of the newest tick; its ticks are not yet taken
std::uint8_t buttons;
std::array<RadioPacket, 16> packets;
std::size_t first, waiting;
std::uint32_t lost, slot_us, time_us, alarm_at;
bool is_alarm_set, has_slot;

void write(Kind kind, std::span<const std::uint8_t> content) {
  std::array<std::uint8_t, wire::max_frame> frame;
  const std::size_t size = wire::encode_frame(static_cast<wire::FrameKind>(kind), content, frame);
  for (std::size_t i = 0; i < size; ++i) {
    while ((UART[1] & is_full_to_send) != 0) {
    }
    UART[0] = frame[i];
  }
}

void take_from_radio(std::span<const std::uint8_t> bytes) {
  if (waiting == packets.size() || bytes.size() > RadioPacket::most_bytes) {
    ++lost;
    return;
  }
  RadioPacket& packet = packets[(first + waiting++) % packets.size()];
  packet.size = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) packet.bytes[i] = bytes[i];
}

void take(const wire::Frame& frame) {
  if (frame.kind == static_cast<std::uint8_t>(Kind::packet)) {
    take_from_radio(frame.content);
  } else if (frame.kind == static_cast<std::uint8_t>(Kind::tick) && frame.content.size() == 5) {
    const auto number = [&](std::size_t at) {
      return static_cast<std::uint16_t>(frame.content[at] | frame.content[at + 1] << 8);
    };
    elapsed = number(0);
    switches = number(2);
    buttons = frame.content[4];
  }
}

void look() {
  serve_radio();
  if ((SYST[0] & counted) == 0) return;  // reading clears it
  SCB_ICSR = clear_pending;
  time_us += slot_us;
  has_slot = true;
}

}  // namespace

void start() {
  UART[4] = 16;
  UART[2] = 0b1011;  // sends, receives, and interrupts when a byte has arrived
  NVIC_ISER[0] = 1;
}
void sleep() { wait_for_interrupt(); }

void start_ticks(std::uint32_t period_us) {
  slot_us = period_us / slots_per_tick;
  SYST[1] = slot_us * cycles_per_us - 1;
  SYST[2] = 0;
  SYST[0] = 0b111;  // from the processor's clock, with an interrupt
}
std::uint16_t take_ticks() {
  look();
  const std::uint16_t taken = elapsed;
  elapsed = 0;
  return taken;
}
bool take_slot() {
  look();
  const bool taken = has_slot;
  has_slot = false;
  return taken;
}
std::uint32_t now_us() {
  look();
  return time_us;
}
void set_alarm(std::uint32_t delay_us) {
  alarm_at = now_us() + delay_us;
  is_alarm_set = true;
}
bool take_alarm() {
  look();
  if (!is_alarm_set || static_cast<std::int32_t>(time_us - alarm_at) < 0) return false;
  is_alarm_set = false;
  return true;
}

void start_radio(std::uint8_t, std::int8_t) {}
bool take_packet(RadioPacket& packet) {
  if (waiting == 0) return false;
  packet = packets[first];
  first = (first + 1) % packets.size();
  --waiting;
  return true;
}
bool send(const RadioPacket& packet) {
  write(Kind::packet, {packet.bytes.data(), packet.size});
  return true;
}
bool is_sending() { return false; }
void serve_radio() {
  // No byte after a tick is taken before the tick has been: it belongs to the next one.
  while (elapsed == 0 && (UART[1] & has_received) != 0) {
    const auto byte = static_cast<std::uint8_t>(UART[0]);
    UART[3] = 0b10;
    if (decoder.take(byte)) take(decoder.frame());
  }
  NVIC_ICPR[0] = 1;
}
std::uint32_t lost_packets() { return lost; }
std::uint32_t damaged_packets() { return 0; }

void start_servos() {}
void write_servos(const Pulses& pulses) {
  std::uint8_t content[8];
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    content[2 * i] = static_cast<std::uint8_t>(pulses[i] & 255);
    content[2 * i + 1] = static_cast<std::uint8_t>(pulses[i] >> 8);
  }
  write(Kind::pulses, content);
}
void start_switches() {}
std::uint16_t read_switches() { return switches; }
std::uint8_t read_buttons() { return buttons; }

const std::uint32_t* page(std::size_t number) {
  return reinterpret_cast<const std::uint32_t*>(storage) + number * words_per_page;
}
void write_word(std::size_t number, std::size_t word, std::uint32_t value) {
  const_cast<std::uint32_t*>(page(number))[word] &= value;
}
void erase_page(std::size_t number) {
  for (std::size_t i = 0; i < words_per_page; ++i) {
    const_cast<std::uint32_t*>(page(number))[i] = 0xFFFFFFFF;
  }
}

// The world ends QEMU if no record of a tick arrives.
void start_watchdog(std::uint32_t) {}
void feed_watchdog() {
  write(Kind::done, {reinterpret_cast<const std::uint8_t*>(&tick_record), sizeof tick_record});
}

// No source of randomness, and nothing to collide with: the count of SysTick will do.
std::uint32_t random_word() { return Register<0xE000E018>{} * 2654435761U + 1; }

// What this board does not have: LEDs, a battery, a motor board, the station's serial line.
void show(std::uint32_t) {}
void next_row() {}
void start_battery(std::uint16_t) {}
std::uint16_t battery_mv() { return 3300; }
bool take_brown_out() { return false; }
void start_motor_board() {}
void write_motor_board(std::int16_t, std::int16_t) {}
bool motor_board_answers() { return false; }
void start_uart() {}
std::size_t read_uart(std::uint8_t*, std::size_t) { return 0; }
std::size_t uart_room() { return 0; }
void write_uart(const std::uint8_t*, std::size_t) {}
void serve_uart() {}

}  // namespace palmbots::board
