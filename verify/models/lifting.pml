/* SPDX-License-Identifier: Apache-2.0 */
/* Two robots in a job that begins or ends on the floor or on a stand: the shipped table (palmbots/control/lifting.hpp),
 * called as C.
 *
 * One turn of the loop is one cycle: a step of each robot in either order, and the motion of its arm.
 * What a palm feels is an adversary's choice in every cycle, so nothing is assumed about the object
 * and the floor, until the faults are over. Then a robot feels what lets its phase end; docks may
 * still fail. The radio is an adversary as in signs.pml. While a program does not run, the arm holds.
 */

c_decl {
\#include "lifting.h"
}
c_track "&pair" "sizeof(struct pair)"
c_track "&radio" "sizeof(struct radio)"
c_code {
  static int cycle_number = 0;
  static void print_robot(int side)
  {
    Printf("  %-5s arm %2d %-13s", side == LEFT ? "left" : "right", pair.height[side],
           now.down[side] ? "off" : robot_doing(side));
  }
  static void print_cycle(void)
  {
    Printf("%4d", cycle_number++);
    print_robot(LEFT);
    print_robot(RIGHT);
    Printf("\n");
  }
}

#define LEFT 0
#define RIGHT 1

/* What is asserted. */
#define APART 1 /* the heights of the arms differ by what an arm moves in BOUND cycles at most */
#define WORD 2  /* an arm moves only while its robot hears that its partner's may, or does */
#define LEAVE 4 /* no robot takes its palm away while its partner's arm is up */
#define DROP 8  /* no arm that is up is commanded to follow the floor */
#define ALONE 16 /* a robot travels for NOTICE cycles at most while its partner does not */
#define STILL 32 /* where LEVEL holds, wheels move under the object only while both arms are up */
#define claim(kind, condition) assert(!(ARMED & kind) || (condition))

byte ARMED;  /* sum of the above */
byte FIRST;  /* 1: one robot docks first */
byte STAND;  /* 1: the object is on a stand at first */
byte LEVEL;  /* 1: the pair corrects its contacts at level pivots only */
byte LEASE;  /* cycles for which a message counts */
byte DELAY;  /* cycles that a message takes at most when the radio is calm */
byte REACH;  /* tenths of a cycle, from which the limits of the table follow */
byte TOP;    /* cycles in which an arm rises to the height of the carry */
byte STEP;   /* cycles in which it rises by a step of the table */
byte DOWN;   /* cycles for which a robot that reboots is off */
byte BOUND;  /* see APART */
byte NOTICE; /* see ALONE */
bool CALMS;  /* whether faults come to an end */

byte reboots;  /* that may still happen */
bool calm;     /* no fault will come any more */
byte lone[2];  /* cycles for which each robot has heard a partner that did not hear it: LEASE + 1 at
                * most, as beacons.pml proves */
byte down[2];  /* cycles for which a robot is still off */
bool travels[2];
byte alone[2]; /* see ALONE: the cycles in a row for which a robot has travelled alone */
bool over;     /* the job has ended, or needs a person */

/* Of one cycle, and 0 between cycles. */
byte who;
int options;
byte choice;
byte feels;
bool bad;

inline pick(number)
{
  do
  :: options & (1 << number) -> break
  :: options >> (number + 1) -> number++
  od;
  skip
}

/* One step of robot `who`: the adversary picks what it hears and feels. */
inline step()
{
  if
  :: down[who] > 0 -> down[who]--; travels[who] = false
  :: down[who] == 0 ->
       c_code {
         now.options = choices(now.who, now.calm ? now.DELAY : now.LEASE, !now.calm);
         if (!now.calm && now.lone[now.who] > now.LEASE) now.options = 1 << SILENCE;
       };
       pick(choice);
       c_code { now.options = readings(now.who, now.choice, now.calm); };
       pick(feels);
       d_step {
         c_code { now.travels[now.who] = robot_step(now.who, now.choice, now.feels); };
         c_code { now.bad = arm_moves(now.who) && !arm_may_move(now.who); };
         claim(WORD, !bad);
         options = 0; choice = 0; feels = 0; bad = false
       }
  fi
}

