// SPDX-License-Identifier: Apache-2.0
// Everything in the world that moves, as numbers: for one carry or for several side by side.
#pragma once

#include "palmbots/mechanics/loop_closure.hpp"

namespace palmbots {

// Where everything is.
template <class V>
struct Kinematics {
  Configuration<V> configuration;
  ContactVector<V> contact_vector;
};

// What its contacts slide by.
template <class V>
struct SlipState {
  V push;  // sideways specific force of the pair's acceleration
  V tied;  // ±1: the direction in which both contacts slide along their tie; 0: they do not
  V multi_contact;  // 1: the object rests on more, or on something else, than its two vertices
};

// Everything in the world that moves.
template <class V>
struct WorldState : Kinematics<V>, SlipState<V> {};

}  // namespace palmbots
