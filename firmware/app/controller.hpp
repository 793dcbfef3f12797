// SPDX-License-Identifier: Apache-2.0
// The robot that the settings of a board ask for, with one of the controllers of the registry or with
// the table of a policy.
#pragma once

#include <cstddef>
#include <new>
#include <tuple>

#include "palmbots/control/hand_over.hpp"
#include "palmbots/control/lone.hpp"
#include "palmbots/control/machine_table.hpp"
#include "palmbots/runtime/any_robot.hpp"
#include "palmbots/runtime/controller_registry.hpp"
#include "settings.hpp"
#include "storage.hpp"

namespace palmbots::app {

// Greatest age of an order [ticks].
inline std::uint32_t order_age_of(const Settings& s) {
  constexpr std::uint8_t usual = 20;
  const std::uint8_t periods = s.order_age == 0 ? usual : s.order_age;
  return std::uint32_t{periods} * s.status_period;
}

inline runtime::RuntimeSettings runtime_settings(const Settings& s) {
  using namespace runtime;
  return {
      {s.rejoins != 0 ? AfterReboot::rejoin : AfterReboot::disarm,
       s.stops_without_station != 0 ? StationLost::stop : StationLost::carry_on,
       s.stops_without_partner != 0 ? PartnerLost::stop : PartnerLost::controller, s.has_radio != 0,
       s.lease, s.station_limit, s.time_limit, s.travel, s.stopping_limit, s.most_overruns},
      s.state_period,
      s.status_period,
      s.number,
      order_age_of(s),
      s.is_under_way == 0};
}

template <class Table>
runtime::PhaseSettings<Table> phase_settings(const Settings& s) {
  TableTimes<Table> times{s.phase_times[0], s.phase_times[1], {}};
  static_assert(2 + Table::limits == sizeof s.phase_times / sizeof s.phase_times[0]);
  for (std::size_t i = 0; i < Table::limits; ++i) times.limits[i] = s.phase_times[2 + i];
  return {is_job(s, Job::lifts),
          is_job(s, Job::begins_low),
          is_job(s, Job::ends_low),
          s.leads != 0,
          is_job(s, Job::stands_by),
          is_job(s, Job::level_only),
          times};
}

namespace detail {

using PolicyProgram = runtime::PartnerProgram<MachineRobot>;

// The robot with the program of a row; of no size for a controller without one.
struct NoRobot {};
template <class Maker>
struct RobotOf {
  using Type = NoRobot;
};
template <class Maker>
  requires requires { typename Maker::Program; }
struct RobotOf<Maker> {
  static_assert(Maker::times <= most_times);
  using Type = runtime::RobotWith<typename Maker::Program>;
};

// A robot whose palm holds the object alone: it has no controller.
template <class Table>
using OnePalmRobot = runtime::RobotWith<runtime::NoProgram, runtime::PhaseProgram<Table>>;

// All robots share the memory of the largest.
template <class... Robots>
struct Room {
  static constexpr std::size_t largest() {
    std::size_t most = 0;
    for (const std::size_t size : {sizeof(Robots)...}) most = size > most ? size : most;
    return most;
  }
  alignas(Robots...) static inline std::byte bytes[largest()];
};

template <class... Makers>
Room<runtime::RobotWith<PolicyProgram>, OnePalmRobot<Lone>, OnePalmRobot<HandOver>,
     typename RobotOf<Makers>::Type...>
room_for(const std::tuple<ControllerRow<Makers>...>&);
using RoomForAll = decltype(room_for(controller_rows));

template <class Table = Lifting, class Program>
runtime::Robot& robot_with(const SettingsPage& page, const Stored& stored, const Program& fresh,
                           const Program& rebooted) {
  const Settings& s = page.settings;
  wire::Identity identity{{}, s.pair, static_cast<wire::Role>(s.role)};
  for (std::size_t i = 0; i < identity.key.size(); ++i) identity.key[i] = s.key[i];
  using Phases = runtime::PhaseProgram<Table>;
  return *new (RoomForAll::bytes) runtime::RobotWith<Program, Phases>(
      identity, stored.epoch, fresh, rebooted,
      Phases(phase_settings<Table>(s), stored.epoch, stored.holds), runtime_settings(s),
      runtime::StoredMode{stored.carries, stored.stop}, s.is_under_way != 0);
}

}  // namespace detail

// The robot that the settings ask for. To be called once.
inline runtime::Robot& make_robot(const SettingsPage& page, const Stored& stored) {
  const Settings& s = page.settings;
  if (is_job(s, Job::lifts)) {
    const runtime::NoProgram none;
    if (s.table == Lone::number) return detail::robot_with<Lone>(page, stored, none, none);
    if (s.table == HandOver::number) return detail::robot_with<HandOver>(page, stored, none, none);
  }
  const runtime::ProgramStart start{s.times,         stored.epoch,    s.leads != 0,
                                    s.may_stop != 0, s.by_touch != 0, stored.assists};
  runtime::Robot* robot = nullptr;
  visit_program_where([&](const ControllerInfo& info) { return info.board_number == s.controller; },
                      [&](auto maker) {
                        if constexpr (requires { maker.fresh(start); }) {
                          robot = &detail::robot_with(page, stored, maker.fresh(start),
                                                      maker.rebooted(start));
                        }
                      });
  if (robot != nullptr) return *robot;
  const detail::PolicyProgram policy(MachineRobot(&page.table), stored.epoch);
  return detail::robot_with(page, stored, policy, policy);
}

}  // namespace palmbots::app
