/* SPDX-License-Identifier: Apache-2.0 */
/* The radio of controllers that are tables, as shipped: palmbots/control/mailbox.hpp, and the lease in
 * palmbots/control/table_robot.hpp. What the robots sense and say makes no difference here.
 *
 * Stamps are kept as ages in cycles, as in resilient.h. Ages stop at one more than the lease.
 */
#ifndef PALMBOTS_VERIFY_BEACONS_H
#define PALMBOTS_VERIFY_BEACONS_H

#include "common.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { LONGEST_LEASE = 6 };

/* When something was sent: in which life of the sender (0: never), and how many cycles ago. */
struct stamp {
  unsigned char life;
  unsigned char age;
};

struct robot {
  unsigned char life;
  unsigned char age; /* of the message, as the controller counts it; beyond the lease: silence */
  unsigned char newest_life; /* the stamp of the newest beacon that it has heard */
  unsigned char newest_age;
  unsigned char true_age;   /* of the message */
  unsigned char true_bound; /* cycles since the robot itself sent what the message's beacon echoes */
  unsigned char since_boot;
  unsigned char lone; /* cycles for which it has heard a partner that did not hear it */
};

struct beacon {
  struct stamp sent; /* its age is its place */
  struct stamp heard;
};

struct pair {
  struct robot robot[2];
  struct beacon air[2][LONGEST_LEASE + 1]; /* to each robot, by age */
};
extern struct pair pair;

void set_lease(int lease);
void robot_boot(int side);

/* One more cycle has passed. */
void pass_time(void);

/* The choices of an adversary for the next step of a robot, as bits: 0: it hears nothing; 1 + n: the
 * beacon sent n cycles ago. */
int choices(int side);
/* A step in which the robot hears the beacon sent so many cycles ago; −1: none. */
void robot_step(int side, int age);

/* After both have stepped. */
void note_links(void);
int is_silent(int side);

#ifdef __cplusplus
}
#endif
#endif
