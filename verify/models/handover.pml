/* SPDX-License-Identifier: Apache-2.0 */
/* Two robots in a job in which one hands the object to the other: the shipped table
 * (palmbots/control/hand_over.hpp), called as C. The right robot leads, so it takes the object.
 *
 * One turn of the loop is one cycle: a step of each robot in either order, and the motion of its arm.
 * What a palm feels, when it has turned and how far a robot has travelled is an adversary's choice in
 * every cycle, so nothing is assumed about the object and the floor. Once the faults are over, palms
 * turn and robots arrive; palms still feel anything. The radio is an adversary as in signs.pml. While a
 * program does not run, wheels and arm hold.
 */

c_decl {
\#include "handover.h"
}
c_track "&pair" "sizeof(struct pair)"
c_track "&radio" "sizeof(struct radio)"
c_code {
  static int cycle_number = 0;
  static void print_robot(int side)
  {
    Printf("  %-5s arm %2d %-12s", side == LEFT ? "left" : "right", pair.height[side],
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
#define WALL 1 /* while a robot picks the object up, its partner's wheels stand */
#define ONE 2  /* at most one arm is up */
#define DROP 4 /* no arm that is up is commanded to follow the floor, or its palm to become steep */
#define LEAVE 8 /* a robot leaves its place as a wall only when its partner holds the object, or has failed */
#define claim(kind, condition) assert(!(ARMED & kind) || (condition))

byte ARMED;  /* sum of the above */
byte LEASE;  /* cycles for which a message counts */
byte DELAY;  /* cycles that a message takes at most when the radio is calm */
byte REACH;  /* tenths of a cycle, from which the limits of the table follow */
byte TOP;    /* cycles in which an arm rises to the height of the carry */
byte DOWN;   /* cycles for which a robot that reboots is off */
bool STORES; /* whether a robot stores that the object may have been lifted */
bool CALMS;  /* whether faults come to an end */

byte reboots;  /* that may still happen */
bool calm;     /* no fault will come any more */
byte lone[2];  /* cycles for which each robot has heard a partner that did not hear it: LEASE + 1 at
                * most, as beacons.pml proves */
byte down[2];  /* cycles for which a robot is still off */
bool over;     /* both robots are done, or need a person */

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
  :: down[who] > 0 -> down[who]--
  :: down[who] == 0 ->
       c_code {
         now.options = choices(now.who, now.calm ? now.DELAY : now.LEASE, !now.calm);
         if (!now.calm && now.lone[now.who] > now.LEASE) now.options = 1 << SILENCE;
       };
       pick(choice);
       c_code { now.options = readings(now.who, now.choice, now.calm); };
       pick(feels);
       d_step {
         c_code { robot_step(now.who, now.choice, now.feels); };
         options = 0; choice = 0; feels = 0
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
         c_code {
           robot_boot(now.who, now.STORES);
           Printf("      %s reboots\n", side_name(now.who));
         };
         down[who] = DOWN; who = 0
       }
  :: !calm && CALMS && down[LEFT] + down[RIGHT] == 0 ->
       calm = true; c_code { Printf("      faults are over\n"); }
  :: skip
  fi
}

inline check()
{
  c_code {
    int side;
    for (side = 0; side < 2; ++side)
      now.lone[side] = radio.message[side] != 0 && radio.message[1 - side] == 0 ? now.lone[side] + 1 : 0;
  };
  c_code {
    int side;
    now.bad = 0;
    for (side = 0; side < 2; ++side)
      now.bad |= !now.down[side] && drives(side) && !now.down[1 - side] && picks_up(1 - side);
  };
  claim(WALL, !bad);
  claim(ONE, c_expr { pair.height[LEFT] == 0 || pair.height[RIGHT] == 0 });
  c_code {
    int side;
    now.bad = 0;
    for (side = 0; side < 2; ++side)
      now.bad |= !now.down[side] && pair.height[side] > 0 && (arm_follows_floor(side) || is_steep(side));
  };
  claim(DROP, !bad);
  c_code {
    int side;
    now.bad = 0;
    for (side = 0; side < 2; ++side)
      now.bad |= !now.down[side] && leaves_wall(side) && !needs_no_wall(1 - side);
  };
  claim(LEAVE, !bad);
  bad = false;
  c_code { now.over = is_over(LEFT) && is_over(RIGHT); }
}

active proctype cycle()
{
  atomic {
    c_code {
      now.ARMED = parameter("ARMED");
      now.LEASE = parameter("LEASE");
      now.DELAY = parameter("DELAY");
      now.REACH = parameter("REACH");
      now.TOP = parameter("TOP");
      now.DOWN = parameter("DOWN");
      now.STORES = parameter("STORES");
      now.CALMS = parameter("CALMS");
      now.reboots = parameter("REBOOTS");
      set_program(now.LEASE, now.REACH, now.TOP);
      robot_boot(LEFT, 0);
      robot_boot(RIGHT, 0);
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

/* Once faults are over the job ends: each robot is done, or has failed. */
ltl ends { <>[] calm -> <>[] over }
