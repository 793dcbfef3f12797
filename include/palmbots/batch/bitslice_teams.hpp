// SPDX-License-Identifier: Apache-2.0
// The bit-sliced teams of the carries in lanes (batch/bitslice.hpp).
#pragma once

#include <algorithm>

#include "palmbots/batch/bitslice_centralized.hpp"
#include "palmbots/batch/bitslice_table_team.hpp"
#include "palmbots/batch/event_draws.hpp"
#include "palmbots/sim/recorder.hpp"

namespace palmbots {

// Times at which programs of robots stop or start to run, in each of 64 carries.
class BitslicedProgramStates {
 public:
  BitslicedProgramStates() { change_at_.fill(never); }

  // Carry i begins at the tick `start`, with these faults.
  void insert(int i, std::uint64_t start, const Faults& faults) {
    if (!faults.any()) return;
    const auto place = static_cast<std::size_t>(i);
    start_[place] = change_at_[place] = start;
    faults_[place] = &faults;
    first_change_ = std::min(first_change_, start);
  }
  void erase(int i) {
    change_at_[static_cast<std::size_t>(i)] = never;
    now_.off &= ~both_at(i);
    now_.booting &= ~both_at(i);
  }

  const BitslicedProgramState& at(std::uint64_t tick) {
    now_.booting = RobotMask{};
    if (tick >= first_change_) [[unlikely]]
      change(tick);
    return now_;
  }

 private:
  static constexpr std::uint64_t never = ~std::uint64_t{0};

  [[gnu::noinline]] void change(std::uint64_t tick) {
    first_change_ = never;
    for (std::size_t i = 0; i < 64; ++i) {
      if (change_at_[i] <= tick) change(i, tick);
      first_change_ = std::min(first_change_, change_at_[i]);
    }
  }

  void change(std::size_t i, std::uint64_t tick) {
    const auto own_tick = static_cast<std::uint32_t>(tick - start_[i]);
    const CarryMask bit = CarryMask{1} << i;
    std::uint32_t next = ~0U;
    for (const std::size_t side : {left, right}) {
      if (faults_[i]->program_state(own_tick, side) == ProgramState::off) {
        now_.off[side] |= bit;
      } else {
        now_.booting[side] |= now_.off[side] & bit;
        now_.off[side] &= ~bit;
      }
      next = std::min(next, faults_[i]->next_change(own_tick, side));
    }
    change_at_[i] = next == ~0U ? never : start_[i] + next;
  }

  BitslicedProgramState now_;
  std::array<const Faults*, 64> faults_{};
  std::array<std::uint64_t, 64> start_{};
  std::array<std::uint64_t, 64> change_at_;
  std::uint64_t first_change_ = never;  // not later than any of them
};

// Up to 64 carries, in packs of n SIMD lanes. Lane l of pack p corresponds to bit p·n + l. Only
// teams for which `BitslicedTeam` is specialised can run bit-sliced.
template <class Real, int n, class Team>
class BitslicedTeams {
 public:
  using V = Lanes<Real, n>;
  using Mask = LaneMask<Real, n>;
  using One = Carry<Real, Team, NoRecorder>;
  static constexpr std::size_t packs = 64 / n;
  static constexpr bool exists = BitslicedTeam<Team>::exist;

  // Carry i begins at the tick `start`. Its team continues here if it can run bit-sliced.
  void insert(int i, std::uint64_t start, const One& one) {
    const auto steps = one.tactile_.steps();
    if (!steps || !Teams::supports(one.team_)) return;
    Share& share = shares_[static_cast<std::size_t>(i / n)];
    const int l = i % n;
    share.not_negative.raw[l] = steps->not_negative;
    share.positive.raw[l] = steps->positive;
    for (const std::size_t side : {left, right}) {
      for (const Move move : {Move::hold, Move::away, Move::closer}) {
        const auto m = static_cast<std::size_t>(move);
        share.speeds[side][m].raw[l] = one.goal_speed(side, {Palm::steep, move});
        share.resting[side][m].raw[l] = one.goal_speed(side, {Palm::steep, move, true});
      }
    }
    teams_.insert(i, one.team_);
    programs_.insert(i, start, one.faults_);
    here_ |= CarryMask{1} << i;
    if (one.tactile_.has_false_readings()) misread_ |= CarryMask{1} << i;
    if (one.team_.radio().loss_words() > 0) lossy_ |= CarryMask{1} << i;
  }

  // Carry i is over: its team's metrics are written to `one`.
  void erase(int i, One& one) {
    if ((here_ >> i & 1) == 0) return;
    teams_.write_results(i, one.tick_, one.metrics_, one.team_.link_totals);
    teams_.erase(i);
    programs_.erase(i);
    here_ &= ~(CarryMask{1} << i);
    misread_ &= ~(CarryMask{1} << i);
    lossy_ &= ~(CarryMask{1} << i);
  }

  // The carries whose teams run bit-sliced.
  CarryMask here() const { return here_; }

  // To be called before a block of ticks: draws the random numbers of a pack.
  void draw(std::size_t pack, const LaneRandomInputs<n>& random_inputs, std::uint64_t tick) {
    Share& share = shares_[pack];
    if (of(pack, misread_) != 0) draw_readings(random_inputs, tick, share.readings);
    if (of(pack, lossy_) != 0) {
      draw_losses(random_inputs, 0, tick, share.reports_lost);
      if (Teams::station) draw_losses(random_inputs, 2, tick, share.commands_lost);
    }
  }

