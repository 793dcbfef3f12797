// SPDX-License-Identifier: Apache-2.0
// Many carries, several side by side in SIMD lanes (base/simd_lanes.hpp).
//
// Every lane executes Carry::tick with the same bits. Work that all carries do in every tick is
// done in lanes: sensing, driving, the fast step of the world, and statistics. Teams that have a
// bit-sliced form are stepped in that form (batch/bitslice.hpp). Rare work is done by the lane's
// own Carry, to which the lane's numbers are copied first. This is stepping other teams, steps in
// which more happens than one contact sliding, and the end of a carry. A lane whose carry is over
// takes the next one at the next block of ticks.
//
// Carries with bit-sliced teams count corrections but do not store them one by one (Metrics::rows,
// longest_correction, limit_cycle).
#pragma once

#include <optional>
#include <utility>

#include "palmbots/batch/bitslice_teams.hpp"
#include "palmbots/batch/noise_draws.hpp"

namespace palmbots {

// Runs carries in lanes of type Lanes<Real, n>. Team is as in Carry.
template <class Real, int n, class Team>
class LaneCarries {
 public:
  using V = Lanes<Real, n>;
  using One = Carry<Real, Team, NoRecorder>;

  // Runs carries until there are no more. next(slot, index) puts a carry into an optional<One> and
  // gives it a number, or returns false. done(index, carry) gets each finished carry, in no
  // particular order. Stops without finishing when stop() returns true.
  template <class Next, class Done, class Stop>
  void run(Next&& next, Done&& done, Stop&& stop) {
    bool more = true;
    std::uint32_t busy = 1;
    for (std::uint64_t tick = 0; busy != 0 || more; ++tick) {
      if (tick % block_ticks == 0) {
        if (stop()) return;
        for (Pack& pack : packs_) more = refill(pack, tick, more, next, done);
      }
      for (Pack& pack : packs_) {
        if ((pack.busy & pack.is_jolted) != 0) apply_jolts(pack, tick, done);
      }
      think(tick);
      busy = 0;
      for (Pack& pack : packs_) {
        if (pack.busy != 0) step(pack, tick);
      }
      for (Pack& pack : packs_) {
        if (pack.unfinished != 0) finish_step(pack, tick, done);
        busy |= pack.busy;
      }
    }
  }

 private:
  // A word has one bit for each carry.
  static constexpr std::size_t pack_count = 64 / n;
  static constexpr bool in_bits = BitslicedTeams<Real, n, Team>::exists;

  struct Lane {
    std::optional<One> carry;
    std::size_t index = 0;
    std::uint64_t start = 0;  // the tick at which it began
  };

  struct Pack {
    ModelParams<V> params;
    // The positions now and a tick ago, in alternating order. Lifts are the same in both.
    std::array<Kinematics<V>, 2> kinematics;
    SlipState<V> slip_state;
    Robots<V> robots;
    ContactStatistics<V> statistics;
    V goal;  // midpoint × travel sense at which the carry is delivered
    // An observation of a lane's robots stays valid while the palms are touched from `from` on and
    // before `until`, and while palm_at_target does not change.
    PerSide<V> from;
    PerSide<V> until;
    PerSide<LaneMask<Real, n>> palm_at_target;
    std::uint32_t has_false_readings = 0;  // lanes whose readings may be false
    std::uint32_t is_jolted = 0;           // lanes whose carry has bumps, or biases that change
    std::uint32_t shaken = 0;              // lanes with a bump in this tick
    LaneRandomInputs<n> random{};
    PerSide<std::array<V, block_ticks>> noise;
    // Ticks from the start of the block at which a lane's team has to be stepped, and at which its
    // carry times out.
    V next_decision;
    V timeout;
    std::uint32_t busy = 0;
    // About the step in progress: the result of its first half, the midpoint before it, the lanes
    // that have reached their goal or their time limit, and the lanes in which work is left.
    FastStep<V> went;
    V midpoint;
    std::uint32_t over = 0;
    std::uint32_t unfinished = 0;
    std::array<Lane, n> lanes;
  };

