// A carry: world, two robots, radio and controllers, tick after tick, until it ends.
//
// One tick: scheduled and random bumps; sensors read; the team (controllers and radio) turns
// readings into commands; wheels and wrists act; the world moves exactly. Nothing in a tick
// allocates; a recorder, if any, gets its memory before the first.
#pragma once

#include <cstdint>

#include "palmbots/metrics.hpp"
#include "palmbots/setup.hpp"
#include "palmbots/team.hpp"
#include "palmbots/world.hpp"

namespace palmbots {

// Noise is drawn, and metrics are added up, for so many ticks at once.
inline constexpr std::uint32_t block_ticks = 64;

template <class Real, class Team, class Recorder>
class Carry {
 public:
  Carry(const Spec& spec, std::uint64_t seed, Team team, Recorder recorder)
      : spec_(spec),
        seed_(seed),
        faults_(Faults::of(spec, seed)),
        team_(std::move(team)),
        recorder_(std::move(recorder)) {
    const Rig<Real> rig = rig_of<Real>(spec);
    world_ = World<Real>(rig, stance_of(spec, rig));
    robots_ = robots_of<Real>(spec, seed);
    for (const std::size_t side : {left, right}) {
      full_move_[side] = Real(spec.robots[side].correction * (Team::half_moves ? 0.5 : 1.0));
      nominal_[side] = Real(spec.direction * spec.robots[side].speed);
    }
    std::array<Zone<Real>, max_zones> zones{};
    for (std::size_t i = 0; i < spec.zone_count; ++i) {
      zones[i] = {spec.zones[i].sign, Real(spec.zones[i].from), Real(spec.zones[i].to)};
    }
    obey(commands_);
    tactile_ = Tactile<Real>(zones, spec.zone_count, spec.false_rate);
    metrics_.settle_ticks = settle_ticks();
  }

  // Before the first tick: is the object held?
  void begin() { metrics_.end = world_.check(); }

  // From here on the random numbers of another seed; what has happened stays. Faults keep their schedule.
  void fork(std::uint64_t seed) {
    seed_ = seed;
    team_.fork(seed);
    if (tick_ % block_ticks != 0) draw_noise(tick_ - tick_ % block_ticks);
  }

  // Runs to the end.
  void run() {
    begin();
    while (metrics_.outcome == Result::running) {
      recorder_.make_room();
      tick();
    }
    recorder_.make_room();
    recorder_.end(*this);
  }

  // One control period.
  void tick() {
    if (open()) act(sense());
  }

  // The same in two halves, for somebody who decides in between. First bumps; tells whether the object is
  // still held.
  [[gnu::always_inline]] bool open() {
    if (metrics_.end == End::none && (spec_.bump_count > 0 || spec_.bump_rate > 0)) bump();
    if (metrics_.end == End::none) return true;
    metrics_.outcome = Result::dropped;
    metrics_.time_ticks = double(tick_);
    close();
    return false;
  }

  // Then all else, with what the robots sense now.
  [[gnu::always_inline]] void act(const PerSide<Sensed>& sensed) {
    if (sensed != sensed_ || tick_ >= wake_) think(sensed);
    const std::uint32_t k = tick_ % block_ticks;
    if (k == 0) next_block();
    tally_.add(world_.touched());
    const Actuation<Real> act =
        actuate(robots_, world_.stance().palms, {noise_[left][k], noise_[right][k]});
    recorder_.before(*this, sensed);
    const Advance<Real>& step = world_.advance(act.change, act.angles, act.push);
    metrics_.observe(tick_, world_.touches(), !world_.grip().none());
    const Real before = robots_.midpoint;
    robots_.midpoint = before + (step.end == End::none ? act.travel : act.travel * step.fraction);
    recorder_.after(*this);
    finish_tick(step, before);
  }

