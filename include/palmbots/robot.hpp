// A robot as it is: wheels with limits and errors, and a palm that takes time to turn.
#pragma once

#include "palmbots/message.hpp"
#include "palmbots/scalar.hpp"

namespace palmbots {

// The wheels. The commanded speed is approached at a finite acceleration and within a speed limit;
// what the robot does is that plus a constant calibration error and Ornstein–Uhlenbeck noise,
// dn = −n dt/τ + σ √(2/τ) dW, sampled exactly once a tick. Speeds are along the direction of travel.
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
    if (speed != target) speed = clamp(target, speed - gain, speed + gain);
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
    const Real reach = gain * (sizeof(Real) == 8 ? Real(1.000000001) : Real(1.001));
    if (left_to_go <= reach && left_to_go >= -reach) return to;
    return left_to_go > Real(0) ? angle + gain : angle - gain;
  }
};

}  // namespace palmbots
