// The teams of the carries in lockstep that decide all at once, a bit a robot (bits.hpp).
#pragma once

#include <algorithm>

#include "palmbots/lane_chances.hpp"
#include "palmbots/pairs_in_bits.hpp"
#include "palmbots/peers_in_bits.hpp"
#include "palmbots/recorder.hpp"
#include "palmbots/stations_in_bits.hpp"

namespace palmbots {

// When programs of robots stop or start to run, in each of 64 carries.
class Hosts {
 public:
  Hosts() { change_at_.fill(never); }

  // Carry i begins at that tick, with these faults.
  void put(int i, std::uint64_t start, const Faults& faults) {
    if (!faults.any()) return;
    const auto place = static_cast<std::size_t>(i);
    start_[place] = change_at_[place] = start;
    faults_[place] = &faults;
    first_change_ = std::min(first_change_, start);
  }
  void remove(int i) {
    change_at_[static_cast<std::size_t>(i)] = never;
    now_.off &= ~both_at(i);
    now_.boots &= ~both_at(i);
  }

  const HostBits& at(std::uint64_t tick) {
    now_.boots = BothBits{};
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
    const Bits bit = Bits{1} << i;
    std::uint32_t next = ~0U;
    for (const std::size_t side : {left, right}) {
      if (faults_[i]->host(own_tick, side) == Host::off) {
        now_.off[side] |= bit;
      } else {
        now_.boots[side] |= now_.off[side] & bit;
        now_.off[side] &= ~bit;
      }
      next = std::min(next, faults_[i]->next_change(own_tick, side));
    }
    change_at_[i] = next == ~0U ? never : start_[i] + next;
  }

  HostBits now_;
  std::array<const Faults*, 64> faults_{};
  std::array<std::uint64_t, 64> start_{};
  std::array<std::uint64_t, 64> change_at_;
  std::uint64_t first_change_ = never;  // no later than any of them
};

// Of 64 carries in packs of n lanes; lane l of pack p is bit p n + l. Not all teams can go in bits.
template <class Real, int n, class Team>
class Crowd {
 public:
  using V = Lanes<Real, n>;
  using Mask = LaneMask<Real, n>;
  using One = Carry<Real, Team, NoRecorder>;
  static constexpr std::size_t packs = 64 / n;
  static constexpr bool exists = TeamsInBits<Team>::exist;

  // Carry i begins at that tick; its team goes on here, if it can.
  void put(int i, std::uint64_t start, const One& one) {
    const auto steps = one.tactile_.steps();
    if (!steps || !Teams::take(one.team_)) return;
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
    teams_.put(i, one.team_);
    hosts_.put(i, start, one.faults_);
    here_ |= Bits{1} << i;
    if (one.tactile_.has_false_readings()) misread_ |= Bits{1} << i;
    if (one.team_.radio().loss_words() > 0) lossy_ |= Bits{1} << i;
  }

  // Carry i is over, and learns what is known of its team.
  void remove(int i, One& one) {
    if ((here_ >> i & 1) == 0) return;
    teams_.tell(i, one.tick_, one.metrics_, one.team_.traffic);
    teams_.remove(i);
    hosts_.remove(i);
    here_ &= ~(Bits{1} << i);
    misread_ &= ~(Bits{1} << i);
    lossy_ &= ~(Bits{1} << i);
  }

  // Those whose teams are here.
  Bits here() const { return here_; }

  // Before a block of ticks.
  void draw(std::size_t pack, const Dice<n>& dice, std::uint64_t tick) {
    Share& share = shares_[pack];
    if (of(pack, misread_) != 0) draw_readings(dice, tick, share.readings);
    if (of(pack, lossy_) != 0) {
      draw_losses(dice, 0, tick, share.reports_lost);
      if (Teams::station) draw_losses(dice, 2, tick, share.commands_lost);
    }
  }

  // What the robots of a pack sense.
  [[gnu::always_inline]] SensedBits sense(std::size_t pack, const PerSide<V>& touched,
                                          const PerSide<Mask>& turned) const {
    const Share& share = shares_[pack];
    const auto words = [&](auto&& mask) {
      const auto word = [&](std::size_t side) { return Bits{mask(side).bits()} << pack * n; };
      return BothBits{word(left), word(right)};
    };
    return {words([&](std::size_t side) { return touched[side] >= share.positive; }),
            words([&](std::size_t side) { return touched[side] < share.not_negative; }),
            words([&](std::size_t side) { return turned[side]; })};
  }

