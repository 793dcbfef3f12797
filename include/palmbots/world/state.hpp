// SPDX-License-Identifier: Apache-2.0
// The state of the world: everything that moves, as numbers, for one carry or for several side by
// side.
#pragma once

#include "palmbots/mechanics/loop_closure.hpp"

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

}  // namespace palmbots
