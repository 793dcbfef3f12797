// SPDX-License-Identifier: Apache-2.0
// The hardware interface: what a board offers to the programs in firmware/app.
//
// A board implements every function here, in one small file for each peripheral. Nothing waits, except
// that a write to permanent memory halts the processor (write_word, erase_page). docs/reference/board.md
// describes each function.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palmbots::board {

// --- startup.cpp

// Starts the clocks, leaves the debug port open, and puts all outputs at rest.
void start();
// Sleeps until one of the functions below has news. Returns at once if one has.
void sleep();

// --- timer.cpp: time, the control tick, and one alarm.

void start_ticks(std::uint32_t period_us);
// How many ticks have begun since the last call. 0: none. More than 1: the program was late.
std::uint16_t take_ticks();
// A fifth of a tick has begun since the last call.
bool take_slot();
std::uint32_t now_us();
void set_alarm(std::uint32_t delay_us);
// The alarm has rung since the last call.
bool take_alarm();

// --- random.cpp

// A number that nobody can predict.
std::uint32_t random_word();

// --- radio.cpp: packets of at most `most_bytes` bytes, protected by a checksum of the radio.

struct RadioPacket {
  static constexpr std::size_t most_bytes = 36;
  std::uint8_t size = 0;
  std::array<std::uint8_t, most_bytes> bytes{};
};

// `channel` is 0 to 100 [MHz above 2400], the power is in dBm.
void start_radio(std::uint8_t channel, std::int8_t power_dbm);
// Takes the oldest packet that has arrived. False: there is none.
bool take_packet(RadioPacket& packet);
// Starts to send. False: another packet is still being sent.
bool send(const RadioPacket& packet);
bool is_sending();
// Lets the radio go on after an event. To be called whenever `sleep` returns.
void serve_radio();
// How many packets arrived while there was no room for them.
std::uint32_t lost_packets();
// How many packets arrived with a wrong checksum.
std::uint32_t damaged_packets();

// --- servos.cpp: four pulses, repeated every 20 ms.

enum class Servo : std::uint8_t { palm, left_wheel, right_wheel, arm };
using Pulses = std::array<std::uint16_t, 4>;  // [µs]; 0: no pulse

void start_servos();
void write_servos(const Pulses& pulses);

// --- motor_board.cpp: wheels behind an I²C motor board.

void start_motor_board();
// Speeds from −255 to 255. Takes effect without waiting.
void write_motor_board(std::int16_t left, std::int16_t right);
// The board has taken the last command, or the one before if that is still on its way.
bool motor_board_answers();

// --- switches.cpp: nine switches as a 3 × 3 matrix.

void start_switches();
// Which switches are closed; bit 3 × row + column.
std::uint16_t read_switches();

// --- buttons.cpp

// Bit 0: button A is held, bit 1: button B.
std::uint8_t read_buttons();

// --- leds.cpp: 5 × 5 LEDs, of which one row shines at a time.

// Bit 5 × row + column; row 0 is at the top, column 0 at the left.
void show(std::uint32_t picture);
// Lights the next row. To be called in every slot.
void next_row();

// --- battery.cpp

void start_battery(std::uint16_t least_mv);
// The supply voltage [mV], measured at most a second ago.
std::uint16_t battery_mv();
// The supply has been below the least voltage since the last call.
bool take_brown_out();

// --- flash.cpp: permanent memory, two pages of words that are 0xFFFFFFFF after an erase.

inline constexpr std::size_t words_per_page = 1024;
const std::uint32_t* page(std::size_t number);
void write_word(std::size_t page, std::size_t word, std::uint32_t value);
void erase_page(std::size_t page);

// --- watchdog.cpp: resets the board unless it is fed in time.

void start_watchdog(std::uint32_t limit_us);
void feed_watchdog();

// --- uart.cpp: the serial line of the dongle.

void start_uart();
// Takes the bytes that have arrived, at most `size`; returns how many. To be called in every slot, which
// may last 1 ms: bytes that are not taken in time are overwritten.
std::size_t read_uart(std::uint8_t* bytes, std::size_t size);
// How many bytes may be written now.
std::size_t uart_room();
void write_uart(const std::uint8_t* bytes, std::size_t size);
// Lets the line go on after an event. To be called whenever `sleep` returns.
void serve_uart();

}  // namespace palmbots::board
