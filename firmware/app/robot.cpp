// SPDX-License-Identifier: Apache-2.0
// The program of a robot. Once per control tick it reads its switches and the packets that have
// arrived, lets the core decide (palmbots/runtime/robot_runtime.hpp), drives palm and wheels, stores
// what has to survive a boot, and sends. Between ticks the processor sleeps.
#include <cstddef>
#include <cstdint>

#include "../board/board.hpp"
#include "arm.hpp"
#include "controller.hpp"
#include "missed_ticks.hpp"
#include "only_show.hpp"
#include "outbox.hpp"
#include "palm_switches.hpp"
#include "palmbots/runtime/hand_controls.hpp"
#include "picture.hpp"
#include "settings.hpp"
#include "storage.hpp"
#include "strangers.hpp"
#include "tick_record.hpp"

// Without settings: `palmbots firmware` replaces them.
[[gnu::section(".settings"),
  gnu::used]] constinit const palmbots::app::SettingsPage settings_page{};

palmbots::app::TickRecord tick_record;

namespace palmbots::app {

namespace {

bool are_right(const SettingsPage& page) {
  const Settings& s = page.settings;
  if (s.magic != Settings::right_magic || s.format != Settings::newest_format) return false;
  if (s.check != crc32(&s, offsetof(Settings, check))) return false;
  return s.controller != policy_board_number ||
         page.table_check == crc32(&page.table, sizeof page.table);
}

class Program {
 public:
  Program(const SettingsPage& page, Storage& storage)
      : settings_(page.settings),
        storage_(storage),
        robot_(make_robot(page, storage.content())),
        switches_(page.settings),
        outbox_(page.settings.period_us, board::random_word()),
        palm_(storage.content().assists ? Palm::shallow : Palm::steep),
        arm_(page.settings, storage.content().arm,
             storage.content().epoch == page.settings.first_epoch),
        pulse_(settings_.palm_us[static_cast<std::size_t>(palm_)]),
        wheel_{settings_.wheels[0][1][0], settings_.wheels[1][1][0]} {
    const bool begins = storage.content().epoch == settings_.first_epoch;
    if (settings_.is_under_way != 0 && begins && robot_.greets()) greetings_ = 4;
  }

  [[noreturn]] void run() {
    while (true) {
      board::sleep();
      board::serve_radio();
      if (board::take_slot()) board::next_row();
      if (board::take_alarm()) outbox_.send_next();
      outbox_.go_on();
      const std::uint16_t elapsed = board::take_ticks();
      if (elapsed == 0) continue;
      outbox_.begin_tick();
      if (greetings_ > 0) {
        greet();
      } else {
        tick(elapsed);
      }
      board::feed_watchdog();
      maintain();
    }
  }

 private:
  // Before a carry in lockstep, robots that need a session say hello in turn: left, right, left; or,
  // if they talk to the station, left and then right, which answers.
  void greet() {
    board::RadioPacket packet;
    while (board::take_packet(packet)) robot_.receive({packet.bytes.data(), packet.size});
    tick_record.rejected = robot_.received().rejected;
    const unsigned round = 4U - greetings_--;
    const bool is_turn = robot_.greets_station() ? round == 2U * settings_.role
                                                 : round < 3 && round % 2 == settings_.role;
    wire::Bytes bytes;
    if (!is_turn || !robot_.greet(bytes)) return;
    outbox_.clear();
    outbox_.add(bytes);
    outbox_.release();
  }

  void tick(std::uint16_t elapsed) {
    missed_.count(elapsed);
    robot_.begin(elapsed);
    board::RadioPacket packet;
    while (board::take_packet(packet)) robot_.receive({packet.bytes.data(), packet.size});
    switches_.read(board::read_switches(), palm_, elapsed);
    const BoardFault fault = fault_now();
    const std::uint8_t held = board::read_buttons();
    const runtime::HandWish wish = hands_.step({(held & 1) != 0, (held & 2) != 0}, mode_);
    if (wish.operates) robot_.operate(wish.operation);
    robot_.step(reading(fault, wish.stop), out_);
    mode_ = out_.mode.mode;
    drive(elapsed);
    const bool is_stored = store();
    say(is_stored);
    strangers_.count(robot_.endpoint(), elapsed, settings_.lease);
    record(elapsed, show(fault));
  }

