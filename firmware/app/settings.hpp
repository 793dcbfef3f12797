// SPDX-License-Identifier: Apache-2.0
// What distinguishes one board from another: identity, key, controller, times, calibration. `palmbots
// firmware` writes it into the last page of a ready-made image (src/palmbots/boards/settings_page.py has
// the same layout). Times are control ticks unless a name says otherwise.
#pragma once

#include <cstddef>
#include <cstdint>

#include "palmbots/control/machine_table.hpp"

namespace palmbots::app {

enum class WheelKind : std::uint8_t { servos, motor_board };

// What a closed switch of the palm means.
enum class SwitchMeaning : std::uint8_t {
  unused,
  minus,
  zero,
  plus,
  steep_end,
  shallow_end,
  goal,     // not of the palm: the robot is where the object is to be put down
  beneath,  // not of the palm: the robot is below the object on its stand
};

// A job on the floor, as bits of Settings::job.
enum class Job : std::uint8_t {
  lifts = 1,       // there is one
  begins_low = 2,  // with the object on the floor or on a stand
  ends_low = 4,
  stands_by = 8,  // the robot docks after its partner
  from_stand = 16,
  onto_stand = 32,
  level_only = 64,  // the pair corrects its contacts at level pivots only
};

inline constexpr std::size_t most_times = 16;

struct Settings {
  static constexpr std::uint32_t right_magic = 0x42504D42;
  static constexpr std::uint16_t newest_format = 3;

  std::uint32_t magic;
  std::uint16_t format;
  std::uint16_t pair;
  std::uint8_t key[16];
  std::uint32_t first_epoch;  // of the first boot with this image
  std::uint32_t last_epoch;   // the last that this image may use
  std::uint32_t number;       // equal on both boards if their settings are
  std::uint32_t period_us;    // of control
  std::uint32_t watchdog_us;
  std::uint32_t lease;
  std::uint32_t station_limit;
  std::uint32_t time_limit;
  std::uint32_t travel;          // time in mode carrying that covers the distance
  std::uint32_t stopping_limit;  // [ticks]
  std::uint32_t stopping;
  std::uint32_t turn_limit;  // longest time in which the palm turns
  std::uint16_t most_overruns;
  std::uint16_t state_period;
  std::uint16_t status_period;
  std::uint16_t least_battery_mv;
  std::uint8_t role;        // 0 left, 1 right, 2 the station's radio
  std::uint8_t controller;  // its number (palmbots/runtime/controller_registry.hpp)
  std::uint8_t channel;
  std::int8_t power_dbm;
  std::uint8_t rejoins;
  std::uint8_t stops_without_station;
  std::uint8_t stops_without_partner;
  std::uint8_t has_radio;
  std::uint8_t leads;
  std::uint8_t may_stop;
  std::uint8_t by_touch;
  std::uint8_t is_under_way;  // the carry begins at the boot, as in the simulator
  std::uint8_t wheel_kind;
  std::uint8_t debounce;    // equal readings in a row that a switch needs
  std::uint16_t palm_slew;  // largest change of the palm's pulse in a tick [µs]
  std::uint16_t
      wheel_slew;  // largest change of a wheel's pulse or speed in a tick, unless it rests
  std::uint8_t switches[9];  // SwitchMeaning of each
  std::uint8_t order_age;    // greatest age of an order, in periods of the status; 0: the usual
  std::uint16_t palm_us[2];  // pulses of the steep and of the shallow angle
  // For left and right wheel, by `stop` and move: pulses [µs], or speeds of the motor board.
  std::int16_t wheels[2][2][3];
  std::uint16_t times[most_times];  // of the controller, in the order of its `Times`
  std::uint16_t phase_times[7];     // of the table of the job: beacon, lease, limits
  // Pulses of the arm: the nose of a steep and of a shallow palm is on the floor; it is at its lowest at
  // the beginning and at the end of the job; the palm touches an object on its stand at the latest; the
  // pair carries.
  std::uint16_t arm_floor_us[2];
  std::uint16_t arm_low_us[2];
  std::uint16_t arm_clear_us;
  std::uint16_t arm_top_us;
  std::uint16_t arm_slew;  // change of the arm's pulse in a tick [1/256 µs]
  std::uint8_t job;        // bits of `Job`
  std::uint8_t table;      // of the job (`Table::number`)
  std::uint8_t unused[2];
  std::uint32_t arm_step;  // a step of the table of the job [1/256 µs]
  std::uint32_t check;     // CRC-32 of everything before
};
inline constexpr std::size_t settings_size = 208;
static_assert(sizeof(Settings) == settings_size && alignof(Settings) == 4);

// The page of the settings: these, and the table of a policy, with a check of its own.
struct SettingsPage {
  Settings settings;
  MachineTable table;
  std::uint8_t fill[4 - (settings_size + sizeof(MachineTable)) % 4];
  std::uint32_t table_check;  // CRC-32 of `table`
};
constexpr bool is_job(const Settings& settings, Job bit) {
  return (settings.job & static_cast<std::uint8_t>(bit)) != 0;
}
static_assert(alignof(MachineTable) == 1 && sizeof(MachineTable) == 3265);

}  // namespace palmbots::app

// The page in the image of this board, which each program defines in the section `.settings`.
extern "C" const palmbots::app::SettingsPage settings_page;

namespace palmbots::app {

// The settings that this board has been flashed with. The compiler sees only the empty ones with which
// the program is compiled, so it must not follow the address.
inline const SettingsPage& flashed_settings() {
  const SettingsPage* page = &settings_page;
  asm volatile("" : "+r"(page));
  return *page;
}

}  // namespace palmbots::app
