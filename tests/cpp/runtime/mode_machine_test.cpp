// SPDX-License-Identifier: Apache-2.0
// The mode machine of a robot, step by step.
#include "palmbots/runtime/mode_machine.hpp"

#include "support/check.hpp"
#include "support/mode_world.hpp"

using namespace palmbots;
using namespace palmbots::runtime;
using namespace palmbots::test;
using wire::FaultCode;

namespace {

ModeSettings settings_for_steps() {
  ModeSettings settings{};
  settings.lease = 20;
  settings.station_limit = 50;
  settings.time_limit = 1000;
  settings.stopping_limit = 10;
  settings.most_overruns = 3;
  return settings;
}

// Everything is in order, and the partner is ready.
ModeInputs good() {
  ModeInputs in;
  in.partner = {RobotMode::ready, 2};
  in.station_age = 5;
  in.preflight = {true, true, true, true, 9};
  return in;
}

ModeInputs with(Operation operation) {
  ModeInputs in = good();
  in.order(operation, true);
  return in;
}

ModeMachine disarmed(const ModeSettings& settings = settings_for_steps()) {
  ModeMachine machine(settings, {});
  CHECK(machine.step(good()).mode == RobotMode::disarmed);
  return machine;
}

ModeMachine carrying(const ModeSettings& settings = settings_for_steps()) {
  ModeMachine machine = disarmed(settings);
  CHECK(machine.step(with(Operation::arm)).mode == RobotMode::armed);
  const ModeOutputs ready = machine.step(with(Operation::start));
  CHECK(ready.mode == RobotMode::ready && !ready.wheels && !ready.store.carries);
  const ModeOutputs out = machine.step(good());
  CHECK(out.mode == RobotMode::carrying && out.wheels && out.store.carries && !out.stop);
  CHECK(out.controller == ControllerStart::fresh);
  CHECK(machine.step(good()).controller == ControllerStart::none);
  return machine;
}

// True if this step would bring a robot into this mode, and stop its wheels at once.
bool ends(ModeMachine machine, const ModeInputs& in, RobotMode mode,
          FaultCode code = FaultCode::none) {
  const ModeOutputs out = machine.step(in);
  return out.mode == mode && out.code == code && !out.wheels && !out.store.carries &&
         out.stop == (mode == RobotMode::stopped) && out.store.stop == out.stop;
}

void arming_needs_every_check() {
  const auto refused = [](auto&& spoil, FaultCode why) {
    ModeInputs in = with(Operation::arm);
    spoil(in);
    ModeMachine machine = disarmed();
    const ModeOutputs out = machine.step(in);
    CHECK(out.mode == RobotMode::disarmed && out.code == why);
    // The reason remains until the robot is armed.
    CHECK(machine.step(good()).code == why);
    const ModeOutputs armed = machine.step(with(Operation::arm));
    CHECK(armed.mode == RobotMode::armed && armed.code == FaultCode::none);
  };
  refused([](ModeInputs& in) { in.driver_ok = false; }, FaultCode::driver);
  refused([](ModeInputs& in) { in.storage_ok = false; }, FaultCode::storage);
  refused([](ModeInputs& in) { in.preflight.contact = false; }, FaultCode::contact);
  refused([](ModeInputs& in) { in.preflight.palm = false; }, FaultCode::palm);
  refused([](ModeInputs& in) { in.preflight.arm = false; }, FaultCode::arm);
  refused([](ModeInputs& in) { in.preflight.battery = false; }, FaultCode::battery);
  refused([](ModeInputs& in) { in.preflight.settings = false; }, FaultCode::settings);
  refused([](ModeInputs& in) { in.preflight.stopping = 11; }, FaultCode::stopping);
  refused([](ModeInputs& in) { in.preflight.stopping = never; }, FaultCode::stopping);
  refused([](ModeInputs& in) { in.partner.age = 21; }, FaultCode::partner_lost);
  refused([](ModeInputs& in) { in.partner.mode = RobotMode::stopped; }, FaultCode::stop);
  refused([](ModeInputs& in) { in.partner_stop = true; }, FaultCode::stop);
}

void a_robot_starts_with_its_partner() {
  const auto starts = [](RobotMode partner, std::uint32_t age) {
    ModeMachine machine = disarmed();
    machine.step(with(Operation::arm));
    machine.step(with(Operation::start));
    ModeInputs in = good();
    in.partner = {partner, age};
    return machine.step(in).wheels;
  };
  CHECK(starts(RobotMode::ready, 20) && starts(RobotMode::carrying, 0));
  CHECK(starts(RobotMode::holding, 20));
  CHECK(!starts(RobotMode::ready, 21) && !starts(RobotMode::holding, never));
  for (const RobotMode mode : {RobotMode::off, RobotMode::disarmed, RobotMode::armed,
                               RobotMode::done, RobotMode::stopped, RobotMode::fault}) {
    CHECK(!starts(mode, 0));
  }
  // A start that comes too early is not remembered.
  ModeMachine machine = disarmed();
  machine.step(with(Operation::start));
  machine.step(with(Operation::arm));
  CHECK(machine.step(good()).mode == RobotMode::armed);
  // Without a radio the operator alone starts it.
  ModeSettings settings = settings_for_steps();
  settings.has_radio = false;
  ModeMachine silent = disarmed(settings);
  ModeInputs alone = with(Operation::arm);
  alone.partner = {};
  alone.preflight.settings = false;
  CHECK(silent.step(alone).mode == RobotMode::armed);
  alone.operation = Operation::start;
  CHECK(silent.step(alone).mode == RobotMode::ready);
  CHECK(silent.step(alone).wheels);
}

void a_start_is_void_once_the_partner_is_silent() {
  ModeMachine machine = disarmed();
  machine.step(with(Operation::arm));
  machine.step(with(Operation::start));
  ModeInputs in = good();
  in.partner = {RobotMode::armed, 20};
  CHECK(machine.step(in).mode == RobotMode::ready);
  in.partner = {RobotMode::ready, 21};
  CHECK(ends(machine, in, RobotMode::armed, FaultCode::partner_lost));
  machine.step(in);
  in.partner.age = 0;
  CHECK(machine.step(in).mode == RobotMode::armed);
  CHECK(machine.step(with(Operation::start)).code == FaultCode::none);
  CHECK(machine.step(in).wheels);
}

void each_end_of_a_carry() {
  const auto ended = [](auto&& change, RobotMode mode, FaultCode code = FaultCode::none) {
    ModeInputs in = good();
    change(in);
    CHECK(ends(carrying(), in, mode, code));
  };
  ended([](ModeInputs& in) { in.stop = true; }, RobotMode::stopped);
  ended([](ModeInputs& in) { in.partner_stop = true; }, RobotMode::stopped);
  ended([](ModeInputs& in) { in.order(Operation::stop, true); }, RobotMode::stopped);
  ended([](ModeInputs& in) { in.order(Operation::e_stop, false); }, RobotMode::stopped);
  ended([](ModeInputs& in) { in.order(Operation::disarm, true); }, RobotMode::disarmed);
  ended([](ModeInputs& in) { in.covered = true; }, RobotMode::done);
  ended([](ModeInputs& in) { in.partner.mode = RobotMode::done; }, RobotMode::done);
  ended([](ModeInputs& in) { in.failed = true; }, RobotMode::fault, FaultCode::job);
  ModeInputs alone = good();
  alone.partner.mode = RobotMode::done;
  alone.ends_alone = true;  // a job on the floor
  ModeMachine goes_on = carrying();
  CHECK(goes_on.step(alone).wheels);
  ended([](ModeInputs& in) { in.driver_ok = false; }, RobotMode::fault, FaultCode::driver);
  ended([](ModeInputs& in) { in.overruns = 4; }, RobotMode::fault, FaultCode::overrun);
  ended([](ModeInputs& in) { in.storage_ok = false; }, RobotMode::fault, FaultCode::storage);
  ended([](ModeInputs& in) { in.elapsed = 1000; }, RobotMode::fault, FaultCode::time_limit);
  for (const RobotMode mode : {RobotMode::disarmed, RobotMode::armed, RobotMode::fault}) {
    ended([&](ModeInputs& in) { in.partner.mode = mode; }, RobotMode::fault, FaultCode::partner);
  }
  // Without a session only an emergency stop counts.
  for (const Operation wish : {Operation::stop, Operation::disarm, Operation::start}) {
    ModeInputs in = good();
    in.order(wish, false);
    CHECK(carrying().step(in).wheels);
  }
}

void nothing_else_ends_a_carry() {
  ModeInputs in = good();
  in.preflight = {};
  in.overruns = 3;
  for (const RobotMode mode : {RobotMode::off, RobotMode::ready, RobotMode::holding}) {
    in.partner = {mode, 20};
    for (const Operation wish : {Operation::arm, Operation::start, Operation::release}) {
      in.order(wish, true);
      for (const bool travels : {true, false}) {
        in.travels = travels;
        ModeMachine machine = carrying();
        const ModeOutputs out = machine.step(in);
        CHECK(out.wheels && out.code == FaultCode::none);
        CHECK(out.mode == (travels ? RobotMode::carrying : RobotMode::holding));
        in.travels = true;
        CHECK(machine.step(in).mode == RobotMode::carrying);
      }
    }
  }
}

void limits_of_time() {
  // A carry has lasted one tick when `carrying` returns.
  ModeMachine late = carrying();
  ModeInputs in = good();
  in.elapsed = 998;
  CHECK(late.step(in).wheels);
  in.elapsed = 1;
  CHECK(ends(late, in, RobotMode::fault, FaultCode::time_limit));
  // Silence, by the settings.
  ModeInputs silent = good();
  silent.elapsed = 50;
  silent.partner.age = 21;
  CHECK(ends(carrying(), silent, RobotMode::fault, FaultCode::partner_lost));
  silent.partner.age = 20;
  CHECK(carrying().step(silent).wheels);
  ModeInputs deaf = good();
  deaf.elapsed = 50;
  deaf.station_age = 51;
  CHECK(ends(carrying(), deaf, RobotMode::fault, FaultCode::station_lost));
  ModeSettings settings = settings_for_steps();
  deaf.station_age = 50;
  CHECK(carrying().step(deaf).wheels);
  deaf.station_age = never;
  settings.station_lost = StationLost::carry_on;
  settings.partner_lost = PartnerLost::controller;
  deaf.partner.age = never;
  CHECK(carrying(settings).step(deaf).wheels);
  // Without encoders time in mode carrying covers the distance.
  settings.travel = 100;
  ModeMachine blind = carrying(settings);
  in.travels = false;
  blind.step(in);
  in.elapsed = 500;
  CHECK(blind.step(in).mode == RobotMode::holding);
  in.elapsed = 1;
  in.travels = true;
  CHECK(blind.step(in).mode == RobotMode::carrying);
  in.elapsed = 97;
  CHECK(blind.step(in).wheels);
  in.elapsed = 1;
  CHECK(ends(blind, in, RobotMode::done));
}

void a_stop_is_latched() {
  ModeMachine machine = carrying();
  ModeInputs in = good();
  in.stop = true;
  machine.step(in);
  for (const Operation wish : {Operation::arm, Operation::disarm, Operation::start}) {
    CHECK(ends(machine, with(wish), RobotMode::stopped));
  }
  // A stop of the same step, or a button that is still held, prevails over the release.
  ModeInputs both = with(Operation::release);
  both.order(Operation::e_stop, false);
  both.order(Operation::release, true);
  CHECK(ends(machine, both, RobotMode::stopped));
  // The partner may still be stopped. It does not stop a released robot, which cannot be armed.
  ModeInputs release = with(Operation::release);
  release.partner_stop = true;
  CHECK(machine.step(release).mode == RobotMode::disarmed);
  ModeInputs arm = with(Operation::arm);
  arm.partner_stop = true;
  CHECK(machine.step(arm).mode == RobotMode::disarmed);
  CHECK(machine.step(with(Operation::arm)).mode == RobotMode::armed);
}

void a_fault_is_latched() {
  ModeMachine machine = carrying();
  ModeInputs in = good();
  in.driver_ok = false;
  machine.step(in);
  for (const Operation wish : {Operation::start, Operation::release}) {
    CHECK(ends(machine, with(wish), RobotMode::fault, FaultCode::driver));
  }
  CHECK(ends(machine, with(Operation::disarm), RobotMode::disarmed));
  CHECK(ends(machine, with(Operation::arm), RobotMode::armed));
  in.order(Operation::arm, true);
  in.preflight.contact = false;
  CHECK(ends(machine, in, RobotMode::fault, FaultCode::driver));
  in.driver_ok = true;
  CHECK(ends(machine, in, RobotMode::fault, FaultCode::contact));
}

void what_a_boot_does() {
  ModeSettings settings = settings_for_steps();
  const auto booted = [&](const StoredMode& stored, const ModeInputs& in) {
    return ModeMachine(settings, stored).step(in);
  };
  ModeInputs in = good();
  in.partner = {};
  in.station_age = never;
  CHECK(booted({true, false}, in).mode == RobotMode::disarmed);
  settings.after_reboot = AfterReboot::rejoin;
  CHECK(booted({false, false}, in).mode == RobotMode::disarmed);
  CHECK(booted({true, true}, in).mode == RobotMode::stopped);
  CHECK(booted({false, true}, in).mode == RobotMode::stopped);
  const ModeOutputs out = booted({true, false}, in);
  CHECK(out.wheels && out.controller == ControllerStart::reboot && out.store.carries);
  // Nobody has been heard since the boot. Silence counts from there.
  ModeMachine machine(settings, {true, false});
  machine.step(in);
  in.elapsed = 20;
  CHECK(machine.step(in).wheels);
  in.elapsed = 1;
  CHECK(ends(machine, in, RobotMode::fault, FaultCode::partner_lost));
  in.partner_stop = true;
  CHECK(booted({true, false}, in).mode == RobotMode::stopped);
  in.partner_stop = false;
  in.storage_ok = false;
  CHECK(booted({true, false}, in).code == FaultCode::storage);
  CHECK(booted({false, true}, in).mode == RobotMode::stopped);
}

void a_second_carry_starts_anew() {
  ModeSettings settings = settings_for_steps();
  settings.travel = 600;
  ModeMachine machine = carrying(settings);
  ModeInputs in = good();
  in.elapsed = 599;
  CHECK(machine.step(in).mode == RobotMode::done);
  // A refusal is reported in this mode, too.
  ModeInputs arm = with(Operation::arm);
  arm.preflight.battery = false;
  CHECK(ends(machine, arm, RobotMode::done, FaultCode::battery));
  machine.step(with(Operation::arm));
  machine.step(with(Operation::start));
  CHECK(machine.step(good()).controller == ControllerStart::fresh);
  CHECK(machine.step(in).wheels);
  in.elapsed = 1;
  CHECK(ends(machine, in, RobotMode::done));
}

void a_fault_before_the_start() {
  ModeMachine armed = disarmed();
  armed.step(with(Operation::arm));
  ModeMachine ready = armed;
  ready.step(with(Operation::start));
  ModeInputs in = good();
  in.partner = {RobotMode::armed, 0};
  for (const ModeMachine& machine : {armed, ready}) {
    ModeInputs spoilt = in;
    spoilt.driver_ok = false;
    CHECK(ends(machine, spoilt, RobotMode::fault, FaultCode::driver));
    spoilt = in;
    spoilt.overruns = 4;
    CHECK(ends(machine, spoilt, RobotMode::fault, FaultCode::overrun));
    spoilt = in;
    spoilt.station_age = 51;
    CHECK(ends(machine, spoilt, RobotMode::fault, FaultCode::station_lost));
    spoilt = in;
    spoilt.order(Operation::disarm, true);
    CHECK(ends(machine, spoilt, RobotMode::disarmed));
    // What the partner does never ends the wait.
    for (const RobotMode mode : {RobotMode::disarmed, RobotMode::done, RobotMode::fault}) {
      spoilt = in;
      spoilt.partner = {mode, 0};
      CHECK(ends(machine, spoilt, machine.memory().mode));
    }
  }
}

// The search treats these modes of the partner as one.
void some_modes_sound_alike() {
  for (unsigned mode = 0; mode < wire::robot_modes; ++mode) {
    for (unsigned partner = 0; partner < wire::robot_modes; ++partner) {
      for (const std::uint32_t age : {0U, 20U, 21U, never}) {
        for (const Operation wish : {Operation::arm, Operation::start, Operation::release}) {
          const ModeMemory memory{static_cast<RobotMode>(mode), FaultCode::none, 30, 0};
          ModeInputs in = with(wish);
          in.partner = {static_cast<RobotMode>(partner), age};
          ModeMachine one(settings_for_steps(), {}, memory, mode_table);
          ModeMachine two = one;
          one.step(in);
          in.partner.mode = as_heard(in.partner.mode);
          two.step(in);
          CHECK(one.memory() == two.memory());
        }
      }
    }
  }
}

}  // namespace

int main() {
  arming_needs_every_check();
  a_robot_starts_with_its_partner();
  a_start_is_void_once_the_partner_is_silent();
  each_end_of_a_carry();
  nothing_else_ends_a_carry();
  limits_of_time();
  a_stop_is_latched();
  a_fault_is_latched();
  a_fault_before_the_start();
  a_second_carry_starts_anew();
  what_a_boot_does();
  some_modes_sound_alike();
}
