// SPDX-License-Identifier: Apache-2.0
// A carry: world, two robots, radio and controllers, simulated tick by tick until it ends.
//
// In one tick, scheduled and random bumps occur, the sensors are read, the team (controllers and
// radio) turns readings into commands, wheels and wrists act, and the world moves exactly. A tick
// allocates no memory; a recorder, if there is one, allocates before the tick.
#pragma once

#include <cstdint>
#include <span>

#include "palmbots/sim/bumps.hpp"
#include "palmbots/sim/random_streams.hpp"
#include "palmbots/sim/robot_pair.hpp"
#include "palmbots/world/quasistatic_world.hpp"

namespace palmbots {

// From this tick on, a carry continues with the random numbers of another seed.
struct Fork {
  std::uint32_t tick;
  std::uint64_t seed;
};

// The world at the start, of a carry with this seed.
template <class Real>
World<Real> world_of(const Spec& spec, const Model<Real>& model, std::uint64_t seed) {
  World<Real> world(model, configuration_of(spec, model));
  if (spec.ambiguity == Ambiguity::drawn) world.draw_ambiguous(seed, Stream::ambiguity);
  return world;
}

// One carry with the quasistatic world. Team is one of sim/team.hpp, Recorder one of
// sim/recorder.hpp.
template <class Real, class Team, class Recorder>
class Carry : public RobotPair<Real, Team> {
  using Base = RobotPair<Real, Team>;

 public:
  Carry(const Spec& spec, std::uint64_t seed, Team team, Recorder recorder)
      : Base(spec, seed, std::move(team)),
        recorder_(std::move(recorder)),
        world_(world_of(spec, model_of<Real>(spec), seed)),
        bumps_(spec),
        is_limited_(world_.is_limited()) {}

  // To be called before the first tick: checks whether the object is held.
  void begin() { metrics_.reason = world_.check(); }

  // Continues with the random numbers of another seed. Everything that has happened stays, and
  // faults keep their schedule.
  void fork(std::uint64_t seed) {
    seed_ = seed;
    team_.fork(seed);
    if (spec_.ambiguity == Ambiguity::drawn) world_.draw_ambiguous(seed, Stream::ambiguity);
    const std::uint32_t first = tick_ - tick_ % block_ticks;
    if (first == tick_) return;
    draw_noise(first);
    bumps_.draw_block(spec_, seed, first);
  }

  // Runs to the end, with forks at given ticks in their order.
  void run(std::span<const Fork> forks = {}) {
    begin();
    while (!this->done()) {
      for (; !forks.empty() && forks.front().tick <= tick_; forks = forks.subspan(1)) {
        fork(forks.front().seed);
      }
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

  // The same in two halves, for a caller that decides in between. open() applies bumps and returns
  // true if the object is still held.
  [[gnu::always_inline]] bool open() {
    if (metrics_.reason == DropReason::none && Bumps::any(spec_)) bump();
    if (metrics_.reason == DropReason::none) return true;
    drop();
    return false;
  }

  // Executes the rest of the tick with these observations.
  [[gnu::always_inline]] void act(const PerSide<RobotObservation>& sensed) {
    // A team that reads the whole state (optimum/optimal_team.hpp).
    if constexpr (requires { team_.look(world_, robots_); }) team_.look(world_, robots_);
    if (notice(sensed)) think();
    const std::uint32_t k = tick_ % block_ticks;
    if (k == 0) next_block();
    statistics_.add(world_.touched());
    change_biases();
    this->let_palms_fall();
    const Actuation<Real> act =
        actuate(robots_, world_.configuration().palms, {noise_[left][k], noise_[right][k]});
    recorder_.before(*this, sensed);
    const Advance<Real>& step = is_limited_ ? world_.advance(ways(), act.angles, act.push)
                                            : world_.advance(act.change, act.angles, act.push);
    const bool on_contacts = !world_.regime().none();  // and not by a step for two vertices
    metrics_.observe(tick_, world_.contact_events(), on_contacts);
    const Real before = robots_.midpoint;
    robots_.midpoint =
        before + (step.reason == DropReason::none ? act.travel : act.travel * step.fraction);
    if (on_contacts) [[unlikely]]
      robots_.midpoint += metrics_.note_stalls(step);
    recorder_.after(*this);
    finish_tick(step.reason, double(step.fraction), before);
  }

  const World<Real>& world() const { return world_; }
  Recorder& recorder() { return recorder_; }
  const Recorder& recorder() const { return recorder_; }

  // The observations of the robots, after bumps.
  PerSide<RobotObservation> sense() const {
    const PerSide<Sign> signs = read(world_.touched());
    PerSide<RobotObservation> sensed{};
    for (const std::size_t side : {left, right}) {
      sensed[side] = {signs[side],
                      world_.configuration().palms[side].angle == robots_.goal_angle[side]};
    }
    return sensed;
  }

 private:
  template <class, int, class>
  friend class LaneCarries;
  template <class, int, class>
  friend class BitslicedTeams;

  using Base::biases, Base::change_biases, Base::notice, Base::rank;
  using Base::collect, Base::drop, Base::faults_, Base::finish_tick, Base::goal_speed, Base::leader;
  using Base::metrics_, Base::robots_, Base::seed_, Base::sensed_, Base::spec_, Base::tactile_;
  using Base::read, Base::reads_truly, Base::statistics_, Base::team_, Base::tick_,
      Base::next_decision_tick_;

  // The way of each pivot in this tick [m].
  PerSide<Vec> ways() const {
    const auto way = [&](std::size_t side) {
      return Vec{double(robots_.speeds[side]) * double(robots_.period), 0.0};
    };
    return {way(left), way(right)};
  }

  bool think() {
    return Base::think([&](const SentMessage& p) { recorder_.message(p); });
  }

  // Work that is done once for a block of ticks.
  [[gnu::noinline]] void next_block() {
    collect();
    draw_noise(tick_);
  }

  // The noise of a block of ticks. A draw of four words serves two robots for two ticks.
  void draw_noise(std::uint32_t first) {
    const auto words = draw_row<block_ticks / 2>(seed_, first, Stream::noise, 2);
    for (const std::size_t side : {left, right}) {
      const std::size_t lane = rank(side);
      for (std::size_t i = 0; i < block_ticks / 2; ++i) {
        noise_[side][2 * i] = unit_noise<Real>(words[lane][i]);
        noise_[side][2 * i + 1] = unit_noise<Real>(words[2 + lane][i]);
      }
    }
  }

  void bump() {
    if (tick_ % block_ticks == 0) bumps_.draw_block(spec_, seed_, tick_);
    if (!bumps_.due(spec_, tick_, robots_.midpoint, robots_.inertia.together)) return;
    const auto shift = bumps_.take(spec_, seed_, tick_, robots_.midpoint, robots_.inertia.together);
    metrics_.bumps += shift.bumps;
    const PerSide<Real> by{Real(shift.by[left]), Real(shift.by[right])};
    if (by[left] != Real(0) || by[right] != Real(0)) metrics_.reason = world_.shift(by);
  }

  Recorder recorder_;
  World<Real> world_;
  PerSide<std::array<Real, block_ticks>> noise_{};
  Bumps bumps_;
  bool is_limited_;
};

}  // namespace palmbots
