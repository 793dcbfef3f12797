// SPDX-License-Identifier: Apache-2.0
// The resilient distributed algorithm: the cases of Table 2 with leases instead of waits, one copy
// for both robots.
//
// No state waits for a message that may be lost. Every robot broadcasts one message that states
// what it does, in each beacon period and at once when it changes. A robot acts on its partner's
// message only while that message is fresh (control/beacon.hpp bounds its age).
//
//   TiltUp   p > 0: the sender wants the partner's palm up
//   Ack      the sender's palm is up for the partner, which may move
//   TiltDown the sender wants nothing, its palm is steep
//   Closing  the sender is in (d)
//   Raised   the sender's palm is up or on its way, but not for the partner
//
// INTERFACE. step(Input) → Output once per control tick. The object itself (30 bytes) is the only
// memory; there is no I/O and no clock. The caller keeps a BeaconReceiver (control/beacon.hpp) and,
// across a reboot, the epoch and the last Output::assists. control/resilient_timing.hpp computes
// its times. Safety requires hold ≥ lease + braking + skipped ticks, and nothing else.
//
// These rules keep the object on the palms. "Newest" is the newest beacon received.
//   * (a) moves away only while the newest message is a fresh Ack. The sender keeps its palm up
//     for `hold` after its last Ack, unless it hears that the partner has stopped asking.
//   * After a request, a robot starts nothing until it is *released*: it has received a beacon
//     whose sender knew that it no longer asks. From then on none of its old requests can raise
//     the partner's palm.
//   * A move is reported as over only after the wheels have braked: (a) sends TiltUp until then,
//     and (d) sends no Ack before. So motions of the two robots do not overlap, except (d) on both
//     sides.
//   * (d) moves closer only while the newest message is fresh and states that the partner's palm
//     is steep or that the partner is in (d) too. Before (d) has begun a request takes precedence,
//     because the palm of the robot that asks may still be turning.
//   * Requests that cross are case (b): the robot that yields (the lower identity) assists first.
//   * A correction that has begun moves for at least one tick, even if p has become 0 meanwhile,
//     as in Table 2. The reason is that turning palms shift the contacts a little. Two robots at
//     rest, with contacts at the edge of the zero zone, would otherwise request and withdraw
//     forever.
//   * Silence means that there is no fresh message: moves end, palms go steep, and the robot stops
//     travelling.
//
// Travel: a robot rests if its partner rests although the partner knows that this robot travels. So
// two robots never travel apart for longer than a lease, however one-sided the radio is. Both
// broadcast when they are *ready*: linked, idle, p = 0. A robot starts only if both are ready. A
// robot that is off centre or hears nothing looks idle, but is not ready, so skews do not add up.
// The first robot to start may move the other's contact off centre again. The other therefore also
// follows if it was ready within the last `join` ticks, and corrects while travelling.
//
// Source: the paper's section 4 for the cases; Gray and Cheriton, "Leases", SOSP 1989.
// docs/theory/protocols.md has the derivation.
#pragma once

#include "palmbots/control/beacon.hpp"
#include "palmbots/control/lease_state.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/control/transition_table.hpp"

namespace palmbots {

// The program of one robot.
class Resilient {
 public:
  // In ticks. Lease and hold must be below 65535.
  struct Times {
    std::uint16_t beacon;   // the beacon period
    std::uint16_t lease;    // the greatest age at which a message counts
    std::uint16_t hold;     // how long a palm stays up for a partner that fell silent
    std::uint16_t braking;  // how long wheels take from a correction back to the nominal speed
    std::uint16_t join;     // for how long a robot that was ready may still start after its partner
  };

  using Input = RobotInput;

  struct Output {
    Command command;      // with `stop`
    MessageKind message;  // the robot's current message, at all times
    bool ready;           // the robot's current readiness, at all times
    bool send;            // a beacon is due now
    bool assists;         // keep this bit across a reboot
  };

  enum class State : std::uint8_t {
    idle,
    a_request,
    a_move,
    a_stop,
    b_tilt_up,
    c_tilt_up,
    c_grant,
    c_withdraw,
    c_tilt_down,
    d_tilt_up,
    d_move,
    d_tilt_down,
  };
  static constexpr int states = 12;
  static constexpr bool talks = true;  // it sends beacons

  // The name of each state, and its meaning for people.
  static constexpr StateWords words[states] = {
      {"idle", "no correction"},
      {"a_request", "asks the partner to tilt its palm up"},
      {"a_move", "moves away, its partner assists"},
      {"a_stop", "stops moving away"},
      {"b_tilt_up", "tilts its palm up; both contacts are outward, and its partner goes first"},
      {"c_tilt_up", "tilts its palm up to assist"},
      {"c_grant", "permits its partner to move away"},
      {"c_withdraw", "no longer permits it, and waits until its partner has stopped"},
      {"c_tilt_down", "tilts its palm down after assisting"},
      {"d_tilt_up", "tilts its palm up to correct alone"},
      {"d_move", "moves closer"},
      {"d_tilt_down", "tilts its palm down after moving closer"},
  };