  // The observations of the robots of a pack.
  [[gnu::always_inline]] BitslicedObservation sense(std::size_t pack, const PerSide<V>& touched,
                                                    const PerSide<Mask>& palm_at_target) const {
    const Share& share = shares_[pack];
    const auto words = [&](auto&& mask) {
      const auto word = [&](std::size_t side) { return CarryMask{mask(side).bits()} << pack * n; };
      return RobotMask{word(left), word(right)};
    };
    return {words([&](std::size_t side) { return touched[side] >= share.positive; }),
            words([&](std::size_t side) { return touched[side] < share.not_negative; }),
            words([&](std::size_t side) { return palm_at_target[side]; })};
  }

  // Steps the teams; new commands are passed to robots(pack).
  template <class RobotsOf>
  [[gnu::always_inline]] void decide(std::uint64_t tick, BitslicedObservation& sensed,
                                     RobotsOf&& robots) {
    if (misread_ != 0) falsify(tick, sensed);
    const BitslicedLoss lost = lossy_ != 0 ? losses(tick) : BitslicedLoss{};
    const CarryMask are_new = teams_.step(tick, sensed, programs_.at(tick), lost);
    // Handles all packs without a branch: some pack almost always has new commands, so a branch
    // would often be mispredicted. Unrolled.
    [&]<std::size_t... pack>(std::index_sequence<pack...>) {
      (obey(pack, are_new, robots(pack)), ...);
    }(std::make_index_sequence<packs>());
  }

 private:
  using Teams = BitslicedTeam<Team>;
  static constexpr CarryMask all_lanes = (CarryMask{1} << n) - 1;

  // The data of a pack's lanes.
  struct Share {
    V not_negative;                     // outward coordinate from which on palms read 0 or +
    V positive;                         // … and from which on they read +
    PerSide<std::array<V, 3>> speeds;   // speed for each move
    PerSide<std::array<V, 3>> resting;  // … of robots that rest
    FalseReadings<block_ticks> readings;
    ChanceRows<block_ticks> reports_lost;   // messages of the robots
    ChanceRows<block_ticks> commands_lost;  // messages of a station
  };

  static std::uint32_t of(std::size_t pack, CarryMask word) {
    return static_cast<std::uint32_t>(word >> pack * n & all_lanes);
  }

  // Applies false readings.
  [[gnu::noinline]] void falsify(std::uint64_t tick, BitslicedObservation& sensed) const {
    const RobotMask wrong =
        come_true(tick, misread_, [](const Share& s) -> const auto& { return s.readings.wrong; });
    const RobotMask once =
        come_true(tick, misread_, [](const Share& s) -> const auto& { return s.readings.once; });
    sensed.falsify(wrong, once);
  }

  [[gnu::noinline]] BitslicedLoss losses(std::uint64_t tick) const {
    return {come_true(tick, lossy_, [](const Share& s) -> const auto& { return s.reports_lost; }),
            come_true(tick, lossy_, [](const Share& s) -> const auto& { return s.commands_lost; })};
  }

  // The random events of a tick, for these carries.
  template <class Rows>
  [[gnu::always_inline]] RobotMask come_true(std::uint64_t tick, CarryMask these,
                                             Rows&& rows) const {
    RobotMask found{};
    for (std::size_t p = 0; p < packs; ++p) {
      const ChanceRows<block_ticks>& row = rows(shares_[p]);
      for (const std::size_t side : {left, right}) {
        found[side] |= CarryMask{row[side][tick % block_ticks]} << p * n;
      }
    }
    return found & (RobotMask{} + these);
  }

  [[gnu::always_inline]] void obey(std::size_t pack, CarryMask are_new, Robots<V>& robots) const {
    const BitslicedCommand& commands = teams_.commands();
    const auto lanes = [&](CarryMask word) { return Mask::of(of(pack, word)); };
    const Mask commanded = lanes(are_new);
    on_both_sides([&](std::size_t side) {
      const auto moving = [&](const std::array<V, 3>& speeds) {
        const auto& [hold, away, closer] = speeds;
        return select(lanes(commands.away[side]), away,
                      select(lanes(commands.closer[side]), closer, hold));
      };
      const Wrist<V>& wrist = robots.wrists[side];
      const V angle = select(lanes(commands.shallow[side]), wrist.shallow, wrist.steep);
      V speed = moving(shares_[pack].speeds[side]);
      if constexpr (Teams::can_stop) {
        const Mask stops = lanes(commands.stop[side]);
        speed = select(stops, moving(shares_[pack].resting[side]), speed);
        const V held_at =
            select(stops & (speed == V(0)), V(Robots<V>::braked), V(Robots<V>::released));
        robots.held_at[side] = select(commanded, held_at, robots.held_at[side]);
      }
      robots.goal_angle[side] = select(commanded, angle, robots.goal_angle[side]);
      robots.goal_speed[side] = select(commanded, speed, robots.goal_speed[side]);
    });
  }

  Teams teams_;
  BitslicedProgramStates programs_;
  CarryMask here_ = 0;
  CarryMask misread_ = 0;  // carries that may have false readings
  CarryMask lossy_ = 0;    // carries that may lose messages
  std::array<Share, packs> shares_{};
};

}  // namespace palmbots
