/* SPDX-License-Identifier: Apache-2.0 */
/* The table of jobs that begin or end on the floor or on a stand, as shipped (palmbots/control/lifting.hpp): plain C
 * around palmbots/control/table_robot.hpp.
 */
#ifndef PALMBOTS_VERIFY_LIFTING_H
#define PALMBOTS_VERIFY_LIFTING_H

#include "leased_radio.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a robot may feel in a step; BENEATH: that it is below an object on a stand, which its palm does
 * not touch; FAR_THERE: that it has travelled the distance of its task. */
enum { NOTHING, INWARD, CENTRED, OUTWARD, FAR_THERE, BENEATH, READINGS };

/* palmbots::TableRobot without its times, and without the message that it hears. */
struct mind {
  unsigned char state;
  unsigned char since_entered;
  unsigned char tries;
  unsigned char backs; /* it was backing off in its last step */
};

struct pair {
  struct mind mind[2];
  unsigned char height[2]; /* of the pivots over the floor, or over where they were when
                            * the palms touched the object on a stand, in cycles of motion */
};
extern struct pair pair;

/* The limits of the table follow from `reach` (palmbots::TableTiming); arms carry at the height `top`,
 * and a step of the table is so high. All times in cycles, `reach` in tenths of one. The right robot
 * leads. `from_stand`: the object is on a stand at first. `level`: the pair corrects its contacts at level
 * pivots only. */
void set_program(int lease, int reach, int top, int step, int from_stand, int level);
/* The left robot stands by until the right one is under the object. */
void one_first(void);
void begin(int side);
void robot_boot(int side);

/* What an adversary may let a robot feel in its next step, in which it hears what `choice` says: one of
 * each that make a difference. `helps`: only what lets its phase end. */
int readings(int side, int choice, int helps);
/* Returns whether the robot travels then. */
int robot_step(int side, int choice, int reading);

/* Whether an arm is commanded to move, and the robot hears that it may. */
int arm_moves(int side);
int arm_may_move(int side);
int arm_follows_floor(int side);
/* Whether a robot takes its palm away from under the object. */
int leaves(int side);
/* Whether its controller commands its wheels, if something presses its palm. */
int corrects(int side);
int is_over(int side);
int is_held(int side);

#ifdef __cplusplus
}
#endif
#endif
