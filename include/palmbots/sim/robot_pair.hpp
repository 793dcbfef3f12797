// SPDX-License-Identifier: Apache-2.0
// The two robots and their shared radio, without a contact model: sensing, decisions, actuation,
// termination and metrics.
//
// A `Carry` drives them with the quasistatic world; a `CoSimulation` lets an external simulator do
// so.
#pragma once

#include <cstdint>
#include <utility>

#include "palmbots/sim/build.hpp"
#include "palmbots/sim/faults.hpp"
#include "palmbots/sim/metrics.hpp"
#include "palmbots/sim/pushes.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/speed_errors.hpp"
#include "palmbots/sim/team.hpp"

namespace palmbots {

// Base of `Carry` and `CoSimulation`. Real is the precision of the robots' motion.
template <class Real, Team TheTeam>
class RobotPair {
 public:
  RobotPair(const Spec& spec, std::uint64_t seed, TheTeam team)
      : spec_(spec), seed_(seed), faults_(Faults::of(spec, seed)), team_(std::move(team)) {
    robots_ = robots_of<Real>(spec, seed);
    for (const std::size_t side : {left, right}) {
      full_move_[side] = Real(spec.robots[side].correction * (team_.half_moves ? 0.5 : 1.0));
      nominal_[side] = Real(spec.direction * spec.robots[side].speed);
    }
    tactile_ = tactile_of<Real>(spec);
    metrics_.settle_ticks = settle_ticks();
    obey(commands_);
  }

  bool done() const { return metrics_.outcome != Outcome::running; }
  std::uint32_t ticks() const { return tick_; }
  const Spec& spec() const { return spec_; }
  const TheTeam& team() const { return team_; }
  const Metrics& metrics() const { return metrics_; }
  Real midpoint() const { return robots_.midpoint; }
  const PerSide<Real>& speeds() const { return robots_.speeds; }
  const PerSide<Command>& commands() const { return commands_; }

  // The speed that a command requests of a robot, in the world's x direction [m/s].
  Real wanted(std::size_t side, Command command) const {
    const Real away = outward<Real>(side) * full_move_[side];
    const Real move =
        command.move == Move::away ? away : (command.move == Move::closer ? -away : Real(0));
    return (command.stop ? Real(0) : nominal_[side]) + move;
  }

 protected:
  // The leading robot has the first word of a tick, on either side, so that the mirrored carry
  // draws the mirrored numbers.
  std::size_t leader() const { return leader_of(spec_); }
  std::size_t rank(std::size_t side) const { return side == leader() ? 0 : 1; }

  // The readings of the sensors in this tick, with the palms touched at these coordinates.
  PerSide<Sign> read(const PerSide<Real>& touched) const {
    PerSide<Sign> signs{};
    Words words{};
    if (tactile_.has_false_readings()) words = draw(seed_, tick_, Stream::tactile);
    for (const std::size_t side : {left, right}) {
      const std::size_t first = 2 * rank(side);
      signs[side] = tactile_.has_false_readings()
                        ? tactile_.sign(touched[side], words[first], words[first + 1])
                        : tactile_.sign(touched[side]);
      if (faults_.any()) [[unlikely]]
        signs[side] = faults_.reading(tick_, side, signs[side]);
    }
    return signs;
  }

  // The set point of the wheel speed, times the gain, along the direction of travel [m/s].
  Real goal_speed(std::size_t side, Command command) const {
    const Wheels<Real>& wheels = robots_.wheels[side];
    return wheels.gain * wheels.within_limit(robots_.travel_sense * wanted(side, command));
  }

  // True if the readings depend only on the zones in which the palms are touched.
  bool reads_truly() const {
    return !tactile_.has_false_readings() && !faults_.corrupts_readings();
  }

  // Takes in the observations. Returns true if the team has to be stepped. Otherwise this tick is
  // like the one before: the observations are the same, and the team does not act on its own.
  [[gnu::always_inline]] bool notice(const PerSide<RobotObservation>& sensed) {
    bool is_news = tick_ >= next_decision_tick_;
    // Copies field by field: a copy of the whole struct would stall on fields that have only just
    // been written.
    on_both_sides([&](std::size_t side) {
      is_news |= !(sensed[side] == sensed_[side]);
      sensed_[side].sign = sensed[side].sign;
      sensed_[side].palm_at_target = sensed[side].palm_at_target;
    });
    return is_news;
  }

  // Steps the team and executes its commands; log(SentMessage) is called for each message. Returns
  // true if the commands are new.
  template <class Log>
  bool think(Log&& log) {
    const PerSide<Command>& commands = team_.step(tick_, sensed_, log);
    next_decision_tick_ = team_.next_decision_tick(tick_);
    const bool are_new = commands != commands_;
    if (are_new) [[unlikely]]
      obey(commands);
    metrics_.note(tick_, team_);
    return are_new;
  }

