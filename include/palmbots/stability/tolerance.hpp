// SPDX-License-Identifier: Apache-2.0
// Tolerance: the error of one quantity that a pair of palm angles tolerates over an envelope.
//
// The COM's tolerance has a closed form: the distance of the stated c_x from the nearer end of the
// permitted interval. For the other quantities the envelope is widened by ±δ until the stated c_x
// is no longer permitted, or, if angles or contacts are widened, until the outline touches a palm.
// A wider envelope permits less, so bisection finds the largest δ. Source:
// docs/theory/stability.md.
#pragma once

#include "palmbots/stability/operating_envelope.hpp"

namespace palmbots {

// The quantities whose error can be bounded.
enum class Quantity : std::uint8_t { com, friction, slope, contacts, angle };

namespace detail {

// The envelope widened by δ, limited to values that are physically possible.
template <class Real>
constexpr OperatingEnvelope<Real> widened(OperatingEnvelope<Real> envelope, Quantity quantity,
                                          Real by) {
  switch (quantity) {
    case Quantity::friction:
      for (Interval<Real>& mu : envelope.friction.palms) {
        mu = {mu.low > by ? mu.low - by : Real(0), mu.high + by};
      }
      break;
    case Quantity::slope:
      envelope.slope = {envelope.slope.low - by, envelope.slope.high + by};
      break;
    case Quantity::contacts:
      for (Interval<Real>& p : envelope.contacts) p = {-by, by};
      break;
    case Quantity::com:
    case Quantity::angle: break;
  }
  return envelope;
}

// True if the envelope permits the whole interval of c_x.
template <class Real>
bool permits(const OperatingEnvelope<Real>& envelope, Interval<Real> com_x,
             const PerSide<AnglePair<Real>>& angles) {
  return contains(com_x_all(envelope, angles, com_x), com_x);
}

// The same with palm angles that are wrong by up to `error` [rad], including the clearance.
template <class Real>
bool permits_errors(const OperatingEnvelope<Real>& envelope, Interval<Real> com_x,
                    const PerSide<AnglePair<Real>>& angles, Real error) {
  const auto turned = [](const AnglePair<Real>& pair, Real by) {
    return AnglePair<Real>{PalmAngle<Real>::at(pair.shallow.angle + by),
                           PalmAngle<Real>::at(pair.steep.angle + by)};
  };
  for (const Real l : {-error, Real(0), error}) {
    for (const Real r : {-error, Real(0), error}) {
      const PerSide<AnglePair<Real>> wrong{turned(angles[left], l), turned(angles[right], r)};
      if (!permits(envelope, com_x, wrong) || !(clearance_margin(envelope, wrong) >= Real(0))) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace detail

// The tolerance of one quantity, up to `most`. Negative if the stated envelope itself does not
// hold.
template <class Real>
Real tolerance(const OperatingEnvelope<Real>& envelope, Interval<Real> com_x, Quantity quantity,
               Real most, const PerSide<AnglePair<Real>>& angles) {
  if (quantity == Quantity::com) {
    const Interval<Real> permitted = com_x_all(envelope, angles, com_x);
    const Real below = com_x.low - permitted.low;
    const Real above = permitted.high - com_x.high;
    return below < above ? below : above;
  }
  const auto holds = [&](Real by) {
    if (quantity == Quantity::angle) {
      return detail::permits_errors(envelope, com_x, angles, by);
    }
    const OperatingEnvelope<Real> wider = detail::widened(envelope, quantity, by);
    return detail::permits(wider, com_x, angles) &&
           (quantity != Quantity::contacts || clearance_margin(wider, angles) >= Real(0));
  };
  if (!holds(Real(0))) return Real(-1);
  if (holds(most)) return most;
  Real good = Real(0);
  Real bad = most;
  while (bad - good > Real(1e-7) * most) {
    const Real middle = Real(0.5) * (good + bad);
    (holds(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace palmbots
