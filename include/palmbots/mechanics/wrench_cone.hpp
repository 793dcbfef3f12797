// SPDX-License-Identifier: Apache-2.0
// Wrench cone: whether the forces at several frictional contacts can balance a body's weight.
//
// Frame: world x forward, y up, positions from the COM. Forces are in units of the weight. Under a
// sideways specific force s (towards −x, as in mechanics/equilibrium.hpp) the supports must
// together push with (s, 1) through the COM. Each support adds rays to a cone of wrenches (force,
// moment about the COM): both edges of its friction cone where it sticks, the edge that opposes the
// slip where it slides, none where it leaves. With one point on each palm,
// mechanics/contact_modes.hpp gives the same result in closed form.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/base/ray_cone.hpp"
#include "palmbots/base/side.hpp"

namespace palmbots {

// The largest number of points at which the palms support a body: two rays each.
inline constexpr std::size_t max_supports = max_rays / 2;

// How a contact moves on its palm: as `SlipDirection` (up is outward), or it leaves the palm.
enum class Motion : std::int8_t { down = -1, stick = 0, up = 1, leave = 2 };

// +1 of a contact that slides up, −1 of one that slides down, 0 of one that sticks.
constexpr double way_of(Motion motion) { return double(static_cast<int>(motion)); }

// The tangent at a normal; `sense` is +1 where outward is towards +x, −1 where it is towards −x.
constexpr Vec tangent_of(double sense, Vec normal) {
  return {sense * normal.y, -(sense * normal.x)};
}

// A point at which a surface supports the body.
struct Support {
  std::size_t side;  // whose outward direction is that of the tangent
  Vec point;         // from the COM [m]
  Vec normal;        // of unit size, into the body
  Vec tangent;       // in which the body moves where it slides up, that is outward
  double friction;

  static constexpr Support at(std::size_t side, Vec point, Vec normal, double friction) {
    return {side, point, normal, tangent_of(outward<double>(side), normal), friction};
  }
  // The wrench (force, moment / reach) of a force at the point; also the row of a condition on its
  // motion in a direction.
  constexpr Triple row(Vec direction, double reach) const {
    return {direction.x, direction.y, cross(point, direction) / reach};
  }
};

// The points at which the palms support a body, in a fixed order.
using Supports = FixedList<Support, max_supports>;

// The largest distance of a support from the COM [m], by which moments are divided; 1 if it is zero.
inline double reach_of(const Supports& supports) {
  double most = 0.0;
  for (const Support& s : supports) most = larger(most, dot(s.point, s.point));
  return most > 0.0 ? square_root(most) : 1.0;
}

// How each support moves, in the order of Supports.
using Motions = std::array<Motion, max_supports>;

// The edges of a contact's friction cone on which its force can lie, as bits: 1 up, 2 down.
constexpr std::uint32_t edges_of(Motion motion) {
  constexpr std::array<std::uint32_t, 4> edges{2, 3, 1, 0};
  return edges[static_cast<std::size_t>(static_cast<int>(motion) + 1)];
}

// Calls visit(along) for each of these edges: on it, `along` is the friction force per unit of normal
// force, in the direction of a slide up.
template <class Visit>
void each_edge(Motion motion, double friction, Visit visit) {
  if ((edges_of(motion) & 1) != 0) visit(-friction);
  if ((edges_of(motion) & 2) != 0) visit(friction);
}

// Adds the forces of a contact that moves in this way, as rays of unit size.
inline void add_rays(Rays& rays, const Support& s, Motion motion, double reach) {
  each_edge(motion, s.friction, [&](double along) {
    const Triple wrench = s.row(s.normal + s.tangent * along, reach);
    rays.push_back(wrench * (1.0 / size(wrench)));
  });
}

// The rays that the supports add to the wrench cone while they move in this way.
inline Rays rays_of(const Supports& supports, const Motions& motions) {
  const double reach = reach_of(supports);
  Rays rays;
  for (std::size_t i = 0; i < supports.size(); ++i) add_rays(rays, supports[i], motions[i], reach);
  return rays;
}

// Whether the contacts in these motions balance the body, up to rounding.
inline bool balances(const Supports& supports, const Motions& motions, double slope) {
  return !ContainingCones(rays_of(supports, motions), {slope, 1.0, 0.0}).sets().empty();
}

}  // namespace palmbots