  BoardFault fault_now() {
    const std::uint16_t mv = board::battery_mv();
    const bool is_weak = settings_.least_battery_mv > 0 && mv < settings_.least_battery_mv;
    is_battery_ok_ = !is_weak;
    // A supply that breaks down under load recovers when the load is gone, so the fault stays until
    // the robot is armed anew.
    if (board::take_brown_out()) supply_failed_ = true;
    if (mode_ == wire::RobotMode::disarmed) supply_failed_ = false;
    if (switches_.fault() != BoardFault::none) return switches_.fault();
    if (uses_motor_board() && !board::motor_board_answers()) return BoardFault::motor;
    return supply_failed_ || is_weak ? BoardFault::supply : BoardFault::none;
  }

  runtime::Reading reading(BoardFault fault, bool stop) const {
    runtime::Reading reading{{switches_.sign(), switches_.at_target()}};
    reading.contact = switches_.has_contact();
    reading.covered = switches_.at_goal();
    reading.beneath = switches_.is_beneath();
    reading.arm_there = arm_.is_there(switches_.at_target());
    reading.arm_steps = arm_.steps();
    reading.battery_ok = is_battery_ok_;
    reading.driver_ok = !rests_wheels(fault);
    reading.storage_ok = storage_.works();
    reading.stop = stop;
    reading.overruns = missed_.recent();
    reading.battery_mv = board::battery_mv();
    reading.stopping = settings_.stopping;
    return reading;
  }

  // Carries out what has been decided. The palm keeps its angle while the controller does not run,
  // also over a boot.
  void drive(std::uint16_t elapsed) {
    const Command& command = out_.decision.command;
    const bool wheels = out_.mode.wheels;
    if (wheels) palm_ = command.palm;
    const std::uint16_t target = settings_.palm_us[static_cast<std::size_t>(palm_)];
    pulse_ = static_cast<std::uint16_t>(nearer(
        static_cast<std::int16_t>(pulse_), static_cast<std::int16_t>(target), settings_.palm_slew));
    for (std::size_t side = 0; side < 2; ++side) {
      const auto& table = settings_.wheels[side];
      const std::int16_t rest = table[1][0];
      const std::int16_t wanted =
          table[static_cast<std::size_t>(command.stop)][static_cast<std::size_t>(command.move)];
      // A wheel that may not turn rests at once.
      wheel_[side] = wheels ? nearer(wheel_[side], wanted, settings_.wheel_slew) : rest;
    }
    const bool lifts = is_job(settings_, Job::lifts);
    if (lifts) arm_.move(out_.arm, palm_, out_.arm_ends, elapsed);
    // A servo without pulses rests, as after a reset.
    board::Pulses pulses{pulse_, 0, 0, lifts ? arm_.pulse() : std::uint16_t{0}};
    if (uses_motor_board()) {
      board::write_motor_board(wheel_[0], wheel_[1]);
    } else if (wheels) {
      pulses[1] = static_cast<std::uint16_t>(wheel_[0]);
      pulses[2] = static_cast<std::uint16_t>(wheel_[1]);
    }
    board::write_servos(pulses);
  }

  // The next value on the way from one to another.
  static std::int16_t nearer(std::int16_t now, std::int16_t wanted, int most) {
    const int way = wanted - now;
    return static_cast<std::int16_t>(now + (way > most ? most : way < -most ? -most : way));
  }

  // Stores what the partner relies on after a boot, before it is said.
  bool store() {
    Stored wanted = storage_.content();
    wanted.assists =
        palm_ == Palm::shallow && (out_.mode.wheels ? out_.decision.assists : wanted.assists);
    wanted.carries = out_.mode.store.carries;
    wanted.stop = out_.mode.store.stop;
    wanted.holds = out_.holds;
    if (is_job(settings_, Job::lifts)) wanted.arm = arm_.stored();
    return storage_.keep(wanted);
  }

  // A robot that does not carry promises nothing, and must pass on a stop at once.
  void say(bool is_stored) {
    outbox_.clear();
    for (std::size_t i = 0; i < out_.packet_count; ++i) {
      const runtime::Outgoing& packet = out_.packets[i];
      const bool may_go = is_stored || packet.receiver == wire::Role::station || !out_.mode.wheels;
      if (may_go) outbox_.add(packet.bytes);
    }
    outbox_.release();
  }

