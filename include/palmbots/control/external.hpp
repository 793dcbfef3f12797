// SPDX-License-Identifier: Apache-2.0
// A controller that does what it is told from outside: for programs that decide tick by tick, such
// as learning environments, instead of being called.
//
// The order lies with whoever gives it and outlives the controller, also a reboot of its robot. A
// message is read in the tick in which it is there, or left where it is; one that is sent goes out
// once.
#pragma once

#include "palmbots/control/distributed.hpp"

namespace palmbots {

// What one robot is to do from the next tick on.
struct ExternalCommand {
  Command command{Palm::steep, Move::hold};
  MessageKind send = MessageKind::none;  // in the next tick
  bool read = true;                      // the oldest message is used up
};

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
