// SPDX-License-Identifier: Apache-2.0
// What the frames on a serial line contain (docs/reference/wire.md): reports of a radio bridge, and
// the commands and readings of a motor board. Numbers are little-endian.
//
// Each `..._in` returns false for content that is not as described, and then writes nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/wire/serial_frame.hpp"

namespace palmbots::wire {

using Content = std::span<const std::uint8_t>;

namespace detail {

// Writes numbers one after the other.
template <std::size_t Size>
class Writer {
 public:
  constexpr Writer& add(std::uint32_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      bytes_[at_++] = static_cast<std::uint8_t>(value >> 8 * i & 255);
    }
    return *this;
  }
  constexpr std::array<std::uint8_t, Size> bytes() const { return bytes_; }

 private:
  std::array<std::uint8_t, Size> bytes_{};
  std::size_t at_ = 0;
};

// Reads numbers one after the other.
class Reader {
 public:
  constexpr explicit Reader(Content bytes) : bytes_(bytes) {}
  constexpr std::uint32_t take(std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint32_t{bytes_[at_++]} << 8 * i;
    return value;
  }
  constexpr std::uint8_t take_8() { return static_cast<std::uint8_t>(take(1)); }
  constexpr std::uint16_t take_16() { return static_cast<std::uint16_t>(take(2)); }
  constexpr std::int16_t take_signed_16() { return static_cast<std::int16_t>(take_16()); }

 private:
  Content bytes_;
  std::size_t at_ = 0;
};

}  // namespace detail

// --- bridge report: what a radio bridge has done since its boot. It sends one at least every
// second. All counts are modulo 2³².

struct BridgeReport {
  std::uint32_t sent = 0;            // packets from the serial line that the radio has sent
  std::uint32_t received = 0;        // packets from the radio that were written to the serial line
  std::uint32_t radio_full = 0;      // dropped: the radio was busy for too long
  std::uint32_t serial_full = 0;     // dropped: the serial line was busy for too long
  std::uint32_t radio_damaged = 0;   // dropped: received with a wrong checksum
  std::uint32_t serial_damaged = 0;  // dropped: damaged or unknown frames from the serial line

  constexpr bool operator==(const BridgeReport&) const = default;
};

inline constexpr std::size_t bridge_report_size = 24;

constexpr std::array<std::uint8_t, bridge_report_size> content_of(const BridgeReport& report) {
  return detail::Writer<bridge_report_size>{}
      .add(report.sent, 4)
      .add(report.received, 4)
      .add(report.radio_full, 4)
      .add(report.serial_full, 4)
      .add(report.radio_damaged, 4)
      .add(report.serial_damaged, 4)
      .bytes();
}

constexpr bool bridge_report_in(Content bytes, BridgeReport& report) {
  if (bytes.size() != bridge_report_size) return false;
  detail::Reader reader(bytes);
  report.sent = reader.take(4);
  report.received = reader.take(4);
  report.radio_full = reader.take(4);
  report.serial_full = reader.take(4);
  report.radio_damaged = reader.take(4);
  report.serial_damaged = reader.take(4);
  return true;
}

// --- board hello: without content. The board answers with its identity. It also sends its identity
// once after its own boot, so that the program learns that its counters begin anew.

// The version of the commands and readings below.
inline constexpr std::uint8_t board_version = 1;

struct BoardIdentity {
  std::uint8_t version = board_version;
  bool has_encoders = false;
  bool measures_palm = false;
  bool measures_battery = false;
  std::uint8_t switches = 0;           // number of switches on the palm, at most 16
  std::uint16_t longest_watchdog = 0;  // [ms] a command may ask for at most this

  constexpr bool operator==(const BoardIdentity&) const = default;
};

inline constexpr std::size_t board_identity_size = 5;
inline constexpr std::uint8_t most_switches = 16;

constexpr std::array<std::uint8_t, board_identity_size> content_of(const BoardIdentity& board) {
  const unsigned features = (board.has_encoders ? 1U : 0U) | (board.measures_palm ? 2U : 0U) |
                            (board.measures_battery ? 4U : 0U);
  return detail::Writer<board_identity_size>{}
      .add(board.version, 1)
      .add(features, 1)
      .add(board.switches, 1)
      .add(board.longest_watchdog, 2)
      .bytes();
}

