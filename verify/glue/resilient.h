/* SPDX-License-Identifier: Apache-2.0 */
/* The shipped resilient controllers and their ears as the model sees them: plain C around
 * palmbots/control/resilient.hpp and palmbots/control/mailbox.hpp.
 *
 * What the checker keeps of them is packed (struct pair): a controller is its counters, all bounded. An
 * ear counts ticks without end, but all that it does depends on differences of stamps only; so stamps
 * are kept as ages in cycles, and controllers and ears are made from them for each step. Ages stop at
 * one more than the lease: by then a beacon cannot be fresh, however it came (docs/theory/verification.md).
 */
#ifndef PALMBOTS_VERIFY_RESILIENT_H
#define PALMBOTS_VERIFY_RESILIENT_H

#include "common.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { LONGEST_LEASE = 6, SIGNS = 3, NAP = 3 * (LONGEST_LEASE + 2) };

/* A controller: palmbots::Resilient without its times. */
struct mind {
  unsigned char state;
  unsigned char message;
  unsigned char stopped;
  unsigned char partner_stopped;
  unsigned char partner_ready;
  unsigned char age;
  unsigned char since_asked;
  unsigned char since_ready;
  unsigned char since_moved;
  unsigned char since_turned;
  unsigned char since_entered;
};

/* When something was sent: in which life of the sender (0: never), and how many cycles ago. */
struct stamp {
  unsigned char life : 4;
  unsigned char age : 4;
};

/* A beacon on the air; its age is its place. The life is the sender's, 0 where there is none. */
struct beacon {
  unsigned char message : 4;
  unsigned char stopped : 1;
  unsigned char ready : 1;
  unsigned char life : 2;
  struct stamp heard;
};

struct pair {
  struct mind mind[2];
  unsigned char life[2];
  struct stamp newest[2];                  /* the newest beacon that each robot has heard */
  struct beacon air[2][LONGEST_LEASE + 1]; /* to each robot, by age */
};
extern struct pair pair;

struct deed {
  unsigned char palm;
  unsigned char move;
  unsigned char stop;
};

/* All times in cycles. Of the first four follow those of the table (palmbots::ResilientTiming), less
 * `hold_less` and `join_less`. `travels`: whether to keep what robots know of travelling and resting. */
void set_times(int lease, int delay, int braking, int naps, int hold_less, int join_less,
               int travels);
void robot_boot(int side, int again);

/* One more cycle has passed. */
void pass_time(void);

/* The choices of an adversary for the next step of a robot, as bits: choice = 3 × heard + sign + 1,
 * heard: none (0) or the beacon sent `heard` − 1 cycles ago. Of choices with the same outcome only the
 * first. `sign`: −1, 0, 1, or 2 for any. With `delay` ≥ 0 all is well: a beacon comes within so many cycles. */
int choices(int side, int sign, int turned, int elapsed, int delay);
struct deed robot_step(int side, int choice, int turned, int elapsed);

#ifdef __cplusplus
}
#endif
#endif
