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

#include "palmbots/metrics.hpp"
#include "palmbots/recorder.hpp"
#include "palmbots/setup.hpp"
#include "palmbots/team.hpp"

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
class Crew {
 public:
  // `slack`: a palm has turned where its wrist is so near to the angle last commanded [rad].
  Crew(const Spec& spec, std::uint64_t seed, Team team, double slack, const Sight& first)
      : spec_(spec),
        seed_(seed),
        slack_(slack),
        faults_(Faults::of(spec, seed)),
        team_(std::move(team)),
        sight_(first) {
    robots_ = robots_of<double>(spec, seed);
    for (const std::size_t side : {left, right}) {
      full_move_[side] = spec.robots[side].correction * (Team::half_moves ? 0.5 : 1.0);
      set_points_[side] = PalmAngle<double>::at(spec.palms[side].steep);
    }
    tactile_ = Tactile<double>(spec.zones, spec.zone_count, spec.false_rate);
    metrics_.settle_ticks = settle_ticks();
    metrics_.end = first.end;
    world_.see(first);
    robots_.midpoint = first.midpoint;
    obey(commands_);
    if (metrics_.end != End::none) {
      metrics_.outcome = Result::dropped;
      metrics_.close(0);
      finish();
    }
  }

  bool done() const { return metrics_.outcome != Result::running; }

  // What the robots sense where the world was last seen.
  PerSide<Sensed> sense() const {
    PerSide<Sensed> sensed{};
    Words words{};
    if (tactile_.has_false_readings()) words = draw(seed_, tick_, Stream::tactile);
    for (const std::size_t side : {left, right}) {
      const std::size_t first = 2 * lane(side);
      // Where nothing presses hard enough no switch is closed, which reads as 0.
      const double p = sight_.pressed[side] ? sight_.touched[side] : 0.0;
      sensed[side].sign = tactile_.has_false_readings()
                              ? tactile_.sign(p, words[first], words[first + 1])
                              : tactile_.sign(p);
      if (faults_.any()) sensed[side].sign = faults_.reading(tick_, side, sensed[side].sign);
      const double off = sight_.wrists[side] - robots_.goal_angle[side];
      sensed[side].turned = off <= slack_ && off >= -slack_;
    }
    return sensed;
  }

  // What wheels and wrists do until the next tick.
  Actuation<double> command() {
    recorder_.make_room();
    const PerSide<Sensed> sensed = sense();
    if (sensed != sensed_ || tick_ >= wake_) think(sensed);
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
    const double travel = sight.midpoint - sight_.midpoint;
    sight_ = sight;
    world_.see(sight);
    robots_.midpoint = sight.midpoint;
    recorder_.after(*this);
    const double gone = sight.midpoint * spec_.direction;
    if (sight.end != End::none) {
      metrics_.end = sight.end;
      metrics_.outcome = Result::dropped;
      metrics_.time_ticks = tick_ + sight.fraction;
    } else if (gone >= spec_.distance) {
      metrics_.outcome = Result::delivered;
      const double over = gone - spec_.distance;
      const double way = travel * spec_.direction;
      metrics_.time_ticks = tick_ + (way > 0 ? 1 - over / way : 1);
    } else if (tick_ + 1 >= spec_.timeout_ticks) {
      metrics_.outcome = Result::stalled;
      metrics_.time_ticks = tick_ + 1.0;
    }
    ++tick_;
    if (!done()) return;
    collect();
    close_team(team_, tick_);
    metrics_.close(tick_);
    finish();
  }

  std::uint32_t ticks() const { return tick_; }
  const Spec& spec() const { return spec_; }
  const Team& team() const { return team_; }
  const Metrics& metrics() const { return metrics_; }
  TraceRecorder& recorder() { return recorder_; }
  const SeenWorld& world() const { return world_; }
  double midpoint() const { return robots_.midpoint; }
  const PerSide<double>& speeds() const { return robots_.speeds; }
  const PerSide<Command>& commands() const { return commands_; }
  double wanted(std::size_t side, Command command) const {
    const double away = outward<double>(side) * full_move_[side];
    const double move =
        command.move == Move::away ? away : (command.move == Move::closer ? -away : 0.0);
    return (command.rest ? 0.0 : spec_.direction * spec_.robots[side].speed) + move;
  }

 private:
  std::size_t lane(std::size_t side) const { return side == leader_of(spec_) ? 0 : 1; }

  void think(const PerSide<Sensed>& sensed) {
    sensed_ = sensed;
    const PerSide<Command> commands =
        team_.step(tick_, sensed, [&](const Posted& p) { recorder_.message(p); });
    wake_ = wake_of(team_, tick_);
    if (commands != commands_) obey(commands);
    metrics_.note(tick_, team_);
  }

  void obey(const PerSide<Command>& commands) {
    commands_ = commands;
    for (const std::size_t side : {left, right}) {
      robots_.goal_angle[side] = robots_.wrists[side].target(commands[side].palm);
      robots_.goal_speed[side] =
          robots_.wheels[side].within_limit(robots_.travel_sense * wanted(side, commands[side]));
      robots_.brakes[side] = commands[side].rest && robots_.goal_speed[side] == 0 ? 1.0 : 0.0;
    }
  }

  // The words of a tick as `Carry` draws them: four serve two robots for two ticks.
  PerSide<double> noise() const {
    const Words words = draw(seed_, tick_ - tick_ % 2, Stream::noise);
    const std::size_t first = 2 * (tick_ % 2);
    return {unit_noise<double>(words[first + lane(left)]),
            unit_noise<double>(words[first + lane(right)])};
  }

  // As in Carry.
  std::uint32_t settle_ticks() const {
    double turn = 0;
    for (const PalmSpec& palm : spec_.palms) {
      const double own = (palm.steep - palm.shallow) / palm.rate;
      turn = own > turn ? own : turn;
    }
    const double time = 2 * (turn + 2 * (spec_.latency + spec_.jitter));
    return static_cast<std::uint32_t>(time / spec_.period) + 10;
  }

  void collect() { metrics_.collect(tally_, tick_ - metrics_.samples); }

  void finish() {
    recorder_.make_room();
    recorder_.end(*this);
  }

  Spec spec_;
  std::uint64_t seed_;
  double slack_;
  Faults faults_;
  Team team_;
  TraceRecorder recorder_;
  Sight sight_;
  SeenWorld world_;
  Robots<double> robots_{};
  PerSide<PalmAngle<double>> set_points_{};  // of the wrists' motors
  Tactile<double> tactile_;
  PerSide<double> full_move_{};
  PerSide<Sensed> sensed_{};
  std::uint32_t wake_ = 0;
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Tally<double> tally_{};
  std::uint32_t tick_ = 0;
  Metrics metrics_;
};

}  // namespace palmbots