constexpr bool board_identity_in(Content bytes, BoardIdentity& board) {
  if (bytes.size() != board_identity_size || bytes[1] > 7 || bytes[2] > most_switches) return false;
  detail::Reader reader(bytes);
  board.version = reader.take_8();
  const std::uint8_t features = reader.take_8();
  board.has_encoders = (features & 1) != 0;
  board.measures_palm = (features & 2) != 0;
  board.measures_battery = (features & 4) != 0;
  board.switches = reader.take_8();
  board.longest_watchdog = reader.take_16();
  return true;
}

// --- board command. The board stops the wheels when no further command arrives within `watchdog`.

struct BoardCommand {
  std::uint8_t number = 0;       // of the command, modulo 256
  bool wheels = false;           // the wheels may turn; false: they stop at once
  bool palm = false;             // the palm is to go to `palm_angle`; false: it keeps its angle
  std::uint16_t watchdog = 1;    // [ms], at least 1
  std::int16_t left_speed = 0;   // of the left wheel [mrad/s], > 0: the robot drives forward
  std::int16_t right_speed = 0;  // of the right wheel
  std::int16_t palm_angle = 0;   // of the palm's servo [mrad]

  constexpr bool operator==(const BoardCommand&) const = default;
};

inline constexpr std::size_t board_command_size = 10;

constexpr std::array<std::uint8_t, board_command_size> content_of(const BoardCommand& command) {
  const auto bits = [](std::int16_t value) { return static_cast<std::uint16_t>(value); };
  return detail::Writer<board_command_size>{}
      .add(command.number, 1)
      .add((command.wheels ? 1U : 0U) | (command.palm ? 2U : 0U), 1)
      .add(command.watchdog, 2)
      .add(bits(command.left_speed), 2)
      .add(bits(command.right_speed), 2)
      .add(bits(command.palm_angle), 2)
      .bytes();
}

constexpr bool board_command_in(Content bytes, BoardCommand& command) {
  if (bytes.size() != board_command_size || bytes[1] > 3) return false;
  if (bytes[2] == 0 && bytes[3] == 0) return false;
  detail::Reader reader(bytes);
  command.number = reader.take_8();
  const std::uint8_t flags = reader.take_8();
  command.wheels = (flags & 1) != 0;
  command.palm = (flags & 2) != 0;
  command.watchdog = reader.take_16();
  command.left_speed = reader.take_signed_16();
  command.right_speed = reader.take_signed_16();
  command.palm_angle = reader.take_signed_16();
  return true;
}

// --- board reading, at least every 20 ms.

struct BoardReading {
  std::uint8_t number = 0;      // of the newest command that has arrived
  bool watchdog_acts = false;   // the wheels are stopped because commands failed to come
  std::uint16_t time = 0;       // [ms] of the board's clock, modulo 65536
  std::uint16_t switches = 0;   // bit i: switch i is pressed
  std::int16_t palm_angle = 0;  // of the palm's servo [mrad]; 0 if not measured
  std::int32_t left_count = 0;  // of the left encoder, modulo 2³²; 0 if there is none
  std::int32_t right_count = 0;
  std::uint16_t battery = 0;  // [mV]; 0 if not measured
  std::uint16_t damaged = 0;  // frames that were damaged or malformed, modulo 65536

  constexpr bool operator==(const BoardReading&) const = default;
};

inline constexpr std::size_t board_reading_size = 20;

constexpr std::array<std::uint8_t, board_reading_size> content_of(const BoardReading& reading) {
  return detail::Writer<board_reading_size>{}
      .add(reading.number, 1)
      .add(reading.watchdog_acts ? 1U : 0U, 1)
      .add(reading.time, 2)
      .add(reading.switches, 2)
      .add(static_cast<std::uint16_t>(reading.palm_angle), 2)
      .add(static_cast<std::uint32_t>(reading.left_count), 4)
      .add(static_cast<std::uint32_t>(reading.right_count), 4)
      .add(reading.battery, 2)
      .add(reading.damaged, 2)
      .bytes();
}

constexpr bool board_reading_in(Content bytes, BoardReading& reading) {
  if (bytes.size() != board_reading_size || bytes[1] > 1) return false;
  detail::Reader reader(bytes);
  reading.number = reader.take_8();
  reading.watchdog_acts = reader.take_8() != 0;
  reading.time = reader.take_16();
  reading.switches = reader.take_16();
  reading.palm_angle = reader.take_signed_16();
  reading.left_count = static_cast<std::int32_t>(reader.take(4));
  reading.right_count = static_cast<std::int32_t>(reader.take(4));
  reading.battery = reader.take_16();
  reading.damaged = reader.take_16();
  return true;
}

}  // namespace palmbots::wire