inline environment()
{
  if
  :: !calm && reboots > 0 ->
       reboots--;
       if
       :: who = LEFT
       :: who = RIGHT
       fi;
       d_step {
         c_code { robot_boot(now.who); Printf("      %s reboots\n", side_name(now.who)); };
         down[who] = DOWN; travels[who] = false; who = 0
       }
  :: !calm && CALMS && down[LEFT] + down[RIGHT] == 0 ->
       calm = true; c_code { Printf("      faults are over\n"); }
  :: skip
  fi
}

#define travels_alone(s) ((ARMED & ALONE) && travels[s] && !travels[1 - s])

inline check()
{
  c_code {
    int side;
    for (side = 0; side < 2; ++side)
      now.lone[side] = radio.message[side] != 0 && radio.message[1 - side] == 0 ? now.lone[side] + 1 : 0;
  };
  c_code {
    int apart = pair.height[LEFT] - pair.height[RIGHT];
    now.bad = apart > now.BOUND || -apart > now.BOUND;
  };
  claim(APART, !bad);
  c_code {
    int side;
    now.bad = 0;
    for (side = 0; side < 2; ++side)
      now.bad |= !now.down[side] && leaves(side) && pair.height[1 - side] > 0;
  };
  claim(LEAVE, !bad);
  c_code {
    int side;
    now.bad = 0;
    for (side = 0; side < 2; ++side)
      now.bad |= !now.down[side] && arm_follows_floor(side) && pair.height[side] > 0;
  };
  claim(DROP, !bad);
  c_code {
    int side;
    now.bad = 0;
    for (side = 0; side < 2; ++side)
      now.bad |= now.LEVEL && !now.down[side] && corrects(side) &&
                 (pair.height[LEFT] < now.TOP || pair.height[RIGHT] < now.TOP);
  };
  claim(STILL, !bad);
  bad = false;
  alone[LEFT] = (travels_alone(LEFT) -> alone[LEFT] + 1 : 0);
  alone[RIGHT] = (travels_alone(RIGHT) -> alone[RIGHT] + 1 : 0);
  claim(ALONE, alone[LEFT] <= NOTICE && alone[RIGHT] <= NOTICE);
  c_code { now.over = (is_over(LEFT) && is_over(RIGHT)) || (is_held(LEFT) && is_held(RIGHT)); }
}

active proctype cycle()
{
  atomic {
    c_code {
      now.ARMED = parameter("ARMED");
      now.FIRST = parameter("FIRST");
      now.STAND = parameter("STAND");
      now.LEVEL = parameter("LEVEL");
      now.LEASE = parameter("LEASE");
      now.DELAY = parameter("DELAY");
      now.REACH = parameter("REACH");
      now.TOP = parameter("TOP");
      now.STEP = parameter("STEP");
      now.DOWN = parameter("DOWN");
      now.BOUND = parameter("BOUND");
      now.NOTICE = parameter("NOTICE");
      now.CALMS = parameter("CALMS");
      now.reboots = parameter("REBOOTS");
      set_program(now.LEASE, now.REACH, now.TOP, now.STEP, now.STAND, now.LEVEL);
      begin(LEFT);
      begin(RIGHT);
      if (now.FIRST) one_first();
    }
  };
  do
  :: atomic {
       environment();
       c_code { pass_time(); };
       if
       :: who = LEFT
       :: who = RIGHT
       fi;
       step();
       who = 1 - who;
       step();
       who = 0;
       d_step { c_code { print_cycle(); }; check() }
     }
  od
}

/* Once faults are over the job ends, or both robots hold the object until a person helps. */
ltl ends { <>[] calm -> <>[] over }
