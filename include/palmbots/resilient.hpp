// The resilient distributed algorithm: the cases of Table 2 on leases instead of waits, one copy for
// both robots. Nothing in it waits for a message that may be lost: every robot broadcasts, each beacon
// period and at once when it changes, one letter that says what it does, and what a robot does on the
// other's letter it does only while that letter is fresh (beacon.hpp says how old it can be at most).
//
//   TiltUp   p > 0: I want your palm up         Ack      my palm is up for you, move
//   TiltDown nothing wanted, my palm is steep   Closing  I am in (d)
//   Raised   my palm is up or on its way, but not for you
//
// INTERFACE. step(Input) → Output once a control tick; no memory but the object itself (30 bytes),
// no I/O, no clock. The caller keeps an Ear (beacon.hpp), and across a reboot the epoch and the last
// Output::assists. Times are in ticks: `beacon`, the period; `lease`, how old a letter may be to
// count; `hold`, how long a palm stays up for a partner that fell silent; `braking`, how long wheels
// take from a correction back to the nominal speed; `join`, for how long a robot that was ready may
// still start after its partner. They come from resilient_bounds.hpp; safety needs
// hold ≥ lease + braking + skipped ticks, and nothing else.
//
// The rules that keep the object on the palms, with "newest" the newest beacon heard:
//   * (a) moves away only while the newest letter is a fresh Ack. Whoever sent it keeps its palm up
//     for `hold` after its last Ack, unless it hears that the partner has stopped asking.
//   * Having asked, a robot starts nothing until it hears a beacon whose sender had heard that it
//     asks no more ("released"): from then on no old request of its can bring up the other's palm.
//   * Nobody says that a move is over before the wheels have braked: TiltUp until then in (a), and no
//     Ack after (d). So motions of the two do not overlap, but for (d) on both sides.
//   * (d) moves closer only while the newest letter is fresh and says that the other palm is steep,
//     or in (d) too. Before it has begun a request goes first: who asks may have its palm still turning.
//   * Requests that cross, case (b): the robot that yields (the lower identity) assists first.
//   * What was begun is moved through for at least one tick, even if p has come to 0 meanwhile, as in
//     Table 2. Palms that turn shift the contacts a little: two robots that stand, with contacts at
//     the edge of the zero zone, would otherwise ask and withdraw for ever.
//   * Silence, that is no fresh letter: moves end, palms go steep, the robot stops travelling.
// Travel: a robot that hears that its partner knows it to travel and yet rests, rests too; so two
// robots never travel apart for longer than a lease, however one-sided the radio is. Both say when they
// are *ready*: linked, idle, p = 0. A robot starts only where both are; one that is off centre or hears
// nothing looks idle, but not ready. So skews do not add up. Whoever starts first may shift the other's
// contact off again: so the other follows also where it was ready `join` ago, and corrects on the way.
//
// Source: the paper's section 4 for the cases; Gray and Cheriton, "Leases", SOSP 1989. docs/protocol.md
// has the derivation.
#pragma once

