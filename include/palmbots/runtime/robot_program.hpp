// SPDX-License-Identifier: Apache-2.0
// The program of a robot: a controller with what it needs to talk to its partner or to the station.
//
// Every program has the same interface, so that one runtime (runtime/robot_runtime.hpp) serves all
// controllers. It provides
//   begin(tick)        the controller starts, so many ticks after this boot
//   pass(elapsed)      the ticks since the last step, before anything that arrived in them
//   hear(decoded)      a packet that arrived, with its verdict; returns how it was taken
//   step(observation)  → Decision: one tick
//   name(), awaits(), waits()   the case, and what it waits for, for logs
//   answers_with_hello whether a packet of the partner without a session is answered by a hello
//   greets             whether a hello opens a session before a carry in lockstep, and with_station
//                      whether that is with the station
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/distributed.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/wire/codec.hpp"
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
  wire::State state{};                              // kind state, without mode and stop
  Centralized::Report report{};                     // kind report
  MessageKind word = MessageKind::none;             // of the state, for logs
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

// A robot that sends beacons or signs, or nothing: Resilient, and every table
// (control/table_robot.hpp).
template <class Robot>
class BeaconProgram {
 public:
  static constexpr bool answers_with_hello = false;  // robots send each other only beacons
  static constexpr bool greets = false;
  static constexpr bool with_station = false;

  // `lease` is the greatest age at which a beacon counts [ticks], `epoch` the number of this boot.
  constexpr BeaconProgram(const Robot& robot, wire::Language language, std::uint16_t lease,
                          std::uint32_t epoch)
      : robot_(robot), language_(language), lease_(lease), epoch_(epoch), receiver_(epoch) {}

  constexpr void begin(std::uint32_t tick) { receiver_ = BeaconReceiver(epoch_, tick); }

  constexpr void pass(std::uint16_t elapsed) {
    elapsed_ = elapsed;
    receiver_.tick(elapsed);
    news_ = false;
  }

  constexpr Taken hear(const wire::Decoded& got) {
    if (is_old(got)) return Taken::rejected;
    if (!wire::hear(receiver_, got, language_)) return Taken::ignored;
    news_ = true;
    return receiver_.age() > lease_ ? Taken::late : Taken::taken;
  }

  Decision step(const Observation& seen) {
    const Beacon& newest = receiver_.newest();
    const auto out = robot_.step({seen.sign, seen.palm_at_target, elapsed_,
                                  news_ ? newest.message : MessageKind::none, newest.stopped,
                                  newest.ready, receiver_.age()});
    Decision decision{out.command, out.send};
    if constexpr (requires { out.assists; }) decision.assists = out.assists;
    if (out.send) {
      decision.state.language = language_;
      decision.state.word = out.message;
      decision.state.ready = out.ready;
      decision.state.at_rest = robot_.stopped();
      decision.word = out.message;
    }
    return decision;
  }

  constexpr char name() const { return robot_.now().name; }
  constexpr bool waits() const { return robot_.now().waits; }
  constexpr MessageKind awaits() const { return waits() ? MessageKind::ack : MessageKind::none; }
  constexpr const Robot& robot() const { return robot_; }

 private:
  Robot robot_;
  wire::Language language_;
  std::uint16_t lease_;
  std::uint32_t epoch_;
  BeaconReceiver receiver_;
  std::uint16_t elapsed_ = 1;
  bool news_ = false;
};

// A robot that exchanges the messages of Table 2: Distributed, machines derived from a policy, and
// classes from outside. Messages wait until the controller reads them.
template <class Controller>
class MessageProgram {
 public:
  static constexpr bool answers_with_hello = true;
  static constexpr bool greets = true;
  static constexpr bool with_station = false;

  explicit MessageProgram(Controller controller) : controller_(std::move(controller)) {}

  constexpr void begin(std::uint32_t) {}

  constexpr void pass(std::uint16_t) {}

  constexpr Taken hear(const wire::Decoded& got) {
    if (is_old(got) || got.verdict == wire::Verdict::no_session) return Taken::rejected;
    if (got.packet.kind != wire::PacketKind::state) return Taken::ignored;
    const wire::State state = wire::state_of(got.packet.payload);
    if (state.language != wire::Language::messages) return Taken::ignored;
    if (waiting_ == capacity) return Taken::rejected;
    inbox_[(first_ + waiting_++) % capacity] = state.word;
    return Taken::taken;
  }

  Decision step(const Observation& seen) {
    const MessageKind oldest = waiting_ > 0 ? inbox_[first_] : MessageKind::none;
    const auto out = controller_.step({seen.sign, oldest, seen.palm_at_target});
    if (out.read && oldest != MessageKind::none) {
      first_ = (first_ + 1) % capacity;
      --waiting_;
    }
    Decision decision{out.command, out.send != MessageKind::none};
    if (decision.speaks) {
      decision.state.language = wire::Language::messages;
      decision.state.word = decision.word = out.send;
    }
    return decision;
  }

  char name() const { return controller_.now().name; }
  bool waits() const { return controller_.now().waits; }
  MessageKind awaits() const { return controller_.now().awaits; }

 private:
  static constexpr std::size_t capacity = 256;

  Controller controller_;
  std::array<MessageKind, capacity> inbox_{};
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
};

// A robot of the centralized algorithm: it reports in every tick, and executes the newest command.
class ReportProgram {
 public:
  static constexpr bool answers_with_hello = false;  // reports answer
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

 private:
  Command command_{Palm::steep, Move::hold};
  Palm obeyed_;
};

}  // namespace palmbots::runtime
