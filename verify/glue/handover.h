/* SPDX-License-Identifier: Apache-2.0 */
/* The table of jobs in which one robot hands the object to the other one, as shipped
 * (palmbots/control/hand_over.hpp): plain C around palmbots/control/table_robot.hpp.
 */
#ifndef PALMBOTS_VERIFY_HANDOVER_H
#define PALMBOTS_VERIFY_HANDOVER_H

#include "leased_radio.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a robot may feel in a step, as bits: a switch is closed; it has travelled far enough; its palm
 * has turned. */
enum { TOUCHES = 1, FAR = 2, TURNED = 4, READINGS = 8 };

/* palmbots::TableRobot without its times, and without the message that it hears. */
struct mind {
  unsigned char state;
  unsigned char since_entered;
  unsigned char tries;
  unsigned char backs; /* it was backing off in its last step */
};

struct pair {
  struct mind mind[2];
  unsigned char height[2]; /* of the pivots over the floor, in cycles of motion */
};
extern struct pair pair;

/* The limits of the table follow from `reach` (palmbots::TableTiming); arms carry at the height `top`.
 * All times in cycles, `reach` in tenths of one. The right robot leads, so it takes the object. */
void set_program(int lease, int reach, int top);
/* `stores`: it had stored whether the object may have been lifted. */
void robot_boot(int side, int stores);

/* What an adversary may let a robot feel in its next step, in which it hears what `choice` says: one of
 * each that make a difference. `helps`: its palm turns, and it has travelled far enough. */
int readings(int side, int choice, int helps);
void robot_step(int side, int choice, int reading);

/* Whether a robot drives its palm under the object, or raises its arm to find whether it has. */
int picks_up(int side);
/* Whether its wheels move. */
int drives(int side);
int arm_follows_floor(int side);
/* Whether its palm is steep, or becomes so. */
int is_steep(int side);
/* Whether the giver, or the taker, leaves the place at which it is the wall of its partner. */
int leaves_wall(int side);
/* Whether its partner may then do without. */
int needs_no_wall(int side);
int is_over(int side);

#ifdef __cplusplus
}
#endif
#endif
