/* SPDX-License-Identifier: Apache-2.0 */
/* Two robots that run the resilient algorithm: the shipped controller and its ear
 * (palmbots/control/resilient.hpp, palmbots/control/mailbox.hpp), called as C.
 *
 * One turn of the loop is one cycle, a beacon period: what the environment does, a step of each robot in
 * an order that stays, and the motion that follows. Both robots send in every step. The radio is an
 * adversary: whatever was ever sent may come at any time, any number of times, in any order, or never,
 * until it is `calm`; then nothing is lost, and everything comes within DELAY cycles.
 *
 * Where SPAN is 0 there are no contacts: at each step the sensors read what an adversary likes. That
 * covers every object, every palm and every disturbance, and is how safety is proved.
 */

c_decl {
\#include "resilient.h"
}
c_track "&pair" "sizeof(struct pair)"
c_code {
  static int cycle_number = 0;
  static void print_robot(int side)
  {
    Printf("  %-5s %+3d %-11s%s %-7s%s%s %-6s", side == LEFT ? "left" : "right", now.p[side], robot_doing(side),
           now.rest[side] ? " rests" : "      ", now.palm[side] == STEEP ? "steep" : "shallow",
           now.turning[side] ? "…" : " ", now.missed[side] ? " naps" : "     ",
           now.rolls[side] == AWAY ? "away" : now.rolls[side] == CLOSER ? "closer" : "");
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
#define STEEP 0
#define SHALLOW 1
#define AWAY 1
#define CLOSER 2
#define NAP 24 /* as in resilient.h */

/* What is asserted. */
#define FALL 1   /* S4: no contact comes off its palm */
#define FIGHT 2  /* S1: never one robot moves away while the other moves closer */
#define PULL 4   /* S2: away only with the own palm steep and the partner's shallow, both at rest */
#define LONE 8   /* S3: closer only to a palm that is steep and at rest, or to a robot in (d) */
                 /* or one that rebooted there and whose palm is still on its way back */
#define ALONE 16 /* nobody travels alone for longer than SKEW cycles */
#define claim(kind, condition) assert(!(ARMED & kind) || (condition))

byte ARMED; /* sum of the above */
byte START; /* contacts start, and bumps leave them, up to so many units off the zero zone */
byte LEASE; /* cycles for which a message counts */
byte HELD_LESS; /* cycles by which a palm stays up for a silent partner for a shorter time than shipped */
byte DELAY; /* cycles that a beacon takes at most when all is well */
byte BRAKING; /* cycles after a move that a robot takes its wheels to brake, */
byte COAST; /* and that they do */
byte JOIN_LESS; /* cycles by which a robot that was ready may start after its partner for a shorter time */
byte NAPS;  /* steps in a row that a robot may miss */
byte TRAVEL; /* units a cycle, to the right: nominal speed over correction speed */
byte SKEW;  /* cycles that nobody may travel alone; 0: travel is left out */
bool CALMS; /* whether faults come to an end */

#include "contacts.pml"

byte reboots;   /* that may still happen */
byte bumps;     /* shifts of a contact by a unit that may still happen; 255: any number */
bool calm;      /* no fault will come any more */
bool goal;      /* contacts at 0, palms steep, robots idle, and on their way */
bool second;    /* which robot steps after the other, for good */
byte wheels[2]; /* what each robot commands its wheels */
byte rolls[2];  /* and what they do; those of a robot that reboots stop at once */
byte coasts[2]; /* for so many cycles more */
bool rest[2];   /* whether it does not travel */
byte missed[2]; /* steps in a row */
bool fainted[2]; /* it has rebooted in (d), and its palm has not come back since */
byte alone;     /* cycles for which one robot has travelled without the other, */
bool loner;     /* namely this one */

/* Of one cycle, and 0 between cycles. */
byte who;
int choices;
byte choice;
byte turn_to;
byte case_of[2];
short net;
byte k;

#define rate(s) ((rolls[s] == CLOSER) - (rolls[s] == AWAY))
#define up(s) (palm[s] == SHALLOW && turning[s] == 0)
#define down(s) (palm[s] == STEEP && turning[s] == 0)

/* One step of robot `who`: the adversary picks a beacon to be heard, if any, and what is felt. */
inline step()
{
  c_code {
    now.choices = choices(now.who, now.SPAN == 0 ? 2 : (now.p[now.who] >= now.WIDTH) - (now.p[now.who] < 0),
                          now.turning[now.who] == 0, now.missed[now.who] + 1, now.calm ? now.DELAY : -1);
  };
  if
  :: choices & (1 << 0) -> choice = 0
  :: choices & (1 << 1) -> choice = 1
  :: choices & (1 << 2) -> choice = 2
  :: choices & (1 << 3) -> choice = 3
  :: choices & (1 << 4) -> choice = 4
  :: choices & (1 << 5) -> choice = 5
  :: choices & (1 << 6) -> choice = 6
  :: choices & (1 << 7) -> choice = 7
  :: choices & (1 << 8) -> choice = 8
  :: choices & (1 << 9) -> choice = 9
  :: choices & (1 << 10) -> choice = 10
  :: choices & (1 << 11) -> choice = 11
  :: choices & (1 << 12) -> choice = 12
  :: choices & (1 << 13) -> choice = 13
  :: choices & (1 << 14) -> choice = 14
  :: choices & (1 << 15) -> choice = 15
  :: choices & (1 << 16) -> choice = 16
  :: choices & (1 << 17) -> choice = 17
  :: choices & (1 << 18) -> choice = 18
  :: choices & (1 << 19) -> choice = 19
  :: choices & (1 << 20) -> choice = 20
  :: choices & (1 << 21) -> choice = 21
  :: choices & (1 << 22) -> choice = 22
  :: choices & (1 << 23) -> choice = 23
  :: !calm && missed[who] < NAPS -> choice = NAP
  fi;
  d_step {
    if
    :: choice < NAP ->
         c_code {
           struct deed done = robot_step(now.who, now.choice, now.turning[now.who] == 0, now.missed[now.who] + 1);
           now.turn_to = done.palm;
           now.wheels[now.who] = done.move;
           now.rest[now.who] = (now.SKEW > 0 || now.SPAN > 0) && done.stop;
         };
         missed[who] = 0; fainted[who] = fainted[who] && turn_to == STEEP
    :: else ->
         turn_to = palm[who];
         missed[who]++
    fi;
    if
    :: wheels[who] != 0 -> rolls[who] = wheels[who]; coasts[who] = COAST
    :: wheels[who] == 0 && coasts[who] > 0 -> coasts[who]--
    :: else -> rolls[who] = 0
    fi;
    turn(who, turn_to);
    fainted[who] = fainted[who] && !down(who);
    choices = 0; choice = 0; turn_to = 0
  }
}

inline environment()
{
  if
  :: !calm && bumps > 0 && SPAN > 0 ->
       if
       :: bumps < 255 -> bumps--
       :: else
       fi;
       if
       :: p[LEFT] < WIDTH - 1 + START -> p[LEFT]++; c_code { Printf("      a bump: left contact outward\n"); }
       :: p[LEFT] > 0 - START -> p[LEFT]--; c_code { Printf("      a bump: left contact inward\n"); }
       :: p[RIGHT] < WIDTH - 1 + START -> p[RIGHT]++; c_code { Printf("      a bump: right contact outward\n"); }
       :: p[RIGHT] > 0 - START -> p[RIGHT]--; c_code { Printf("      a bump: right contact inward\n"); }
       fi
  :: !calm && reboots > 0 ->
       reboots--;
       if
       :: who = LEFT
       :: who = RIGHT
       fi;
       d_step {
         c_code {
           now.fainted[now.who] = robot_case(now.who) == 'd';
           robot_boot(now.who, 1);
           Printf("      %s reboots\n", side_name(now.who));
         };
         wheels[who] = 0; coasts[who] = 0; rest[who] = true; missed[who] = 0; who = 0
       }
  :: !calm && CALMS -> calm = true; c_code { Printf("      faults are over\n"); }
  :: skip
  fi
}

inline move()
{
  if
  :: SPAN > 0 ->
       net = rate(LEFT) + rate(RIGHT) + TRAVEL * (rest[RIGHT] - rest[LEFT]);
       do
       :: net > 0 -> together(); net--
       :: net < 0 -> apart(); net++
       :: net == 0 -> break
       od
  :: else
  fi
}

inline check()
{
  claim(FIGHT, rate(LEFT) * rate(RIGHT) >= 0);
  claim(PULL, rate(LEFT) >= 0 || (down(LEFT) && up(RIGHT)));
  claim(PULL, rate(RIGHT) >= 0 || (down(RIGHT) && up(LEFT)));
  claim(LONE, rate(LEFT) <= 0 || down(RIGHT) || case_of[RIGHT] == 'd' || fainted[RIGHT]);
  claim(LONE, rate(RIGHT) <= 0 || down(LEFT) || case_of[LEFT] == 'd' || fainted[LEFT]);
  claim(FALL, SPAN == 0 || (!fallen(LEFT) && !fallen(RIGHT)));
  claim(ALONE, alone <= SKEW);
  goal = p[LEFT] >= 0 && p[LEFT] < WIDTH && p[RIGHT] >= 0 && p[RIGHT] < WIDTH && down(LEFT) && down(RIGHT) &&
         case_of[LEFT] == ' ' && case_of[RIGHT] == ' ' && !rest[LEFT] && !rest[RIGHT]
}

active proctype cycle()
{
  atomic {
    c_code {
      now.ARMED = parameter("ARMED");
      now.WIDTH = parameter("WIDTH");
      now.SPAN = parameter("SPAN");
      now.EVERYWHERE = parameter("EVERYWHERE");
      now.TURN = parameter("TURN");
      now.START = parameter("START");
      now.LEASE = parameter("LEASE");
      now.HELD_LESS = parameter("HELD_LESS");
      now.DELAY = parameter("DELAY");
      now.BRAKING = parameter("BRAKING");
      now.JOIN_LESS = parameter("JOIN_LESS");
      now.COAST = parameter("COAST");
      now.NAPS = parameter("NAPS");
      now.TRAVEL = parameter("TRAVEL");
      now.SKEW = parameter("SKEW");
      now.CALMS = parameter("CALMS");
      now.reboots = parameter("REBOOTS");
      now.bumps = parameter("BUMPS");
      set_times(now.LEASE, now.DELAY, now.BRAKING, now.NAPS, now.HELD_LESS, now.JOIN_LESS,
                now.SKEW > 0 || now.SPAN > 0);
      robot_boot(LEFT, 0);
      robot_boot(RIGHT, 0);
    };
    rest[LEFT] = true;
    rest[RIGHT] = true;
    if
    :: second = LEFT
    :: second = RIGHT
    fi;
    if
    :: SPAN > 0 ->
         select (k : 0 .. 2 * START + WIDTH - 1);
         p[LEFT] = k - START;
         select (k : 0 .. 2 * START + WIDTH - 1);
         p[RIGHT] = k - START;
         k = 0
    :: else
    fi
  };
  do
  :: atomic {
       environment();
       d_step { c_code { pass_time(); }; who = 1 - second };
       step();
       who = second
     };
     atomic {
       step();
       move();
       d_step {
         alone = (rest[LEFT] == rest[RIGHT] || SKEW == 0 -> 0 : (rest[loner] -> 1 : alone + 1));
         loner = (alone == 1 -> rest[LEFT] : loner * (alone > 1));
         c_code { now.case_of[0] = robot_case(0); now.case_of[1] = robot_case(1); print_cycle(); };
         check();
         case_of[LEFT] = 0; case_of[RIGHT] = 0;
         who = 0
       }
     }
  od
}

/* Once faults are over the goal is reached, and kept. */
ltl converges { <>[] calm -> <>[] goal }
