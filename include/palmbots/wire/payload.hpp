// SPDX-License-Identifier: Apache-2.0
// What packets say: the kinds of packets, and the five payload bytes of each.
//
// Bit 0 of the last byte means the same in every kind: the sender knows that a stop is in force. So
// each packet passes a stop on, whatever else it says. Bits and values without a meaning are 0;
// `means` rejects all others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/control/centralized.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/wire/robot_mode.hpp"

namespace palmbots::wire {

inline constexpr std::size_t payload_size = 5;
using Payload = std::array<std::uint8_t, payload_size>;

// What a packet carries.
enum class PacketKind : std::uint8_t { hello, state, status, operate, report, command, phase };
inline constexpr unsigned packet_kinds = 7;

constexpr const char* name_of(PacketKind kind) {
  constexpr const char* names[] = {"hello",  "state",   "status", "operate",
                                   "report", "command", "phase"};
  return names[static_cast<int>(kind)];
}

// True if the sender knows that a stop is in force.
constexpr bool passes_stop(const Payload& payload) { return (payload[4] & 1) != 0; }

namespace detail {
constexpr std::uint8_t bits(unsigned value, unsigned place = 0) {
  return static_cast<std::uint8_t>(value << place);
}
constexpr unsigned field(std::uint8_t byte, unsigned place, unsigned width) {
  return byte >> place & ((1U << width) - 1);
}
constexpr unsigned number(Sign sign) { return static_cast<unsigned>(static_cast<int>(sign) + 1); }
constexpr Sign sign_of(unsigned number) { return static_cast<Sign>(static_cast<int>(number) - 1); }
}  // namespace detail

// --- hello: the sender is up. It may state which settings it runs with, as a number that is equal
// on both robots and the station if their settings are.

struct Hello {
  std::uint32_t settings = 0;  // 0: not stated
  bool stop = false;

  constexpr bool operator==(const Hello&) const = default;
};

constexpr Payload payload_of(const Hello& hello) {
  using detail::bits;
  return {bits(hello.settings & 255), bits(hello.settings >> 8 & 255),
          bits(hello.settings >> 16 & 255), bits(hello.settings >> 24), bits(hello.stop)};
}

constexpr Hello hello_of(const Payload& b) {
  return {b[0] | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24,
          passes_stop(b)};
}

// --- state and phase: what a robot sends its partner, for its controller and for the table of a job on
// the floor.

// The language of a controller: messages of Table 2, beacons of the resilient algorithm, or the
// messages of a controller that shares signs. `none`: it says nothing. `phases` are the messages of
// the table that lifts (control/lifting.hpp); only a packet of the kind phase has them.
enum class Language : std::uint8_t { none, messages, beacons, signs, phases };

constexpr const char* name_of(Language language) {
  constexpr const char* names[] = {"none", "messages", "beacons", "signs", "phases"};
  return names[static_cast<int>(language)];
}

// The language of a beacon with this message.
constexpr Language language_of(MessageKind message) {
  if (is_phase(message)) return Language::phases;
  return is_sign(message) ? Language::signs : Language::beacons;
}

// The kind of the packets with this language.
constexpr PacketKind kind_of(Language language) {
  return language == Language::phases ? PacketKind::phase : PacketKind::state;
}

// True if the language has this message.
constexpr bool has_message(Language language, MessageKind kind) {
  switch (language) {
    case Language::none: return kind == MessageKind::none;
    case Language::messages: return kind >= MessageKind::tilt_up && kind <= MessageKind::ack;
    case Language::beacons: return kind >= MessageKind::tilt_up && kind <= MessageKind::raised;
    case Language::signs: return is_sign(kind);
    case Language::phases: return is_phase(kind);
  }
  return false;
}

struct State {
  Language language = Language::none;
  MessageKind message = MessageKind::none;  // what the controller or the table says
  RobotMode mode = RobotMode::off;
  // Of a controller: no condition keeps the sender from travelling, and it does not travel. Of a phase:
  // the bits 1 and 0 of the steps of its arm.
  bool ready = false;
  bool at_rest = false;
  bool stop = false;

  constexpr bool operator==(const State&) const = default;
};

constexpr Payload payload_of(const State& state) {
  using detail::bits;
  const unsigned kind = static_cast<unsigned>(state.message);
  const unsigned language = static_cast<unsigned>(state.language);
  const unsigned flags =
      unsigned{state.stop} | unsigned{state.ready} << 1 | unsigned{state.at_rest} << 2;
  return {bits(kind), bits(static_cast<unsigned>(state.mode) | language << 4), 0, 0, bits(flags)};
}

constexpr State state_of(const Payload& b) {
  using detail::field;
  return {static_cast<Language>(field(b[1], 4, 4)),
          static_cast<MessageKind>(b[0]),
          static_cast<RobotMode>(field(b[1], 0, 4)),
          field(b[4], 1, 1) != 0,
          field(b[4], 2, 1) != 0,
          passes_stop(b)};
}

// --- status: what a robot reports to the station, at most 20 times per second.

// Numbers that take turns in the status. Counts are modulo 65536; the receiver adds up differences.
// The counts of received packets, one for each verdict, follow `sent`.
enum class StatusItem : std::uint8_t {
  progress,  // covered part of the distance, 65535: all
  battery,   // [mV]; 65535: not measured
  overruns,  // control ticks that came too late, among the last 100
  sent,      // count of packets
  phase,     // of a job on the floor, the number of its state; 65535: it is none
  received,  // count of packets with the first verdict; the other verdicts follow
};
inline constexpr unsigned verdicts_in_status = 10;
inline constexpr unsigned status_items =
    static_cast<unsigned>(StatusItem::received) + verdicts_in_status;

// The cases of Table 2 and of Table 1 as they are numbered in a status; ' ': none.
inline constexpr char case_names[] = {' ', 'a', 'b', 'c', 'd', '1', '2',
                                      '3', '4', '5', '6', '7', '8'};

struct Status {
  RobotMode mode = RobotMode::off;
  FaultCode fault = FaultCode::none;
  Sign sign = Sign::zero;
  Palm palm = Palm::steep;      // the angle last commanded
  bool palm_at_target = false;  // the palm has reached that angle
  char activity = ' ';          // the case, one of `case_names`
  StatusItem item = StatusItem::progress;
  std::uint16_t value = 0;  // of the item
  bool ready = false;
  bool at_rest = false;
  bool stop = false;

