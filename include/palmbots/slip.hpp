// Which contact slips, and which way: the two questions that the world asks at every instant.
//
// Source: MECHANICS sections 1 and 2.
#pragma once

#include "palmbots/modes.hpp"
#include "palmbots/stance.hpp"

namespace palmbots {

// The load as it counts for which contact lets go first: with the push, a further sideways specific
// force (an acceleration / g).
template <class V>
constexpr Moments<V> moments_under(const Load<V>& load, V push) {
  return Moments<V>::of(load, load.slope + push);
}

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

// The edges on which contacts that slide in one direction are: `way` is +1 for up and −1 for down.
template <class V>
constexpr PerSide<Edge<V>> edges_at(const PerSide<V>& friction, const PerSide<PalmAngle<V>>& palms,
                                    V way) {
  PerSide<Edge<V>> edges{};
  on_both_sides([&](std::size_t side) {
    edges[side] = leading_edge<V>({palms[side].sin, palms[side].cos}, way * friction[side]);
  });
  return edges;
}

// Contacts of which one has slid, and the span they lead to.
template <class V>
struct Slipped {
  PerSide<V> contacts;
  Span<V> span;
};

// Closes the loop by sliding one contact: the left one, or the right one.
template <class V>
[[gnu::always_inline]] inline Slipped<V> slip(MaskOf<V> on_left, V separation,
                                              const PerSide<PalmAngle<V>>& palms,
                                              const PerSide<V>& contacts, const PerSide<V>& offset,
                                              V width) {
  // Seen from the side of the contact that slides.
  Span<V> base = feet(separation, palms, offset);
  base.dy = select(on_left, base.dy, -base.dy);
  const PalmAngle<V> own = select<V>(on_left, palms[left], palms[right]);
  const PalmAngle<V> partner = select<V>(on_left, palms[right], palms[left]);
  const V held = select(on_left, contacts[right], contacts[left]);
  const Slid<V> next = slid(base, own, partner, held, width);
  return {{select(on_left, next.contact, contacts[left]),
           select(on_left, contacts[right], next.contact)},
          {next.span.dx, select(on_left, next.span.dy, -next.span.dy)}};
}

}  // namespace palmbots
