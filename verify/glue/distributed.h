/* SPDX-License-Identifier: Apache-2.0 */
/* The shipped controllers as the models see them: plain C around include/palmbots, no logic.
 *
 * The checker keeps the very bytes of the two controllers in its states (c_track) and calls the step
 * that the simulator and a robot call. Numbers are those of the enumerations in control/messages.hpp.
 */
#ifndef PALMBOTS_VERIFY_DISTRIBUTED_H
#define PALMBOTS_VERIFY_DISTRIBUTED_H

#include "common.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Messages: 0 none, 1 TiltUp, 2 TiltDown, 3 Ack. */

/* What a step gives, and what became of the controller. */
struct deed {
  unsigned char palm;
  unsigned char move;
  unsigned char send;
  unsigned char read;     /* the message is used up */
  unsigned char confused; /* … but nobody waited for it */
  unsigned char stirred;  /* the controller has changed */
  unsigned char row_case; /* the case of Table 2 that the step belongs to, or ' ' */
};

extern unsigned char robots[2]; /* two palmbots::TableRobot<Distributed> */

void robot_boot(int side);
struct deed robot_step(int side, int sign, int message, int turned);
int robots_idle(void);
int robots_in_d(void);

const char* message_name(int message);

#ifdef __cplusplus
}
#endif
#endif
