// SPDX-License-Identifier: Apache-2.0
// The mailbox of a robot: what has arrived from its partner and the controller has not yet heard. It
// holds the newest beacon, or a queue of messages.
//
// BEACONS are what two robots send over a radio that loses, duplicates, delays and reorders.
// A beacon carries a message and a stamp of when it was sent: the boot epoch and the sender's own
// count of ticks since boot, which serves as sequence number. It also carries an *echo*: the newest
// stamp that the sender had received from its partner. The echo serves three purposes:
//   * Liveness: if my beacons do not arrive, the partner's echo stops advancing, so both robots
//     know.
//   * Age: a beacon that echoes what I sent at my tick s was sent after s. By my own clock it is
//     at most now − s old. No delay bound is trusted and no clocks are compared.
//   * Acknowledgement: it states which of my messages the partner knew when it sent the beacon.
// Only the newest beacon counts. An older one that arrives later, or a duplicate, is rejected. A
// reboot raises the epoch and outdates everything sent before it. Time is in control ticks.
//
// A CONTROLLER WITH MAIL is a controller and its mailbox. The same one runs in simulations (sim/robot_team.hpp), on robots and on boards
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

#include "palmbots/control/messages.hpp"
#include "palmbots/control/table.hpp"

namespace palmbots {

// When something was sent: the sender's boot epoch, and the tick since that boot.
struct BeaconStamp {
  std::uint32_t epoch = 0;  // 0: never
  std::uint32_t tick = 0;

  constexpr bool after(const BeaconStamp& that) const {
    return epoch > that.epoch || (epoch == that.epoch && tick > that.tick);
  }
};

// A beacon: the sender's message and readiness, with its stamp and echo.
struct Beacon {
  MessageKind message = MessageKind::none;
  bool stopped = false;  // the sender does not travel
  bool ready = false;    // no condition keeps it from travelling
  BeaconStamp sent;
  BeaconStamp heard;  // the newest stamp received from the partner
};

// Age reported before any beacon was received; it always exceeds the lease [ticks].
inline constexpr std::uint16_t unknown_age = 0xFFFF;

// Receives the partner's beacons and stamps this robot's own.
class BeaconReceiver {
 public:
  // `epoch` counts the boots of this robot from 1. It must be stored where it survives a reboot.
  // `tick` is the time since the boot [ticks].
  constexpr explicit BeaconReceiver(std::uint32_t epoch, std::uint32_t tick = 0)
      : now_{epoch, tick} {}

  constexpr void tick(std::uint16_t elapsed) { now_.tick += elapsed; }

  // Accepts a beacon if it is newer than all before it. Returns true if it was accepted.
  constexpr bool accept(const Beacon& beacon) {
    if (!beacon.sent.after(newest_.sent)) return false;
    newest_ = beacon;
    return true;
  }

  constexpr const Beacon& newest() const { return newest_; }

  // Upper bound on the time since the newest beacon was sent [ticks].
  constexpr std::uint16_t age() const {
    if (newest_.heard.epoch != now_.epoch || newest_.heard.tick > now_.tick) return unknown_age;
    const std::uint32_t age = now_.tick - newest_.heard.tick;
    return age < unknown_age ? static_cast<std::uint16_t>(age) : unknown_age;
  }

  // The beacon to send now.
  constexpr Beacon beacon(MessageKind message, bool stopped, bool ready) const {
    return {message, stopped, ready, now_, newest_.sent};
  }

 private:
  BeaconStamp now_;
  Beacon newest_;
};

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

// A controller and its mailbox.
template <class TheController>
class ControllerWithMail {
 public:
  using Controller = TheController;
  static constexpr Mail mail = Controller::mail;
  static constexpr bool has_clock = Controller::has_clock;

  constexpr explicit ControllerWithMail(Controller controller)
      : controller_(std::move(controller)) {}

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
