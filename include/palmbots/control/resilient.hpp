// SPDX-License-Identifier: Apache-2.0
// The resilient distributed algorithm: the cases of Table 2 on leases instead of waits, one copy
// for both robots. Nothing in it waits for a message that may be lost: every robot broadcasts, each
// beacon period and at once when it changes, one message that says what it does, and what a robot
// does on the other's message it does only while that message is fresh (control/beacon.hpp says how
// old it can be at most).
//
//   TiltUp   p > 0: I want your palm up         Ack      my palm is up for you, move
//   TiltDown nothing wanted, my palm is steep   Closing  I am in (d)
//   Raised   my palm is up or on its way, but not for you
//
// INTERFACE. step(Input) → Output once a control tick; no memory but the object itself (30 bytes),
// no I/O, no clock. The caller keeps an BeaconReceiver (control/beacon.hpp), and across a reboot
// the epoch and the last Output::assists. Times are in ticks: `beacon`, the period; `lease`, how
// old a message may be to count; `hold`, how long a palm stays up for a partner that fell silent;
// `braking`, how long wheels take from a correction back to the nominal speed; `join`, for how long
// a robot that was ready may still start after its partner. They come from
// control/resilient_timing.hpp; safety needs hold ≥ lease + braking + skipped ticks, and nothing
// else.
//
// The rules that keep the object on the palms, with "newest" the newest beacon heard:
//   * (a) moves away only while the newest message is a fresh Ack. The sender keeps its palm up
//     for `hold` after its last Ack, unless it hears that the partner has stopped asking.
//   * Having asked, a robot starts nothing until it hears a beacon whose sender had heard that it
//     asks no more ("released"): from then on no old request of its can bring up the other's palm.
//   * Nobody says that a move is over before the wheels have braked: TiltUp until then in (a), and
//     no Ack after (d). So motions of the two do not overlap, but for (d) on both sides.
//   * (d) moves closer only while the newest message is fresh and says: the other palm is steep,
//     or in (d) too. Before it has begun a request goes first: who asks may have its palm still
//   turning. * Requests that cross, case (b): the robot that yields (the lower identity) assists
//   first. * What was begun is moved through for at least one tick, even if p has come to 0
//     meanwhile, as in Table 2. Palms that turn shift the contacts a little: two robots that stand,
//     with contacts at the edge of the zero zone, would otherwise ask and withdraw for ever.
//   * Silence, that is no fresh message: moves end, palms go steep, the robot stops travelling.
// Travel: a robot that hears that its partner knows it to travel and yet rests, rests too; so two
// robots never travel apart for longer than a lease, however one-sided the radio is. Both say when
// they are *ready*: linked, idle, p = 0. A robot starts only where both are; one that is off centre
// or hears nothing looks idle, but not ready. So skews do not add up. Whoever starts first may
// shift the other's contact off again: so the other follows also where it was ready `join` ago, and
// corrects on the way.
//
// Source: the paper's section 4 for the cases; Gray and Cheriton, "Leases", SOSP 1989.
// docs/theory/protocols.md has the derivation.
#pragma once

#include "palmbots/control/lease_state.hpp"
#include "palmbots/control/messages.hpp"
#include "palmbots/control/transition_table.hpp"

namespace palmbots {

class Resilient {
 public:
  // In ticks; lease and hold below 65535.
  struct Times {
    std::uint16_t beacon;
    std::uint16_t lease;
    std::uint16_t hold;
    std::uint16_t braking;
    std::uint16_t join;
  };

  struct Input {
    Sign sign;
    bool palm_at_target;    // the palm has reached the angle last commanded
    std::uint16_t elapsed;  // ticks since the last step, at least 1
    MessageKind message;    // of a beacon newer than all before, if one came; else none
    bool stopped;           // that beacon's sender does not travel
    bool ready;             // nothing keeps it from travelling
    std::uint16_t age;      // of that beacon, as the BeaconReceiver tells
  };

  struct Output {
    Command command;      // with `stop`
    MessageKind message;  // what the robot has to say, at all times
    bool ready;           // … and with it
    bool send;            // send it now
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

