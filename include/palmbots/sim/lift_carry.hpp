// SPDX-License-Identifier: Apache-2.0
// A job that begins or ends on the floor, in the exact world: robots, radio and controllers as in any
// carry (sim/robot_pair.hpp), with arms beside wheels and wrists, and the floor in the world.
//
// ARMS. An arm that follows the floor is compliant: the nose rests on the floor, however fast the palm
// turns. Otherwise the height of the pivot changes at the arm's rate at most. An arm that rises stops
// at its height with an error that is constant in a job.
//
// WHEELS. As long as a nose is on the floor, a motion that mechanics do not allow stops the wheels for
// the rest of the tick, as wheels that stall. No robot notices that. In the air it ends the job, as in
// a carry.
//
// SWITCHES. A palm's switches feel what lies on its top side, and what presses the heel as the outer
// end. They do not feel what touches the nose.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "palmbots/sim/lift_team.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/recorder.hpp"
#include "palmbots/sim/robot_pair.hpp"
#include "palmbots/world/small_fall.hpp"

namespace palmbots {

// Distance between the object and the noses at the start [m].
inline constexpr double approach_distance = 0.03;

// How far a contact vertex may fall, for example off a nose, before the job ends [m].
inline constexpr double most_fall = 0.003;

// A phase of one robot, which lasts until its next one [ticks].
struct LiftPhase {
  std::size_t side;
  Lifting::State state;
  std::uint32_t start;
};
inline constexpr std::size_t most_lift_phases = 128;

template <class Inner>
class LiftCarry : public RobotPair<double, LiftTeam<Inner>> {
  using Base = RobotPair<double, LiftTeam<Inner>>;
  using State = Lifting::State;

 public:
  LiftCarry(const Spec& spec, std::uint64_t seed, Inner inner, bool records)
      : Base(spec, seed, LiftTeam<Inner>(spec, seed, std::move(inner))),
        recorder_(records),
        records_(records) {
    Model<double> model = model_of<double>(spec);
    model.safe_reach = -1;  // that of level pivots
    model.surroundings = {true, spec.floor_friction};
    world_ = World<double>(model, configuration_of(spec, model));
    const Words words = draw(seed, 0, Stream::arm_height);
    for (const std::size_t side : {left, right}) {
      constexpr double whole = 4294967296.0;
      const double share = 2 * ((words[rank(side)] + 0.5) / whole) - 1;
      carry_height_[side] = spec.arms[side].carry_height + share * spec.arms[side].height_error;
    }
    spec.begins_on == StandsOn::floor ? stand() : hold();
    first_ = world_.pose().at;
    world_.set_on_both(spec.begins_on != StandsOn::floor);
    note_phases();
  }

  void run() {
    metrics_.reason = spec_.begins_on == StandsOn::floor ? DropReason::none : world_.check();
    while (!this->done()) {
      recorder_.make_room();
      tick();
    }
    recorder_.make_room();
    recorder_.end(*this);
    record();
  }

  const World<double>& world() const { return world_; }
  double object_sine() const { return world_.pose().sin; }
  TraceRecorder& recorder() { return recorder_; }
  std::vector<PerSide<double>> take_heights() { return std::move(heights_); }
  const std::vector<LiftPhase>& phases() const { return phases_; }
  // Displacement of the COM since the start [m].
  double moved() const { return world_.pose().at.x - first_.x; }
  std::uint32_t stalled_ticks() const { return stalled_; }

 private:
  using Base::change_biases, Base::collect, Base::drop, Base::notice, Base::rank, Base::read;
  using Base::close, Base::metrics_, Base::robots_, Base::seed_, Base::spec_, Base::statistics_;
  using Base::team_, Base::think, Base::tick_;

  double lowest(std::size_t side, double angle) const {
    return spec_.palms[side].lowest_pivot(sin_cos(angle));
  }

