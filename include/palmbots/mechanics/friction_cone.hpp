// SPDX-License-Identifier: Apache-2.0
// One vertex of the object on one palm: how it can move, and which forces it can carry.
//
// Frame: world x forward, y up; H is the horizontal force with which the palm pushes the object
// inward, V the vertical one, both seen alike from either side. A contact force leans inward from
// the vertical by atan(H / V). Coulomb friction bounds that lean to [θ − φ, θ + φ], φ = atan μ.
// Source: MECHANICS section 2; the friction cones are Figure 3 of the paper.
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

// The two edges of a friction cone. A contact that slides up is on `up` (lean θ + φ), one that
// slides down on `down` (lean θ − φ).
template <class Real>
struct FrictionCone {
  ConeEdge<Real> up;
  ConeEdge<Real> down;
};

// The upper edge; with −μ the lower one.
template <class Real>
constexpr ConeEdge<Real> leading_edge(SinCos<Real> palm, Real friction) {
  return {palm.sin + friction * palm.cos, palm.cos - friction * palm.sin};
}

template <class Real>
constexpr FrictionCone<Real> friction_cone(SinCos<Real> palm, Real friction) {
  return {{palm.sin + friction * palm.cos, palm.cos - friction * palm.sin},
          {palm.sin - friction * palm.cos, palm.cos + friction * palm.sin}};
}

}  // namespace palmbots
