// SPDX-License-Identifier: Apache-2.0
// SAADC measures the supply; the power-failure comparator of POWER notices when it breaks down for a
// moment, as it does when motors start on weak batteries.
#include <cstdint>

#include "../board.hpp"
#include "registers.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t full_scale_mv = 3600;  // reference 0.6 V, gain 1/6
constexpr unsigned calls_per_measurement = 100;

volatile std::int16_t result;
std::uint16_t newest_mv = 0xFFFF;  // not measured
unsigned calls;

}  // namespace

void start_battery(std::uint16_t least_mv) {
  SAADC::CH0_PSELN = 0;
  SAADC::CH0_PSELP = 9;                             // VDD
  SAADC::CH0_CONFIG = 0 << 8 | 0 << 12 | 2U << 16;  // gain 1/6, internal reference, 10 µs
  SAADC::RESOLUTION = 2;                            // 12 bits
  SAADC::RESULT_PTR = address_of(&result);
  SAADC::RESULT_MAXCNT = 1;
  SAADC::ENABLE = 1;
  // Thresholds from 1.7 V (4) in steps of 0.1 V to 2.8 V (15).
  const unsigned steps = least_mv < 1700 ? 0U : (least_mv - 1700U) / 100U;
  const unsigned threshold = 4 + (steps < 11 ? steps : 11);
  POWER::POFCON = 1 | threshold << 1;
}

std::uint16_t battery_mv() {
  if (SAADC::EVENTS_END != 0) {
    SAADC::EVENTS_END = 0;
    const std::int32_t read = result < 0 ? 0 : result;
    newest_mv = static_cast<std::uint16_t>(static_cast<std::uint32_t>(read) * full_scale_mv / 4096);
  }
  if (calls++ % calls_per_measurement == 0) {
    SAADC::EVENTS_STARTED = 0;
    SAADC::TASKS_START = 1;
  } else if (SAADC::EVENTS_STARTED != 0) {
    SAADC::EVENTS_STARTED = 0;
    SAADC::TASKS_SAMPLE = 1;
  }
  return newest_mv;
}

bool take_brown_out() {
  if (POWER::EVENTS_POFWARN == 0) return false;
  POWER::EVENTS_POFWARN = 0;
  return true;
}

}  // namespace palmbots::board
