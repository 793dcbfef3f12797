/* SPDX-License-Identifier: Apache-2.0 */
/* The radio of robots that are tables, as the models of their programs see it.
 *
 * The checker keeps the messages that each robot may still hear: what its partner said in each of the
 * last cycles, without what it has heard already. beacons.h proves for the beacons themselves which
 * messages those are: never an older one after a newer one, and a robot acts on a message only while
 * the lease is no shorter than the age of the message and, at the time when it was said, the age of
 * the newest message that its partner had heard together.
 */
#ifndef PALMBOTS_VERIFY_LEASED_RADIO_H
#define PALMBOTS_VERIFY_LEASED_RADIO_H

#include "common.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { OLDEST = 12, SILENCE = 0, KEEP = 1, HEAR = 2 };

struct radio {
  unsigned char message[2]; /* on which each robot acts; 0: its partner is silent */
  unsigned char age[2];     /* of it, in cycles, */
  unsigned char bound[2];   /* and as the robot bounds it: since what the message echoes was sent */
  unsigned char said[2][OLDEST + 1]; /* to each robot, by age; 0: nothing, or no longer of use */
  unsigned char
      echo[2][OLDEST + 1]; /* how old the newest message was that its partner had heard then */
};
extern struct radio radio;

/* One more cycle has passed. */
void pass_time(void);

/* The choices of an adversary for what a robot hears in its next step, as bits: SILENCE; KEEP, the
 * message that it has; HEAR + n, what its partner said n cycles ago, at most `delay`. `quiet`:
 * whether there may be silence although there is a message. Messages that make no difference are left
 * out. */
int choices(int side, int delay, int quiet);

#ifdef __cplusplus
}
#endif
#endif