#include "palmbots/message.hpp"

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
    bool turned;            // the palm has reached the angle last commanded
    std::uint16_t elapsed;  // ticks since the last step, at least 1
    Letter letter;          // of a beacon newer than all before, if one came; else none
    bool rests;             // that beacon's sender does not travel
    bool ready;             // nothing keeps it from travelling
    std::uint16_t age;      // of that beacon, as the Ear tells
  };

  struct Output {
    Command command;  // with `rest`
    Letter letter;    // what the robot has to say, at all times
    bool ready;       // … and with it
    bool send;        // send it now
    bool assists;     // keep this bit across a reboot
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
  struct Doing {
    char name;  // the case, as in Table 2; ' ' for none
    Command command;
    Letter letter;
    bool waits;  // for an Ack
  };

  static constexpr Doing doing[states] = {
      /* idle        */ {' ', {Palm::steep, Move::hold}, Letter::tilt_down, false},
      /* a_request   */ {'a', {Palm::steep, Move::hold}, Letter::tilt_up, true},
      /* a_move      */ {'a', {Palm::steep, Move::away}, Letter::tilt_up, false},
      /* a_stop      */ {'a', {Palm::steep, Move::hold}, Letter::tilt_up, false},
      /* b_tilt_up   */ {'b', {Palm::shallow, Move::hold}, Letter::raised, false},
      /* c_tilt_up   */ {'c', {Palm::shallow, Move::hold}, Letter::raised, false},
      /* c_grant     */ {'c', {Palm::shallow, Move::hold}, Letter::ack, false},
      /* c_withdraw  */ {'c', {Palm::shallow, Move::hold}, Letter::raised, false},
      /* c_tilt_down */ {'c', {Palm::steep, Move::hold}, Letter::raised, false},
      /* d_tilt_up   */ {'d', {Palm::shallow, Move::hold}, Letter::closing, false},
      /* d_move      */ {'d', {Palm::shallow, Move::closer}, Letter::closing, false},
      /* d_tilt_down */ {'d', {Palm::steep, Move::hold}, Letter::closing, false},
  };

  // Conditions of a row. What was heard is the newest letter while it is fresh, else silence.
  enum class P : std::uint8_t { any, positive, not_positive, negative, not_negative };
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
    released,  // the partner knew, when it sent the newest letter, that this robot asks no more
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
  static constexpr Row table[] = {
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

  // After a boot a robot rests and starts nothing until it is linked. A palm that was up for the
  // partner stays up until the partner answers or the partner's lease must have run out.
  constexpr Resilient(Times times, bool yields, bool assisted = false)
      : times_(times),
        state_(assisted ? State::c_withdraw : State::c_tilt_down),
        yields_(yields),
        age_(stale()),
        since_ready_(most_ready()),
        since_sent_(times.beacon) {}

  Output step(const Input& in) {
    pass(in.elapsed);
    if (in.letter != Letter::none) {
      letter_ = in.letter;
      partner_rests_ = in.rests;
      partner_ready_ = in.ready;
      age_ = in.age < stale() ? in.age : stale();
    }
    const State before = state_;
    if (now().command.move != Move::hold) since_moved_ = 0;
    const bool settled = in.turned && since_moved_ >= times_.braking;
    const bool rested = rests_;
    state_ = lookup.next[index(state_, in.sign, heard(), settled, age_ < since_asked_, yields_,
                               since_entered_ >= times_.hold)];
    if (state_ != before) since_entered_ = 0;
    if (now().letter == Letter::tilt_up) since_asked_ = 0;
    if (state_ == State::idle && in.sign == Sign::zero && !silence()) since_ready_ = 0;
    rests_ = rested ? !may_start() : must_stop();
    if (rests_ != rested) since_turned_ = 0;

    const bool news = now().letter != doing[static_cast<int>(before)].letter || rests_ != rested;
    const bool send = news || since_sent_ >= times_.beacon;
    if (send) since_sent_ = 0;
    Command command = now().command;
    command.rest = rests_;
    return {command, now().letter, ready(), send, assists(state_)};
  }

  // For simulations, which need not step a robot that does nothing: how many steps of one tick each could
  // follow in which nothing happens but that time passes, as long as the robot senses what it sensed in
  // the last one and hears no beacon.
  std::uint16_t quiet(Sign sign, bool turned) const {
    Resilient next = *this;
    const Output out = next.step({sign, turned, 1, Letter::none, false, false, 0});
    if (next.state_ != state_ || out.send) return 0;
    // From there on it stays so until one of the conditions of rows changes, or a beacon is due. (What
    // compares two ages does not change: both grow.)
    int more = times_.beacon - next.since_sent_ - 1;
    const auto until = [&](std::uint16_t since, std::uint16_t most) {
      if (since < most && most - since - 1 < more) more = most - since - 1;
    };
    until(next.age_, stale());
    until(next.since_entered_, times_.hold);
    if (turned) until(next.since_moved_, times_.braking);
    return static_cast<std::uint16_t>(1 + more);
  }

  // So many of these steps at once.
  constexpr void idle(Sign sign, std::uint16_t steps) {
    pass(steps);
    if (now().letter == Letter::tilt_up) since_asked_ = 0;
    if (now().command.move != Move::hold) since_moved_ = 0;
    if (state_ == State::idle && sign == Sign::zero && !silence()) since_ready_ = 0;
  }

  constexpr State state() const { return state_; }
  constexpr bool rests() const { return rests_; }
  constexpr bool yields() const { return yields_; }
  // No fresh letter: the partner is silent, or does not hear this robot.
  constexpr bool silence() const { return age_ >= stale(); }
  constexpr const Doing& now() const { return doing[static_cast<int>(state_)]; }

 private:
  // The rows spread out over every input, so that a step is one look-up.
  static constexpr int signs = 3;
  static constexpr int letters = 6;
  static constexpr int flags = 16;
  struct Lookup {
    State next[states * signs * letters * flags];
  };

  static constexpr int index(State state, Sign sign, Letter heard, bool settled, bool released,
                             bool yields, bool held) {
    const int bits = int{settled} | int{released} << 1 | int{yields} << 2 | int{held} << 3;
    const int row = static_cast<int>(state) * signs + static_cast<int>(sign) + 1;
    return (row * letters + static_cast<int>(heard)) * flags + bits;
  }

  static constexpr bool fits(P p, Sign sign) {
    switch (p) {
      case P::positive: return sign == Sign::positive;
      case P::not_positive: return sign != Sign::positive;
      case P::negative: return sign == Sign::negative;
      case P::not_negative: return sign != Sign::negative;
      case P::any: break;
    }
    return true;
  }

  static constexpr bool fits(Heard wanted, Letter heard) {
    const bool steep =
        heard == Letter::tilt_up || heard == Letter::tilt_down || heard == Letter::closing;
    switch (wanted) {
      case Heard::tilt_up: return heard == Letter::tilt_up;
      case Heard::not_tilt_up: return heard != Letter::tilt_up;
      case Heard::ack: return heard == Letter::ack;
      case Heard::not_ack: return heard != Letter::ack;
      case Heard::other: return heard != Letter::none && heard != Letter::tilt_up;
      case Heard::steep: return steep;
      case Heard::not_steep: return !steep;
      case Heard::silence: return heard == Letter::none;
      case Heard::any: break;
    }
    return true;
  }

  static constexpr bool assists(State state) {
    return state == State::c_grant || state == State::c_withdraw;
  }

  static constexpr Lookup spread() {
    Lookup all{};
    for (int s = 0; s < states; ++s) {
      for (int sign = -1; sign <= 1; ++sign) {
        for (int letter = 0; letter < letters; ++letter) {
          for (int bits = 0; bits < flags; ++bits) {
            const auto state = static_cast<State>(s);
            const auto seen = static_cast<Sign>(sign);
            const auto heard = static_cast<Letter>(letter);
            const bool settled = (bits & 1) != 0;
            // Who hears nothing fresh is not released, whatever was answered before.
            const bool released = (bits & 2) != 0 && heard != Letter::none;
            const bool yields = (bits & 4) != 0;
            const bool held = (bits & 8) != 0;
            const bool met[] = {true, settled, released, yields, held};
            State next = state;
            for (const Row& row : table) {
              if (row.state == state && fits(row.p, seen) && fits(row.heard, heard) &&
                  met[static_cast<int>(row.when)]) {
                next = row.next;
                break;
              }
            }
            all.next[index(state, seen, heard, settled, (bits & 2) != 0, yields, held)] = next;
          }
        }
      }
    }
    return all;
  }

  static const Lookup lookup;

  // The first age that is too old. Counters stop there: longer makes no difference.
  constexpr std::uint16_t stale() const { return static_cast<std::uint16_t>(times_.lease + 1); }

  constexpr std::uint16_t most_ready() const { return static_cast<std::uint16_t>(times_.join + 1); }

  static constexpr std::uint16_t later(std::uint16_t since, std::uint16_t elapsed,
                                       std::uint16_t most) {
    return elapsed < most - since ? static_cast<std::uint16_t>(since + elapsed) : most;
  }

  constexpr void pass(std::uint16_t elapsed) {
    age_ = later(age_, elapsed, stale());
    since_asked_ = later(since_asked_, elapsed, stale());
    since_ready_ = later(since_ready_, elapsed, most_ready());
    since_moved_ = later(since_moved_, elapsed, times_.braking);
    since_turned_ = later(since_turned_, elapsed, stale());
    since_entered_ = later(since_entered_, elapsed, times_.hold);
    since_sent_ = later(since_sent_, elapsed, times_.beacon);
  }

  constexpr Letter heard() const { return silence() ? Letter::none : letter_; }

  // The partner knew, when it sent the newest beacon, that this robot travels (or rests) as it does.
  constexpr bool known() const { return age_ <= since_turned_; }

  constexpr bool must_stop() const { return silence() || (partner_rests_ && known()); }

  // At rest a robot is ready, or not; while a start is under way it is so for a little longer.
  constexpr bool ready() const { return since_ready_ == 0 || (!rests_ && lately_ready()); }
  constexpr bool lately_ready() const { return since_ready_ <= times_.join; }

  constexpr bool may_start() const {
    if (silence() || !partner_ready_) return false;
    return partner_rests_ ? since_ready_ == 0 && known() : lately_ready();
  }

  Times times_;
  State state_;
  Letter letter_ = Letter::none;  // of the newest beacon
  bool yields_;
  bool rests_ = true;
  bool partner_rests_ = true;
  bool partner_ready_ = false;
  std::uint16_t age_;              // of the newest beacon
  std::uint16_t since_ready_;      // since it was linked, idle and p = 0
  std::uint16_t since_asked_ = 0;  // since the last step that said TiltUp; a boot may follow one
  std::uint16_t since_moved_ = 0;  // since the step that ended the last move; a boot may follow one
  std::uint16_t since_turned_ = 0;   // since the step at which it last started or stopped
  std::uint16_t since_entered_ = 0;  // since the state was entered
  std::uint16_t since_sent_;         // since the last beacon
};

inline constexpr Resilient::Lookup Resilient::lookup = Resilient::spread();

}  // namespace palmbots