  template <class Next, class Done>
  bool refill(Pack& pack, std::uint64_t tick, bool more, Next& next, Done& done) {
    for (int l = 0; l < n; ++l) {
      Lane& lane = pack.lanes[static_cast<std::size_t>(l)];
      while ((pack.busy >> l & 1) == 0 && more) {
        more = next(lane.carry, lane.index);
        if (!more) break;
        One& one = *lane.carry;
        one.begin();
        if (one.metrics_.reason != DropReason::none) {  // it does not start at all
          one.tick();
          done(lane.index, one);
          continue;
        }
        one.change_biases();
        lane.start = tick;
        load(pack, l, one);
        pack.busy |= 1U << l;
      }
      if ((pack.busy >> l & 1) != 0) collect(pack, l, tick);
    }
    if (pack.busy == 0) return more;
    draw_noise(pack.random, tick, pack.noise);
    if constexpr (in_bits) teams_.draw(number(pack), pack.random, tick);
    return more;
  }

  void load(Pack& pack, int l, const One& one) {
    put_lane(pack.params, l, static_cast<const ModelParams<Real>&>(one.world_.model()));
    put_state(pack, l, one.world_.state());
    put_lane(pack.robots, l, one.robots_);
    put_lane(pack.statistics, l, one.statistics_);
    for (const std::size_t side : {left, right}) {
      pack.from[side].raw[l] = std::numeric_limits<Real>::infinity();  // no observation yet
    }
    pack.has_false_readings = (pack.has_false_readings & ~(1U << l)) | (one.reads_truly() ? 0U : 1U)
                                                                           << l;
    const bool jolts =
        Bumps::any(one.spec_) || Pushes::any(one.spec_) || SpeedErrors::vary(one.spec_);
    pack.is_jolted = (pack.is_jolted & ~(1U << l)) | (jolts ? 1U : 0U) << l;
    // The least Real that is not less than the distance.
    auto goal = Real(one.spec_.distance);
    if (double(goal) < one.spec_.distance) {
      goal = std::nextafter(goal, std::numeric_limits<Real>::infinity());
    }
    pack.goal.raw[l] = goal;
    const auto i = static_cast<std::size_t>(l);
    const std::uint64_t start = pack.lanes[i].start;
    if constexpr (in_bits) teams_.insert(bit(pack, l), start, one);
    pack.random.seed[i] = one.seed_;
    pack.random.start[i] = start;
    pack.random.left_leads[i] = one.leader() == left ? ~std::uint64_t{0} : 0;
    pack.random.false_words[i] = double(one.tactile_.false_words());
    if constexpr (in_bits) pack.random.loss_words[i] = double(one.team_.radio().loss_words());
  }

  std::size_t number(const Pack& pack) const {
    return static_cast<std::size_t>(&pack - packs_.data());
  }
  // The bit of a word that belongs to a lane.
  int bit(const Pack& pack, int l = 0) const { return static_cast<int>(number(pack)) * n + l; }

  void collect(Pack& pack, int l, std::uint64_t tick) {
    One& one = follow(pack, l, tick);
    one.statistics_ = take_lane(pack.statistics, l);
    one.collect();
    put_lane(pack.statistics, l, one.statistics_);
    pack.next_decision.raw[l] = in_block(one, one.next_decision_tick_);
    pack.timeout.raw[l] = in_block(one, one.spec_.timeout_ticks - 1);
    one.bumps_.draw_block(one.spec_, one.seed_, one.tick_);
  }

  // A tick of a carry, counted from the start of its current block.
  static Real in_block(const One& one, std::uint64_t tick) {
    return Real(static_cast<std::int64_t>(tick) - (one.tick_ - one.tick_ % block_ticks));
  }

  // A lane's carry, set to the current tick.
  static One& follow(Pack& pack, int l, std::uint64_t tick) {
    Lane& lane = pack.lanes[static_cast<std::size_t>(l)];
    lane.carry->tick_ = static_cast<std::uint32_t>(tick - lane.start);
    return *lane.carry;
  }