  std::uint32_t ticks() const { return tick_; }
  const Spec& spec() const { return spec_; }
  const World<Real>& world() const { return world_; }
  const Team& team() const { return team_; }
  const Metrics& metrics() const { return metrics_; }
  Recorder& recorder() { return recorder_; }
  const Recorder& recorder() const { return recorder_; }
  Real midpoint() const { return robots_.midpoint; }
  const PerSide<Real>& speeds() const { return robots_.speeds; }
  const PerSide<Command>& commands() const { return commands_; }

  // The speed a command asks of a robot, in the world's x direction.
  Real wanted(std::size_t side, Command command) const {
    const Real away = outward<Real>(side) * full_move_[side];
    const Real move =
        command.move == Move::away ? away : (command.move == Move::closer ? -away : Real(0));
    return (command.rest ? Real(0) : nominal_[side]) + move;
  }

  // What the robots sense, bumps done.
  PerSide<Sensed> sense() const {
    const PerSide<Sign> signs = read(world_.touched());
    PerSide<Sensed> sensed{};
    for (const std::size_t side : {left, right}) {
      sensed[side] = {signs[side], world_.stance().palms[side].angle == robots_.goal_angle[side]};
    }
    return sensed;
  }

 private:
  template <class, int, class>
  friend class Lockstep;

  // What the sensors say of palms touched there, in this tick.
  PerSide<Sign> read(const PerSide<Real>& touched) const {
    PerSide<Sign> signs{};
    Words words{};
    if (tactile_.has_false_readings()) words = draw(seed_, tick_, Stream::tactile);
    for (const std::size_t side : {left, right}) {
      const std::size_t lane = side == leader() ? 0 : 2;
      signs[side] = tactile_.has_false_readings()
                        ? tactile_.sign(touched[side], words[lane], words[lane + 1])
                        : tactile_.sign(touched[side]);
      if (faults_.any()) [[unlikely]]
        signs[side] = faults_.reading(tick_, side, signs[side]);
    }
    return signs;
  }

  // Whether they say the same as long as the palms are touched in the same stretches.
  bool reads_truly() const { return !tactile_.has_false_readings() && !faults_.bend_readings(); }

  // The team runs, and what it commands is obeyed. Between two calls every tick would be the same: the
  // robots sense what they sensed, and the team has nothing to do by itself. Tells whether the commands
  // are new.
  bool think(const PerSide<Sensed>& sensed) {
    sensed_ = sensed;
    const PerSide<Command> commands =
        team_.step(tick_, sensed, [&](const Posted& p) { recorder_.message(p); });
    wake_ = wake_of(team_, tick_);
    const bool are_new = commands != commands_;
    if (are_new) [[unlikely]]
      obey(commands);
    metrics_.note(tick_, team_);
    return are_new;
  }

  // Out of line, so that a tick need not wait for the controllers: commands seldom change, and the
  // processor guesses that they did not.
  [[gnu::noinline]] void obey(const PerSide<Command>& commands) {
    commands_ = commands;
    for (const std::size_t side : {left, right}) {
      robots_.goal_angle[side] = robots_.wrists[side].target(commands[side].palm);
      robots_.goal_speed[side] =
          robots_.wheels[side].within_limit(robots_.travel_sense * wanted(side, commands[side]));
      const bool rests = commands[side].rest && robots_.goal_speed[side] == Real(0);
      robots_.brakes[side] = Real(rests ? 1 : 0);
    }
  }

  // The robot that leads has the first word of a tick, wherever it stands, so that the mirrored carry
  // draws the mirrored numbers.
  std::size_t leader() const { return leader_of(spec_); }

  // What is done for many ticks at once.
  [[gnu::noinline]] void next_block() {
    collect();
    draw_noise(tick_);
  }

  void collect() { metrics_.collect(tally_, tick_ - metrics_.samples); }

  // The noise of a block of ticks: four words serve two robots for two ticks.
  void draw_noise(std::uint32_t first) {
    const auto words = draw_every_other<block_ticks / 2>(seed_, first, Stream::noise);
    for (const std::size_t side : {left, right}) {
      const std::size_t lane = side == leader() ? 0 : 1;
      for (std::size_t i = 0; i < block_ticks / 2; ++i) {
        noise_[side][2 * i] = unit_noise<Real>(words[lane][i]);
        noise_[side][2 * i + 1] = unit_noise<Real>(words[2 + lane][i]);
      }
    }
  }

