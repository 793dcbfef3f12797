// SPDX-License-Identifier: Apache-2.0
// A controller that executes commands given from outside, for programs that decide tick by tick
// instead of being called, such as learning environments.
//
// The external program owns the command, so the command survives the controller, even a reboot of
// its robot. A message is consumed in the tick in which it is available, or left in the inbox. A
// message to send is sent once.
#pragma once

#include "palmbots/control/distributed.hpp"

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
  explicit ExternalController(const ExternalCommand* command) : command_(command) {}

  Distributed::Output step(Distributed::Input) const {
    return {command_->command, command_->send, command_->read};
  }
  Distributed::StateOutput now() const {
    return {' ', command_->command, false, MessageKind::none};
  }

 private:
  const ExternalCommand* command_;
};

}  // namespace palmbots
