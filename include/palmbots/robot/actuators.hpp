// SPDX-License-Identifier: Apache-2.0
// Actuators of a robot: wheels with limits and errors, and a palm that turns at a finite rate.
#pragma once

#include <limits>

#include "palmbots/control/messages.hpp"
#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// The wheels. They approach the commanded speed at a finite acceleration and within a speed limit.
// The actual speed is the gain times that, plus a calibration error and Ornstein–Uhlenbeck noise,
// dn = −n dt/τ + σ √(2/τ) dW, sampled exactly once per tick. Target, step and `speed` are multiplied
// by the gain already, so that a tick need not. Speeds are along the direction of travel.
template <class Real>
struct Wheels {
  Real ramp;             // largest change of speed in a tick, times the gain [m/s]
  Real limit;            // largest commanded speed [m/s]
  Real bias;             // calibration error, with all that changes it from tick to tick [m/s]
  Real memory;           // e^(−T/τ)
  Real drive;            // σ √(1 − memory²) [m/s]
  Real creep = Real(0);  // share of the noise that is left while the brakes hold wheels that stand
  Real gain = Real(1);   // actual speed per commanded speed [1]
  Real speed = Real(0);  // reached, times the gain [m/s]
  Real noise = Real(0);

  // The commanded speed, limited to what the wheels can do [m/s].
  constexpr Real within_limit(Real wanted) const { return clamp(wanted, -limit, limit); }

  // The actual speed [m/s] over the next tick, towards a target: a speed within the limit, times the
  // gain. `random` has mean 0 and variance 1.
  constexpr Real step(Real target, Real random) {
    speed = clamp(target, speed - ramp, speed + ramp);
    noise = memory * noise + drive * random;
    return speed + (bias + noise);
  }

  // The actual speed [m/s] over the tick that was just stepped, if the brakes hold the wheels.
  constexpr Real held() const { return creep * noise; }
};

// The palm's motor. It turns the palm to one of two angles at a finite rate.
template <class Real>
struct Wrist {
  Real steep;    // [rad]
  Real shallow;  // [rad]
  Real gain;     // largest turn in a tick [rad]

  constexpr Real target(Palm palm) const { return palm == Palm::steep ? steep : shallow; }

  // The angle [rad] at the end of the next tick. A remainder below a billionth of a tick's turn (in
  // float a thousandth) is rounding of the sum, not a distance left to go.
  constexpr Real step(Real angle, Real to) const {
    const Real left_to_go = to - angle;
    constexpr bool is_double = sizeof(typename ScalarOf<Real>::type) == 8;
    const Real reach = gain * Real(is_double ? 1.000000001 : 1.001);
    return select(within(left_to_go, reach), to,
                  select(left_to_go > Real(0), angle + gain, angle - gain));
  }
};

// The push of the object's inertia: the sideways specific force of the pair's acceleration, which a
// first-order lag smooths (docs/theory/mechanics.md).
template <class Real>
struct InertiaFilter {
  static constexpr double least_push = 1e-6;  // a push that has decayed to this counts as zero [1]

  Real gain;      // push per change of the sum of the speeds [s/m]; 0: no inertia
  Real memory;    // e^(−T/τ)
  Real share;     // 1 − memory
  Real together;  // sum of both robots' speeds towards +x in the last tick [m/s]
  Real push;      // [1]

  // The push over the next tick, in which the sum of the speeds is this [m/s].
  [[gnu::always_inline]] constexpr Real step(Real speeds) {
    const Real jerked = gain * (speeds - together);
    push = memory * push + share * jerked;
    const MaskOf<Real> steady = jerked == Real(0);
    if (any(steady)) push = select(steady & within(push, Real(least_push)), Real(0), push);
    together = speeds;
    return push;
  }
};

// Both robots: their actuators, their set points and the motion of the pair.
template <class Real>
struct Robots {
  // Brakes hold wheels that stand: speed 0. Released, they hold them at no speed. So whether wheels
  // are held is one comparison in each tick.
  static constexpr double braked = 0;
  static constexpr double released = std::numeric_limits<double>::quiet_NaN();

  PerSide<Wheels<Real>> wheels;
  PerSide<Wrist<Real>> wrists;
  PerSide<Real>
      goal_speed;  // within the limit, times the gain, along the direction of travel [m/s]
  PerSide<Real> goal_angle;                                  // [rad]
  PerSide<Real> held_at = {Real(released), Real(released)};  // where brakes hold wheels [m/s]
  Real travel_sense;                                         // ±1: the direction of travel along x
  Real period;                                               // of control [s]
  PerSide<Real> speeds;                                      // over the last tick, towards +x [m/s]
  InertiaFilter<Real> inertia;
  Real midpoint;  // of the pivots, from where it started, along +x [m]

  // Displacement in the last tick [m]: change of the separation, and travel of the midpoint.
  constexpr Real change() const { return (speeds[right] - speeds[left]) * period; }
  constexpr Real travel() const { return Real(0.5) * inertia.together * period; }
};

// The effect of both robots on the world in one tick.
template <class Real>
struct Actuation {
  Real change;           // change of the separation [m]
  PerSide<Real> angles;  // palm angles at the end of the tick [rad]
  Real push;             // sideways specific force of their acceleration [1]
  Real travel;           // displacement of the midpoint [m]
};

// Moves wheels and wrists by one tick. `random` has mean 0 and variance 1 for each robot.
template <class Real>
[[gnu::always_inline]] inline Actuation<Real> actuate(Robots<Real>& robots,
                                                      const PerSide<PalmAngle<Real>>& palms,
                                                      const PerSide<Real>& random) {
  Actuation<Real> done{};
  on_both_sides([&](std::size_t side) {
    robots.speeds[side] =
        robots.travel_sense * robots.wheels[side].step(robots.goal_speed[side], random[side]);
    done.angles[side] = robots.wrists[side].step(palms[side].angle, robots.goal_angle[side]);
  });
  // The brakes hold a robot that stands: of noise and calibration error only the creep moves it.
  const MaskOf<Real> left_held = robots.wheels[left].speed == robots.held_at[left];
  const MaskOf<Real> right_held = robots.wheels[right].speed == robots.held_at[right];
  if (any(left_held | right_held)) {
    const auto creeps = [&](std::size_t side) {  // + 0: a robot at rest has the speed 0, not −0
      return Real(0) + robots.travel_sense * robots.wheels[side].held();
    };
    robots.speeds[left] = select(left_held, creeps(left), robots.speeds[left]);
    robots.speeds[right] = select(right_held, creeps(right), robots.speeds[right]);
  }
  done.change = robots.change();
  done.push = robots.inertia.step(robots.speeds[left] + robots.speeds[right]);
  done.travel = robots.travel();
  return done;
}

}  // namespace palmbots