  // What a robot commands and broadcasts as long as it is in a state.
  struct StateOutput {
    char name;  // the case, as in Table 2; ' ' for none
    Command command;
    MessageKind message;
    bool waits;  // waits for an Ack
  };

  static constexpr StateOutput outputs[states] = {
      /* idle        */ {' ', {Palm::steep, Move::hold}, MessageKind::tilt_down, false},
      /* a_request   */ {'a', {Palm::steep, Move::hold}, MessageKind::tilt_up, true},
      /* a_move      */ {'a', {Palm::steep, Move::away}, MessageKind::tilt_up, false},
      /* a_stop      */ {'a', {Palm::steep, Move::hold}, MessageKind::tilt_up, false},
      /* b_tilt_up   */ {'b', {Palm::shallow, Move::hold}, MessageKind::raised, false},
      /* c_tilt_up   */ {'c', {Palm::shallow, Move::hold}, MessageKind::raised, false},
      /* c_grant     */ {'c', {Palm::shallow, Move::hold}, MessageKind::ack, false},
      /* c_withdraw  */ {'c', {Palm::shallow, Move::hold}, MessageKind::raised, false},
      /* c_tilt_down */ {'c', {Palm::steep, Move::hold}, MessageKind::raised, false},
      /* d_tilt_up   */ {'d', {Palm::shallow, Move::hold}, MessageKind::closing, false},
      /* d_move      */ {'d', {Palm::shallow, Move::closer}, MessageKind::closing, false},
      /* d_tilt_down */ {'d', {Palm::steep, Move::hold}, MessageKind::closing, false},
  };

  // The conditions of a row. `Heard` refers to the newest message while it is fresh, else to
  // silence.
  using P = ContactCondition;
  enum class Heard : std::uint8_t {
    any,
    tilt_up,
    not_tilt_up,  // silence included
    ack,
    not_ack,    // silence included
    other,      // a message, but not TiltUp
    steep,      // the partner's palm is steep or in (d): TiltUp, TiltDown, Closing
    not_steep,  // silence included
    silence,
  };
  enum class If : std::uint8_t {
    any,
    settled,   // the palm has reached the angle last commanded, and the wheels have braked
    released,  // the partner knew, when it sent the newest message, that this robot no longer asks
    yields,    // this robot has the lower identity
    held,      // the palm has been kept up for `hold`
  };

  struct Row {
    State state;
    P p;
    Heard heard;
    If when;
    State next;
  };

  // A robot runs the first row that fits. If no row fits, it stays in its state.
  // clang-format off
  static constexpr Row rows[] = {
      // in state            contact          heard               if            go to
      // a request takes precedence over corrections of one's own
      {State::idle,          P::positive,     Heard::tilt_up,     If::any,      State::b_tilt_up},
      {State::idle,          P::any,          Heard::tilt_up,     If::any,      State::c_tilt_up},
      {State::idle,          P::positive,     Heard::any,         If::released, State::a_request},
      {State::idle,          P::negative,     Heard::any,         If::released, State::d_tilt_up},
      // (a), and (b) where requests cross
      {State::a_request,     P::any,          Heard::ack,         If::settled,  State::a_move},
      {State::a_request,     P::any,          Heard::tilt_up,     If::yields,   State::b_tilt_up},
      {State::a_move,        P::not_positive, Heard::any,         If::any,      State::a_stop},
      {State::a_move,        P::any,          Heard::not_ack,     If::any,      State::a_stop},
      {State::a_stop,        P::positive,     Heard::ack,         If::any,      State::a_move},
      {State::a_stop,        P::positive,     Heard::any,         If::settled,  State::a_request},
      {State::a_stop,        P::any,          Heard::any,         If::settled,  State::idle},
      // (c)
      {State::b_tilt_up,     P::any,          Heard::not_tilt_up, If::any,      State::c_tilt_down},
      {State::b_tilt_up,     P::any,          Heard::any,         If::settled,  State::c_grant},
      {State::c_tilt_up,     P::any,          Heard::not_tilt_up, If::any,      State::c_tilt_down},
      {State::c_tilt_up,     P::any,          Heard::any,         If::settled,  State::c_grant},
      {State::c_grant,       P::any,          Heard::silence,     If::any,      State::c_withdraw},
      {State::c_grant,       P::any,          Heard::other,       If::any,      State::c_tilt_down},
      {State::c_withdraw,    P::any,          Heard::tilt_up,     If::settled,  State::c_grant},
      {State::c_withdraw,    P::any,          Heard::other,       If::any,      State::c_tilt_down},
      {State::c_withdraw,    P::any,          Heard::any,         If::held,     State::c_tilt_down},
      {State::c_tilt_down,   P::any,          Heard::tilt_up,     If::any,      State::c_tilt_up},
      {State::c_tilt_down,   P::positive,     Heard::any,         If::released, State::a_request},
      {State::c_tilt_down,   P::negative,     Heard::any,         If::released, State::d_tilt_up},
      {State::c_tilt_down,   P::any,          Heard::any,         If::settled,  State::idle},
      // (d)
      {State::d_tilt_up,     P::any,          Heard::silence,     If::any,      State::d_tilt_down},
      {State::d_tilt_up,     P::any,          Heard::tilt_up,     If::any,      State::c_tilt_up},
      {State::d_tilt_up,     P::any,          Heard::steep,       If::settled,  State::d_move},
      {State::d_move,        P::not_negative, Heard::tilt_up,     If::any,      State::c_tilt_up},
      {State::d_move,        P::not_negative, Heard::any,         If::any,      State::d_tilt_down},
      {State::d_move,        P::any,          Heard::not_steep,   If::any,      State::d_tilt_up},
      {State::d_tilt_down,   P::not_positive, Heard::tilt_up,     If::any,      State::c_tilt_up},
      {State::d_tilt_down,   P::any,          Heard::any,         If::settled,  State::idle},
  };
  // clang-format on

