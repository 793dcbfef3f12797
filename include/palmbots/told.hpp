// A controller that does what it is told from outside: for programs that decide tick by tick, such as
// learning environments, instead of being called.
//
// The order lies with whoever gives it and outlives the controller, also a reboot of its robot. A letter
// is read in the tick in which it is there, or left where it is; one that is sent goes out once.
#pragma once

#include "palmbots/protocol.hpp"

namespace palmbots {

// What one robot is to do from the next tick on.
struct Order {
  Command command{Palm::steep, Move::hold};
  Letter send = Letter::none;  // in the next tick
  bool read = true;            // the oldest letter is used up
};

class Told {
 public:
  explicit Told(const Order* order) : order_(order) {}

  Distributed::Output step(Distributed::Input) const {
    return {order_->command, order_->send, order_->read};
  }
  Distributed::Doing now() const { return {' ', order_->command, false, Letter::none}; }

 private:
  const Order* order_;
};

}  // namespace palmbots
