// A carry: world, two robots, radio and controllers, tick after tick, until it ends.
//
// One tick: scheduled and random bumps; sensors read; the team (controllers and radio) turns
// readings into commands; wheels and wrists act; the world moves exactly. Nothing in a tick
// allocates; a recorder, if any, gets its memory before the first.
#pragma once

#include <cstdint>

#include "palmbots/metrics.hpp"
#include "palmbots/robot.hpp"
#include "palmbots/spec.hpp"
#include "palmbots/team.hpp"
#include "palmbots/world.hpp"

namespace palmbots {

template <class Real>
Rig<Real> rig_of(const Spec& spec) {
  Rig<Real> rig{};
  rig.load = {Real(spec.width), Real(spec.com_left), Real(spec.com_right), Real(spec.com_height),
              Real(spec.slope)};
  rig.moments = Moments<Real>::of(rig.load);
  rig.outline.count = spec.outline.count;
  rig.outline.contact = spec.outline.contact;
  for (std::size_t i = 0; i < spec.outline.count; ++i) {
    const Vertex<double>& v = spec.outline.vertices[i];
    rig.outline.vertices[i] = {{Real(v.along[left]), Real(v.along[right])}, Real(v.height)};
  }
  for (const std::size_t side : {left, right}) {
    rig.clear[side] = clear_cone(rig.outline, side);
    rig.offset[side] = Real(spec.palms[side].offset);
    rig.half_length[side] = Real(0.5 * spec.palms[side].length);
    rig.friction[side] = Real(spec.palms[side].friction);
  }
  return rig;
}

// Both palms steep, the contacts where the spec starts them, the robots where the object makes them.
template <class Real>
Stance<Real> stance_of(const Spec& spec, const Rig<Real>& rig) {
  Stance<Real> stance{};
  for (const std::size_t side : {left, right}) {
    stance.palms[side] = PalmAngle<Real>::at(Real(spec.palms[side].steep));
    stance.contacts[side] = Real(spec.start[side]);
  }
  stance.separation = closing_separation(stance, rig.offset, rig.load.width);
  return stance;
}

template <class Real>
Wheels<Real> wheels_of(const RobotSpec& robot, double period) {
  const Real memory = robot.noise_tau > 0 ? exp_minus(Real(period / robot.noise_tau)) : Real(0);
  const Real drive = Real(robot.noise) * std::sqrt(Real(1) - memory * memory);
  return {Real(robot.acceleration * period), Real(robot.max_speed), Real(robot.bias), memory,
          drive};
}

template <class Real>
Wrist<Real> wrist_of(const PalmSpec& palm, double period) {
  return {Real(palm.steep), Real(palm.shallow), Real(palm.rate * period)};
}

inline Channel channel_of(const Spec& spec) {
  Channel channel = Channel::of(spec.latency, spec.jitter, spec.loss, spec.period);
  channel.duplicate_words = Channel::words_of(spec.duplicate);
  channel.reorders = spec.reorders != 0;
  channel.burst_share = spec.burst_share;
  channel.burst_rate = spec.period / ((1 - spec.burst_share) * spec.burst_mean);
  channel.airtime_ticks = spec.airtime / spec.period;
  channel.outage_count = spec.outage_count;
  for (std::size_t i = 0; i < spec.outage_count; ++i) {
    const OutageSpec& outage = spec.outages[i];
    const auto tick = [&](double s) { return static_cast<std::uint32_t>(s / spec.period + 0.5); };
    channel.outages[i] = {outage.sender, tick(outage.from), tick(outage.to)};
  }
  channel.mishap_count = spec.mishap_count;
  for (std::size_t i = 0; i < spec.mishap_count; ++i) {
    const MishapSpec& m = spec.mishaps[i];
    channel.mishaps[i] = {m.sender, m.message, static_cast<Fate>(m.fate),
                          static_cast<std::uint32_t>(m.late / spec.period + 0.5)};
  }
  return channel;
}

inline std::size_t leader_of(const Spec& spec) { return spec.direction > 0 ? right : left; }

template <class Real, class Team, class Recorder>
class Carry {
 public:
  Carry(const Spec& spec, std::uint64_t seed, Team team, Recorder recorder)
      : spec_(spec),
        seed_(seed),
        faults_(Faults::of(spec, seed)),
        team_(std::move(team)),
        recorder_(std::move(recorder)),
        sense_of_travel_(Real(spec.direction)) {
    const Rig<Real> rig = rig_of<Real>(spec);
    world_ = World<Real>(rig, stance_of(spec, rig));
    for (const std::size_t side : {left, right}) {
      wheels_[side] = wheels_of<Real>(spec.robots[side], spec.period);
      wrists_[side] = wrist_of<Real>(spec.palms[side], spec.period);
      // Noise is under way when the carry starts: its first value has its lasting spread.
      const Words words = draw(seed, ~0U, Stream::noise);
      wheels_[side].noise = Real(spec.robots[side].noise) * random(words, 0, side);
      full_move_[side] = Real(spec.robots[side].correction * (Team::half_moves ? 0.5 : 1.0));
      nominal_[side] = Real(spec.direction * spec.robots[side].speed);
    }
    std::array<Zone<Real>, max_zones> zones{};
    for (std::size_t i = 0; i < spec.zone_count; ++i) {
      zones[i] = {spec.zones[i].sign, Real(spec.zones[i].from), Real(spec.zones[i].to)};
    }
    obey(commands_);
    tactile_ = Tactile<Real>(zones, spec.zone_count, spec.false_rate);
    // The object goes with the mean of the two robots; a push is an acceleration in units of g.
    if (spec.inertia != 0) inertia_ = Real(0.5 / (spec.period * standard_gravity));
    metrics_.settle_ticks = settle_ticks();
  }

