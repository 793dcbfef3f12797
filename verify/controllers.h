/* The shipped controllers as the models see them: plain C around include/palmbots, no logic.
 *
 * The checker keeps the very bytes of the two controllers in its states (c_track) and calls the step
 * that the simulator and a robot call. Numbers are those of the enumerations in message.hpp.
 */
#ifndef PALMBOTS_VERIFY_CONTROLLERS_H
#define PALMBOTS_VERIFY_CONTROLLERS_H

#ifdef __cplusplus
extern "C" {
#endif

enum { LEFT, RIGHT };
enum { STEEP, SHALLOW };
enum { HOLD, AWAY, CLOSER };
/* Letters: 0 none, 1 TiltUp, 2 TiltDown, 3 Ack. */

/* What a step gives, and what it tells of the controller. */
struct deed {
  unsigned char palm;
  unsigned char move;
  unsigned char send;
  unsigned char read;     /* the letter is used up */
  unsigned char confused; /* … but nobody waited for it */
  unsigned char stirred;  /* the controller has changed */
  unsigned char row_case; /* the case of Table 2 that the step belongs to, or ' ' */
};

extern unsigned char robots[2]; /* two palmbots::Distributed */

void robot_boot(int side);
struct deed robot_step(int side, int sign, int letter, int turned);
int robots_idle(void);
int robots_in_d(void);
char robot_case(int side);
const char* robot_doing(int side); /* for people */

const char* side_name(int side);
const char* letter_name(int letter);

/* A parameter of the configuration, from the environment; stops the run where it is missing. */
int parameter(const char* name);

#ifdef __cplusplus
}
#endif
#endif
