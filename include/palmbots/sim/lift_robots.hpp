// SPDX-License-Identifier: Apache-2.0
// The robots of a job that begins or ends on the floor or on a stand, whatever moves the object:
// robots, radio and controllers as in any carry (sim/robot_pair.hpp), with arms beside wheels and
// wrists, and phases.
//
// ARMS. An arm that follows the floor is compliant: the nose rests on the floor, however fast the palm
// turns. Otherwise the height of the pivot changes at the arm's rate at most. An arm that rises stops
// at its height with an error that is constant in a job. A step of the table is what an arm moves in a
// lease and a delay. Measured from where each stands on the floor, two arms that move differ by a step
// and a tick at most, which the model checker proves (docs/theory/verification.md). At a stand heights
// are measured from where each palm touched the object, or from below the object.
//
// SWITCHES. A palm's switches feel what lies on its top side, and what presses the heel as the outer
// end. They do not feel what touches the nose. Where nothing presses, a robot reads −.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "palmbots/sim/lift_team.hpp"
#include "palmbots/sim/pivot_rises.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/robot_pair.hpp"
#include "palmbots/sim/standing_start.hpp"

namespace palmbots {

// A step of the table [m].
inline double lift_step_of(const Spec& spec) {
  return larger(spec.arms[left].rate, spec.arms[right].rate) *
         (table_lease(spec) + spec.longest_delay());
}

// A phase of one robot, which lasts until its next one [ticks].
struct LiftPhase {
  std::size_t side;
  const char* name;
  int state;  // its number in the table
  std::uint32_t start;
  double moved;  // displacement of the COM until then [m]
};
inline constexpr std::size_t most_lift_phases = 128;

// A small fall of the object.
struct LiftFall {
  std::uint32_t tick;
  Fall fall;
};

template <class Inner, class Recorder = TraceRecorder, class Table = Lifting>
class LiftRobots : public RobotPair<double, LiftTeam<Inner, Table>> {
  using Base = RobotPair<double, LiftTeam<Inner, Table>>;

 public:
  using TheTable = Table;
  using State = Table::State;

  LiftRobots(const Spec& spec, std::uint64_t seed, Inner inner, bool records)
      : Base(spec, seed, LiftTeam<Inner, Table>(spec, seed, std::move(inner))),
        recorder_(records),
        records_(records),
        step_height_(lift_step_of(spec)),
        level_only_(corrects_level_only(spec)) {
    const Words words = draw(seed, 0, Stream::arm_height);
    for (const std::size_t side : {left, right}) {
      constexpr double whole = 4294967296.0;
      const double share = 2 * ((words[rank(side)] + 0.5) / whole) - 1;
      carry_height_[side] = spec.arms[side].carry_height + share * spec.arms[side].height_error;
      floor_[side] = spec.palms[side].lowest_pivot(sin_cos(first_angle(spec, side)));
      for (const bool ends : {false, true}) {
        lowest_[ends][side] = floor_[side];
        if (!is_stand(ends)) continue;
        const double top = standing_level(spec, ends ? spec.direction * spec.distance : 0.0);
        const StandHeights heights = StandHeights::of(spec, side, top);
        lowest_[ends][side] = heights.low;
        clear_[side] = larger(clear_[side], heights.clear);
      }
      if (is_stand(false)) way_below_[side] = StandingStart::of(spec).way_below(spec, side);
    }
    if (Table::on_one_palm) robots_.inertia.gain *= 2;  // the object moves with one robot
    height_ = lowest_[false];
    lifted_from_ = height_;
  }

  Recorder& recorder() { return recorder_; }
  std::vector<PerSide<double>> take_heights() { return std::move(heights_); }
  const std::vector<LiftPhase>& phases() const { return phases_; }
  // Of the pivots, as commanded [m].
  const PerSide<double>& heights() const { return height_; }
  // What each robot has moved while carrying, in the direction of travel [m].
  const PerSide<double>& travelled() const { return travelled_; }
  // Whether a nose is on the floor, or the object may touch a stand.
  bool is_low(std::size_t side) const {
    const ArmMove arm = team_.arm(side);
    return arm == ArmMove::follow || arm == ArmMove::reach || height_[side] < clear_[side];
  }
  bool follows_floor(std::size_t side) const {
    return team_.arm(side) == ArmMove::follow && !is_stand(is_ending(side));
  }

 protected:
  using Base::close, Base::metrics_, Base::rank, Base::read, Base::robots_, Base::seed_;
  using Base::spec_, Base::statistics_, Base::team_, Base::tick_;

  bool is_airborne() const { return !is_low(left) && !is_low(right); }

  // The arms hold the object already, at one height: whatever their errors are.
  void hold_at(double level) {
    for (const std::size_t side : {left, right}) carry_height_[side] = height_[side] = level;
  }
  double carry_level() const { return 0.5 * (carry_height_[left] + carry_height_[right]); }

