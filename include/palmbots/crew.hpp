// Both robots of a carry without its world: sensors, controllers and radio, wheels and wrists, metrics and
// trace, for a world that is moved by somebody else (a dynamics engine, say).
//
// One tick in two calls. `command` reads the sensors where the world was last seen, lets the team decide and
// says what wheels and wrists do until the next tick; `observe` takes in what became of it. In between the
// world moves. Driven with the quasistatic world it is `Carry` to the last bit, which is a test; what Carry
// does besides (bumps that shift contacts) belongs to that world and is left out.
#pragma once

#include <cstdint>
#include <utility>

#include "palmbots/bearers.hpp"
#include "palmbots/recorder.hpp"

namespace palmbots {

// What is seen of a world at the end of a tick.
struct Sight {
  PerSide<double> contacts{};           // p of the contact vertices [m]
  PerSide<double> lift{};               // of the contact vertices above their palms [m]
  PerSide<double> touched{};            // where the palms are pressed: p of that [m]
  PerSide<bool> pressed{{true, true}};  // hard enough for a switch
  PerSide<double> palms{};              // angles of the palms in the world [rad]
  PerSide<double> wrists{};             // angles as the robots measure them [rad]
  double separation = 0;                // of the pivots [m]
  double midpoint = 0;                  // of the pivots, from where it started [m]
  double rise = 0;                      // of the right contact vertex over the left one [m]
  PerSide<int> motion{};  // over the tick: contacts slide down −1, stick 0, slide up +1
  End end = End::none;
  double fraction = 1;  // of the tick at which it ended
};

// The sight as the recorder takes it: as it takes a world.
class SeenWorld {
 public:
  void see(const Sight& sight) {
    for (const std::size_t side : {left, right}) {
      stance_.contacts[side] = sight.contacts[side];
      stance_.lift[side] = sight.lift[side];
      stance_.palms[side].angle = sight.palms[side];
      last_.motion[side] = static_cast<Slide>(sight.motion[side]);
    }
    stance_.separation = sight.separation;
    span_.dy = sight.rise;
  }
  const Stance<double>& stance() const { return stance_; }
  const Span<double>& span() const { return span_; }
  const Advance<double>& last() const { return last_; }

 private:
  Stance<double> stance_{};
  Span<double> span_{};
  Advance<double> last_{};
};

template <class Team>
class Crew : public Bearers<double, Team> {
  using Base = Bearers<double, Team>;

 public:
  // `slack`: a palm has turned where its wrist is so near to the angle last commanded [rad].
  Crew(const Spec& spec, std::uint64_t seed, Team team, double slack, const Sight& first)
      : Base(spec, seed, std::move(team)), slack_(slack), sight_(first) {
    for (const std::size_t side : {left, right}) {
      set_points_[side] = PalmAngle<double>::at(spec.palms[side].steep);
    }
    metrics_.end = first.end;
    world_.see(first);
    robots_.midpoint = first.midpoint;
    if (metrics_.end == End::none) return;
    drop();
    finish();
  }

  // What the robots sense where the world was last seen.
  PerSide<Sensed> sense() const {
    PerSide<double> touched{};
    for (const std::size_t side : {left, right}) {
      // Where nothing presses hard enough no switch is closed, which reads as 0.
      touched[side] = sight_.pressed[side] ? sight_.touched[side] : 0.0;
    }
    const PerSide<Sign> signs = read(touched);
    PerSide<Sensed> sensed{};
    for (const std::size_t side : {left, right}) {
      const double off = sight_.wrists[side] - robots_.goal_angle[side];
      sensed[side] = {signs[side], off <= slack_ && off >= -slack_};
    }
    return sensed;
  }

  // What wheels and wrists do until the next tick.
  Actuation<double> command() {
    recorder_.make_room();
    const PerSide<Sensed> sensed = sense();
    if (notice(sensed)) think([&](const Posted& p) { recorder_.message(p); });
    if (tick_ % block_ticks == 0) collect();
    const PerSide<double> random = noise();
    tally_.add(sight_.touched);
    const Actuation<double> act = actuate(robots_, set_points_, random);
    for (const std::size_t side : {left, right}) set_points_[side].angle = act.angles[side];
    recorder_.before(*this, sensed);
    return act;
  }

  // What became of it.
  void observe(const Sight& sight) {
    const double before = sight_.midpoint;
    sight_ = sight;
    world_.see(sight);
    robots_.midpoint = sight.midpoint;
    recorder_.after(*this);
    finish_tick(sight.end, sight.fraction, before);
    if (this->done()) finish();
  }

  TraceRecorder& recorder() { return recorder_; }
  const SeenWorld& world() const { return world_; }

 private:
  using Base::collect, Base::drop, Base::finish_tick, Base::notice, Base::rank, Base::read;
  using Base::metrics_, Base::robots_, Base::seed_, Base::tally_, Base::think, Base::tick_;

  // The words of a tick as `Carry` draws them: four serve two robots for two ticks.
  PerSide<double> noise() const {
    const Words words = draw(seed_, tick_ - tick_ % 2, Stream::noise);
    const std::size_t first = 2 * (tick_ % 2);
    return {unit_noise<double>(words[first + rank(left)]),
            unit_noise<double>(words[first + rank(right)])};
  }

  void finish() {
    recorder_.make_room();
    recorder_.end(*this);
  }

  double slack_;
  TraceRecorder recorder_;
  Sight sight_;
  SeenWorld world_;
  PerSide<PalmAngle<double>> set_points_{};  // of the wrists' motors
};

}  // namespace palmbots
