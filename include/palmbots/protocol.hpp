// The distributed algorithm: Table 2 of the paper as a table, one copy for both robots.
//
// A robot runs the first row whose state, sign and letter fit; no row: it stays as it is. A row says
// what it sends and whether it takes the letter off the inbox; what the palm and the wheels do is a
// matter of the state alone. The paper's prose (section 4) fixes what the table leaves open:
//   * a message that arrives while no state waits for it stays in the inbox, so that a robot in (d)
//     assists when it is done;
//   * TiltUp goes before an own negative contact (the columns (c) and (d) of Table 2);
//   * an Ack says that the palm has turned, and (d) moves only once its own palm has;
//   * a letter that a waiting robot did not wait for is dropped. With reliable, prompt radio there is
//     none. With losses the algorithm hangs: that is the paper's algorithm, not a defect here.
// While it waits, a robot keeps its nominal speed.
#pragma once

#include "palmbots/message.hpp"

namespace palmbots {

class Distributed {
 public:
  struct Input {
    Sign sign;
    Letter letter;  // the oldest unread letter, or none
    bool turned;    // the palm has reached the angle last commanded
  };

  struct Output {
    Command command;
    Letter send;
    bool read;  // the letter is used up
  };

  enum class State : std::uint8_t {
    idle,
    a_or_b_request,  // sent TiltUp, waits for the answer that tells (a) from (b)
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

  // What a robot does as long as it is in a state.
  struct Doing {
    char name;  // the case, as in Table 2; ' ' for none
    Command command;
    bool waits;     // for a message
    Letter awaits;  // which one, where that is known
  };

  static constexpr Doing doing[states] = {
      /* idle           */ {' ', {Palm::steep, Move::hold}, false, Letter::none},
      /* a_or_b_request */ {'a', {Palm::steep, Move::hold}, true, Letter::ack},
      /* a_move         */ {'a', {Palm::steep, Move::away}, false, Letter::none},
      /* b_wait_ack     */ {'b', {Palm::steep, Move::hold}, true, Letter::ack},
      /* b_move         */ {'b', {Palm::steep, Move::away}, false, Letter::none},
      /* b_tilt_up      */ {'b', {Palm::shallow, Move::hold}, false, Letter::none},
      /* b_wait_down    */ {'b', {Palm::shallow, Move::hold}, true, Letter::tilt_down},
      /* b_tilt_down    */ {'b', {Palm::steep, Move::hold}, false, Letter::none},
      /* c_tilt_up      */ {'c', {Palm::shallow, Move::hold}, false, Letter::none},
      /* c_wait_down    */ {'c', {Palm::shallow, Move::hold}, true, Letter::tilt_down},
      /* c_tilt_down    */ {'c', {Palm::steep, Move::hold}, false, Letter::none},
      /* d_tilt_up      */ {'d', {Palm::shallow, Move::hold}, false, Letter::none},
      /* d_move         */ {'d', {Palm::shallow, Move::closer}, false, Letter::none},
      /* d_tilt_down    */ {'d', {Palm::steep, Move::hold}, false, Letter::none},
  };

  // Conditions of a row.
  enum class P : std::uint8_t { any, positive, not_positive, negative, not_negative };
  enum class Got : std::uint8_t { any, tilt_up, tilt_down, ack };
  enum class Tilt : std::uint8_t { any, done };

  struct Row {
    State state;
    P p;
    Got got;
    Tilt tilt;
    State next;
    Letter send;
  };