  // The positions at the start of a tick.
  static Kinematics<V>& kinematics(Pack& pack, std::uint64_t tick) {
    return pack.kinematics[tick % 2];
  }

  static void put_state(Pack& pack, int l, const WorldState<Real>& state) {
    for (Kinematics<V>& place : pack.kinematics)
      put_lane(place, l, static_cast<const Kinematics<Real>&>(state));
    put_lane(pack.slip_state, l, static_cast<const SlipState<Real>&>(state));
  }
  static WorldState<Real> take_state(const Kinematics<V>& place, const Pack& pack, int l) {
    return {take_lane(place, l), take_lane(pack.slip_state, l)};
  }

  // Copies a lane's numbers to its carry.
  static One& take(Pack& pack, const Kinematics<V>& place, int l, std::uint64_t tick) {
    One& one = follow(pack, l, tick);
    one.world_.set_state(take_state(place, pack, l));
    one.robots_ = take_lane(pack.robots, l);
    one.statistics_ = take_lane(pack.statistics, l);
    return one;
  }

  // The part of a tick that all carries execute. The rest follows when all packs have come this far
  // (world/fast_step.hpp).
  [[gnu::noinline, gnu::flatten]] void step(Pack& pack, std::uint64_t tick) {
    const std::size_t k = tick % block_ticks;
    const Kinematics<V>& from = kinematics(pack, tick);
    const Actuation<V> act =
        actuate(pack.robots, from.configuration.palms, {pack.noise[left][k], pack.noise[right][k]});
    pack.midpoint = pack.robots.midpoint;
    pack.robots.midpoint = pack.midpoint + act.travel;
    const V gone = pack.robots.midpoint * pack.robots.travel_sense;
    pack.over = ((gone >= pack.goal) | (V(k) >= pack.timeout)).bits() & pack.busy;
    step_fast<V>(pack.params, from, pack.slip_state, kinematics(pack, tick + 1), act.change,
                 act.angles, act.push, pack.went);
    pack.unfinished = (~pack.went.done.bits() & pack.busy) | pack.over | pack.shaken;
  }

  template <class Done>
  [[gnu::noinline]] void finish_step(Pack& pack, std::uint64_t tick, Done& done) {
    const Kinematics<V>& from = kinematics(pack, tick);
    Kinematics<V>& to = kinematics(pack, tick + 1);
    const V change = pack.robots.change();
    if ((~pack.went.done.bits() & pack.busy) != 0) {
      finish_fast<V>(pack.params, from, pack.slip_state, to, change, pack.went);
    }
    const std::uint32_t undone = ~pack.went.done.bits() & pack.busy;
    pack.unfinished = 0;
    for_each_bit(undone | pack.over | std::exchange(pack.shaken, 0), [&](int l) {
      One& one = follow(pack, l, tick);
      Advance<Real> step;
      if ((undone >> l & 1) != 0) {
        one.world_.set_state(take_state(to, pack, l));
        // Computes the motion of the robots once more, for this lane.
        const Robots<Real> robots = take_lane(pack.robots, l);
        const auto angle = [&](std::size_t side) {
          const Real then = one.world_.configuration().palms[side].angle;
          return robots.wrists[side].step(then, robots.goal_angle[side]);
        };
        const PerSide<Real> angles{angle(left), angle(right)};
        if (one.is_limited_) {
          one.robots_ = robots;
          step = one.world_.advance(one.ways(), angles, one.world_.state().push);
          const Real midpoint = pack.robots.midpoint.raw[l] + one.metrics_.note_stalls(step);
          pack.robots.midpoint.raw[l] = midpoint;
          const bool is_over = midpoint * robots.travel_sense >= pack.goal.raw[l] ||
                               Real(tick % block_ticks) >= pack.timeout.raw[l];
          if (!is_over) pack.over &= ~(1U << l);
        } else {
          step = one.world_.take_apart(change.raw[l], angles);
        }
        put_state(pack, l, one.world_.state());
      }
      one.metrics_.observe(one.tick_, one.world_.contact_events(), !one.world_.regime().none());
      if (step.reason != DropReason::none || (pack.over >> l & 1) != 0)
        end(pack, l, tick, step, done);
    });
  }

