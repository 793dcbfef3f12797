// SPDX-License-Identifier: Apache-2.0
// The program of a robot, packets in and decisions out.
//
// Every program has the same interface, so that one runtime (runtime/robot_runtime.hpp) serves all
// controllers. It provides
//   begin(tick)        the controller starts, so many ticks after this boot
//   pass(elapsed)      the ticks since the last step, before anything that arrived in them
//   hear(decoded)      a packet that arrived, with its verdict; returns how it was taken
//   step(observation)  → Decision: one tick
//   name(), awaits(), waits()   the case, and what it waits for, for logs
//   silence()          how long it may say nothing to its partner by its own rules [ticks]; 0: it
//                      repeats what it says
//   repeats            whether what it said may be said again at any time
//   answers_with_hello whether a packet of the partner without a session is answered by a hello
//   greets             whether a hello opens a session before a carry in lockstep, and with_station
//                      whether that is with the station
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "palmbots/control/mailbox.hpp"
#include "palmbots/wire/packet.hpp"

namespace palmbots::runtime {

// What a robot senses in a tick.
struct Observation {
  Sign sign;
  bool palm_at_target;  // the palm has reached the angle last commanded
};

// What a program decides in a tick, and what it says to the partner or to the station.
struct Decision {
  Command command{Palm::steep, Move::hold, true};
  bool speaks = false;
  wire::PacketKind kind = wire::PacketKind::state;  // of what it says
  wire::State state{};                              // kind state or phase, without mode and stop
  Centralized::Report report{};                     // kind report
  MessageKind message = MessageKind::none;          // of the state, for logs
  // To be stored before the packets of this tick are sent, and given to the program after a boot.
  bool assists = false;
};

// How a program took a packet.
enum class Taken : std::uint8_t {
  ignored,  // not for a program
  taken,
  late,      // taken, but older than the lease
  rejected,  // a copy, an overtaken packet, or one without a session
};

// True if the verdict counts against the sender's link.
constexpr bool is_old(const wire::Decoded& got) { return got.verdict == wire::Verdict::stale; }

// A robot that decides by itself, with any controller (control/mailbox.hpp).
template <class Controller>
class PartnerProgram {
  static constexpr Mail mail = Controller::mail;

 public:
  // Robots that send beacons send each other nothing else.
  static constexpr bool answers_with_hello = mail == Mail::queue;
  static constexpr bool repeats = mail == Mail::beacons;
  static constexpr bool greets = mail == Mail::queue;
  static constexpr bool with_station = false;

  // `epoch` is the number of this boot.
  constexpr PartnerProgram(Controller controller, std::uint32_t epoch)
      : program_(std::move(controller)), epoch_(epoch) {
    begin(0);
  }

  constexpr void begin(std::uint32_t tick) { program_.boot(epoch_, tick); }
  constexpr void pass(std::uint16_t elapsed) { program_.pass(elapsed); }

  // A beacon with the verdict `no_session` counts, too. It is the newest and has unknown age
  // (`BeaconReceiver::age`), so the partner is treated as silent until it answers. If it were
  // ignored, the beacon before it would still count as the newest, although this robot's packets
  // acknowledge the new one and the partner therefore regards the old one as forgotten. For the same
  // reason such robots send each other only beacons of their language during a carry.
  constexpr Taken hear(const wire::Decoded& got) {
    if (is_old(got)) return Taken::rejected;
    const wire::Packet& packet = got.packet;
    auto& mailbox = program_.mailbox();
    if constexpr (mail == Mail::queue) {
      if (got.verdict == wire::Verdict::no_session) return Taken::rejected;
    }
    if (packet.kind != wire::kind_of(language)) return Taken::ignored;
    const wire::State state = wire::state_of(packet.payload);
    if (state.language != language) return Taken::ignored;
    if constexpr (mail == Mail::queue) {
      return mailbox.accept(state.message) ? Taken::taken : Taken::rejected;
    } else if constexpr (mail == Mail::beacons) {
      const Beacon beacon{state.message,
                          state.at_rest,
                          state.ready,
                          {packet.sent.epoch, packet.sent.sequence},
                          {packet.heard.epoch, packet.heard.sequence}};
      if (!mailbox.accept(beacon)) return Taken::ignored;
      return mailbox.age() > program_.lease() ? Taken::late : Taken::taken;
    }
    return Taken::ignored;
  }