  // The object stands on the floor, with its COM at 0, and the noses are beside it.
  void stand() {
    PerSide<double> end{};
    const PerSide<double> radius = contact_radii(spec_.outline);
    for (const Vec& point : silhouette(spec_)) {
      end[left] = larger(end[left], -(point.x - spec_.com_left));
      end[right] = larger(end[right], point.x - spec_.com_left);
    }
    PerSide<Vec> pivots{};
    PerSide<double> angles{};
    for (const std::size_t side : {left, right}) {
      const PalmSpec& palm = spec_.palms[side];
      const SinCos<double> at = sin_cos(palm.steep);
      angles[side] = palm.steep;
      height_[side] = palm.lowest_pivot(at);
      const double arm = 0.5 * palm.length * at.cos + palm.offset * at.sin;
      pivots[side] = {outward<double>(side) * (end[side] + approach_distance + arm), height_[side]};
    }
    const double high = spec_.com_height + larger(radius[left], radius[right]);
    world_.put(pivots, angles, Pose::of({0.0, high}, 0.0));
  }

  // Both palms hold the object at the height at which they carry.
  void hold() {
    const Vec at = world_.pose().at;
    PerSide<Vec> pivots{};
    PerSide<double> angles{};
    const double level = 0.5 * (carry_height_[left] + carry_height_[right]);
    for (const std::size_t side : {left, right}) {
      carry_height_[side] = level;  // the object is on the palms already: whatever the error is
      height_[side] = level;
      angles[side] = spec_.palms[side].steep;
      pivots[side] = {world_.pivot(side).x - at.x, level};
    }
    world_.put(pivots, angles,
               Pose::of({0.0, at.y - world_.pivot(left).y + level}, world_.pose().angle));
  }

  // What closes switches of a palm: where on it, if anything does [m].
  bool feels(std::size_t side, double& at) const {
    const Regime& regime = world_.regime();
    for (std::size_t i = 0; i < regime.count; ++i) {
      const FeaturePair pair = regime.active[i].pair;
      const Surface& surface = world_.shapes().surfaces.at[pair.surface];
      if (static_cast<std::size_t>(surface.carrier) != side || surface.tip) continue;
      const bool is_heel = surface.normal.x < -0.5 && surface.at.x > 0;
      const double half = 0.5 * spec_.palms[side].length;
      if (surface.normal.y > 0.5 || is_heel) {
        at = is_heel ? half : clamp(world_.configuration().contacts[side], -half, half);
        return true;
      }
    }
    return false;
  }

  bool is_low(std::size_t side) const { return team_.arm(side) == ArmMove::follow; }
  bool is_airborne() const { return !is_low(left) && !is_low(right); }

  PerSide<RobotObservation> sense() {
    PerSide<double> places{};
    PerSide<LiftSenses> senses{};
    for (const std::size_t side : {left, right}) {
      places[side] = -0.5 * spec_.palms[side].length;
      senses[side].touches = feels(side, places[side]);
      senses[side].arm_there = arm_there_[side];
      senses[side].far_enough = travelled_[side] >= spec_.distance;
      // Nothing presses: no false reading either.
      felt_[side] = senses[side].touches ? places[side] : 0.0;
    }
    PerSide<Sign> signs = read(places);
    PerSide<RobotObservation> sensed{};
    for (const std::size_t side : {left, right}) {
      if (!senses[side].touches) signs[side] = Sign::negative;
      sensed[side] = {signs[side],
                      world_.configuration().palms[side].angle == robots_.goal_angle[side]};
    }
    team_.feel(senses);
    return sensed;
  }

  void tick() {
    if (metrics_.reason != DropReason::none) {
      drop();
      return;
    }
    const PerSide<RobotObservation> sensed = sense();
    if (notice(sensed)) think([&](const SentMessage& p) { recorder_.message(p); });
    note_phases();
    if (tick_ % block_ticks == 0) collect();
    const bool airborne = is_airborne();
    statistics_.add(airborne ? felt_ : PerSide<double>{});
    change_biases();
    this->let_palms_fall();
    const Actuation<double> act = actuate(robots_, world_.configuration().palms, noise());
    PerSide<Vec> by{};
    for (const std::size_t side : {left, right})
      by[side] = {robots_.speeds[side] * spec_.period, rise(side, act.angles[side])};
    recorder_.before(*this, sensed);
    record();
    world_.set_on_both(airborne);
    const Advance<double>& step = world_.advance(by, act.angles, act.push);
    const bool stalls = !airborne && step.reason == DropReason::jammed;
    if (stalls) ++stalled_;
    for (const std::size_t side : {left, right}) {
      height_[side] += step.fraction * by[side].y;
      if (team_.state(side) == State::carry)
        travelled_[side] += spec_.direction * step.fraction * by[side].x;
    }
    robots_.midpoint += step.fraction * act.travel;
    recorder_.after(*this);
    const bool goes_on =
        step.reason == DropReason::none || stalls || (!airborne && falls_a_little());
    end_tick(goes_on ? DropReason::none : step.reason, step.fraction);
  }

