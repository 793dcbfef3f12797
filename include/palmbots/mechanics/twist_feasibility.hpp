// SPDX-License-Identifier: Apache-2.0
// Twist feasibility: which motions of several contacts a rigid body can make while the palms move,
// and which of them balance.
//
// Frame: world x forward, y up, positions from the COM. A body's twist is (vx, vy, ω · reach). The
// velocity of a contact point relative to the palm obeys these conditions. Along the normal it is
// zero where the contact stays and positive where it leaves. Along the tangent it is zero where the
// contact sticks, positive where it slides up and negative where it slides down. Together they are
// equations and strict inequalities for three unknowns (base/half_spaces.hpp).
#pragma once

#include <bit>

#include "palmbots/base/half_spaces.hpp"
#include "palmbots/mechanics/wrench_cone.hpp"

namespace palmbots {

// The velocities of the palms at the contacts.
using Velocities = std::array<Vec, max_supports>;

// Selections of contacts: which ones each of them leaves out, as bits.
using Selections = FixedList<std::uint32_t, 27>;

// The body's possible twists, built up contact by contact.
class Twists {
 public:
  Twists(const Supports& supports, const Velocities& palms) : count_(supports.size()) {
    const double reach = reach_of(supports);
    double fastest = 0.0;
    for (std::size_t i = 0; i < count_; ++i) fastest = larger(fastest, dot(palms[i], palms[i]));
    // Rates have no scale of their own. Only which of them are zero or positive matters.
    const double pace = fastest > 0.0 ? 1.0 / square_root(fastest) : 1.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const auto condition = [&](Vec direction) {
        const Triple row = supports[i].row(direction, reach);
        const double scale = 1.0 / size(row);
        return LinearCondition{row * scale, dot(direction, palms[i]) * pace * scale};
      };
      normal_[i] = condition(supports[i].normal);
      tangent_[i] = condition(supports[i].tangent);
    }
  }

  // Calls found(motions, k) for every combination of contact motions that is kinematically possible and
  // in which the edges of the friction cones on which forces can lie balance. The contacts that the
  // k-th selection leaves out count as not there and get the motion `leave`.
  template <class Found>
  void each(const Selections& selections, const ContainingCones& balancing, Found found) const {
    Search<Found> search{*this, balancing, found};
    std::uint32_t hold = 0;  // selections that balance where all of their contacts stick
    std::uint32_t edges = 0;
    for (std::size_t k = 0; k < selections.size(); ++k) {
      std::uint32_t own = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        const std::uint32_t is_out = selections[k] >> i & 1;
        search.without[i] |= is_out << k;
        if (is_out == 0) own |= edges_of(Motion::stick) << (2 * i);
      }
      if (!balancing.any(balancing.without(~own & all_edges))) continue;
      hold |= std::uint32_t{1} << k;
      edges |= own;
    }
    HalfSpaces open;
    if (hold != 0) search.descend(0, hold, balancing.without(~edges & all_edges), {}, open);
  }

 private:
  using Forces = ContainingCones::Some;  // sets of edges on which forces can lie and that balance
  static constexpr std::uint32_t all_edges = (std::uint32_t{1} << 2 * max_supports) - 1;

  // Adds the inequality of a contact. False if no twist of the space satisfies it as well.
  bool add(HalfSpaces& open, const SolutionSpace& space, std::size_t i, Motion motion) const {
    const LinearCondition& along = tangent_[i];
    if (motion == Motion::leave) return open.add(space, normal_[i]);
    if (motion == Motion::up) return open.add(space, along);
    return motion == Motion::stick || open.add(space, {along.row * -1.0, -along.value});
  }

  template <class Found>
  struct Search {
    const Twists& twists;
    const ContainingCones& balancing;
    Found& found;
    Motions motions{};
    std::array<std::uint32_t, max_supports> without{};  // each contact: the selections, as bits

    // From contact i on. The earlier ones leave this space, in which their inequalities are `open`;
    // they are the same in all of these selections.
    void descend(std::size_t i, std::uint32_t selections, const Forces& forces,
                 const SolutionSpace& space, HalfSpaces& open) {
      if (i == twists.count_) return found(motions, std::size_t(std::countr_zero(selections)));
      const auto with = [&](Motion motion) {
        const std::uint32_t closed = edges_of(Motion::stick) & ~edges_of(motion);
        return balancing.without(closed << (2 * i), forces);
      };
      const Forces away = with(Motion::leave);
      if (const std::uint32_t out = selections & without[i]; out != 0) {
        motions[i] = Motion::leave;
        if (balancing.any(away)) descend(i + 1, out, away, space, open);
        selections &= ~out;
        if (selections == 0) return;
      }
      const auto go_on = [&](Motion motion, const Forces& rest, const SolutionSpace& in,
                             HalfSpaces& there) {
        motions[i] = motion;
        const std::size_t before = there.size();
        if (balancing.any(rest) && twists.add(there, in, i, motion))
          descend(i + 1, selections, rest, in, there);
        there.keep(before);
      };
      // The inequalities in a part of the space: the same, or `made` anew. None: no twist satisfies
      // them.
      const auto in_part = [&](const SolutionSpace& part, HalfSpaces& made) -> HalfSpaces* {
        if (part.dimension == space.dimension) return &open;
        for (std::size_t k = 0; k < i; ++k) {
          if ((selections & without[k]) == 0 && !twists.add(made, part, k, motions[k]))
            return nullptr;
        }
        return &made;
      };
      SolutionSpace touching = space;
      if (touching.restrict(twists.normal_[i])) {
        SolutionSpace still = touching;
        HalfSpaces made;
        if (still.restrict(twists.tangent_[i]))
          if (HalfSpaces* const there = in_part(still, made))
            go_on(Motion::stick, forces, still, *there);
        const Forces up = with(Motion::up);
        const Forces down = with(Motion::down);
        made.clear();
        if (balancing.any(up) || balancing.any(down)) {
          if (HalfSpaces* const there = in_part(touching, made)) {
            go_on(Motion::up, up, touching, *there);
            go_on(Motion::down, down, touching, *there);
          }
        }
      }
      go_on(Motion::leave, away, space, open);
    }
  };

  static_assert(max_supports <= max_half_spaces);
  std::size_t count_;
  std::array<LinearCondition, max_supports> normal_{};
  std::array<LinearCondition, max_supports> tangent_{};
};

// Which edges of all friction cones balance the weight.
inline ContainingCones balancing_edges(const Supports& supports, double slope) {
  return {rays_of(supports, Motions{}), {slope, 1.0, 0.0}};
}

// Calls found(motions) for every combination of contact motions that is possible and balances.
// There may be none (the body falls or jams) or several.
template <class Found>
void each_outcome(const Supports& supports, const Velocities& palms, double slope, Found found) {
  const ContainingCones balancing = balancing_edges(supports, slope);
  Twists(supports, palms).each({0}, balancing, [&](const Motions& motions, std::size_t) {
    found(motions);
  });
}

}  // namespace palmbots
