// SPDX-License-Identifier: Apache-2.0
// What ends a carry: one table. A row is something that may happen to the object or to a robot; a
// column is a phase of the task. Worlds notice what happens. This table states what follows, and
// contains the words that users read.
//
// docs/guide/commands.md shows the table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palmbots {

// Why a carry ended with a drop. Stored results contain these numbers.
enum class DropReason : std::uint8_t {
  none,
  off_palm,
  sliding,
  flush,
  tip,
  tipping,
  jammed,
  lifting,
  robot_tipped,
  fell,
  toppled,
};
inline constexpr std::size_t drop_reasons = 11;

// The phases of a task that differ in what ends it.
enum class CarryPhase : std::uint8_t {
  placed,   // before anything moves
  carried,  // both palms hold the object, above the floor
  low,      // a nose is on the floor, or the object may touch a stand
  by_hand,  // palms without robots, over a floor
};
inline constexpr std::size_t carry_phases = 4;

// The name of each phase, and its meaning for users.
inline constexpr const char* carry_phase_words[carry_phases][2] = {
    {"placed", "at the start of a carry, and after a bump"},
    {"carried", "in a carry, and in a job while the palms are above the floor and any stand"},
    {"low", "in a job while a nose is on the floor, or the object may touch a stand"},
    {"by_hand", "in `FloorWorld`, and in the view Mechanics of the page"},
};

enum class Then : std::uint8_t {
  never,    // it does not happen in this phase
  goes_on,  // the carry continues
  stalls,   // the wheels stall, and the carry continues
  falls,    // the object falls to where it rests, and the carry continues if that is not too far
  ends,
};

constexpr const char* name_of(Then then) {
  constexpr const char* names[] = {"never", "goes on", "stalls", "falls", "ends"};
  return names[static_cast<int>(then)];
}

// What follows. `reason` is that of a carry that ends.
struct Consequence {
  Then then = Then::never;
  DropReason reason = DropReason::none;
};

struct EndRow {
  const char* name;
  const char* meaning;
  std::array<Consequence, carry_phases> by_phase;
  const char* in_mujoco = nullptr;  // its meaning there, if it is another one
};

// By the number of what happens.
inline constexpr std::array<EndRow, drop_reasons> carry_ends = [] {
  using R = DropReason;
  constexpr Consequence never{};
  constexpr Consequence goes_on{Then::goes_on};
  constexpr Consequence stalls{Then::stalls};
  constexpr const char* turned = "the object turned by more than 60°";
  const auto ends = [](R reason) { return Consequence{Then::ends, reason}; };
  const auto falls = [](R reason) { return Consequence{Then::falls, reason}; };
  // Each row in the order placed, carried, low, by_hand.
  return std::array<EndRow, drop_reasons>{{
      {"", "", {}},
      {"off-palm",
       "a contact left the usable part of its palm at an end or a side",
       {ends(R::off_palm), ends(R::off_palm), goes_on, goes_on}},
      {"sliding",
       "no squeeze force balances the object: it slides on both palms",
       {ends(R::sliding), ends(R::sliding), falls(R::fell), falls(R::fell)}},
      {"flush",
       "a palm and an edge of the object coincide",
       {ends(R::flush), goes_on, goes_on, goes_on}},
      {"tip", "the end of a palm is inside the object", {ends(R::tip), goes_on, goes_on, goes_on}},
      {"tipping",
       "the object tipped over a contact",
       {ends(R::tipping), ends(R::tipping), falls(R::toppled), falls(R::toppled)},
       turned},
      {"jammed",
       "no motion that the palms allow is in balance",
       {never, ends(R::jammed), stalls, ends(R::jammed)}},
      {"lifting", "the object lifted off a palm", {never, ends(R::lifting), goes_on, goes_on}},
      {"robot tipped",
       "a robot lost its balance under the load (palmbots load)",
       {never, ends(R::robot_tipped), ends(R::robot_tipped), never}},
      {"fell", "no forces balance the object, and it falls farther than world.fall_m", {}},
      {"toppled", "the object tips over, and falls farther than world.fall_m", {}, turned},
  }};
}();

constexpr const char* name_of(DropReason reason) {
  return carry_ends[static_cast<std::size_t>(reason)].name;
}

constexpr const Consequence& consequence(DropReason event, CarryPhase phase) {
  return carry_ends[static_cast<std::size_t>(event)].by_phase[static_cast<std::size_t>(phase)];
}

// The reason of a carry that this ends, or `none`. What should never happen in a phase is its own
// reason if it happens all the same.
constexpr DropReason ends_as(DropReason event, CarryPhase phase) {
  const Consequence& then = consequence(event, phase);
  return then.then == Then::never ? event : then.reason;
}

// Whether a step of the world ends when the object leaves one palm: at an end of it, or upwards.
constexpr bool needs_both_palms(CarryPhase phase) {
  return consequence(DropReason::lifting, phase).then == Then::ends;
}
static_assert(
    [] {
      for (const CarryPhase phase : {CarryPhase::carried, CarryPhase::low, CarryPhase::by_hand}) {
        const auto then = [&](DropReason event) { return consequence(event, phase).then; };
        if ((then(DropReason::off_palm) == Then::ends) != needs_both_palms(phase)) return false;
        for (const DropReason contact : {DropReason::flush, DropReason::tip})
          if (then(contact) != Then::goes_on) return false;
      }
      return true;
    }(),
    "worlds notice both or neither, and go on with further contacts");

}  // namespace palmbots
