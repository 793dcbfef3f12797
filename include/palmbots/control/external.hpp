// SPDX-License-Identifier: Apache-2.0
// A controller that executes commands given from outside, for programs that decide tick by tick
// instead of being called, such as learning environments.
//
// The external program owns the command, so the command survives the controller, even a reboot of
// its robot. A message is consumed in the tick in which it is available, or left in the inbox. A
// message to send is sent once.
#pragma once

#include "palmbots/control/table.hpp"

namespace palmbots {

// What one robot does from the next tick on.
struct ExternalCommand {
  Command command{Palm::steep, Move::hold};
  MessageKind send = MessageKind::none;  // in the next tick
  bool read = true;                      // the oldest message is consumed
};

// A controller that executes the command it points to. It reports no case and never waits.
class ExternalController {
 public:
  static constexpr Mail mail = Mail::queue;
  static constexpr bool has_clock = false;

  explicit ExternalController(const ExternalCommand* command) : command_(command) {}

  RobotOutput step(const RobotInput&) const {
    const MessageKind send = command_->send;
    return {command_->command, send, send != MessageKind::none, command_->read};
  }
  ExternalController booted() const { return *this; }
  static constexpr char name() { return ' '; }
  static constexpr bool waits() { return false; }
  static constexpr MessageKind awaits() { return MessageKind::none; }
  static constexpr bool stopped() { return false; }

 private:
  const ExternalCommand* command_;
};

}  // namespace palmbots