  constexpr bool operator==(const Status&) const = default;
};

constexpr unsigned case_number(char name) {
  for (unsigned i = 0; i < sizeof case_names; ++i) {
    if (case_names[i] == name) return i;
  }
  return 0;
}

constexpr Payload payload_of(const Status& s) {
  using detail::bits;
  const unsigned flags = unsigned{s.stop} | unsigned{s.ready} << 1 | unsigned{s.at_rest} << 2;
  return {bits(static_cast<unsigned>(s.mode) | static_cast<unsigned>(s.fault) << 4),
          bits(detail::number(s.sign) | static_cast<unsigned>(s.palm) << 2 |
               unsigned{s.palm_at_target} << 3 | case_number(s.activity) << 4),
          bits(s.value & 255U), bits(s.value >> 8U),
          bits(flags | static_cast<unsigned>(s.item) << 3)};
}

constexpr Status status_of(const Payload& b) {
  using detail::field;
  return {static_cast<RobotMode>(field(b[0], 0, 4)),
          static_cast<FaultCode>(field(b[0], 4, 4)),
          detail::sign_of(field(b[1], 0, 2)),
          static_cast<Palm>(field(b[1], 2, 1)),
          field(b[1], 3, 1) != 0,
          case_names[field(b[1], 4, 4)],
          static_cast<StatusItem>(field(b[4], 3, 5)),
          static_cast<std::uint16_t>(b[2] | b[3] << 8),
          field(b[4], 1, 1) != 0,
          field(b[4], 2, 1) != 0,
          passes_stop(b)};
}

// --- operate: what the operator wants, from the station.

struct Operate {
  Operation operation;
  bool stop = false;

  constexpr bool operator==(const Operate&) const = default;
};

constexpr Payload payload_of(const Operate& wish) {
  return {detail::bits(static_cast<unsigned>(wish.operation)), 0, 0, 0, detail::bits(wish.stop)};
}

constexpr Operate operate_of(const Payload& b) {
  return {static_cast<Operation>(b[0]), passes_stop(b)};
}

// --- report and command of the centralized algorithm (Table 1).

constexpr Payload payload_of(const Centralized::Report& report, bool stop = false) {
  const unsigned palm = static_cast<unsigned>(report.palm);
  return {
      detail::bits(detail::number(report.sign) | palm << 2 | unsigned{report.palm_at_target} << 3),
      0, 0, 0, detail::bits(stop)};
}

constexpr Centralized::Report report_of(const Payload& b) {
  using detail::field;
  return {detail::sign_of(field(b[0], 0, 2)), static_cast<Palm>(field(b[0], 2, 1)),
          field(b[0], 3, 1) != 0};
}

constexpr Payload payload_of(const Command& command, bool stop = false) {
  const unsigned palm = static_cast<unsigned>(command.palm);
  const unsigned move = static_cast<unsigned>(command.move);
  return {detail::bits(palm | move << 1), 0, 0, 0, detail::bits(stop)};
}

constexpr Command command_of(const Payload& b) {
  return {static_cast<Palm>(b[0] & 1), static_cast<Move>(b[0] >> 1)};
}

// --- What is valid.

// True if the payload is valid for this kind.
constexpr bool means(PacketKind kind, const Payload& b) {
  using detail::field;
  const bool is_short = (b[1] | b[2] | b[3]) == 0 && b[4] < 2;
  switch (kind) {
    case PacketKind::hello: return b[4] < 2;
    case PacketKind::state:
    case PacketKind::phase: {
      const auto language = static_cast<Language>(field(b[1], 4, 4));
      return language <= Language::phases && kind_of(language) == kind &&
             has_message(language, static_cast<MessageKind>(b[0])) &&
             field(b[1], 0, 4) < robot_modes && b[2] == 0 && b[3] == 0 && b[4] < 8;
    }
    case PacketKind::status:
      return field(b[0], 0, 4) < robot_modes && field(b[0], 4, 4) < fault_codes &&
             field(b[1], 0, 2) < 3 && field(b[1], 4, 4) < sizeof case_names &&
             field(b[4], 3, 5) < status_items;
    case PacketKind::operate: return is_short && b[0] < operations;
    case PacketKind::report: return is_short && b[0] < 16 && field(b[0], 0, 2) < 3;
    case PacketKind::command: return is_short && b[0] < 6;
  }
  return false;
}

}  // namespace palmbots::wire
