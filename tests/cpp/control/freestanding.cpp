// SPDX-License-Identifier: Apache-2.0
// What a robot and a station run, as firmware would call it: functions without a system below.
// Compiled by tests/cpp/test_programs.py, never run.
#include "palmbots/control/external.hpp"
#include "palmbots/control/lifting.hpp"
#include "palmbots/control/machine_table.hpp"
#include "palmbots/control/resilient_timing.hpp"
#include "palmbots/control/row_policy.hpp"
#include "palmbots/runtime/any_robot.hpp"
#include "palmbots/runtime/controller_registry.hpp"
#include "palmbots/runtime/hand_controls.hpp"
#include "palmbots/runtime/station_runtime.hpp"
#include "palmbots/wire/device_frames.hpp"
#include "palmbots/wire/serial_frame.hpp"

using DistributedRobot = palmbots::TableRobot<palmbots::Distributed>;

palmbots::RobotOutput distributed_step(DistributedRobot& robot, const palmbots::RobotInput& in);

palmbots::RobotOutput distributed_step(DistributedRobot& robot, const palmbots::RobotInput& in) {
  return robot.step(in);
}

palmbots::Centralized::Output station_step(palmbots::Centralized& station,
                                           const palmbots::Centralized::Report (&reports)[2]);

palmbots::Centralized::Output station_step(palmbots::Centralized& station,
                                           const palmbots::Centralized::Report (&reports)[2]) {
  return station.step(reports);
}

using ResilientRobot = palmbots::TableRobot<palmbots::Resilient>;

palmbots::RobotOutput resilient_step(ResilientRobot& robot, const palmbots::RobotInput& in);

palmbots::RobotOutput resilient_step(ResilientRobot& robot, const palmbots::RobotInput& in) {
  return robot.step(in);
}

using SharedSignRobot = palmbots::TableRobot<palmbots::SharedSign>;

palmbots::RobotOutput shared_sign_step(SharedSignRobot& robot, const palmbots::RobotInput& in);

palmbots::RobotOutput shared_sign_step(SharedSignRobot& robot, const palmbots::RobotInput& in) {
  return robot.step(in);
}

bool hear(palmbots::BeaconReceiver& receiver, const palmbots::Beacon& beacon);

bool hear(palmbots::BeaconReceiver& receiver, const palmbots::Beacon& beacon) {
  return receiver.accept(beacon);
}

bool radio_send(palmbots::wire::Endpoint& end, palmbots::wire::Role to,
                palmbots::wire::PacketKind kind, const palmbots::wire::Payload& payload,
                palmbots::wire::Bytes& bytes);

bool radio_send(palmbots::wire::Endpoint& end, palmbots::wire::Role to,
                palmbots::wire::PacketKind kind, const palmbots::wire::Payload& payload,
                palmbots::wire::Bytes& bytes) {
  return end.send(to, kind, payload, bytes);
}

palmbots::wire::Decoded radio_receive(palmbots::wire::Endpoint& end, const std::uint8_t* bytes,
                                      std::size_t size);

palmbots::wire::Decoded radio_receive(palmbots::wire::Endpoint& end, const std::uint8_t* bytes,
                                      std::size_t size) {
  return end.receive({bytes, size});
}

palmbots::RobotOutput commanded_step(const palmbots::ExternalController& robot);

palmbots::RobotOutput commanded_step(const palmbots::ExternalController& robot) {
  return robot.step({});
}

palmbots::ResilientTiming timing(const palmbots::ResilientTimingInputs& inputs);

palmbots::ResilientTiming timing(const palmbots::ResilientTimingInputs& inputs) {
  return palmbots::ResilientTiming::of(inputs);
}

palmbots::runtime::ModeOutputs mode_step(palmbots::runtime::ModeMachine& robot,
                                         const palmbots::runtime::ModeInputs& in);

palmbots::runtime::ModeOutputs mode_step(palmbots::runtime::ModeMachine& robot,
                                         const palmbots::runtime::ModeInputs& in) {
  return robot.step(in);
}

using ResilientRuntime =
    palmbots::runtime::RobotRuntime<palmbots::runtime::PartnerProgram<ResilientRobot>>;

palmbots::runtime::Outputs robot_step(ResilientRuntime& robot, const std::uint8_t* bytes,
                                      std::size_t size);

palmbots::runtime::Outputs robot_step(ResilientRuntime& robot, const std::uint8_t* bytes,
                                      std::size_t size) {
  robot.begin(1);
  robot.receive({bytes, size});
  return robot.step({});
}
