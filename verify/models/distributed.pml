/* SPDX-License-Identifier: Apache-2.0 */
/* Two robots that run Table 2 of the paper: the shipped controller (palmbots/control/distributed.hpp), called as C.
 *
 * One turn of the loop is one control cycle: what the environment does, a step of each robot in either
 * order or both at once, and the motion that follows. Messages wait in line until they are read. On a
 * prompt radio a message is there at the receiver's next step. The parameters of a run (runs.toml)
 * switch on one fault or another and arm the assertions.
 */

c_decl {
\#include "distributed.h"
}
c_track "robots" "sizeof(robots)"
c_code {
  /* One line a cycle, only when a trail is replayed. */
  static int cycle_number = 0;
  static void print_robot(int side)
  {
    Printf("  %-5s %+3d (%c) %-7s%s %-20s", side == LEFT ? "left" : "right", now.p[side], robot_case(side),
           now.palm[side] == STEEP ? "steep" : "shallow", now.turning[side] ? "…" : " ", robot_doing(side));
  }
  static void print_message(const char *fate)
  {
    Printf("      %s sends %s%s\n", side_name(now.who), message_name(now.sent[now.who]), fate);
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

/* What is asserted. */
#define FALL 1      /* no contact comes off its palm */
#define FIGHT 2     /* never one robot moves away while the other moves closer */
#define CONFUSED 4  /* nobody reads a message that it does not wait for */
#define HANG 8      /* nobody waits where nothing more can come */
#define RISE 16     /* |p_L| + |p_R| never rises */
#define LONE 32     /* nobody moves closer to a shallow palm, unless both are in (d) */
#define claim(kind, condition) assert(!(ARMED & kind) || (condition))

byte ARMED;     /* sum of the above */
byte START;     /* contacts start, and bumps leave them, up to so many units off the zero zone */
byte SPEED;     /* units that a robot moves in a cycle */
byte LATENCY;   /* age of the sensor readings: 0, 1 or 2 cycles */
byte COAST;     /* cycles that the wheels run on after a command: 0 or 1 */
byte LOSE_CASE; /* the case and … */
byte LOSE;      /* … the message of the send that may be lost, once */
byte COPY;      /* the message that may be duplicated, once; the duplicate comes at any time */
byte LATE;      /* the message that may take any time */

#include "contacts.pml"

chan air[2] = [8] of { byte }; /* messages to each robot */
byte ghost[2];                 /* a duplicate on its way to each robot */
byte mishaps;                  /* losses or duplicates that may still happen */
byte reboots;                  /* reboots that may still happen */
byte bumps;                    /* shifts of a contact by a unit that may still happen; 255: any number */
bool calm;                     /* no bump will come any more */
bool goal;                     /* contacts at 0, palms steep, robots idle, nothing on the air */

byte wheels[2];  /* what each robot commands its wheels */
byte before[2];  /* and commanded a cycle ago */
short was[2];    /* the contacts a cycle ago */
short earlier[2];/* and two */

/* Of one cycle, and 0 between cycles. */
byte who;
short at;        /* where it feels its contact */
byte heard;
byte sent[2];
byte case_of[2]; /* of the send */
byte turn_to;    /* the palm's command */
bool taken;
bool stray;
bool stirred;    /* something changed */
byte off;        /* |p_L| + |p_R| before the motion */
byte k;
bool both_idle;
bool both_in_d;
short net;       /* units that the robots still come together */

#define motion(s) (COAST == 0 -> wheels[s] : before[s])
#define felt(s) (LATENCY == 0 -> p[s] : (LATENCY == 1 -> was[s] : earlier[s]))
#define beyond(x) (x < 0 -> 0 - x : (x >= WIDTH -> x - WIDTH + 1 : 0))
#define distance (beyond(p[LEFT]) + beyond(p[RIGHT]))
#define quiet (len(air[LEFT]) + len(air[RIGHT]) == 0)
#define rate(s) ((motion(s) == CLOSER) - (motion(s) == AWAY))

/* One step of robot `who`. Where its message may be late, perhaps it is not there yet. */
inline step()
{
  if
  :: nempty(air[who]) -> air[who]?<heard>
  :: air[who]?[eval(LATE)] -> skip
  :: empty(air[who])
  fi;
  d_step {
    at = felt(who);
    c_code {
      struct deed done = robot_step(now.who, (now.at >= now.WIDTH) - (now.at < 0), now.heard,
                                    now.turning[now.who] == 0);
      now.turn_to = done.palm;
      now.wheels[now.who] = done.move;
      now.sent[now.who] = done.send;
      now.case_of[now.who] = done.row_case;
      now.taken = done.read;
      now.stray = now.stray || done.confused;
      now.stirred = now.stirred || done.stirred || now.turning[now.who] > 0;
    };
    if
    :: taken -> air[who]?heard
    :: else
    fi;
    turn(who, turn_to);
    at = 0; heard = 0; turn_to = 0; taken = 0
  }
}

/* Puts what `who` sends on the air. */
inline post()
{
  if
  :: sent[who] != 0 -> air[1 - who]!sent[who]; c_code { print_message(""); }
  :: sent[who] != 0 && mishaps > 0 && sent[who] == COPY ->
       mishaps--; air[1 - who]!sent[who]; ghost[1 - who] = sent[who]; c_code { print_message(", copied"); }
  :: sent[who] != 0 && mishaps > 0 && sent[who] == LOSE && case_of[who] == LOSE_CASE ->
       mishaps--; c_code { print_message(", lost"); }
  :: sent[who] == 0
  fi;
  stirred = stirred || sent[who] != 0;
  sent[who] = 0; case_of[who] = 0
}

/* What the world does to the robots before they look. */
inline environment()
{
  if
  :: !calm && bumps > 0 ->
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
  :: reboots > 0 ->
       reboots--;
       if
       :: who = LEFT
       :: who = RIGHT
       fi;
       c_code { robot_boot(now.who); Printf("      %s reboots\n", side_name(now.who)); };
       who = 0
  :: ghost[LEFT] != 0 -> air[LEFT]!ghost[LEFT]; ghost[LEFT] = 0; c_code { Printf("      the copy comes to left\n"); }
  :: ghost[RIGHT] != 0 -> air[RIGHT]!ghost[RIGHT]; ghost[RIGHT] = 0; c_code { Printf("      the copy comes to right\n"); }
  :: !calm -> calm = true
  :: skip
  fi
}

/* The robots' motion: one unit after the other. Away against closer leaves the separation as it is. */
inline move()
{
  stirred = stirred || motion(LEFT) != 0 || motion(RIGHT) != 0 || wheels[LEFT] != 0 || wheels[RIGHT] != 0;
  off = distance;
  net = SPEED * (rate(LEFT) + rate(RIGHT));
  do
  :: net > 0 -> together(); net--
  :: net < 0 -> apart(); net++
  :: net == 0 -> break
  od
}

inline check()
{
  claim(FALL, !fallen(LEFT) && !fallen(RIGHT));
  claim(FIGHT, rate(LEFT) * rate(RIGHT) >= 0);
  claim(CONFUSED, !stray);
  claim(RISE, distance <= off);
  claim(LONE, !(rate(LEFT) > 0 && palm[RIGHT] == SHALLOW && !both_in_d));
  claim(LONE, !(rate(RIGHT) > 0 && palm[LEFT] == SHALLOW && !both_in_d));
  goal = both_idle && distance == 0 && settled &&
         palm[LEFT] == STEEP && palm[RIGHT] == STEEP && quiet;
  claim(HANG, stirred || !settled || !quiet || goal)
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
      now.SPEED = parameter("SPEED");
      now.LATENCY = parameter("LATENCY");
      now.COAST = parameter("COAST");
      now.LOSE_CASE = parameter("LOSE_CASE");
      now.LOSE = parameter("LOSE");
      now.COPY = parameter("COPY");
      now.LATE = parameter("LATE");
      now.mishaps = now.LOSE != 0 || now.COPY != 0;
      now.reboots = parameter("REBOOTS");
      now.bumps = parameter("BUMPS");
      now.calm = now.bumps == 0;
      robot_boot(LEFT);
      robot_boot(RIGHT);
    };
    select (k : 0 .. 2 * START + WIDTH - 1);
    p[LEFT] = k - START;
    select (k : 0 .. 2 * START + WIDTH - 1);
    p[RIGHT] = k - START;
    k = 0;
    was[LEFT] = p[LEFT]; was[RIGHT] = p[RIGHT];
    earlier[LEFT] = p[LEFT]; earlier[RIGHT] = p[RIGHT];
  };
  do
  :: atomic {
       environment();
       /* Who steps first, and whether the other hears of it in the same cycle. */
       if
       :: who = LEFT
       :: who = RIGHT
       fi;
       step();
       if
       :: post()
       :: skip
       fi;
       who = 1 - who;
       step();
       post();
       who = 1 - who;
       post();
       d_step {
         earlier[LEFT] = (LATENCY > 1 -> was[LEFT] : 0);
         earlier[RIGHT] = (LATENCY > 1 -> was[RIGHT] : 0);
         was[LEFT] = (LATENCY > 0 -> p[LEFT] : 0);
         was[RIGHT] = (LATENCY > 0 -> p[RIGHT] : 0)
       };
       move();
       d_step {
         c_code { print_cycle(); now.both_idle = robots_idle(); now.both_in_d = robots_in_d(); };
         check();
         before[LEFT] = (COAST > 0 -> wheels[LEFT] : 0);
         before[RIGHT] = (COAST > 0 -> wheels[RIGHT] : 0);
         who = 0; stray = false; stirred = false; off = 0;
         both_idle = false; both_in_d = false
       }
     }
  od
}

/* Once bumps are over the goal is reached, and kept. */
ltl converges { <>[] calm -> <>[] goal }
