/* SPDX-License-Identifier: Apache-2.0 */
/* The shipped controllers `silent` and `shared-sign` as the model sees them: plain C around
 * palmbots/control/table_robot.hpp.
 *
 * A controller is its state and the cycles since it entered it.
 */
#ifndef PALMBOTS_VERIFY_SIGNS_H
#define PALMBOTS_VERIFY_SIGNS_H

#include "leased_radio.h"

#ifdef __cplusplus
extern "C" {
#endif

/* palmbots::TableRobot without its times, and without the message that it hears. */
struct mind {
  unsigned char state;
  unsigned char since_entered;
};

struct pair {
  struct mind mind[2];
};
extern struct pair pair;

struct deed {
  unsigned char palm;
  unsigned char move;
  unsigned char stop;
};

/* `talks`: shared-sign, else silent. The last four are a palmbots::TableTiming, from which the limits
 * of the table follow. All times in cycles. The right robot leads. */
void set_program(int talks, int brake, int lease, int turn, int delay, int reach, int crossing);
void robot_boot(int side);
/* Both robots as they are before the left one starts by itself. */
void start_by_touch(void);

struct deed robot_step(int side, int sign, int choice);
/* A robot that makes no step in a cycle; its message stays the same. */
void robot_skip(int side);
/* Whether a robot of shared-sign sends hardly any beacons in its state. */
int is_quiet(int side);

#ifdef __cplusplus
}
#endif
#endif
