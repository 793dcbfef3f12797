// SPDX-License-Identifier: Apache-2.0
// Inputs and outputs of the controllers: tactile sign, messages, commands.
//
// Controllers are sans-I/O: step(input) → output, called once per control tick, with no clock, heap
// or global state. The simulator, a model checker and a robot call the same step. These headers
// compile freestanding.
#pragma once

#include <cstdint>

namespace palmbots {

// The tactile sensor's reading of the contact coordinate p.
enum class Sign : std::int8_t { negative = -1, zero = 0, positive = 1 };

// The messages of the distributed algorithm (paper, section 4): none, tilt_up, tilt_down, ack. The
// resilient algorithm adds two states that the partner must know: the sender corrects a negative
// contact (closing), or its palm is up but not in answer to a request (raised). The others are the
// messages of a controller that shares signs: the sender's sign, and whether its palm is shallow
// where its sign is not zero. Last come the messages of the table that lifts (control/lifting.hpp),
// which no controller sends.
enum class MessageKind : std::uint8_t {
  none,
  tilt_up,
  tilt_down,
  ack,
  closing,
  raised,
  zero,
  plus,
  plus_shallow,
  minus,
  minus_shallow,
  docking,
  under,
  centring,
  ready,
  raising,
  lifted,
  carrying,
  arrived,
  lowering,
  down,
  leaving,
  empty,
  backing,
  holding,
};
inline constexpr int message_kinds = 11;      // that controllers send
inline constexpr int all_message_kinds = 25;  // of all tables

constexpr bool is_sign(MessageKind kind) {
  return kind >= MessageKind::zero && kind <= MessageKind::minus_shallow;
}
// Of the table that lifts.
constexpr bool is_phase(MessageKind kind) {
  return kind >= MessageKind::docking && static_cast<int>(kind) < all_message_kinds;
}

// The names that the paper, the logs and the tables use.
constexpr const char* name_of(MessageKind kind) {
  constexpr const char* names[] = {
      "",        "TiltUp",      "TiltDown", "Ack",          "Closing", "Raised",   "Zero",
      "Plus",    "PlusShallow", "Minus",    "MinusShallow", "Docking", "Under",    "Centring",
      "Ready",   "Raising",     "Lifted",   "Carrying",     "Arrived", "Lowering", "Down",
      "Leaving", "Empty",       "Backing",  "Holding"};
  return names[static_cast<int>(kind)];
}

// Which of its two angles a palm is commanded to. Tilting "up" lowers the angle (Table 1, caption).
enum class Palm : std::uint8_t { steep, shallow };

constexpr const char* name_of(Palm palm) {
  constexpr const char* names[] = {"steep", "shallow"};
  return names[static_cast<int>(palm)];
}

// The speed that a robot adds to its nominal one.
enum class Move : std::uint8_t { hold, away, closer };

constexpr const char* name_of(Move move) {
  constexpr const char* names[] = {"hold", "away", "closer"};
  return names[static_cast<int>(move)];
}

// The name of a controller's state, and what a robot does in it, in words for people.
struct StateMeaning {
  const char* name;
  const char* meaning;
};

// What a controller commands: the palm's angle, the wheels' move, and whether to stop travelling.
struct Command {
  Palm palm;
  Move move;
  bool stop = false;  // do not travel: the nominal speed is 0

  constexpr bool operator==(const Command&) const = default;
};

// What the program of a robot knows at a step.
struct RobotInput {
  Sign sign;
  bool palm_at_target;        // the palm has reached the angle last commanded
  std::uint16_t elapsed = 1;  // ticks since the last step, at least 1
  // With a queue the oldest message that it has not read; with beacons that of a beacon newer than
  // all before. Else none.
  MessageKind message = MessageKind::none;
  // The rest of that beacon.
  bool stopped = false;   // its sender does not travel
  bool ready = false;     // no condition keeps that sender from travelling
  std::uint16_t age = 0;  // from BeaconReceiver::age()
};

// What it decides.
struct RobotOutput {
  Command command;
  // With a queue the message to send now, or none; with beacons its present message, at all times.
  MessageKind message = MessageKind::none;
  bool send = false;     // the message is sent now
  bool read = false;     // with a queue: the message that it heard is consumed
  bool ready = false;    // no condition keeps it from travelling, at all times
  bool assists = false;  // keep this bit across a reboot
};

}  // namespace palmbots
