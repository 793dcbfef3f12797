// SPDX-License-Identifier: Apache-2.0
// The distributed algorithm: Table 2 of the paper as a table, one copy for both robots.
//
// A robot runs the first row that fits its state, sign and message. If no row fits, it stays in its
// state. A row states which message to send and whether the received message is consumed. The
// commands for palm and wheels depend on the state alone. The paper's prose (section 4) settles
// what the table leaves open:
//   * A message that arrives while no state waits for it stays in the inbox, so that a robot in (d)
//     assists when it is done.
//   * TiltUp takes precedence over a robot's own negative contact (columns (c) and (d) of Table 2).
//   * An Ack states that the palm has turned, and (d) moves only after its own palm has turned.
//   * A waiting robot drops a message that it does not wait for. On a reliable radio with short
//     delays there is none. With losses the algorithm hangs; that is a property of the paper's
//     algorithm, not a defect here.
// While it waits, a robot keeps its nominal speed.
#pragma once

#include "palmbots/control/messages.hpp"
#include "palmbots/control/transition_table.hpp"

namespace palmbots {

// The program of one robot.
class Distributed {
 public:
  struct Input {
    Sign sign;
    MessageKind message;  // the oldest unread message, or none
    bool palm_at_target;  // the palm has reached the angle last commanded
  };

  struct Output {
    Command command;
    MessageKind send;
    bool read;  // the message is consumed
  };

  enum class State : std::uint8_t {
    idle,
    a_or_b_request,  // sent TiltUp, waits for the answer that decides between (a) and (b)
    a_move,
    b_wait_ack,
    b_move,
    b_tilt_up,
    b_wait_down,
    b_tilt_down,
    c_tilt_up,
    c_wait_down,
    c_tilt_down,
    d_tilt_up,
    d_move,
    d_tilt_down,
  };
  static constexpr int states = 14;

  // What a robot commands as long as it is in a state.
  struct StateOutput {
    char name;  // the case, as in Table 2; ' ' for none
    Command command;
    bool waits;          // waits for a message
    MessageKind awaits;  // which message, if that is fixed
  };

  static constexpr StateOutput outputs[states] = {
      /* idle           */ {' ', {Palm::steep, Move::hold}, false, MessageKind::none},
      /* a_or_b_request */ {'a', {Palm::steep, Move::hold}, true, MessageKind::ack},
      /* a_move         */ {'a', {Palm::steep, Move::away}, false, MessageKind::none},
      /* b_wait_ack     */ {'b', {Palm::steep, Move::hold}, true, MessageKind::ack},
      /* b_move         */ {'b', {Palm::steep, Move::away}, false, MessageKind::none},
      /* b_tilt_up      */ {'b', {Palm::shallow, Move::hold}, false, MessageKind::none},
      /* b_wait_down    */ {'b', {Palm::shallow, Move::hold}, true, MessageKind::tilt_down},
      /* b_tilt_down    */ {'b', {Palm::steep, Move::hold}, false, MessageKind::none},
      /* c_tilt_up      */ {'c', {Palm::shallow, Move::hold}, false, MessageKind::none},
      /* c_wait_down    */ {'c', {Palm::shallow, Move::hold}, true, MessageKind::tilt_down},
      /* c_tilt_down    */ {'c', {Palm::steep, Move::hold}, false, MessageKind::none},
      /* d_tilt_up      */ {'d', {Palm::shallow, Move::hold}, false, MessageKind::none},
      /* d_move         */ {'d', {Palm::shallow, Move::closer}, false, MessageKind::none},
      /* d_tilt_down    */ {'d', {Palm::steep, Move::hold}, false, MessageKind::none},
  };

  // The conditions of a row.
  using P = ContactCondition;
  enum class Got : std::uint8_t { any, tilt_up, tilt_down, ack };
  enum class Tilt : std::uint8_t { any, done };

  struct Row {
    State state;
    P p;
    Got got;
    Tilt tilt;
    State next;
    MessageKind send;
  };

  // clang-format off
  static constexpr Row rows[] = {
      // in state              contact          message         palm        go to                  send
      // p > 0: ask for the partner's palm, and learn whether the partner asks too
      {State::idle,            P::positive,     Got::any,       Tilt::any,  State::a_or_b_request, MessageKind::tilt_up},
      // (a)
      {State::a_or_b_request,  P::any,          Got::ack,       Tilt::any,  State::a_move,         MessageKind::none},
      {State::a_move,          P::not_positive, Got::any,       Tilt::any,  State::idle,           MessageKind::tilt_down},
      // (b)
      {State::a_or_b_request,  P::any,          Got::tilt_up,   Tilt::any,  State::b_wait_ack,     MessageKind::ack},
      {State::b_wait_ack,      P::any,          Got::ack,       Tilt::any,  State::b_move,         MessageKind::none},
      {State::b_move,          P::not_positive, Got::any,       Tilt::any,  State::b_tilt_up,      MessageKind::none},
      {State::b_tilt_up,       P::any,          Got::any,       Tilt::done, State::b_wait_down,    MessageKind::tilt_down},
      {State::b_wait_down,     P::any,          Got::tilt_down, Tilt::any,  State::b_tilt_down,    MessageKind::none},
      {State::b_tilt_down,     P::any,          Got::any,       Tilt::done, State::idle,           MessageKind::none},
      // (c) p ≤ 0 and asked by the partner
      {State::idle,            P::not_positive, Got::tilt_up,   Tilt::any,  State::c_tilt_up,      MessageKind::none},
      {State::c_tilt_up,       P::any,          Got::any,       Tilt::done, State::c_wait_down,    MessageKind::ack},
      {State::c_wait_down,     P::any,          Got::tilt_down, Tilt::any,  State::c_tilt_down,    MessageKind::none},
      {State::c_tilt_down,     P::any,          Got::any,       Tilt::done, State::idle,           MessageKind::none},
      // (d) p < 0 and not asked by the partner
      {State::idle,            P::negative,     Got::any,       Tilt::any,  State::d_tilt_up,      MessageKind::none},
      {State::d_tilt_up,       P::any,          Got::any,       Tilt::done, State::d_move,         MessageKind::none},
      {State::d_move,          P::not_negative, Got::any,       Tilt::any,  State::d_tilt_down,    MessageKind::none},
      {State::d_tilt_down,     P::any,          Got::any,       Tilt::done, State::idle,           MessageKind::none},
  };
  // clang-format on