  Decision step(const Observation& seen) {
    const RobotOutput out = program_.step(seen.sign, seen.palm_at_target);
    Decision decision{out.command, out.send};
    decision.assists = out.assists;
    if (out.send || repeats) {
      decision.kind = wire::kind_of(language);
      decision.state.language = language;
      decision.state.message = decision.message = out.message;
      decision.state.ready = out.ready;
      decision.state.at_rest = controller().stopped();
    }
    return decision;
  }

  char name() const { return controller().name(); }
  bool waits() const { return controller().waits(); }
  MessageKind awaits() const { return controller().awaits(); }
  std::uint32_t silence() const {
    if constexpr (requires { requires Controller::Beacons::spares; }) {
      return Controller::Beacons::longest(controller().clock().times);
    }
    return 0;
  }
  const Controller& controller() const { return program_.controller(); }
  Controller& controller() { return program_.controller(); }

 private:
  // The language that has the messages of the controller.
  static constexpr wire::Language language = [] {
    if constexpr (mail == Mail::beacons) {
      constexpr auto found = wire::language_of(Controller::outputs[0].message);
      static_assert(std::ranges::all_of(Controller::outputs, [](const TableOutput& output) {
        return wire::has_message(found, output.message);
      }));
      return found;
    }
    return mail == Mail::queue ? wire::Language::messages : wire::Language::none;
  }();

  ControllerWithMail<Controller> program_;
  std::uint32_t epoch_;
};

// A robot without a controller: the table of its job does everything.
class NoProgram {
 public:
  static constexpr bool answers_with_hello = false;
  static constexpr bool repeats = false;
  static constexpr bool greets = false;
  static constexpr bool with_station = false;

  constexpr void begin(std::uint32_t) {}
  constexpr void pass(std::uint16_t) {}
  constexpr Taken hear(const wire::Decoded&) { return Taken::ignored; }
  constexpr Decision step(const Observation&) { return {}; }
  static constexpr char name() { return ' '; }
  static constexpr bool waits() { return false; }
  static constexpr MessageKind awaits() { return MessageKind::none; }
  static constexpr std::uint32_t silence() { return 0; }
};

// A robot of the centralized algorithm: it reports in every tick, and executes the newest command.
class ReportProgram {
 public:
  static constexpr bool answers_with_hello = false;  // reports answer
  static constexpr bool repeats = false;
  static constexpr bool greets = true;
  static constexpr bool with_station = true;

  // After a boot: whether the palm had been commanded up, as it was stored.
  constexpr explicit ReportProgram(bool palm_up = false)
      : obeyed_(palm_up ? Palm::shallow : Palm::steep) {}

  constexpr void begin(std::uint32_t) {}
  constexpr void pass(std::uint16_t) {}

  constexpr Taken hear(const wire::Decoded& got) {
    if (is_old(got) || got.verdict == wire::Verdict::no_session) return Taken::rejected;
    if (got.packet.kind != wire::PacketKind::command) return Taken::ignored;
    command_ = wire::command_of(got.packet.payload);
    return Taken::taken;
  }

  Decision step(const Observation& seen) {
    Decision decision{command_, true, wire::PacketKind::report};
    // `palm_at_target` refers to the command that was in force until this tick.
    decision.report = {seen.sign, obeyed_, seen.palm_at_target};
    obeyed_ = command_.palm;
    decision.assists = obeyed_ == Palm::shallow;
    return decision;
  }

  static constexpr char name() { return ' '; }  // the station knows the case
  static constexpr bool waits() { return false; }
  static constexpr MessageKind awaits() { return MessageKind::none; }
  static constexpr std::uint32_t silence() { return 0; }

 private:
  Command command_{Palm::steep, Move::hold};
  Palm obeyed_;
};

}  // namespace palmbots::runtime
