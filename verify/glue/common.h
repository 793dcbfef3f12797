/* SPDX-License-Identifier: Apache-2.0 */
/* What the glue of both models shares: numbers of the enumerations in control/messages.hpp, and what the
 * models ask of a robot and of the configuration of a run.
 */
#ifndef PALMBOTS_VERIFY_COMMON_H
#define PALMBOTS_VERIFY_COMMON_H

#include <stdio.h>
#include <stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LEFT, RIGHT };
enum { STEEP, SHALLOW };
enum { HOLD, AWAY, CLOSER };

/* Of a robot: the case of Table 2 that it is in, or ' '; and what it does, for people. */
char robot_case(int side);
const char* robot_doing(int side);

static inline const char* side_name(int side) { return side == LEFT ? "left" : "right"; }

/* A parameter of the configuration, from the environment; stops the run where it is missing. */
static inline int parameter(const char* name) {
  const char* value = getenv(name);
  if (value) return atoi(value);
  fprintf(stderr, "parameter %s is not set\n", name);
  exit(2);
}

#ifdef __cplusplus
}

#include "palmbots/control/messages.hpp"

static_assert(STEEP == static_cast<int>(palmbots::Palm::steep));
static_assert(SHALLOW == static_cast<int>(palmbots::Palm::shallow));
static_assert(HOLD == static_cast<int>(palmbots::Move::hold));
static_assert(AWAY == static_cast<int>(palmbots::Move::away));
static_assert(CLOSER == static_cast<int>(palmbots::Move::closer));
#endif
#endif
