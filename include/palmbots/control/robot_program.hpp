// SPDX-License-Identifier: Apache-2.0
// The program of a robot with what has arrived for it: a controller and its mailbox.
//
// The same program runs in simulations (sim/robot_team.hpp), on robots and on boards
// (runtime/robot_program.hpp), which differ in how a packet comes to it. A controller provides
//   mail, has_clock          how it hears its partner (control/table.hpp), and whether it counts time
//   step(RobotInput) → RobotOutput
//   booted()                 the controller after a boot
//   name(), waits(), awaits(), stopped()   for logs; whether it waits for its partner to travel
//   quiet(), idle()          how to skip steps without effect, as in control/table_robot.hpp; optional
//                            for one without a clock
// It is a table (control/table_robot.hpp), one that is known at run time only
// (control/machine_table.hpp), or made elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/table.hpp"

namespace palmbots {

// What has arrived and the controller has not yet heard. Nothing arrives where there is no mail.
template <Mail mail>
class Mailbox {
 public:
  constexpr void boot(std::uint32_t, std::uint32_t = 0) {}
  constexpr void pass(std::uint16_t) {}
  constexpr void show(RobotInput&) const {}
  constexpr void read() {}
};

// The messages of a queue, in order of arrival.
template <>
class Mailbox<Mail::queue> {
 public:
  constexpr void boot(std::uint32_t, std::uint32_t = 0) { head_ = tail_; }
  constexpr void pass(std::uint16_t) {}

  // Returns false if the mailbox is full; the message is then dropped.
  constexpr bool accept(MessageKind message) {
    if (tail_ - head_ == capacity) return false;
    messages_[tail_++ % capacity] = message;
    return true;
  }

  // The oldest message, or none.
  constexpr MessageKind oldest() const {
    return head_ != tail_ ? messages_[head_ % capacity] : MessageKind::none;
  }
  constexpr void show(RobotInput& in) const { in.message = oldest(); }
  constexpr void read() { ++head_; }

 private:
  static constexpr std::uint32_t capacity = 256;  // as many as a link of the simulation holds

  std::array<MessageKind, capacity>
      messages_;  // not cleared: head_ and tail_ delimit the valid part
  std::uint32_t head_ = 0;
  std::uint32_t tail_ = 0;
};

// The newest beacon, and whether it has arrived since the last step.
template <>
class Mailbox<Mail::beacons> : public BeaconReceiver {
 public:
  constexpr explicit Mailbox(std::uint32_t epoch = 1, std::uint32_t tick = 0)
      : BeaconReceiver(epoch, tick) {}
  constexpr void boot(std::uint32_t epoch, std::uint32_t tick = 0) { *this = Mailbox(epoch, tick); }
  constexpr void pass(std::uint16_t elapsed) { tick(elapsed); }

  // Returns false for a beacon that is not newer than all before it.
  constexpr bool accept(const Beacon& beacon) {
    const bool is_newer = BeaconReceiver::accept(beacon);
    news_ = news_ || is_newer;
    return is_newer;
  }
  constexpr void show(RobotInput& in) const {
    if (news_) in.message = newest().message;
    in.stopped = newest().stopped;
    in.ready = newest().ready;
    in.age = age();
  }
  constexpr void read() { news_ = false; }

 private:
  bool news_ = false;
};

template <class TheController>
class RobotProgram {
 public:
  using Controller = TheController;
  static constexpr Mail mail = Controller::mail;
  static constexpr bool has_clock = Controller::has_clock;

  constexpr explicit RobotProgram(Controller controller) : controller_(std::move(controller)) {}

  // The boot number `epoch` of this robot, or its start so many ticks after it.
  constexpr void boot(std::uint32_t epoch, std::uint32_t tick = 0) { mailbox_.boot(epoch, tick); }
  constexpr void reboot(std::uint32_t epoch) {
    controller_ = controller_.booted();
    mailbox_.boot(epoch);
  }

  // The ticks since the last step, before anything that arrived in them.
  constexpr void pass(std::uint16_t elapsed) {
    elapsed_ = elapsed;
    mailbox_.pass(elapsed);
  }

  constexpr Mailbox<mail>& mailbox() { return mailbox_; }
  constexpr const Mailbox<mail>& mailbox() const { return mailbox_; }

  RobotOutput step(Sign sign, bool palm_at_target) {
    RobotInput in{sign, palm_at_target, elapsed_};
    mailbox_.show(in);
    const RobotOutput out = controller_.step(in);
    if (mail == Mail::beacons || (out.read && in.message != MessageKind::none)) mailbox_.read();
    return out;
  }

  // Steps without effect may be skipped: how many there are, and their execution.
  std::uint16_t quiet(Sign sign, bool palm_at_target) const {
    if constexpr (mail == Mail::queue) {
      if constexpr (requires { controller_.quiet(sign, palm_at_target, MessageKind::none); }) {
        return controller_.quiet(sign, palm_at_target, mailbox_.oldest());
      }
      return 0;
    } else {
      return controller_.quiet(sign, palm_at_target);
    }
  }
  constexpr void idle(Sign sign, std::uint16_t steps) {
    if constexpr (has_clock) controller_.idle(sign, steps);
    mailbox_.pass(steps);
  }

  constexpr const Controller& controller() const { return controller_; }
  constexpr Controller& controller() { return controller_; }
  // The greatest age at which a beacon counts [ticks].
  constexpr std::uint16_t lease() const
    requires(mail == Mail::beacons)
  {
    return controller_.clock().times.lease;
  }

 private:
  Controller controller_;
  Mailbox<mail> mailbox_;
  std::uint16_t elapsed_ = 1;
};

}  // namespace palmbots