  // Runs to the end.
  void run() {
    metrics_.end = world_.check();
    while (metrics_.outcome == Result::running) {
      recorder_.make_room();
      tick();
    }
    recorder_.make_room();
    recorder_.end(*this);
  }

  // One control period.
  void tick() {
    if (metrics_.end == End::none && (spec_.bump_count > 0 || spec_.bump_rate > 0)) bump();
    if (metrics_.end != End::none) {
      metrics_.outcome = Result::dropped;
      metrics_.time_ticks = double(tick_);
      metrics_.close(tick_);
      return;
    }
    const PerSide<Sensed> sensed = sense();
    const PerSide<Command> commands =
        team_.step(tick_, sensed, [&](const Posted& p) { recorder_.message(p); });
    if (commands != commands_) [[unlikely]]
      obey(commands);
    metrics_.observe(tick_, team_, world_.stance().contacts);

    if (tick_ % noise_block == 0) draw_noise();
    PerSide<Real> angles{};
    for (const std::size_t side : {left, right}) {
      speeds_[side] = sense_of_travel_ *
                      wheels_[side].step(goal_speed_[side], noise_[side][tick_ % noise_block]);
      // Wheels that have come to rest are braked: a robot that stands does not wander.
      const bool stands = commands_[side].rest && wheels_[side].speed == Real(0);
      if (stands && goal_speed_[side] == Real(0)) [[unlikely]]
        speeds_[side] = Real(0);
      const Real angle = world_.stance().palms[side].angle;
      angles[side] = wrists_[side].step(angle, goal_angle_[side]);
    }
    const auto period = Real(spec_.period);
    recorder_.before(*this, sensed);
    const Real together = speeds_[left] + speeds_[right];
    const Real push = inertia_ * (together - together_);
    const Advance<Real>& step =
        world_.advance((speeds_[right] - speeds_[left]) * period, angles, push);
    together_ = together;
    const Real travel = Real(0.5) * together * period;
    midpoint_ = midpoint_ + (step.end == End::none ? travel : travel * step.fraction);
    recorder_.after(*this);
    finish_tick(step, travel);
  }

  std::uint32_t ticks() const { return tick_; }
  const Spec& spec() const { return spec_; }
  const World<Real>& world() const { return world_; }
  const Team& team() const { return team_; }
  const Metrics& metrics() const { return metrics_; }
  Recorder& recorder() { return recorder_; }
  const Recorder& recorder() const { return recorder_; }
  Real midpoint() const { return midpoint_; }
  const PerSide<Real>& speeds() const { return speeds_; }
  const PerSide<Command>& commands() const { return commands_; }

  // The speed a command asks of a robot, in the world's x direction.
  Real wanted(std::size_t side, Command command) const {
    const Real away = outward<Real>(side) * full_move_[side];
    const Real move =
        command.move == Move::away ? away : (command.move == Move::closer ? -away : Real(0));
    return (command.rest ? Real(0) : nominal_[side]) + move;
  }

 private:
  // Out of line, so that a tick need not wait for the controllers: commands seldom change, and the
  // processor guesses that they did not.
  [[gnu::noinline]] void obey(const PerSide<Command>& commands) {
    commands_ = commands;
    for (const std::size_t side : {left, right}) {
      goal_angle_[side] = wrists_[side].target(commands[side].palm);
      goal_speed_[side] =
          wheels_[side].within_limit(sense_of_travel_ * wanted(side, commands[side]));
    }
  }

