// Which contact slips, and which way: the two questions that the world asks at every instant.
//
// Source: MECHANICS sections 1 and 2.
#pragma once

#include "palmbots/modes.hpp"
#include "palmbots/stance.hpp"

namespace palmbots {

// > 0: the left contact lets go first; < 0: the right one; 0: tie. `let_go` is the tie of the cone
// ends that count in this direction.
template <class Real>
constexpr Real left_first(const Tie<Real>& let_go, Slide direction, Span<Real> span) {
  const Real left_higher = let_go.at(span);
  return direction == Slide::up ? -left_higher : left_higher;
}

// Half the rate of change of |C_R − C_L|² with both contacts held: < 0 closes, > 0 opens. `change`
// and `turn` are the rates of the separation and of the palm angles.
template <class Real>
constexpr Real drive_rate(const PerSide<PalmAngle<Real>>& palms, const PerSide<Real>& contacts,
                          const PerSide<Real>& offset, Span<Real> span, Real change,
                          const PerSide<Real>& turn) {
  PerSide<Real> along{};
  PerSide<Real> lift{};
  on_both_sides([&](std::size_t side) {
    const PalmAngle<Real>& palm = palms[side];
    const Real p = contacts[side];
    const Real o = offset[side];
    along[side] = (p * palm.sin + o * palm.cos) * turn[side];
    lift[side] = (p * palm.cos - o * palm.sin) * turn[side];
  });
  return span.dx * (change - (along[left] + along[right])) + span.dy * (lift[right] - lift[left]);
}

// The direction in which contacts slide at that rate: up when closing, down when opening.
template <class Real>
constexpr Slide direction_of(Real rate) {
  return rate < Real(0) ? Slide::up : (rate > Real(0) ? Slide::down : Slide::stick);
}

}  // namespace palmbots
