// SPDX-License-Identifier: Apache-2.0
// A job that begins or ends on the floor or on a stand, in the exact world: robots with arms
// (sim/lift_robots.hpp), and the floor in the world.
//
// WHEELS. Wheels that stall (mechanics/carry_ends.hpp) stand for the rest of the tick. No robot
// notices that. The odometry of wheels that spin counts on. Wheels also stall when the nose of a palm is
// at a wall, or at the nose of its partner while one hands the object to the other.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "palmbots/sim/lift_robots.hpp"

namespace palmbots {

template <class Inner, class Recorder = TraceRecorder, class Table = Lifting>
class LiftCarry : public LiftRobots<Inner, Recorder, Table> {
  using Base = LiftRobots<Inner, Recorder, Table>;

 public:
  LiftCarry(const Spec& spec, std::uint64_t seed, Inner inner, bool records)
      : Base(spec, seed, std::move(inner), records) {
    Model<double> model = model_of<double>(spec);
    model.safe_reach = -1;  // that of level pivots
    model.surroundings = surroundings_of(spec);
    world_ = world_of(spec, model, seed);
    is_given() ? hold() : stand();
    first_ = world_.pose().at;
    set_phase(is_given());
    note_phases(0.0);
  }

  void run() {
    begin();
    while (!this->done()) {
      recorder_.make_room();
      tick();
    }
    recorder_.make_room();
    recorder_.end(*this);
    this->record(height_);
  }

  // A job that is commanded from outside calls `begin` once, and then `tick`.
  void begin() { metrics_.reason = is_given() ? world_.check() : DropReason::none; }

  const World<double>& world() const { return world_; }
  const std::vector<LiftFall>& falls() const { return falls_; }
  // Displacement of the COM since the start [m].
  double moved() const { return world_.pose().at.x - first_.x; }

  // The object is on the floor alone.
  bool stands() const { return !world_.is_touched(left) && !world_.is_touched(right); }

  PerSide<RobotObservation> sense() {
    PerSide<double> places{}, wrists{};
    PerSide<bool> pressed{};
    for (const std::size_t side : {left, right}) {
      pressed[side] = feels(side, places[side]);
      wrists[side] = world_.configuration().palms[side].angle;
    }
    return this->observe(pressed, places, wrists, 0.0);
  }

  void tick() {
    if (metrics_.reason != DropReason::none) {
      drop();
      return;
    }
    const PerSide<RobotObservation> sensed = sense();
    if (notice(sensed)) think([&](const SentMessage& p) { recorder_.message(p); });
    note_phases(moved());
    if (tick_ % block_ticks == 0) collect();
    this->add_statistics();
    change_biases();
    this->let_palms_fall();
    const Actuation<double> act = actuate(robots_, world_.configuration().palms, this->noise());
    PerSide<Vec> by{};
    for (const std::size_t side : {left, right})
      by[side] = {before_walls(side, robots_.speeds[side] * spec_.period),
                  this->rise(side, act.angles[side])};
    recorder_.before(*this, sensed);
    this->record(height_);
    set_phase(is_airborne());
    const bool is_felt = Table::moves_object(this->team_.state(left), this->team_.state(right));
    const Advance<double>& step = world_.advance(by, act.angles, is_felt ? act.push : 0.0);
    for (const std::size_t side : {left, right}) {
      height_[side] += step.fraction * by[side].y;
      const double way = step.fraction * by[side].x + step.lag[side];
      this->count_travel(side, spec_.robots[side].spins() ? by[side].x : way);
    }
    robots_.midpoint += step.fraction * act.travel + metrics_.note_stalls(step);
    recorder_.after(*this);
    if (world_.fall()) falls_.push_back({tick_, *world_.fall()});
    this->end_tick(step.reason, step.fraction, stands());
  }

 private:
  using Base::change_biases, Base::collect, Base::drop, Base::height_, Base::is_airborne;
  using Base::metrics_, Base::note_phases, Base::notice, Base::recorder_, Base::robots_,
      Base::spec_;
  using Base::think, Base::tick_;

  // Whether both palms hold the object from the start.
  bool is_given() const { return spec_.begins_on == StandsOn::palms; }

  // The object stands on the floor or on a stand, and the noses are beside it.
  void stand() {
    const StandingStart start = StandingStart::of(spec_);
    world_.put(start.pivots, {first_angle(spec_, left), first_angle(spec_, right)},
               Pose::of(start.com, 0.0));
  }

  // Both palms hold the object at the height at which they carry.
  void hold() {
    const Vec at = world_.pose().at;
    PerSide<Vec> pivots{};
    PerSide<double> angles{};
    const double level = this->carry_level();
    this->hold_at(level);
    for (const std::size_t side : {left, right}) {
      angles[side] = spec_.palms[side].steep;
      pivots[side] = {world_.pivot(side).x - at.x, level};
    }
    world_.put(pivots, angles,
               Pose::of({0.0, at.y - world_.pivot(left).y + level}, world_.pose().angle));
  }

  // What closes switches of a palm: where on it, if anything does [m].
  bool feels(std::size_t side, double& at) const {
    for (const ActivePair& active : world_.regime().active) {
      const Surface& surface = world_.shapes().surfaces[active.pair.surface];
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

  // One palm alone may hold an object on it, as on the floor.
  void set_phase(bool airborne) {
    const bool by_both = airborne && !Table::on_one_palm;
    world_.set_phase(by_both ? CarryPhase::carried : CarryPhase::low, spec_.fall);
  }

  // The part of the way of a pivot along the floor that leaves its nose in front of the walls,
  // and of its partner [m].
  double before_walls(std::size_t side, double way) {
    if (!this->is_low(side)) return way;
    const double out = outward<double>(side);
    const auto before = [&](double wall) {
      const double room = out * (nose(side) - wall);
      if (-out * way <= room) return;
      const double left_over = -out * larger(room, 0.0);
      metrics_.stalled_ticks[side] += 1 - left_over / way;
      robots_.midpoint += 0.5 * (left_over - way);
      way = left_over;
    };
    for (std::size_t i = 0; i < spec_.wall_count; ++i) {
      if (spec_.walls[i].at * out <= 0) before(spec_.walls[i].at);
    }
    if (hands_over(spec_) && this->is_low(other(side))) before(nose(other(side)));
    return way;
  }
  // Where the inner end of a palm is along the floor [m].
  double nose(std::size_t side) const {
    const PalmAngle<double>& at = world_.configuration().palms[side];
    const PalmSpec& palm = spec_.palms[side];
    const double arm = 0.5 * palm.length * at.cos + palm.offset * at.sin;
    return world_.pivot(side).x - outward<double>(side) * arm;
  }

  World<double> world_;
  std::vector<LiftFall> falls_;
  Vec first_{};  // the COM at the start [m]
};

}  // namespace palmbots
