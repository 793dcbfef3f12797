// SPDX-License-Identifier: Apache-2.0
// TIMER0 counts microseconds. CC[0] is the next slot, CC[1] the alarm, CC[2] takes the time.
#include <cstdint>

#include "../board.hpp"
#include "registers.hpp"
#include "wake.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t slots_per_tick = 5;

std::uint32_t slot_us;
std::uint32_t slot;        // since the last tick
std::uint16_t ticks;       // begun, and not yet taken
bool has_slot, has_alarm;  // not yet taken

void take_events() {
  const bool rings = TIMER0::EVENTS_COMPARE[1] != 0;
  const bool begins = TIMER0::EVENTS_COMPARE[0] != 0;
  if (!rings && !begins) return;
  if (rings) TIMER0::EVENTS_COMPARE[1] = 0;
  if (begins) TIMER0::EVENTS_COMPARE[0] = 0;
  has_been_served(Interrupt::timer0);
  has_alarm = has_alarm || rings;
  if (!begins) return;
  has_slot = true;
  // The program may have been halted for longer than a slot. A compare value in the past would never
  // match, so the next one is set until it lies ahead.
  std::uint32_t next = TIMER0::CC[0];
  do {
    next += slot_us;
    if (++slot == slots_per_tick) {
      slot = 0;
      ticks = static_cast<std::uint16_t>(ticks + 1);
    }
    TIMER0::CC[0] = next;
  } while (static_cast<std::int32_t>(next - now_us()) <= 0);
}

}  // namespace

std::uint32_t now_us() {
  TIMER0::TASKS_CAPTURE[2] = 1;
  return TIMER0::CC[2];
}

void start_ticks(std::uint32_t period_us) {
  slot_us = period_us / slots_per_tick;
  TIMER0::MODE = 0;
  TIMER0::BITMODE = 3;    // 32 bits
  TIMER0::PRESCALER = 4;  // 16 MHz / 2⁴
  TIMER0::CC[0] = slot_us;
  TIMER0::INTENSET = 0b11U << 16;
  wakes(Interrupt::timer0);
  TIMER0::TASKS_CLEAR = 1;
  TIMER0::TASKS_START = 1;
}

std::uint16_t take_ticks() {
  take_events();
  const std::uint16_t taken = ticks;
  ticks = 0;
  return taken;
}

bool take_slot() {
  take_events();
  const bool taken = has_slot;
  has_slot = false;
  return taken;
}

void set_alarm(std::uint32_t delay_us) {
  has_alarm = false;
  TIMER0::EVENTS_COMPARE[1] = 0;
  TIMER0::CC[1] = now_us() + delay_us;
}

bool take_alarm() {
  take_events();
  const bool taken = has_alarm;
  has_alarm = false;
  return taken;
}

}  // namespace palmbots::board
