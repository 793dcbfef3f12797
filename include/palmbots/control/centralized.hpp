// SPDX-License-Identifier: Apache-2.0
// The centralized algorithm: Table 1 of the paper as a table, run by a station beside the robots.
//
// Case 7 is the mirror image of case 8 here. Our copy of the paper prints its two conditions in the
// opposite order ("closer until p_R ≤ 0, separate until p_L ≥ 0"). Both hold on entry, where p_L >
// 0 and p_R < 0, so nothing would ever move.
//
// The station receives each robot's sign and whether its palm has reached its target. It answers
// with a command. Both travel in periodic state packets, of which only the newest counts.
#pragma once

#include "palmbots/control/messages.hpp"
#include "palmbots/control/transition_table.hpp"

namespace palmbots {

// The station's program. Robots are numbered 0 (left) and 1 (right).
class Centralized {
 public:
  static constexpr int left = 0;
  static constexpr int right = 1;
  static constexpr bool half_moves = true;  // both robots move, at half the correction speed each

  // What a robot reports.
  struct Report {
    Sign sign;
    Palm palm;            // the angle last commanded
    bool palm_at_target;  // the palm has reached that angle

    constexpr bool operator==(const Report&) const = default;
  };

  // Which robot a condition or a tilt refers to. `either` stands for both robots.
  enum class Who : std::uint8_t { on_left, on_right, either, none };
  enum class Until : std::uint8_t { le_zero, ge_zero };  // p ≤ 0, p ≥ 0

  // One action: both robots make the same move until a contact satisfies a condition.
  struct Action {
    Move move;  // away: separate, closer: move closer, hold: no action
    Who who;
    Until until;
  };

  struct Case {
    Sign sign[2];
    Who tilt;  // the palm that is tilted up first and restored last (Table 1)
    Action first;
    Action second;
  };

  static constexpr Sign neg = Sign::negative, zero = Sign::zero, pos = Sign::positive;
  static constexpr Who L = Who::on_left, R = Who::on_right, any = Who::either, no = Who::none;
  static constexpr Move away = Move::away, closer = Move::closer;
  static constexpr Until le = Until::le_zero, ge = Until::ge_zero;
  static constexpr Action done_then{Move::hold, no, le};

  // clang-format off
  static constexpr Case table[] = {
      //  p_L   p_R    tilt up   first, until      then, until
      {{pos,  zero},   R,   {away,   L,   le},   done_then},          // 1
      {{zero, pos },   L,   {away,   R,   le},   done_then},          // 2
      {{neg,  zero},   L,   {closer, L,   ge},   done_then},          // 3
      {{zero, neg },   R,   {closer, R,   ge},   done_then},          // 4
      {{pos,  pos },   no,  {away,   any, le},   done_then},          // 5
      {{neg,  neg },   no,  {closer, any, ge},   done_then},          // 6
      {{pos,  neg },   R,   {closer, R,   ge},   {away, L, le}},      // 7
      {{neg,  pos },   L,   {closer, L,   ge},   {away, R, le}},      // 8
  };
  // clang-format on
  static constexpr int cases = 8;

  // The station's knowledge of a robot, as truth values (control/transition_table.hpp): of one
  // robot, or of 64 side by side.
  template <class B>
  struct Heard {
    Observation<B> seen;
    B shallow;  // the angle last commanded
  };

  template <class B>
  [[gnu::always_inline]] static constexpr B shows(Sign sign, const Heard<B>& robot) {
    switch (sign) {
      case Sign::positive: return robot.seen.positive;
      case Sign::negative: return robot.seen.negative;
      case Sign::zero: break;
    }
    return opposite<B>(robot.seen.positive | robot.seen.negative);
  }

