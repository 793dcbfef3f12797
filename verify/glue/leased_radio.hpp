// SPDX-License-Identifier: Apache-2.0
// The radio behind leased_radio.h; part of the glue of each model that has it.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "leased_radio.h"

namespace glue {

inline int lease = 0;

inline void set_lease(int cycles) {
  lease = cycles;
  if (lease <= OLDEST) return;
  std::fprintf(stderr, "a lease of %d cycles is too long for the model\n", lease);
  std::exit(2);
}

inline void fall_silent(int side) { radio.message[side] = radio.age[side] = radio.bound[side] = 0; }

// What a robot says in this cycle. Of equal messages in a row only the newest is kept: its bound is
// not the greater one, so that hearing it leaves an adversary all that hearing an older one leaves.
// A robot that acts on no message may have heard one just now.
inline void say(int side, int message) {
  unsigned char* said = radio.said[1 - side];
  unsigned char* echo = radio.echo[1 - side];
  said[0] = static_cast<unsigned char>(message);
  echo[0] = radio.message[side] != 0 ? radio.age[side] : 0;
  for (int age = 1; age <= lease; ++age) {
    if (said[age] == 0) continue;
    if (said[age] == said[0]) said[age] = echo[age] = 0;
    break;
  }
}

// A robot has heard what its partner said so many cycles ago. Older messages will be rejected.
inline void hear_said(int side, int age) {
  unsigned char* said = radio.said[side];
  unsigned char* echo = radio.echo[side];
  radio.message[side] = said[age];
  radio.age[side] = static_cast<unsigned char>(age);
  radio.bound[side] = static_cast<unsigned char>(age + echo[age]);
  for (; age <= lease; ++age) said[age] = echo[age] = 0;
}

// Where the next message is the one that a robot has, it may as well have heard it.
inline void refresh(int side) {
  const unsigned char* said = radio.said[side];
  if (radio.message[side] == 0) return;
  int next = radio.age[side] - 1;
  while (next >= 0 && said[next] == 0) --next;
  if (next >= 0 && said[next] == radio.message[side]) hear_said(side, next);
}

// What a robot hears in a step for which the adversary has chosen.
inline int hear(int side, int choice) {
  if (choice == SILENCE) fall_silent(side);
  if (choice >= HEAR) hear_said(side, choice - HEAR);
  refresh(side);
  return radio.message[side];
}

// A robot boots. A beacon counts only if it echoes a message of this life.
inline void forget(int side) {
  fall_silent(side);
  std::fill_n(radio.said[side], lease + 1, 0);
  std::fill_n(radio.echo[side], lease + 1, 0);
}

}  // namespace glue

extern "C" {

struct radio radio;

void pass_time(void) {
  for (int side = 0; side < 2; ++side) {
    unsigned char* said = radio.said[side];
    unsigned char* echo = radio.echo[side];
    for (int age = glue::lease; age >= 0; --age) {
      const bool counts = age > 0 && said[age - 1] != 0 && age + echo[age - 1] <= glue::lease;
      said[age] = counts ? said[age - 1] : 0;
      echo[age] = counts ? echo[age - 1] : 0;
    }
    if (radio.message[side] == 0) continue;
    ++radio.age[side];
    ++radio.bound[side];
  }
}

int choices(int side, int delay, int quiet) {
  glue::refresh(side);
  int mask = 0;
  if (radio.message[side] != 0 && radio.bound[side] <= glue::lease && radio.age[side] <= delay) {
    mask |= 1 << KEEP;
  }
  for (int age = 0; age <= glue::lease && age <= delay; ++age) {
    if (radio.said[side][age] != 0) mask |= 1 << (HEAR + age);
  }
  if (mask == 0 || quiet) mask |= 1 << SILENCE;
  return mask;
}

}  // extern "C"