  // What a robot does and says as long as it is in a state.
  struct StateOutput {
    char name;  // the case, as in Table 2; ' ' for none
    Command command;
    MessageKind message;
    bool waits;  // for an Ack
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

  // Conditions of a row. What was heard is the newest message while it is fresh, else silence.
  using P = ContactCondition;
  enum class Heard : std::uint8_t {
    any,
    tilt_up,
    not_tilt_up,  // silence included
    ack,
    not_ack,    // silence included
    other,      // something, but no TiltUp
    steep,      // the partner's palm is steep or in (d): TiltUp, TiltDown, Closing
    not_steep,  // silence included
    silence,
  };
  enum class If : std::uint8_t {
    any,
    settled,   // the palm has reached the angle last commanded, and the wheels have braked
    released,  // the partner knew, when it sent the newest message, that this robot asks no more
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

  // A robot runs the first row that fits; no row: it stays as it is.
  // clang-format off
  static constexpr Row rows[] = {
      // in state            contact          heard               if            go to
      // a request goes before corrections of one's own
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

  // What the conditions `If` of a row say.
  template <class B>
  struct Conditions {
    B settled;
    B released;
    B yields;
    B held;
  };

  // Who hears what a row asks for.
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

  // Of whom the condition of a row is true.
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

  // To whom a row applies. heard.is(kind): whose newest message is fresh and that; none: silence.
  template <class B, class Message>
  [[gnu::always_inline]] static constexpr B fits(const Row& row, const Observation<B>& seen,
                                                 const Message& heard, const Conditions<B>& met) {
    const B contact = holds(row.p, seen);
    const B message = hears<B>(row.heard, heard);
    const B condition = may(row.when, met);
    return contact & message & condition;
  }

  // What a step of one robot depends on besides its state, as a number.
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
  // partner stays up until the partner answers or the partner's lease must have run out.
  constexpr Resilient(Times times, bool yields, bool assisted = false)
      : times_(times),
        state_(assisted ? State::c_withdraw : State::c_tilt_down),
        lease_{.yields = yields,
               .stopped = true,
               .partner_stopped = true,
               .age = limits().stale,
               .since_ready = limits().long_ago,
               .since_sent = times.beacon} {}

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

  // For simulations, which need not step a robot that does nothing: how many steps of one tick each
  // could follow in which nothing happens but that time passes, as long as the robot senses what it
  // sensed in the last one and hears no beacon.
  std::uint16_t quiet(Sign sign, bool palm_at_target) const {
    Resilient next = *this;
    const Output out = next.step({sign, palm_at_target, 1, MessageKind::none, false, false, 0});
    if (next.state_ != state_ || out.send) return 0;
    // From there on it stays so until one of the conditions of rows changes, or a beacon is due.
    // (What compares two ages does not change: both grow.)
    int more = times_.beacon - next.lease_.since_sent - 1;
    const auto until = [&](std::uint16_t since, std::uint16_t most) {
      if (since < most && most - since - 1 < more) more = most - since - 1;
    };
    until(next.lease_.age, limits().stale);
    until(next.lease_.since_entered, times_.hold);
    if (palm_at_target) until(next.lease_.since_moved, times_.braking);
    return static_cast<std::uint16_t>(1 + more);
  }

  // So many of these steps at once.
  constexpr void idle(Sign sign, std::uint16_t steps) {
    lease_.pass(steps, limits());
    if (now().message == MessageKind::tilt_up) lease_.since_asked = 0;
    if (now().command.move != Move::hold) lease_.since_moved = 0;
    if (state_ == State::idle && sign == Sign::zero && !silence()) lease_.since_ready = 0;
  }

  constexpr State state() const { return state_; }
  constexpr bool stopped() const { return lease_.stopped; }
  constexpr bool yields() const { return lease_.yields; }
  // No fresh message: the partner is silent, or does not hear this robot.
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
  constexpr const char* names[] = {"idle",        "a_request", "a_move",  "a_stop",
                                   "b_tilt_up",   "c_tilt_up", "c_grant", "c_withdraw",
                                   "c_tilt_down", "d_tilt_up", "d_move",  "d_tilt_down"};
  return names[static_cast<int>(state)];
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