  // A carry ends in this tick, after that step of the world.
  template <class Done>
  [[gnu::noinline]] void end(Pack& pack, int l, std::uint64_t tick, const Advance<Real>& step,
                             Done& done) {
    One& one = take(pack, kinematics(pack, tick + 1), l, tick);
    const Real before = pack.midpoint.raw[l];
    if (step.reason != DropReason::none) {
      one.robots_.midpoint = before + Real(pack.robots.travel().raw[l]) * step.fraction +
                             Real(0.5) * (step.lag[left] + step.lag[right]);
    }
    one.finish_tick(step.reason, double(step.fraction), before);
    finish_lane(pack, l, done);
  }

  template <class Done>
  void finish_lane(Pack& pack, int l, Done& done) {
    pack.busy &= ~(1U << l);
    Lane& lane = pack.lanes[static_cast<std::size_t>(l)];
    if constexpr (in_bits) teams_.erase(bit(pack, l), *lane.carry);
    done(lane.index, *lane.carry);
  }

  // Applies the biases and the bumps of a tick, before anything else.
  template <class Done>
  [[gnu::noinline]] void apply_jolts(Pack& pack, std::uint64_t tick, Done& done) {
    for_each_bit(pack.busy & pack.is_jolted, [&](int l) {
      One& one = follow(pack, l, tick);
      const PerSide<Real> biases = one.biases(one.tick_);
      for (const std::size_t side : {left, right})
        pack.robots.wheels[side].bias.raw[l] = biases[side];
      const double midpoint = pack.robots.midpoint.raw[l];
      const double together = pack.robots.inertia.together.raw[l];
      if (!one.bumps_.due(one.spec_, one.tick_, midpoint, together)) return;
      take(pack, kinematics(pack, tick), l, tick);
      if (!one.open()) return finish_lane(pack, l, done);
      put_state(pack, l, one.world_.state());
      pack.shaken |= 1U << l;
    });
  }

  // Sensing, statistics and decisions. Bit-sliced teams are stepped all at once. The others are
  // stepped one by one if their observation is new or they are due. This set of teams is
  // determined for all packs before the first is stepped, so that there is at most one branch
  // misprediction per tick.
  [[gnu::noinline, gnu::flatten]] void think(std::uint64_t tick) {
    CarryMask asked = 0;
    [[maybe_unused]] BitslicedObservation sensed;
    for (std::size_t p = 0; p < pack_count; ++p) {
      Pack& pack = packs_[p];
      const Kinematics<V>& here = kinematics(pack, tick);
      PerSide<V> elsewhere;
      const PerSide<V>& touched = where_touched(pack, here, elsewhere);
      pack.statistics.add(touched);
      PerSide<LaneMask<Real, n>> palm_at_target;
      on_both_sides([&](std::size_t side) {
        palm_at_target[side] = here.configuration.palms[side].angle == pack.robots.goal_angle[side];
      });
      std::uint32_t one_by_one = pack.busy;
      if constexpr (in_bits) {
        sensed |= teams_.sense(p, touched, palm_at_target);
        one_by_one &= ~static_cast<std::uint32_t>(teams_.here() >> p * n);
      }
      if (!in_bits || one_by_one != 0) {
        asked |= CarryMask{lanes_with_news(pack, touched, palm_at_target, tick) & one_by_one}
                 << p * n;
      }
    }
    if constexpr (in_bits) {
      const auto robots = [&](std::size_t p) -> Robots<V>& { return packs_[p].robots; };
      if (teams_.here() != 0) teams_.decide(tick, sensed, robots);
    }
    for_each_bit(asked, [&](int i) {
      run_controller(packs_[static_cast<std::size_t>(i / n)], i % n, tick);
    });
  }