  // The values of the conditions `If` of a row.
  template <class B>
  struct Conditions {
    B settled;
    B released;
    B yields;
    B held;
  };

  // True for the robots that hear what a row requires.
  template <class B, class Message>
  [[gnu::always_inline]] static constexpr B hears(Heard wanted, const Message& heard) {
    const B tilt_up = heard.is(MessageKind::tilt_up);
    const B tilt_down = heard.is(MessageKind::tilt_down);
    const B ack = heard.is(MessageKind::ack);
    const B closing = heard.is(MessageKind::closing);
    const B silence = heard.is(MessageKind::none);
    const B steep = tilt_up | tilt_down | closing;
    switch (wanted) {
      case Heard::tilt_up: return tilt_up;
      case Heard::not_tilt_up: return opposite(tilt_up);
      case Heard::ack: return ack;
      case Heard::not_ack: return opposite(ack);
      case Heard::other: return opposite<B>(silence | tilt_up);
      case Heard::steep: return steep;
      case Heard::not_steep: return opposite(steep);
      case Heard::silence: return silence;
      case Heard::any: break;
    }
    return everywhere<B>();
  }

  // True for the robots that meet a row's condition.
  template <class B>
  [[gnu::always_inline]] static constexpr B may(If when, const Conditions<B>& met) {
    switch (when) {
      case If::settled: return met.settled;
      case If::released: return met.released;
      case If::yields: return met.yields;
      case If::held: return met.held;
      case If::any: break;
    }
    return everywhere<B>();
  }

  // True for the robots to which a row applies. heard.is(kind) is true where the newest message is
  // fresh and of that kind; `none` stands for silence.
  template <class B, class Message>
  [[gnu::always_inline]] static constexpr B fits(const Row& row, const Observation<B>& seen,
                                                 const Message& heard, const Conditions<B>& met) {
    const B contact = holds(row.p, seen);
    const B message = hears<B>(row.heard, heard);
    const B condition = may(row.when, met);
    return contact & message & condition;
  }

  // The input of a step besides the state of one robot, as a number.
  struct Key {
    static constexpr int messages = 6;
    static constexpr int flags = 16;
    static constexpr int count = 3 * messages * flags;
    Sign sign;
    MessageKind heard;
    Conditions<bool> met;

    constexpr int number() const {
      const int bits =
          int{met.settled} | int{met.released} << 1 | int{met.yields} << 2 | int{met.held} << 3;
      return ((static_cast<int>(sign) + 1) * messages + static_cast<int>(heard)) * flags + bits;
    }
    static constexpr Key of(int n) {
      return {static_cast<Sign>(n / (messages * flags) - 1),
              static_cast<MessageKind>(n / flags % messages),
              {(n & 1) != 0, (n & 2) != 0, (n & 4) != 0, (n & 8) != 0}};
    }
  };
  using Entry = State;

  static constexpr bool fits(const Row& row, const Key& key) {
    return fits(row, observation_of(key.sign, false), OneMessage{key.heard}, key.met);
  }
  static constexpr State stay(State state, const Key&) { return state; }
  static constexpr State run(const Row& row, const Key&) { return row.next; }