  // The robot that leads has the first word of a tick, wherever it stands, so that the mirrored carry
  // draws the mirrored numbers.
  std::size_t leader() const { return leader_of(spec_); }
  Real random(const Words& words, std::uint32_t tick, std::size_t side) const {
    return unit_noise<Real>(words[2 * (tick & 1) + (side == leader() ? 0 : 1)]);
  }

  // The noise of the ticks to come, many at once: four words serve two robots for two ticks, and
  // draws that do not wait for each other are quick.
  [[gnu::noinline]] void draw_noise() {
    for (std::uint32_t k = 0; k < noise_block; k += 2) {
      const Words words = draw(seed_, tick_ + k, Stream::noise);
      for (const std::size_t side : {left, right}) {
        noise_[side][k] = random(words, 0, side);
        noise_[side][k + 1] = random(words, 1, side);
      }
    }
  }

  PerSide<Sensed> sense() const {
    PerSide<Sensed> sensed{};
    const Stance<Real>& now = world_.stance();
    Words words{};
    if (tactile_.has_false_readings()) words = draw(seed_, tick_, Stream::tactile);
    for (const std::size_t side : {left, right}) {
      const Real p = now.contacts[side];
      const std::size_t lane = side == leader() ? 0 : 2;
      sensed[side].sign = tactile_.has_false_readings()
                              ? tactile_.sign(p, words[lane], words[lane + 1])
                              : tactile_.sign(p);
      if (faults_.any()) [[unlikely]]
        sensed[side].sign = faults_.reading(tick_, side, sensed[side].sign);
      sensed[side].turned = now.palms[side].angle == goal_angle_[side];
    }
    return sensed;
  }

  // Scripted bumps that are due, and random ones: for each robot a chance in proportion to the way.
  void bump() {
    PerSide<Real> by{};
    for (std::size_t i = 0; i < spec_.bump_count; ++i) {
      const BumpSpec& bump = spec_.bumps[i];
      const double reached =
          bump.by_time != 0 ? double(tick_) * spec_.period : double(midpoint_) * spec_.direction;
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
    const double way = std::abs(double(speeds_[left] + speeds_[right])) * 0.5 * spec_.period;
    const double chance = spec_.bump_rate * way;
    for (const std::size_t side : {left, right}) {
      const std::size_t lane = side == leader() ? 0 : 2;
      if (unit_uniform<double>(words[lane]) >= chance) continue;
      const double place = 2 * unit_uniform<double>(words[lane + 1]) - 1;
      by[side] += Real(place * spec_.bump_max);
      ++metrics_.bumps;
    }
  }

  void finish_tick(const Advance<Real>& step, Real travel) {
    const double gone = double(midpoint_) * spec_.direction;
    if (step.end != End::none) {
      metrics_.end = step.end;
      metrics_.outcome = Result::dropped;
      metrics_.time_ticks = double(tick_) + double(step.fraction);
    } else if (gone >= spec_.distance) {
      metrics_.outcome = Result::delivered;
      // The instant inside the tick at which the distance was reached.
      const double over = gone - spec_.distance;
      const double way = double(travel) * spec_.direction;
      metrics_.time_ticks = double(tick_) + (way > 0 ? 1 - over / way : 1);
    } else if (tick_ + 1 >= spec_.timeout_ticks) {
      metrics_.outcome = Result::stalled;
      metrics_.time_ticks = double(tick_) + 1;
    }
    ++tick_;
    if (metrics_.outcome != Result::running) metrics_.close(tick_);
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
  Real sense_of_travel_;
  World<Real> world_;
  PerSide<Wheels<Real>> wheels_{};
  PerSide<Wrist<Real>> wrists_{};
  Tactile<Real> tactile_;
  PerSide<Real> full_move_{};
  PerSide<Real> nominal_{};
  PerSide<Real> goal_speed_{};  // along the direction of travel
  PerSide<Real> goal_angle_{};
  PerSide<Real> speeds_{};   // towards +x
  Real together_ = Real(0);  // the sum of the speeds in the tick before
  Real inertia_ = Real(0);   // push per change of that sum [s/m]
  PerSide<Command> commands_{{{Palm::steep, Move::hold}, {Palm::steep, Move::hold}}};
  Real midpoint_ = Real(0);
  static constexpr std::uint32_t noise_block = 32;
  PerSide<std::array<Real, noise_block>> noise_{};
  std::uint64_t bumped_ = 0;
  std::uint32_t tick_ = 0;
  Metrics metrics_;
};

}  // namespace palmbots