  // Scripted bumps that are due, and random ones: for each robot a chance in proportion to the way.
  void bump() {
    PerSide<Real> by{};
    for (std::size_t i = 0; i < spec_.bump_count; ++i) {
      const BumpSpec& bump = spec_.bumps[i];
      const double reached = bump.by_time != 0 ? double(tick_) * spec_.period
                                               : double(robots_.midpoint) * spec_.direction;
      if ((bumped_ >> i & 1) != 0 || reached < bump.at) continue;
      bumped_ |= std::uint64_t{1} << i;
      by[bump.side] += Real(bump.shift);
      ++metrics_.bumps;
    }
    if (spec_.bump_rate > 0) random_bumps(by);
    if (by[left] != Real(0) || by[right] != Real(0)) metrics_.end = world_.shift(by);
  }

  void random_bumps(PerSide<Real>& by) {
    const Words words = draw(seed_, tick_, Stream::bump);
    const double way =
        std::abs(double(robots_.speeds[left] + robots_.speeds[right])) * 0.5 * spec_.period;
    const double chance = spec_.bump_rate * way;
    for (const std::size_t side : {left, right}) {
      const std::size_t lane = side == leader() ? 0 : 2;
      if (unit_uniform<double>(words[lane]) >= chance) continue;
      const double place = 2 * unit_uniform<double>(words[lane + 1]) - 1;
      by[side] += Real(place * spec_.bump_max);
      ++metrics_.bumps;
    }
  }

  // `before`: where the midpoint was.
  void finish_tick(const Advance<Real>& step, Real before) {
    const double gone = double(robots_.midpoint) * spec_.direction;
    if (step.end != End::none) {
      metrics_.end = step.end;
      metrics_.outcome = Result::dropped;
      metrics_.time_ticks = double(tick_) + double(step.fraction);
    } else if (gone >= spec_.distance) {
      metrics_.outcome = Result::delivered;
      // The instant inside the tick at which the distance was reached.
      const double over = gone - spec_.distance;
      const double way = (double(robots_.midpoint) - double(before)) * spec_.direction;
      metrics_.time_ticks = double(tick_) + (way > 0 ? 1 - over / way : 1);
    } else if (tick_ + 1 >= spec_.timeout_ticks) {
      metrics_.outcome = Result::stalled;
      metrics_.time_ticks = double(tick_) + 1;
    }
    ++tick_;
    if (metrics_.outcome != Result::running) close();
  }

  // The carry is over.
  void close() {
    collect();
    close_team(team_, tick_);
    metrics_.close(tick_);
  }

  // A correction that follows the last one within this time belongs to the same run of corrections:
  // twice the time that messages and palms take.
  std::uint32_t settle_ticks() const {
    double turn = 0;
    for (const PalmSpec& palm : spec_.palms) {
      const double own = (palm.steep - palm.shallow) / palm.rate;
      turn = own > turn ? own : turn;
    }
    return static_cast<std::uint32_t>(2 * (turn + 2 * (spec_.latency + spec_.jitter)) /
                                      spec_.period) +
           10;
  }

  Spec spec_;
  std::uint64_t seed_;
  Faults faults_;
  Team team_;
  Recorder recorder_;
  World<Real> world_;
  Robots<Real> robots_{};
  Tactile<Real> tactile_;
  PerSide<Real> full_move_{};
  PerSide<Real> nominal_{};
  PerSide<Sensed> sensed_{};
  std::uint32_t wake_ = 0;  // the next tick at which the team is asked whatever is sensed
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  PerSide<std::array<Real, block_ticks>> noise_{};
  Tally<Real> tally_{};
  std::uint64_t bumped_ = 0;
  std::uint32_t tick_ = 0;
  Metrics metrics_;
};

}  // namespace palmbots