  // clang-format off
  static constexpr Row table[] = {
      // in state              contact          message         palm        go to                  send
      // p > 0: ask for the partner's palm and see whether it asks too
      {State::idle,            P::positive,     Got::any,       Tilt::any,  State::a_or_b_request, Letter::tilt_up},
      // (a)
      {State::a_or_b_request,  P::any,          Got::ack,       Tilt::any,  State::a_move,         Letter::none},
      {State::a_move,          P::not_positive, Got::any,       Tilt::any,  State::idle,           Letter::tilt_down},
      // (b)
      {State::a_or_b_request,  P::any,          Got::tilt_up,   Tilt::any,  State::b_wait_ack,     Letter::ack},
      {State::b_wait_ack,      P::any,          Got::ack,       Tilt::any,  State::b_move,         Letter::none},
      {State::b_move,          P::not_positive, Got::any,       Tilt::any,  State::b_tilt_up,      Letter::none},
      {State::b_tilt_up,       P::any,          Got::any,       Tilt::done, State::b_wait_down,    Letter::tilt_down},
      {State::b_wait_down,     P::any,          Got::tilt_down, Tilt::any,  State::b_tilt_down,    Letter::none},
      {State::b_tilt_down,     P::any,          Got::any,       Tilt::done, State::idle,           Letter::none},
      // (c) p ≤ 0 and asked
      {State::idle,            P::not_positive, Got::tilt_up,   Tilt::any,  State::c_tilt_up,      Letter::none},
      {State::c_tilt_up,       P::any,          Got::any,       Tilt::done, State::c_wait_down,    Letter::ack},
      {State::c_wait_down,     P::any,          Got::tilt_down, Tilt::any,  State::c_tilt_down,    Letter::none},
      {State::c_tilt_down,     P::any,          Got::any,       Tilt::done, State::idle,           Letter::none},
      // (d) p < 0 and not asked
      {State::idle,            P::negative,     Got::any,       Tilt::any,  State::d_tilt_up,      Letter::none},
      {State::d_tilt_up,       P::any,          Got::any,       Tilt::done, State::d_move,         Letter::none},
      {State::d_move,          P::not_negative, Got::any,       Tilt::any,  State::d_tilt_down,    Letter::none},
      {State::d_tilt_down,     P::any,          Got::any,       Tilt::done, State::idle,           Letter::none},
  };
  // clang-format on

  // A state that looks at its messages takes one letter off the inbox a tick, whatever it is. In
  // idle with p > 0 the letter waits for the request's own state, which reads it next.
  static constexpr bool reads(State state, Sign sign) {
    return doing[static_cast<int>(state)].waits || (state == State::idle && sign != Sign::positive);
  }

  Output step(Input in) {
    const Entry& entry = lookup.entries[index(state_, in.sign, in.letter, in.turned)];
    state_ = entry.next;
    return {doing[static_cast<int>(state_)].command, entry.send, entry.read};
  }

  // Whether it would stay as it is and send nothing, however often it got this.
  bool rests(Input in) const {
    const Entry& entry = lookup.entries[index(state_, in.sign, in.letter, in.turned)];
    return entry.next == state_ && entry.send == Letter::none && !entry.read;
  }

  State state() const { return state_; }
  const Doing& now() const { return doing[static_cast<int>(state_)]; }

 private:
  // The rows spread out over every input, so that a step is one look-up.
  struct Entry {
    State next;
    Letter send;
    bool read;
  };
  static constexpr int inputs = 3 * 4 * 2;
  struct Lookup {
    Entry entries[states * inputs];
  };

  static constexpr int index(State state, Sign sign, Letter letter, bool turned) {
    return ((static_cast<int>(state) * 3 + static_cast<int>(sign) + 1) * 4 +
            static_cast<int>(letter)) *
               2 +
           (turned ? 1 : 0);
  }

  static constexpr bool fits(const Row& row, State state, Sign sign, Letter letter, bool turned) {
    if (row.state != state) return false;
    if (row.tilt == Tilt::done && !turned) return false;
    switch (row.p) {
      case P::positive:
        if (sign != Sign::positive) return false;
        break;
      case P::not_positive:
        if (sign == Sign::positive) return false;
        break;
      case P::negative:
        if (sign != Sign::negative) return false;
        break;
      case P::not_negative:
        if (sign == Sign::negative) return false;
        break;
      case P::any: break;
    }
    switch (row.got) {
      case Got::tilt_up: return letter == Letter::tilt_up;
      case Got::tilt_down: return letter == Letter::tilt_down;
      case Got::ack: return letter == Letter::ack;
      case Got::any: break;
    }
    return true;
  }

  static constexpr Lookup spread() {
    Lookup all{};
    for (int s = 0; s < states; ++s) {
      for (int sign = -1; sign <= 1; ++sign) {
        for (int letter = 0; letter < 4; ++letter) {
          for (int turned = 0; turned < 2; ++turned) {
            const auto state = static_cast<State>(s);
            const auto seen = static_cast<Sign>(sign);
            const auto got = static_cast<Letter>(letter);
            Entry entry{state, Letter::none, false};
            for (const Row& row : table) {
              if (fits(row, state, seen, got, turned != 0)) {
                entry = {row.next, row.send, false};
                break;
              }
            }
            entry.read = got != Letter::none && reads(state, seen);
            all.entries[index(state, seen, got, turned != 0)] = entry;
          }
        }
      }
    }
    return all;
  }

  static const Lookup lookup;

  State state_ = State::idle;
};

inline constexpr Distributed::Lookup Distributed::lookup = Distributed::spread();

}  // namespace palmbots
