// SPDX-License-Identifier: Apache-2.0
// Friction cones: how one vertex of the object can move on a palm, and which forces it can carry.
//
// Frame: world x forward, y up. H is the horizontal force with which the palm pushes the object
// inward, V the vertical one; both have the same sign convention on either side. A contact force
// leans inward from the vertical by atan(H / V). Coulomb friction bounds that lean to [θ − φ, θ +
// φ], φ = atan μ. Source: docs/theory/mechanics.md; the friction cones are Figure 3 of the paper.
#pragma once

#include <cstdint>

#include "palmbots/base/scalar.hpp"

namespace palmbots {

// How a contact moves on its palm: down is inward (towards the partner), up is outward.
// The paper's names: on the left palm up = SL and down = SR, on the right palm up = SR, down = SL.
enum class SlipDirection : std::int8_t { down = -1, stick = 0, up = 1 };

// One edge of a friction cone, as the direction (lateral, vertical) of the force on it, so that
// tan(lean) = lateral / vertical. Not normalized: with T = tan θ it is cos θ · (T ± μ, 1 ∓ μT).
template <class Real>
struct ConeEdge {
  Real lateral;
  Real vertical;
};

// The two edges of a friction cone. The force on a contact that slides up lies on `up` (lean θ +
// φ), the force on one that slides down lies on `down` (lean θ − φ).
template <class Real>
struct FrictionCone {
  ConeEdge<Real> up;
  ConeEdge<Real> down;
};

// The friction cone of a palm at this angle; `friction` is μ. With −μ, the edges change places.
template <class Real>
constexpr FrictionCone<Real> friction_cone(SinCos<Real> palm, Real friction) {
  return {{palm.sin + friction * palm.cos, palm.cos - friction * palm.sin},
          {palm.sin - friction * palm.cos, palm.cos + friction * palm.sin}};
}

}  // namespace palmbots
