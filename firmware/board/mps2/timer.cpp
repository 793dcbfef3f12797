// SPDX-License-Identifier: Apache-2.0
// SysTick counts slots of a fifth of a tick, and gives the alarm. The tick itself comes from the world,
// so that both boards keep step with it.
#include <cstdint>

#include "../board.hpp"
#include "../register.hpp"
#include "line.hpp"

namespace palmbots::board {

namespace {

// Control, reload and current value of SysTick.
inline constexpr Registers<0xE000E010, 4> SYST{};
inline constexpr Register<0xE000ED04> SCB_ICSR{};
constexpr std::uint32_t cycles_per_us = 25, slots_per_tick = 5, counted = 1U << 16;
constexpr std::uint32_t clear_pending = 1U << 25;

std::uint32_t slot_us, time_us, alarm_at;
bool is_alarm_set, has_slot;

void look() {
  line::serve();
  if ((SYST[0] & counted) == 0) return;  // reading clears it
  SCB_ICSR = clear_pending;
  time_us += slot_us;
  has_slot = true;
}

}  // namespace

void start_ticks(std::uint32_t period_us) {
  slot_us = period_us / slots_per_tick;
  SYST[1] = slot_us * cycles_per_us - 1;
  SYST[2] = 0;
  SYST[0] = 0b111;  // from the processor's clock, with an interrupt
}

std::uint16_t take_ticks() {
  look();
  const std::uint16_t taken = line::newest_tick().elapsed;
  line::newest_tick().elapsed = 0;
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

}  // namespace palmbots::board