  // The observations, where each palm is pressed [m], if anything presses it, and has this angle by
  // its own measurement. A palm counts as turned within `slack` [rad].
  PerSide<RobotObservation> observe(const PerSide<bool>& pressed, PerSide<double> places,
                                    const PerSide<double>& wrists, double slack) {
    PerSide<LiftSenses> senses{};
    for (const std::size_t side : {left, right}) {
      const double half = 0.5 * spec_.palms[side].length;
      senses[side].touches = pressed[side];
      senses[side].arm_there = arm_there_[side];
      const double share = 0.5 * Table::halves_of_way(team_.state(side), side == this->leader());
      senses[side].far_enough = travelled_[side] >= share * spec_.distance;
      const double zero = is_ending(side) ? lowest_[true][side] : lifted_from_[side];
      senses[side].steps =
          static_cast<std::uint8_t>(std::floor(larger(height_[side] - zero, 0.0) / step_height_));
      if (team_.state(side) == State::back_off) is_beneath_[side] = false;
      is_beneath_[side] |= is_stand(false) && mirrored(side, rolled_[side]) >= way_below_[side];
      senses[side].beneath = is_beneath_[side];
      senses[side].level_only = level_only_;
      // Nothing presses: no false reading either.
      felt_[side] = pressed[side] ? places[side] : 0.0;
      if (!pressed[side]) places[side] = -half;
    }
    PerSide<Sign> signs = read(places);
    PerSide<RobotObservation> sensed{};
    for (const std::size_t side : {left, right}) {
      if (!senses[side].touches) signs[side] = Sign::negative;
      const double off = wrists[side] - robots_.goal_angle[side];
      sensed[side] = {signs[side], off <= slack && off >= -slack};
    }
    team_.feel(senses);
    return sensed;
  }

  // What presses the palms counts while both are off the floor.
  void add_statistics() { statistics_.add(is_airborne() ? felt_ : PerSide<double>{}); }

  // The rise of a pivot in this tick, whose palm is at this angle at its end [m].
  double rise(std::size_t side, double angle) {
    const double floor = spec_.palms[side].lowest_pivot(sin_cos(angle));
    const double most = spec_.arms[side].rate * spec_.period;
    double goal = larger(height_[side], floor);
    arm_there_[side] = true;
    const bool ends = is_ending(side);
    const double bottom = is_stand(ends) ? larger(lowest_[ends][side], floor) : floor;
    switch (team_.arm(side)) {
      case ArmMove::follow:
        goal = is_stand(ends) ? larger(height_[side] - most, bottom) : floor;
        break;
      case ArmMove::reach:
        goal = larger(smaller(height_[side] + most, clear_[side]), floor);
        lifted_from_[side] = goal;
        break;
      case ArmMove::hold: break;
      case ArmMove::rise:
        goal = larger(smaller(height_[side] + most, carry_height_[side]), floor);
        arm_there_[side] = goal >= carry_height_[side];
        break;
      case ArmMove::sink:
        goal = larger(height_[side] - most, bottom);
        arm_there_[side] = goal <= bottom;
        break;
    }
    return goal - height_[side];
  }

  // The wheels of a robot have rolled so far towards +x in this tick [m].
  void count_travel(std::size_t side, double by) {
    rolled_[side] += by;
    if (Table::is_carrying(team_.state(side))) travelled_[side] += spec_.direction * by;
  }

  // `stands`: no palm touches the object.
  void end_tick(DropReason reason, double fraction, bool stands) {
    if (reason != DropReason::none) {
      metrics_.reason = reason;
      end(Outcome::dropped, fraction);
    } else if (ends_jobs && is_done(stands)) {
      end(Outcome::delivered, 1.0);
    } else if (tick_ + 1 >= spec_.timeout_ticks ||
               (ends_jobs && Table::has_failed(team_.state(left), team_.state(right)))) {
      end(Outcome::stalled, 1.0);
    }
    ++tick_;
    if (this->done()) close();
  }

  void note_phases(double moved) {
    for (const std::size_t side : {left, right}) {
      if (Table::alone && side != this->leader()) continue;
      const State now = team_.state(side);
      if (known_[side] && now == noted_[side]) continue;
      known_[side] = true;
      noted_[side] = now;
      if (phases_.size() < most_lift_phases)
        phases_.push_back({side, name_of(now), static_cast<int>(now), tick_, moved});
    }
  }

  void record(const PerSide<double>& heights) {
    if (records_) heights_.push_back(heights);
  }

  Recorder recorder_;
  PerSide<double> height_{};  // of the pivots, as commanded [m]

 private:
  static constexpr bool ends_jobs = LiftTeam<Inner, Table>::ends_jobs;

  void end(Outcome outcome, double fraction) {
    metrics_.outcome = outcome;
    metrics_.time_ticks = double(tick_) + fraction;
  }
  bool both(State state) const { return team_.state(left) == state && team_.state(right) == state; }
  bool is_done(bool stands) const {
    const bool low = spec_.ends_on != StandsOn::palms;
    return Table::has_ended(team_.state(left), low) && Table::has_ended(team_.state(right), low) &&
           (stands || !low);
  }

  bool is_stand(bool ends) const {
    return (ends ? spec_.ends_on : spec_.begins_on) == StandsOn::stand;
  }
  bool is_ending(std::size_t side) const { return Table::ending.has(team_.state(side)); }

  bool records_;
  double step_height_;              // of the table's steps [m]
  bool level_only_;                 // see LiftSenses
  PerSide<double> floor_{};         // the pivot of a steep palm on the floor [m]
  PerSide<double> lowest_[2]{};     // to which an arm sinks at either end of the job [m]
  PerSide<double> clear_{};         // above it, the object touches no stand [m]
  PerSide<double> lifted_from_{};   // where each palm touched the object [m]
  PerSide<double> way_below_{};     // until a palm is below an object on a stand [m]
  PerSide<double> rolled_{};        // since the start, towards +x [m]
  PerSide<bool> is_beneath_{};      // see LiftSenses
  PerSide<double> carry_height_{};  // at which each arm stops rising [m]
  PerSide<double> travelled_{};     // while carrying, in the direction of travel [m]
  PerSide<double> felt_{};          // where each palm is pressed; 0: nowhere [m]
  PerSide<bool> arm_there_{};
  PerSide<State> noted_{};
  PerSide<bool> known_{};
  std::vector<LiftPhase> phases_;
  std::vector<PerSide<double>> heights_;  // of the pivots in each row [m]
};

}  // namespace palmbots