  // After a boot a robot rests and starts nothing until it is linked. A palm that was up for the
  // partner stays up until the partner answers or the partner's lease must have expired.
  constexpr Resilient(Times times, bool yields, bool assisted = false)
      : times_(times),
        state_(assisted ? State::c_withdraw : State::c_tilt_down),
        lease_{.yields = yields,
               .stopped = true,
               .partner_stopped = true,
               .age = limits().stale,
               .since_ready = limits().long_ago,
               .since_sent = times.beacon} {}

  // The robot after a boot, with what it had stored.
  constexpr Resilient booted() const { return Resilient(times_, lease_.yields, assists(state_)); }

  Output step(const Input& in) {
    const LeaseLimits<std::uint16_t> limits = this->limits();
    lease_.pass(in.elapsed, limits);
    if (in.message != MessageKind::none) {
      message_ = in.message;
      lease_.partner_stopped = in.stopped;
      lease_.partner_ready = in.ready;
      lease_.age = in.age < limits.stale ? in.age : limits.stale;
    }
    const State before = state_;
    const bool silence = lease_.silence(limits);
    const auto met = lease_.template conditions<Conditions<bool>>(
        true, now().command.move != Move::hold, in.palm_at_target, silence, limits);
    state_ = lookup.at(state_, {in.sign, silence ? MessageKind::none : message_, met});
    const bool centred = state_ == State::idle && in.sign == Sign::zero;
    const auto done =
        lease_.finish(true, state_ != before, now().message == MessageKind::tilt_up, centred,
                      now().message != outputs[static_cast<int>(before)].message, silence, limits);
    Command command = now().command;
    command.stop = lease_.stopped;
    return {command, now().message, done.ready, done.send, assists(state_)};
  }

  // For simulations that skip steps without effect. Returns how many steps of one tick could follow
  // in which only time passes, as long as the robot's observation stays the same and no beacon
  // arrives.
  std::uint16_t quiet(Sign sign, bool palm_at_target) const {
    Resilient next = *this;
    const Output out = next.step({sign, palm_at_target, 1, MessageKind::none, false, false, 0});
    if (next.state_ != state_ || out.send) return 0;
    // Nothing changes until a condition of the rows changes or a beacon is due. Comparisons of two
    // ages do not change, because both ages grow.
    int more = times_.beacon - next.lease_.since_sent - 1;
    const auto until = [&](std::uint16_t since, std::uint16_t most) {
      if (since < most && most - since - 1 < more) more = most - since - 1;
    };
    until(next.lease_.age, limits().stale);
    until(next.lease_.since_entered, times_.hold);
    if (palm_at_target) until(next.lease_.since_moved, times_.braking);
    return static_cast<std::uint16_t>(1 + more);
  }

  // Executes that many of these steps at once.
  constexpr void idle(Sign sign, std::uint16_t steps) {
    lease_.pass(steps, limits());
    if (now().message == MessageKind::tilt_up) lease_.since_asked = 0;
    if (now().command.move != Move::hold) lease_.since_moved = 0;
    if (state_ == State::idle && sign == Sign::zero && !silence()) lease_.since_ready = 0;
  }

  constexpr State state() const { return state_; }
  constexpr bool stopped() const { return lease_.stopped; }
  constexpr bool yields() const { return lease_.yields; }
  // True if there is no fresh message: the partner is silent, or does not hear this robot.
  constexpr bool silence() const { return lease_.silence(limits()); }
  constexpr const StateOutput& now() const { return outputs[static_cast<int>(state_)]; }

 private:
  static constexpr bool assists(State state) {
    return state == State::c_grant || state == State::c_withdraw;
  }

  static const SpreadTable<Resilient> lookup;

  constexpr LeaseLimits<std::uint16_t> limits() const {
    return {times_.beacon, static_cast<std::uint16_t>(times_.lease + 1), times_.hold,
            times_.braking, static_cast<std::uint16_t>(times_.join + 1)};
  }

  Times times_;
  State state_;
  MessageKind message_ = MessageKind::none;  // of the newest beacon
  LeaseState<bool, std::uint16_t> lease_;
};

inline constexpr SpreadTable<Resilient> Resilient::lookup = spread<Resilient>();

constexpr const char* name_of(Resilient::State state) {
  return Resilient::words[static_cast<int>(state)].name;
}

constexpr const char* name_of(Resilient::Heard condition) {
  constexpr const char* names[] = {"any",   "tilt_up", "not_tilt_up", "ack",    "not_ack",
                                   "other", "steep",   "not_steep",   "silence"};
  return names[static_cast<int>(condition)];
}

constexpr const char* name_of(Resilient::If condition) {
  constexpr const char* names[] = {"any", "settled", "released", "yields", "held"};
  return names[static_cast<int>(condition)];
}

}  // namespace palmbots
