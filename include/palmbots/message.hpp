// What a controller sees and says: tactile sign, letters, commands.
//
// Controllers are sans-I/O: step(input) → output, one call a control tick, no clock, no heap, no
// global state. The simulator, a model checker and a robot call the same step. These headers compile
// freestanding.
#pragma once

#include <cstdint>

namespace palmbots {

// What the tactile sensor says of the contact coordinate p.
enum class Sign : std::int8_t { negative = -1, zero = 0, positive = 1 };

// The messages of the distributed algorithm (paper, section 4): none, tilt_up, tilt_down, ack. The
// resilient one adds what a robot does that its partner must know of: it corrects a negative contact
// (closing), or its palm is up but is no answer to a request (raised).
enum class Letter : std::uint8_t { none, tilt_up, tilt_down, ack, closing, raised };

// Which of its two angles a palm is commanded to. Tilting "up" lowers the angle (Table 1, caption).
enum class Palm : std::uint8_t { steep, shallow };

// The speed a robot adds to its nominal one.
enum class Move : std::uint8_t { hold, away, closer };

struct Command {
  Palm palm;
  Move move;
  bool rest = false;  // do not travel: the nominal speed is 0

  constexpr bool operator==(const Command&) const = default;
};

}  // namespace palmbots