  // Lets an object that its contacts no longer hold fall to where it rests while the palms stand
  // still. False, and nothing changes, if it has farther to fall.
  bool falls_a_little() {
    PerSide<Vec> pivots{};
    PerSide<double> angles{};
    Travel still{};
    for (const std::size_t side : {left, right}) {
      pivots[side] = world_.pivot(side);
      angles[side] = world_.configuration().palms[side].angle;
      still.palms[side] = {pivots[side], {}, angles[side], 0.0, angles[side]};
    }
    const ContactProblem problem{world_.shapes(), spec_.slope, 0.0, false};
    Pose rests = world_.pose();
    if (!SmallFall(problem, still.frames(0.0), most_fall).run(rests)) return false;
    world_.put(pivots, angles, rests);
    return true;
  }

  // The rise of a pivot in this tick, whose palm is at this angle at its end [m].
  double rise(std::size_t side, double angle) {
    const double floor = lowest(side, angle);
    const double most = spec_.arms[side].rate * spec_.period;
    double goal = larger(height_[side], floor);
    arm_there_[side] = true;
    switch (team_.arm(side)) {
      case ArmMove::follow: goal = floor; break;
      case ArmMove::hold: break;
      case ArmMove::rise:
        goal = larger(smaller(height_[side] + most, carry_height_[side]), floor);
        arm_there_[side] = goal >= carry_height_[side];
        break;
      case ArmMove::sink:
        goal = larger(height_[side] - most, floor);
        arm_there_[side] = goal <= floor;
        break;
    }
    return goal - height_[side];
  }

  void end_tick(DropReason reason, double fraction) {
    if (reason != DropReason::none) {
      metrics_.reason = reason;
      end(Outcome::dropped, fraction);
    } else if (is_done()) {
      end(Outcome::delivered, 1.0);
    } else if (tick_ + 1 >= spec_.timeout_ticks || both(State::failed)) {
      end(Outcome::stalled, 1.0);
    }
    ++tick_;
    if (this->done()) close();
  }
  void end(Outcome outcome, double fraction) {
    metrics_.outcome = outcome;
    metrics_.time_ticks = double(tick_) + fraction;
  }

  bool both(State state) const { return team_.state(left) == state && team_.state(right) == state; }
  bool is_done() const {
    if (spec_.ends_on == StandsOn::floor) return both(State::done) && stands();
    return both(State::arrived) || both(State::lower);
  }
  // Whether the object is on the floor alone.
  bool stands() const { return !world_.is_touched(left) && !world_.is_touched(right); }

  void note_phases() {
    for (const std::size_t side : {left, right}) {
      const State now = team_.state(side);
      if (known_[side] && now == noted_[side]) continue;
      known_[side] = true;
      noted_[side] = now;
      if (phases_.size() < most_lift_phases) phases_.push_back({side, now, tick_});
    }
  }

  void record() {
    if (records_) heights_.push_back(height_);
  }

  // The words of a tick as `Carry` draws them.
  PerSide<double> noise() const {
    const Words words = draw(seed_, tick_ - tick_ % 2, Stream::noise);
    const std::size_t first = 2 * (tick_ % 2);
    return {unit_noise<double>(words[first + rank(left)]),
            unit_noise<double>(words[first + rank(right)])};
  }

  TraceRecorder recorder_;
  bool records_;
  World<double> world_;
  PerSide<double> height_{};        // of the pivots [m]
  PerSide<double> carry_height_{};  // at which each arm stops rising [m]
  PerSide<double> travelled_{};     // while carrying, in the direction of travel [m]
  PerSide<double> felt_{};          // where each palm is pressed; 0: nowhere [m]
  PerSide<bool> arm_there_{};
  PerSide<State> noted_{};
  PerSide<bool> known_{};
  std::vector<LiftPhase> phases_;
  std::vector<PerSide<double>> heights_;  // of the pivots in each row [m]
  Vec first_{};                           // the COM at the start [m]
  std::uint32_t stalled_ = 0;
};

}  // namespace palmbots