  // Shows the mode and what is wrong, and returns what that is.
  BoardFault show(BoardFault fault) {
    if (fault == BoardFault::none && !storage_.works()) fault = BoardFault::storage;
    if (fault == BoardFault::none && strangers_.are_all_there_is()) fault = BoardFault::stranger;
    if (fault == BoardFault::none && missed_.recent() > settings_.most_overruns) {
      fault = BoardFault::late;
    }
    board::show(
        picture_of(mode_, out_.mode.code, fault, switches_.has_contact(), switches_.sign()));
    return fault;
  }

  // A page is erased only while nothing can move.
  void maintain() {
    if (mode_ != wire::RobotMode::disarmed || !storage_.wants_erase()) return;
    storage_.erase();
  }

  void record(std::uint16_t elapsed, BoardFault fault) {
    TickRecord& r = tick_record;
    r.rejected = robot_.received().rejected;
    r.late = robot_.received().late;
    r.missed = missed_.total();
    r.palm = static_cast<std::uint8_t>(palm_);
    r.move = static_cast<std::uint8_t>(out_.decision.command.move);
    r.stop = static_cast<std::uint8_t>(out_.decision.command.stop);
    r.wheels = static_cast<std::uint8_t>(out_.mode.wheels);
    r.name = static_cast<std::uint8_t>(robot_.name());
    r.waits = static_cast<std::uint8_t>(robot_.waits());
    r.awaits = static_cast<std::uint8_t>(robot_.awaits());
    r.message = static_cast<std::uint8_t>(out_.decision.message);
    r.mode = static_cast<std::uint8_t>(mode_);
    r.code = static_cast<std::uint8_t>(out_.mode.code);
    r.fault = static_cast<std::uint8_t>(fault);
    r.assists = static_cast<std::uint8_t>(storage_.content().assists);
    r.packets = static_cast<std::uint8_t>(outbox_.count());
    r.phase = static_cast<std::uint8_t>(robot_.phase());
    r.arm = static_cast<std::uint8_t>(out_.arm);
    r.holds = static_cast<std::uint8_t>(storage_.content().holds);
    r.rejected_phases = static_cast<std::uint8_t>(robot_.received_phases().rejected);
    r.late_phases = static_cast<std::uint8_t>(robot_.received_phases().late);
    r.ticks += elapsed;
  }

  bool uses_motor_board() const {
    return static_cast<WheelKind>(settings_.wheel_kind) == WheelKind::motor_board;
  }

  const Settings& settings_;
  Storage& storage_;
  runtime::Robot& robot_;
  PalmSwitches switches_;
  MissedTicks missed_;
  Outbox outbox_;
  Strangers strangers_;
  runtime::HandControls hands_;
  runtime::Outputs out_{};
  wire::RobotMode mode_ = wire::RobotMode::off;
  Palm palm_;
  Arm arm_;
  std::uint16_t pulse_;     // of the palm [µs]
  std::int16_t wheel_[2];   // pulse or speed of each wheel
  unsigned greetings_ = 0;  // rounds still to come
  bool is_battery_ok_ = true;
  bool supply_failed_ = false;
};

// Not on the stack, and made only once everything it needs is there.
alignas(Program) std::byte program_bytes[sizeof(Program)];
Storage storage;

}  // namespace

}  // namespace palmbots::app

extern "C" void run_program() {
  using namespace palmbots;
  board::start();
  const app::SettingsPage& page = app::flashed_settings();
  if (!app::are_right(page)) app::only_show(app::BoardFault::settings);
  const app::Settings& settings = page.settings;
  app::storage.open();
  if (app::storage.wants_erase()) app::storage.erase();
  app::Stored stored = app::storage.content();
  stored.epoch = stored.epoch < settings.first_epoch ? settings.first_epoch : stored.epoch + 1;
  // Without a counted boot nothing may be sent: an epoch must never be used twice.
  if (stored.epoch > settings.last_epoch || !app::storage.keep(stored)) {
    app::only_show(app::BoardFault::storage);
  }
  board::start_switches();
  board::start_servos();
  if (settings.wheel_kind == static_cast<std::uint8_t>(app::WheelKind::motor_board)) {
    board::start_motor_board();
  }
  board::start_battery(settings.least_battery_mv);
  board::start_radio(settings.channel, settings.power_dbm);
  auto& program = *new (app::program_bytes) app::Program(page, app::storage);
  board::start_watchdog(settings.watchdog_us);
  board::start_ticks(settings.period_us);
  program.run();
}
