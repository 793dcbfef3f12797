// SPDX-License-Identifier: Apache-2.0
// The state of the world: everything that moves, as numbers, for one carry or for several side by
// side; and what a step of the world did.
#pragma once

#include <cstdint>

#include "palmbots/mechanics/carry_ends.hpp"
#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/mechanics/contact_modes.hpp"

namespace palmbots {

// The positions of robots, palms and contacts.
template <class V>
struct Kinematics {
  Configuration<V> configuration;
  ContactVector<V> contact_vector;
};

// The state that decides which contacts slip.
template <class V>
struct SlipState {
  V push;  // sideways specific force of the pair's acceleration
  V tied;  // ±1: the way in which both contacts slide along their tie (slip_rule.hpp); 0: not
  V multi_contact;  // 1: the object rests on more than its two vertices, or on other contacts
};

// The complete moving state of the world.
template <class V>
struct WorldState : Kinematics<V>, SlipState<V> {};

// What a step did.
template <class Real>
struct Advance {
  DropReason reason = DropReason::none;  // why it ended
  Real fraction = Real(1);               // of the step that was done
  ContactMode motion{};                  // of its last piece
  std::int32_t segments = 1;             // regimes passed through
  // Of robots that stalled: how far the pivots are along x from where the step should have brought
  // them [m], and in which part of the step each robot stalled.
  PerSide<Real> lag{};
  PerSide<double> stalled{};
};

// A small fall: how far a contact vertex fell at most, and how far the COM [m].
struct Fall {
  double height;
  double com;
};

// Times at which the object rested on a further contact, and the latest: what it was, and when it
// began and, unless it lasts, ended, as fractions of the steps in which it did.
template <class Real>
struct ContactEventCounter {
  std::uint32_t count = 0;
  ContactKind kind = ContactKind::none;
  std::size_t side = left;
  Real began = Real(0);
  Real ended = Real(0);
};

}  // namespace palmbots