  // The lanes in which the robots' observation is new.
  [[gnu::always_inline]] std::uint32_t lanes_with_news(
      Pack& pack, const PerSide<V>& touched, const PerSide<LaneMask<Real, n>>& palm_at_target,
      std::uint64_t tick) {
    const LaneMask<Real, n> same =
        (touched[left] >= pack.from[left]) & (touched[left] < pack.until[left]) &
        (touched[right] >= pack.from[right]) & (touched[right] < pack.until[right]) &
        !(palm_at_target[left] ^ pack.palm_at_target[left]) &
        !(palm_at_target[right] ^ pack.palm_at_target[right]);
    pack.palm_at_target = palm_at_target;
    return ((!same) | (V(tick % block_ticks) >= pack.next_decision)).bits();
  }

  // The coordinates at which the palms are touched, as in World::touched(): those of the two
  // vertices. If some objects rest on more contacts, the coordinates are collected in `elsewhere`.
  [[gnu::always_inline]] static const PerSide<V>& where_touched(const Pack& pack,
                                                                const Kinematics<V>& here,
                                                                PerSide<V>& elsewhere) {
    const std::uint32_t on_more = (pack.slip_state.multi_contact != V(0)).bits() & pack.busy;
    if (on_more == 0) [[likely]]
      return here.configuration.contacts;
    elsewhere = here.configuration.contacts;
    look_where_touched(pack, on_more, elsewhere);
    return elsewhere;
  }

  [[gnu::noinline]] static void look_where_touched(const Pack& pack, std::uint32_t on_more,
                                                   PerSide<V>& touched) {
    for_each_bit(on_more, [&](int l) {
      const PerSide<Real> at = pack.lanes[static_cast<std::size_t>(l)].carry->world_.touched();
      for (const std::size_t side : {left, right}) touched[side].raw[l] = at[side];
    });
  }

  [[gnu::noinline]] void run_controller(Pack& pack, int l, std::uint64_t tick) {
    One& one = follow(pack, l, tick);
    const PerSide<V>& contacts = kinematics(pack, tick).configuration.contacts;
    PerSide<Real> touched{contacts[left].raw[l], contacts[right].raw[l]};
    if (pack.slip_state.multi_contact.raw[l] != Real(0)) [[unlikely]]
      touched = one.world_.touched();
    const bool reads_falsely = (pack.has_false_readings >> l & 1) != 0;
    const PerSide<Sign> odd = reads_falsely ? one.read(touched) : PerSide<Sign>{};
    const auto feel = [&](std::size_t side) {
      if (touched[side] >= pack.from[side].raw[l] && touched[side] < pack.until[side].raw[l])
        return one.sensed_[side].sign;
      if (reads_falsely) return odd[side];
      const auto stretch = one.tactile_.stretch(touched[side]);
      pack.from[side].raw[l] = stretch.from;
      pack.until[side].raw[l] = stretch.until;
      return stretch.sign;
    };
    const auto there = [&](std::size_t side) { return pack.palm_at_target[side].bits() >> l & 1; };
    const PerSide<RobotObservation> sensed{
        {{feel(left), there(left) != 0}, {feel(right), there(right) != 0}}};
    if (!one.notice(sensed)) return;
    const bool are_new = one.think();
    pack.next_decision.raw[l] = in_block(one, one.next_decision_tick_);
    if (!are_new) return;
    for (const std::size_t side : {left, right}) {
      pack.robots.goal_angle[side].raw[l] = one.robots_.goal_angle[side];
      pack.robots.goal_speed[side].raw[l] = one.robots_.goal_speed[side];
      pack.robots.held_at[side].raw[l] = one.robots_.held_at[side];
      pack.palm_at_target[side].put(l, one.sensed_[side].palm_at_target);
    }
  }

  std::array<Pack, pack_count> packs_{};
  BitslicedTeams<Real, n, Team> teams_;
};

}  // namespace palmbots