  // The teams decide, and what is new is obeyed by robots(pack).
  template <class RobotsOf>
  [[gnu::always_inline]] void decide(std::uint64_t tick, SensedBits& sensed, RobotsOf&& robots) {
    if (misread_ != 0) falsify(tick, sensed);
    const LossBits lost = lossy_ != 0 ? losses(tick) : LossBits{};
    const Bits are_new = teams_.step(tick, sensed, hosts_.at(tick), lost);
    // All packs: to some it is almost always new, and to guess which costs more. Unrolled.
    [&]<std::size_t... pack>(std::index_sequence<pack...>) {
      (obey(pack, are_new, robots(pack)), ...);
    }(std::make_index_sequence<packs>());
  }

 private:
  using Teams = TeamsInBits<Team>;
  static constexpr Bits all_lanes = (Bits{1} << n) - 1;

  // What is known of a pack's lanes.
  struct Share {
    V not_negative;                     // from where on palms read 0 or +
    V positive;                         // … and +
    PerSide<std::array<V, 3>> speeds;   // what moves come to
    PerSide<std::array<V, 3>> resting;  // … of robots that rest
    FalseReadings<block_ticks> readings;
    ChanceRows<block_ticks> reports_lost;   // what robots send
    ChanceRows<block_ticks> commands_lost;  // … and a station
  };

  static std::uint32_t of(std::size_t pack, Bits word) {
    return static_cast<std::uint32_t>(word >> pack * n & all_lanes);
  }

  // What sensors that may tell something false make of it.
  [[gnu::noinline]] void falsify(std::uint64_t tick, SensedBits& sensed) const {
    const BothBits wrong =
        come_true(tick, misread_, [](const Share& s) -> const auto& { return s.readings.wrong; });
    const BothBits once =
        come_true(tick, misread_, [](const Share& s) -> const auto& { return s.readings.once; });
    sensed.falsify(wrong, once);
  }

  [[gnu::noinline]] LossBits losses(std::uint64_t tick) const {
    return {come_true(tick, lossy_, [](const Share& s) -> const auto& { return s.reports_lost; }),
            come_true(tick, lossy_, [](const Share& s) -> const auto& { return s.commands_lost; })};
  }

  // What happens by chance in a tick, to these.
  template <class Rows>
  [[gnu::always_inline]] BothBits come_true(std::uint64_t tick, Bits these, Rows&& rows) const {
    BothBits found{};
    for (std::size_t p = 0; p < packs; ++p) {
      const ChanceRows<block_ticks>& row = rows(shares_[p]);
      for (const std::size_t side : {left, right}) {
        found[side] |= Bits{row[side][tick % block_ticks]} << p * n;
      }
    }
    return found & (BothBits{} + these);
  }

  [[gnu::always_inline]] void obey(std::size_t pack, Bits are_new, Robots<V>& robots) const {
    const CommandBits& commands = teams_.commands();
    const auto lanes = [&](Bits word) { return Mask::of(of(pack, word)); };
    const Mask told = lanes(are_new);
    on_both_sides([&](std::size_t side) {
      const auto moving = [&](const std::array<V, 3>& speeds) {
        const auto& [hold, away, closer] = speeds;
        return select(lanes(commands.away[side]), away,
                      select(lanes(commands.closer[side]), closer, hold));
      };
      const Wrist<V>& wrist = robots.wrists[side];
      const V angle = select(lanes(commands.shallow[side]), wrist.shallow, wrist.steep);
      V speed = moving(shares_[pack].speeds[side]);
      if constexpr (Teams::rest) {
        const Mask rests = lanes(commands.rest[side]);
        speed = select(rests, moving(shares_[pack].resting[side]), speed);
        const V brakes = select(rests & (speed == V(0)), V(1), V(0));
        robots.brakes[side] = select(told, brakes, robots.brakes[side]);
      }
      robots.goal_angle[side] = select(told, angle, robots.goal_angle[side]);
      robots.goal_speed[side] = select(told, speed, robots.goal_speed[side]);
    });
  }

  Teams teams_;
  Hosts hosts_;
  Bits here_ = 0;
  Bits misread_ = 0;  // those of them whose readings may be false
  Bits lossy_ = 0;    // … whose messages may be lost
  std::array<Share, packs> shares_{};
};

}  // namespace palmbots