  // The calibration error of both robots' wheels in a tick, with what pushes them and the white part
  // of the noise, or with what was recorded, along the direction of travel [m/s]. Ticks must not
  // decrease.
  PerSide<Real> biases(std::uint32_t tick) {
    const PerSide<double> white = SpeedErrors::white(spec_, seed_, tick);
    const PerSide<double> recorded = SpeedErrors::recorded(spec_, seed_, tick, replays_);
    PerSide<Real> found{};
    for (const std::size_t side : {left, right}) {
      const Real added = outward<Real>(side) * Real(Pushes::speed(spec_, tick, side));
      found[side] = Real(SpeedErrors::modelled(spec_.robots[side]).bias) +
                    robots_.travel_sense * added + Real(white[side] + recorded[side]);
    }
    return found;
  }

  // The random numbers of the wheels' noise in this tick, where blocks of ticks do not draw them.
  PerSide<double> noise() const { return SpeedErrors::noise(spec_, seed_, tick_); }

  // To be called in every tick, before the wheels move.
  [[gnu::always_inline]] void change_biases() {
    if (tick_ < next_bias_change_) [[likely]]
      return;
    const PerSide<Real> now = biases(tick_);
    for (const std::size_t side : {left, right}) robots_.wheels[side].bias = now[side];
    next_bias_change_ = next_bias_change(tick_ + 1);
  }

  // Without power a servo lets its palm fall. To be called in each tick before the palms turn.
  void let_palms_fall() {
    if (!faults_.may_go_limp()) [[likely]]
      return;
    for (const std::size_t side : {left, right}) {
      const auto angle = faults_.limp_angle(tick_, side);
      robots_.goal_angle[side] =
          angle ? Real(*angle) : robots_.wrists[side].target(commands_[side].palm);
    }
  }

  void collect() { metrics_.collect(statistics_, tick_ - metrics_.samples); }

  // Ends a tick of which the world executed `fraction`, with drop reason `reason` if there is one.
  // `before` is the midpoint at the start of the tick [m].
  void finish_tick(DropReason reason, double fraction, Real before) {
    const double gone = double(robots_.midpoint) * spec_.direction;
    if (reason != DropReason::none) {
      metrics_.reason = reason;
      metrics_.outcome = Outcome::dropped;
      metrics_.time_ticks = double(tick_) + fraction;
    } else if (gone >= spec_.distance) {
      metrics_.outcome = Outcome::delivered;
      // The instant inside the tick at which the distance was reached.
      const double over = gone - spec_.distance;
      const double way = (double(robots_.midpoint) - double(before)) * spec_.direction;
      metrics_.time_ticks = double(tick_) + (way > 0 ? 1 - over / way : 1);
    } else if (tick_ + 1 >= spec_.timeout_ticks) {
      metrics_.outcome = Outcome::stalled;
      metrics_.time_ticks = double(tick_) + 1;
    }
    ++tick_;
    if (done()) close();
  }

  // The carry is over.
  void close() {
    collect();
    team_.close(tick_);
    metrics_.close(tick_);
  }

  // The object is no longer held at the start of a tick.
  void drop() {
    metrics_.outcome = Outcome::dropped;
    metrics_.time_ticks = double(tick_);
    close();
  }

 private:
  // The first tick from `tick` on in which a bias may change.
  std::uint32_t next_bias_change(std::uint32_t tick) const {
    return SpeedErrors::vary(spec_) ? tick : Pushes::next_change(spec_, tick);
  }

  // Out of line, so that a tick does not wait for the controllers: commands seldom change, and the
  // branch predictor assumes that they did not.
  [[gnu::noinline]] void obey(const PerSide<Command>& commands) {
    for (const std::size_t side : {left, right}) {
      const bool turns = commands[side].palm != commands_[side].palm;
      if (team_.expects_turns && turns) sensed_[side].palm_at_target = false;
    }
    commands_ = commands;
    for (const std::size_t side : {left, right}) {
      robots_.goal_angle[side] = robots_.wrists[side].target(commands[side].palm);
      robots_.goal_speed[side] = goal_speed(side, commands[side]);
      const bool stops = commands[side].stop && robots_.goal_speed[side] == Real(0);
      robots_.held_at[side] = Real(stops ? robots_.braked : robots_.released);
    }
  }

  // A correction that follows the last one within this time belongs to the same series of
  // corrections. The time is twice the delay of messages and palms [ticks].
  std::uint32_t settle_ticks() const {
    double turn = 0;
    for (const PalmSpec& palm : spec_.palms) {
      const double own = (palm.steep - palm.shallow) / palm.rate;
      turn = own > turn ? own : turn;
    }
    return static_cast<std::uint32_t>(2 * (turn + 2 * spec_.longest_delay()) / spec_.period) + 10;
  }

 protected:
  Spec spec_;
  std::uint64_t seed_;
  Faults faults_;
  TheTeam team_;
  Robots<Real> robots_{};
  PerSide<ErrorReplay> replays_{};
  TactileSensor<Real> tactile_;
  PerSide<RobotObservation> sensed_{};
  std::uint32_t next_decision_tick_ =
      0;  // the next tick at which the team is stepped regardless of the observations
  ContactStatistics<Real> statistics_{};
  std::uint32_t tick_ = 0;
  std::uint32_t next_bias_change_ = 0;  // the next tick in which a bias may change
  Metrics metrics_;

 private:
  PerSide<Real> full_move_{};
  PerSide<Real> nominal_{};
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
};

}  // namespace palmbots