  // True for the robots that received the message a row requires.
  template <class B, class Message>
  [[gnu::always_inline]] static constexpr B got(Got wanted, const Message& message) {
    switch (wanted) {
      case Got::tilt_up: return message.is(MessageKind::tilt_up);
      case Got::tilt_down: return message.is(MessageKind::tilt_down);
      case Got::ack: return message.is(MessageKind::ack);
      case Got::any: break;
    }
    return everywhere<B>();
  }

  // True for the robots to which a row applies, given their observations and messages
  // (message.is(kind)).
  template <class B, class Message>
  [[gnu::always_inline]] static constexpr B fits(const Row& row, const Observation<B>& seen,
                                                 const Message& message) {
    const B contact = holds(row.p, seen);
    const B came = got<B>(row.got, message);
    const B turned = row.tilt == Tilt::done ? seen.palm_at_target : everywhere<B>();
    return contact & came & turned;
  }

  // A state that reads its messages consumes one message from the inbox per tick, whatever it is.
  // In idle with p > 0 the message stays for the request state, which reads it next.
  template <class B>
  [[gnu::always_inline]] static constexpr B reads(State state, const Observation<B>& seen) {
    if (outputs[static_cast<int>(state)].waits) return everywhere<B>();
    return state == State::idle ? holds(P::not_positive, seen) : B{};
  }

  // The input of a step, as a number.
  struct Key {
    static constexpr int messages = 4;
    static constexpr int count = 3 * messages * 2;
    Input in;

    constexpr int number() const {
      return ((static_cast<int>(in.sign) + 1) * messages + static_cast<int>(in.message)) * 2 +
             (in.palm_at_target ? 1 : 0);
    }
    static constexpr Key of(int n) {
      return {{static_cast<Sign>(n / (2 * messages) - 1),
               static_cast<MessageKind>(n / 2 % messages), n % 2 != 0}};
    }
    constexpr Observation<bool> seen() const { return observation_of(in.sign, in.palm_at_target); }
  };

  // The result of a step.
  struct Entry {
    State next;
    MessageKind send;
    bool read;
  };

  static constexpr bool fits(const Row& row, const Key& key) {
    return fits(row, key.seen(), OneMessage{key.in.message});
  }
  static constexpr Entry stay(State state, const Key& key) {
    return {state, MessageKind::none, consumes(state, key)};
  }
  static constexpr Entry run(const Row& row, const Key& key) {
    return {row.next, row.send, consumes(row.state, key)};
  }
  static constexpr bool consumes(State state, const Key& key) {
    return key.in.message != MessageKind::none && reads(state, key.seen());
  }

  Output step(Input in) {
    const Entry& entry = lookup.at(state_, {in});
    state_ = entry.next;
    return {now().command, entry.send, entry.read};
  }

  // True if the robot would stay in its state and send nothing, however often it got this input.
  bool is_quiescent(Input in) const {
    const Entry& entry = lookup.at(state_, {in});
    return entry.next == state_ && entry.send == MessageKind::none && !entry.read;
  }

  State state() const { return state_; }
  const StateOutput& now() const { return outputs[static_cast<int>(state_)]; }

 private:
  static const SpreadTable<Distributed> lookup;

  State state_ = State::idle;
};

inline constexpr SpreadTable<Distributed> Distributed::lookup = spread<Distributed>();

constexpr const char* name_of(Distributed::State state) {
  constexpr const char* names[] = {"idle",      "a_or_b_request", "a_move",      "b_wait_ack",
                                   "b_move",    "b_tilt_up",      "b_wait_down", "b_tilt_down",
                                   "c_tilt_up", "c_wait_down",    "c_tilt_down", "d_tilt_up",
                                   "d_move",    "d_tilt_down"};
  return names[static_cast<int>(state)];
}

constexpr const char* name_of(Distributed::Got condition) {
  constexpr const char* names[] = {"any", "tilt_up", "tilt_down", "ack"};
  return names[static_cast<int>(condition)];
}

constexpr const char* name_of(Distributed::Tilt condition) {
  constexpr const char* names[] = {"any", "done"};
  return names[static_cast<int>(condition)];
}

}  // namespace palmbots
