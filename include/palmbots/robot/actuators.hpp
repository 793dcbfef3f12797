// SPDX-License-Identifier: Apache-2.0
// A robot as it is: wheels with limits and errors, and a palm that takes time to turn.
#pragma once

#include "palmbots/control/messages.hpp"
#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// The wheels. The commanded speed is approached at a finite acceleration and within a speed limit;
// what the robot does is that plus a constant calibration error and Ornstein–Uhlenbeck noise,
// dn = −n dt/τ + σ √(2/τ) dW, sampled exactly once a tick. Speeds are along the direction of
// travel.
template <class Real>
struct Wheels {
  Real gain;    // largest change of speed in a tick [m/s]
  Real limit;   // largest speed [m/s]
  Real bias;    // calibration error [m/s]
  Real memory;  // e^(−T/τ)
  Real drive;   // σ √(1 − memory²) [m/s]
  Real speed = Real(0);
  Real noise = Real(0);

  // What a commanded speed comes to.
  constexpr Real within_limit(Real wanted) const { return clamp(wanted, -limit, limit); }

  // The speed over the next tick towards a target within the limit; `random` has mean 0 and
  // variance 1.
  constexpr Real step(Real target, Real random) {
    speed = clamp(target, speed - gain, speed + gain);
    noise = memory * noise + drive * random;
    return speed + (bias + noise);
  }
};

// The palm's motor: turns to one of two angles at a finite rate.
template <class Real>
struct Wrist {
  Real steep;    // [rad]
  Real shallow;  // [rad]
  Real gain;     // largest turn in a tick [rad]

  constexpr Real target(Palm palm) const { return palm == Palm::steep ? steep : shallow; }

  // The angle at the end of the next tick. A remainder below a billionth of a tick's turn (in float
  // a thousandth) is rounding of the sum, not a distance left to go.
  constexpr Real step(Real angle, Real to) const {
    const Real left_to_go = to - angle;
    constexpr bool is_double = sizeof(typename ScalarOf<Real>::type) == 8;
    const Real reach = gain * Real(is_double ? 1.000000001 : 1.001);
    return select(within(left_to_go, reach), to,
                  select(left_to_go > Real(0), angle + gain, angle - gain));
  }
};

// A push that has faded to this is none [1].
inline constexpr double least_push = 1e-6;

// Both robots: how they drive, and how far the pair has come.
template <class Real>
struct Robots {
  PerSide<Wheels<Real>> wheels;
  PerSide<Wrist<Real>> wrists;
  PerSide<Real> goal_speed;  // within the limit, along the direction of travel [m/s]
  PerSide<Real> goal_angle;  // [rad]
  PerSide<Real> brakes;      // 1: told to rest; wheels that stand are held
  Real travel_sense;         // ±1: the direction of travel along x
  Real period;               // of control [s]
  Real inertia;              // push per change of the sum of the speeds [s/m]
  Real push_memory;          // e^(−T/τ) of the lag with which accelerations count
  Real push_share;           // 1 − that
  PerSide<Real> speeds;      // over the last tick, towards +x [m/s]
  Real together;             // their sum [m/s]
  Real push;                 // sideways specific force of their acceleration, lagged [1]
  Real midpoint;             // of the pivots, from where it started, towards +x [m]

  // What came of it in the last tick [m]: of the separation, and of the midpoint.
  constexpr Real change() const { return (speeds[right] - speeds[left]) * period; }
  constexpr Real travel() const { return Real(0.5) * together * period; }
};

// What the robots do to the world in one tick.
template <class Real>
struct Actuation {
  Real change;           // of the separation [m]
  PerSide<Real> angles;  // of the palms at the end of the tick [rad]
  Real push;             // sideways specific force of their acceleration [1]
  Real travel;           // of the midpoint [m]
};

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
  // A robot that stands does not wander.
  const auto held = [&](std::size_t side) {
    const MaskOf<Real> stands = robots.wheels[side].speed == Real(0);
    const MaskOf<Real> braked = robots.brakes[side] != Real(0);
    return stands & braked;
  };
  const MaskOf<Real> left_held = held(left);
  const MaskOf<Real> right_held = held(right);
  if (any(left_held | right_held)) {
    robots.speeds[left] = select(left_held, Real(0), robots.speeds[left]);
    robots.speeds[right] = select(right_held, Real(0), robots.speeds[right]);
  }
  const Real together = robots.speeds[left] + robots.speeds[right];
  done.change = robots.change();
  const Real jerked = robots.inertia * (together - robots.together);
  robots.push = robots.push_memory * robots.push + robots.push_share * jerked;
  const MaskOf<Real> steady = jerked == Real(0);
  if (any(steady)) {
    robots.push = select(steady & within(robots.push, Real(least_push)), Real(0), robots.push);
  }
  done.push = robots.push;
  robots.together = together;
  done.travel = robots.travel();
  return done;
}

}  // namespace palmbots
