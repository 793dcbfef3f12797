/* SPDX-License-Identifier: Apache-2.0 */
/* Two robots that run `silent` or `shared-sign`: the shipped program of a table
 * (palmbots/control/table_robot.hpp), called as C.
 *
 * One turn of the loop is one cycle: what the environment does, a step of each robot in either order, and
 * the motion that follows. The radio is an adversary: a robot hears any message that its partner
 * said in the last LEASE cycles, never an older one after a newer one, or nothing, until the radio
 * is `calm`. Then the message is at most DELAY cycles old.
 */

c_decl {
\#include "signs.h"
}
c_track "&pair" "sizeof(struct pair)"
c_track "&radio" "sizeof(struct radio)"
c_code {
  static int cycle_number = 0;
  static void print_robot(int side)
  {
    Printf("  %-5s %+3d %-16s%s %-7s%s%s %-6s", side == LEFT ? "left" : "right", now.p[side],
           now.down[side] ? "off" : robot_doing(side), now.rest[side] ? " rests" : "      ",
           now.palm[side] == STEEP ? "steep" : "shallow", now.turning[side] ? "…" : " ",
           now.missed[side] ? " naps" : "     ",
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

/* What is asserted. */
#define FALL 1    /* no contact goes beyond the bound */
#define FIGHT 2   /* robots that hear each other move against each other for OPPOSED cycles at most */
#define STOP 4    /* never do both robots stop that hear each other */
#define ALONE 8   /* a robot travels for NOTICE cycles at most while its partner is off or waits to start */
#define ARRIVE 16 /* WITHIN cycles after faults are over both contacts are at 0, and stay */
#define claim(kind, condition) assert(!(ARMED & kind) || (condition))

byte ARMED; /* sum of the above */
byte START; /* contacts start up to so many units off the zero zone */
byte TALKS; /* 1: shared-sign, 0: silent */
byte BRAKE; /* whether a robot may stop as a correction */
byte LEASE; /* cycles for which a message counts */
byte DELAY; /* cycles that a message takes at most when the radio is calm */
byte LINKS; /* how often a robot may begin to hear its partner before the radio is calm; 255: any number */
byte REACH; /* cycles in which a correction moves a contact from the end of a palm to 0, as the table has it */
byte COAST; /* cycles that the wheels lag behind the command: 0 or 1 */
byte NAPS;  /* 1: a robot whose clock is slow may miss a step without knowing it, */
byte APART; /* after so many cycles without one missed, */
byte SLOW;  /* 1: also when the radio is calm */
byte TRAVEL; /* units a cycle, to the right: nominal speed over correction speed */
byte DOWN;  /* cycles for which a robot that reboots is off */
byte FAIR;  /* times in a row that the same contact slides where no property speaks; 0: any number */
byte OPPOSED; /* see FIGHT */
byte NOTICE; /* see ALONE */
byte TOUCH; /* 1: the left robot starts, and the right one when it feels that */
byte CROSS; /* cycles in which a robot that starts crosses the zero zone, as the table has it */
byte READY; /* 1: at the start the palms are already where a start by touch wants them */
byte FEELS; /* 1: while a robot is off, the contact of the other one slides where no property speaks, */
            /* and the left robot does not reboot while a property says otherwise */
byte KEPT;  /* until the radio is calm, no contact goes farther off the zone; 0: it may */
byte WITHIN; /* see ARRIVE */
byte HUSH;  /* cycles for which robots that were both quiet may still hear nothing when the radio is calm: */
            /* one of them speaks, the other one answers, and is answered */
byte NEAR;  /* units by which a contact at its goal may be off the zone */
bool CALMS; /* whether faults come to an end */

#include "contacts.pml"

byte links[2];  /* how often each robot may still begin to hear its partner */
byte lone[2];   /* cycles for which each robot has heard a partner that did not hear it: LEASE + 1 at
                 * most, as beacons.pml proves */
byte reboots;   /* that may still happen */
byte bumps;     /* shifts of a contact by a unit that may still happen */
bool calm;      /* no fault will come any more */
bool goal;      /* both contacts at 0, or NEAR it */
byte hush;      /* see HUSH */
byte since;     /* cycles since the radio is calm, see ARRIVE */
byte wheels[2]; /* what each robot commands its wheels */
byte rolls[2];  /* and what they do */
bool rest[2];   /* whether it does not travel */
byte missed[2]; /* whether it misses its step */
byte wait;      /* cycles until a step may be missed again */
byte down[2];   /* cycles for which it is still off */
bool begun;     /* the right robot has started */
byte alone;     /* see ALONE */
byte opposed;   /* cycles for which one robot has moved away and the other closer, while they hear each other */
byte streak;    /* times in a row that a contact slid where no property speaks, */
bool slid;      /* namely this one */

/* Of one cycle, and 0 between cycles. */
byte who;
int options;
byte choice;
byte turn_to;
short net;
short at;
bool tie;
byte k;

#define rate(s) ((rolls[s] == CLOSER) - (rolls[s] == AWAY))
#define sign(s) ((p[s] >= WIDTH) - (p[s] < 0))
#define both_hear (c_expr { radio.message[LEFT] != 0 && radio.message[RIGHT] != 0 })
#define linked (c_expr { radio.message[now.who] != 0 })

/* One step of robot `who`: the adversary picks what it hears. */
inline step()
{
  if
  :: down[who] > 0 -> down[who]--; rolls[who] = 0; turn(who, palm[who])
  :: down[who] == 0 && (!calm || SLOW) && missed[who] < NAPS && wait == 0 ->
       d_step {
         missed[who] = 1; wait = APART;
         c_code { robot_skip(now.who); };
         rolls[who] = wheels[who];
         turn(who, palm[who])
       }
  :: down[who] == 0 ->
       d_step {
         c_code { now.options = choices(now.who, now.calm ? now.DELAY : now.LEASE, !now.calm || now.hush > 0); };
         if
         :: !calm && ((links[who] == 0 && !linked) || lone[who] > LEASE) -> options = 1
         :: else
         fi
       };
       do
       :: options & (1 << choice) -> break
       :: options >> (choice + 1) -> choice++
       od;
       skip;
       d_step {
         if
         :: choice > 0 && !linked && !calm && links[who] < 255 -> links[who]--
         :: else
         fi;
         rolls[who] = (COAST > 0 -> wheels[who] : 0);
         c_code {
           struct deed done = robot_step(now.who, (now.p[now.who] >= now.WIDTH) - (now.p[now.who] < 0), now.choice);
           now.turn_to = done.palm;
           now.wheels[now.who] = done.move;
           now.rest[now.who] = done.stop;
         };
         rolls[who] = (COAST > 0 -> rolls[who] : wheels[who]);
         missed[who] = 0;
         turn(who, turn_to);
         options = 0; choice = 0; turn_to = 0
       }
  fi
}

inline environment()
{
  if
  :: !calm && bumps > 0 ->
       bumps--;
       if
       :: p[LEFT]++; c_code { Printf("      a bump: left contact outward\n"); }
       :: p[LEFT]--; c_code { Printf("      a bump: left contact inward\n"); }
       :: p[RIGHT]++; c_code { Printf("      a bump: right contact outward\n"); }
       :: p[RIGHT]--; c_code { Printf("      a bump: right contact inward\n"); }
       fi
  :: !calm && reboots > 0 ->
       reboots--;
       if
       :: !(FEELS && only_shallow(RIGHT)) -> who = LEFT
       :: who = RIGHT
       fi;
       d_step {
         c_code { robot_boot(now.who); Printf("      %s reboots\n", side_name(now.who)); };
         down[who] = DOWN; wheels[who] = 0; rolls[who] = 0; rest[who] = true; missed[who] = 0; who = 0
       }
  :: !calm && CALMS && down[LEFT] + down[RIGHT] == 0 ->
       calm = true;
       if
       :: !SLOW -> missed[LEFT] = 0; missed[RIGHT] = 0; wait = 0
       :: else
       fi;
       c_code { Printf("      faults are over\n"); }
  :: skip
  fi
}

/* Which contact slid in the last unit of motion, and whether an adversary had the choice. */
inline note()
{
  d_step {
    if
    :: FAIR > 0 && tie ->
         streak = (slid == (at == p[LEFT]) -> streak + 1 : 1);
         slid = (at == p[LEFT])
    :: else
    fi;
    at = 0; tie = false
  }
}
#define chooses(s) (!tie || ((FAIR == 0 || slid != s || streak < FAIR) && !(FEELS && down[s] > 0)))

/* An object that stays on the palms, whatever happens. */
inline keep(s)
{
  if
  :: KEPT > 0 && !calm && p[s] < 0 - KEPT -> p[s] = 0 - KEPT
  :: KEPT > 0 && !calm && p[s] > WIDTH - 1 + KEPT -> p[s] = WIDTH - 1 + KEPT
  :: else
  fi
}

inline move()
{
  net = rate(LEFT) + rate(RIGHT) + TRAVEL * (rest[RIGHT] - rest[LEFT]);
  do
  :: net > 0 ->
       at = p[LEFT]; tie = !slides_up(LEFT) && !slides_up(RIGHT);
       if
       :: !slides_up(RIGHT) && chooses(LEFT) -> p[LEFT]++
       :: !slides_up(LEFT) && chooses(RIGHT) -> p[RIGHT]++
       fi;
       note(); net--
  :: net < 0 ->
       at = p[LEFT]; tie = !slides_down(LEFT) && !slides_down(RIGHT);
       if
       :: !slides_down(RIGHT) && chooses(LEFT) -> p[LEFT]--
       :: !slides_down(LEFT) && chooses(RIGHT) -> p[RIGHT]--
       fi;
       note(); net++
  :: net == 0 -> break
  od;
  keep(LEFT);
  keep(RIGHT)
}

/* Whether a robot neither travels nor stops as a correction. */
#define stands(s) (down[s] > 0 || (s == RIGHT && !begun))

#define near(s) (p[s] >= 0 - NEAR && p[s] < WIDTH + NEAR)

inline check()
{
  c_code {
    int side;
    for (side = 0; side < 2; ++side)
      now.lone[side] = radio.message[side] != 0 && radio.message[1 - side] == 0 ? now.lone[side] + 1 : 0;
    if (now.hush > 0) --now.hush;
    if (now.calm && is_quiet(LEFT) && is_quiet(RIGHT)) now.hush = now.HUSH;
  };
  opposed = (rate(LEFT) * rate(RIGHT) < 0 && both_hear && (ARMED & FIGHT) -> opposed + 1 : 0);
  claim(FIGHT, opposed <= OPPOSED);
  begun = begun || !rest[RIGHT];
  alone = ((ARMED & ALONE) && ((stands(LEFT) && !rest[RIGHT]) || (stands(RIGHT) && !rest[LEFT])) -> alone + 1 : 0);
  claim(ALONE, alone <= NOTICE);
  claim(STOP, !(rest[LEFT] && rest[RIGHT] && both_hear));
  claim(FALL, !fallen(LEFT) && !fallen(RIGHT));
  wait = (wait > 0 -> wait - 1 : 0);
  goal = near(LEFT) && near(RIGHT);
  since = (calm && (ARMED & ARRIVE) && since <= WITHIN -> since + 1 : since);
  claim(ARRIVE, since <= WITHIN || goal)
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
      now.TALKS = parameter("TALKS");
      now.BRAKE = parameter("BRAKE");
      now.LEASE = parameter("LEASE");
      now.DELAY = parameter("DELAY");
      now.LINKS = parameter("LINKS");
      now.REACH = parameter("REACH");
      now.COAST = parameter("COAST");
      now.NAPS = parameter("NAPS");
      now.APART = parameter("APART");
      now.SLOW = parameter("SLOW");
      now.TRAVEL = parameter("TRAVEL");
      now.DOWN = parameter("DOWN");
      now.FAIR = parameter("FAIR");
      now.OPPOSED = parameter("OPPOSED");
      now.NOTICE = parameter("NOTICE");
      now.TOUCH = parameter("TOUCH");
      now.CROSS = parameter("CROSS");
      now.READY = parameter("READY");
      now.FEELS = parameter("FEELS");
      now.begun = !now.TOUCH;
      now.KEPT = parameter("KEPT");
      now.WITHIN = parameter("WITHIN");
      now.HUSH = parameter("HUSH");
      now.NEAR = parameter("NEAR");
      now.CALMS = parameter("CALMS");
      now.links[LEFT] = now.LINKS;
      now.links[RIGHT] = now.LINKS;
      now.reboots = parameter("REBOOTS");
      now.bumps = parameter("BUMPS");
      set_program(now.TALKS, now.BRAKE, now.LEASE, now.TURN, now.DELAY, now.REACH, now.CROSS);
      robot_boot(LEFT);
      robot_boot(RIGHT);
      if (now.TOUCH) start_by_touch();
      now.rest[RIGHT] = now.TOUCH;
    };
    select (k : 0 .. 1);
    palm[LEFT] = (READY -> STEEP : k);
    select (k : 0 .. 1);
    palm[RIGHT] = (READY -> SHALLOW : k);
    select (k : 0 .. 2 * START + WIDTH - 1);
    p[LEFT] = k - START;
    select (k : 0 .. 2 * START + WIDTH - 1);
    p[RIGHT] = k - START;
    k = 0
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
       who = 0
     };
     atomic {
       move();
       d_step { c_code { print_cycle(); }; check() }
     }
  od
}

/* Once faults are over the goal is reached, and kept. */
ltl converges { <>[] calm -> <>[] goal }
/* Whatever the object does, opposite signs do not last. */
ltl ties { []<> (sign(LEFT) * sign(RIGHT) >= 0) }
/* Both robots travel in the end. */
ltl starts { <>[] (begun && !rest[LEFT] && !rest[RIGHT]) }
/* The same, once faults are over. */
ltl recovers { <>[] calm -> <>[] (!rest[LEFT] && !rest[RIGHT]) }