  template <class B>
  [[gnu::always_inline]] static constexpr B done(const Action& action, const Heard<B> (&in)[2]) {
    const auto p = action.until == Until::le_zero ? ContactCondition::not_positive
                                                  : ContactCondition::not_negative;
    const B on_left = holds(p, in[left].seen);
    const B on_right = holds(p, in[right].seen);
    switch (action.who) {
      case Who::on_left: return on_left;
      case Who::on_right: return on_right;
      case Who::either: return on_left | on_right;
      case Who::none: break;
    }
    return everywhere<B>();
  }

  template <class B>
  [[gnu::always_inline]] static constexpr B palm_is_at(Who who, Palm to, const Heard<B> (&in)[2]) {
    if (who == Who::none) return everywhere<B>();
    const Heard<B>& robot = in[static_cast<int>(who)];
    const B there = to == Palm::shallow ? robot.shallow : opposite(robot.shallow);
    return there & robot.seen.palm_at_target;
  }

  enum class Stage : std::uint8_t { decide, tilt, first, second, restore };

  struct Output {
    Command command[2];

    constexpr bool operator==(const Output&) const = default;
  };

  // One tick with the newest reports. Do not call it before both robots have reported.
  Output step(const Report (&in)[2]) {
    const auto heard = [](const Report& report) {
      return Heard<bool>{observation_of(report.sign, report.palm_at_target),
                         report.palm == Palm::shallow};
    };
    const Heard<bool> robots[2] = {heard(in[left]), heard(in[right])};
    for (bool moved_on = true; moved_on;) moved_on = advance(in, robots);
    const Case& now = table[case_ - 1];
    const bool tilts = stage_ != Stage::decide && stage_ != Stage::restore;
    const auto palm = [&](Who who) {
      return tilts && now.tilt == who ? Palm::shallow : Palm::steep;
    };
    const Move move = stage_ == Stage::first    ? now.first.move
                      : stage_ == Stage::second ? now.second.move
                                                : Move::hold;
    return {{{palm(Who::on_left), move}, {palm(Who::on_right), move}}};
  }

  // The case in progress, 1–8 as in Table 1; 0 if none.
  int current() const { return stage_ == Stage::decide ? 0 : case_; }
  Stage stage() const { return stage_; }

  constexpr bool operator==(const Centralized&) const = default;

  static constexpr int case_of(Sign l, Sign r) {
    for (int i = 0; i < cases; ++i) {
      if (table[i].sign[left] == l && table[i].sign[right] == r) return i + 1;
    }
    return 0;
  }

 private:
  // Goes to the next stage if this one has ended. A case is shown for at least one tick.
  bool advance(const Report (&in)[2], const Heard<bool> (&robots)[2]) {
    const Case& now = table[case_ - 1];
    switch (stage_) {
      case Stage::decide: {
        const int next = case_of(in[left].sign, in[right].sign);
        if (next == 0) return false;
        case_ = static_cast<std::uint8_t>(next);
        stage_ = Stage::tilt;
        return table[case_ - 1].tilt == Who::none;
      }
      case Stage::tilt:
        if (!palm_is_at(now.tilt, Palm::shallow, robots)) return false;
        stage_ = Stage::first;
        return false;
      case Stage::first:
        if (!done(now.first, robots)) return false;
        stage_ = now.second.move == Move::hold ? Stage::restore : Stage::second;
        return false;
      case Stage::second:
        if (!done(now.second, robots)) return false;
        stage_ = Stage::restore;
        return false;
      case Stage::restore:
        if (!palm_is_at(now.tilt, Palm::steep, robots)) return false;
        stage_ = Stage::decide;
        return false;
    }
    return false;
  }

  std::uint8_t case_ = 1;
  Stage stage_ = Stage::decide;
};

constexpr const char* name_of(Centralized::Who who) {
  constexpr const char* names[] = {"left", "right", "either", "none"};
  return names[static_cast<int>(who)];
}

constexpr const char* name_of(Centralized::Until until) {
  constexpr const char* names[] = {"le_zero", "ge_zero"};
  return names[static_cast<int>(until)];
}

}  // namespace palmbots
