// SPDX-License-Identifier: Apache-2.0
// The controllers that a board can run, each in the runtime of its kind, behind one interface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

#include "palmbots/control/resilient.hpp"
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/control/table_robot.hpp"
#include "palmbots/runtime/robot_runtime.hpp"
#include "settings.hpp"
#include "storage.hpp"

namespace palmbots::app {

// A robot with some controller.
class Robot {
 public:
  // Writes the hello with which a carry in lockstep begins, if the controller needs a session.
  virtual bool greet(wire::Bytes& bytes) = 0;
  virtual void begin(std::uint16_t elapsed) = 0;
  virtual void receive(std::span<const std::uint8_t> bytes) = 0;
  virtual void operate(wire::Operation wish) = 0;
  virtual void step(const runtime::Reading& reading, runtime::Outputs& out) = 0;
  virtual const wire::Endpoint& endpoint() const = 0;
  virtual const runtime::ReceivedCounts& received() const = 0;
  virtual char name() const = 0;
  virtual bool waits() const = 0;
  virtual MessageKind awaits() const = 0;
  virtual bool greets() const = 0;

 protected:
  ~Robot() = default;
};

template <class Program>
class RobotWith final : public Robot {
 public:
  template <class... Arguments>
  explicit RobotWith(const Arguments&... arguments) : runtime_(arguments...) {}

  bool greet(wire::Bytes& bytes) override { return runtime_.greet(bytes); }
  void begin(std::uint16_t elapsed) override { runtime_.begin(elapsed); }
  void receive(std::span<const std::uint8_t> bytes) override { runtime_.receive(bytes); }
  void operate(wire::Operation wish) override { runtime_.operate(wish); }
  void step(const runtime::Reading& reading, runtime::Outputs& out) override {
    out = runtime_.step(reading);
  }
  const wire::Endpoint& endpoint() const override { return runtime_.endpoint(); }
  const runtime::ReceivedCounts& received() const override { return runtime_.received(); }
  char name() const override { return runtime_.program().name(); }
  bool waits() const override { return runtime_.program().waits(); }
  MessageKind awaits() const override { return runtime_.program().awaits(); }
  bool greets() const override { return Program::greets; }

 private:
  runtime::RobotRuntime<Program> runtime_;
};

inline runtime::RuntimeSettings runtime_settings(const Settings& s) {
  using namespace runtime;
  return {
      {s.rejoins != 0 ? AfterReboot::rejoin : AfterReboot::disarm,
       s.stops_without_station != 0 ? StationLost::stop : StationLost::carry_on,
       s.stops_without_partner != 0 ? PartnerLost::stop : PartnerLost::controller, s.has_radio != 0,
       s.lease, s.station_limit, s.time_limit, s.travel, s.stopping_limit, s.most_overruns},
      s.state_period,
      s.status_period,
      s.number};
}

namespace detail {

using runtime::BeaconProgram;
using runtime::MessageProgram;

template <class Table>
using TableRobotProgram = BeaconProgram<TableRobot<Table>>;

// All controllers share the memory of the largest.
template <class... Programs>
struct Room {
  static constexpr std::size_t largest() {
    std::size_t most = 0;
    for (const std::size_t size : {sizeof(RobotWith<Programs>)...})
      most = size > most ? size : most;
    return most;
  }
  alignas(RobotWith<Programs>...) static inline std::byte bytes[largest()];
};
using RoomForAll =
    Room<BeaconProgram<Resilient>, TableRobotProgram<Silent>, TableRobotProgram<SharedSign>,
         MessageProgram<Distributed>, MessageProgram<MachineRobot>, runtime::ReportProgram>;

template <class Program>
Robot& robot_with(const SettingsPage& page, const Stored& stored, const Program& fresh,
                  const Program& rebooted) {
  const Settings& s = page.settings;
  wire::Identity identity{{}, s.pair, static_cast<wire::Role>(s.role)};
  for (std::size_t i = 0; i < identity.key.size(); ++i) identity.key[i] = s.key[i];
  return *new (RoomForAll::bytes)
      RobotWith<Program>(identity, stored.epoch, fresh, rebooted, runtime_settings(s),
                         runtime::StoredMode{stored.carries, stored.stop}, s.is_under_way != 0);
}

template <class Table>
Robot& table_robot(const SettingsPage& page, const Stored& stored, wire::Language language) {
  using Controller = TableRobot<Table>;
  const Settings& s = page.settings;
  typename Controller::Times times{s.times[0], s.times[1], {}};
  static_assert(2 + Table::limits <= most_times);
  for (std::size_t i = 0; i < Table::limits; ++i) times.limits[i] = s.times[2 + i];
  const auto program = [&](bool by_touch) {
    const typename Controller::Role role{s.leads != 0, s.may_stop != 0, by_touch};
    return BeaconProgram(Controller(times, role), language, times.lease, stored.epoch);
  };
  return robot_with(page, stored, program(s.by_touch != 0), program(false));
}

template <class Controller>
Robot& message_robot(const SettingsPage& page, const Stored& stored, const Controller& controller) {
  return robot_with(page, stored, MessageProgram(controller), MessageProgram(controller));
}

}  // namespace detail

// The robot that the settings ask for. To be called once.
inline Robot& make_robot(const SettingsPage& page, const Stored& stored) {
  const Settings& s = page.settings;
  switch (static_cast<ControllerKind>(s.controller)) {
    case ControllerKind::silent:
      return detail::table_robot<Silent>(page, stored, wire::Language::none);
    case ControllerKind::shared_sign:
      return detail::table_robot<SharedSign>(page, stored, wire::Language::signs);
    case ControllerKind::distributed: return detail::message_robot(page, stored, Distributed());
    case ControllerKind::policy:
      return detail::message_robot(page, stored, MachineRobot(&page.table));
    case ControllerKind::centralized:
      return detail::robot_with(page, stored, runtime::ReportProgram(),
                                runtime::ReportProgram(stored.assists));
    case ControllerKind::resilient: break;
  }
  const Resilient::Times times{s.times[0], s.times[1], s.times[2], s.times[3], s.times[4]};
  const auto program = [&](bool assists) {
    return detail::BeaconProgram(Resilient(times, s.leads == 0, assists), wire::Language::beacons,
                                 times.lease, stored.epoch);
  };
  return detail::robot_with(page, stored, program(false), program(stored.assists));
}

}  // namespace palmbots::app
