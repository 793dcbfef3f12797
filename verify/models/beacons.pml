/* SPDX-License-Identifier: Apache-2.0 */
/* Which messages a robot of a table acts on: its shipped controller
 * (palmbots/control/table_robot.hpp) and its receiver (palmbots/control/mailbox.hpp), called as C.
 *
 * The radio is an adversary: whatever was ever sent may come at any time, any number of times, in any
 * order, or never. The model of the contacts (signs.pml) relies on what is proved here.
 */

c_decl {
\#include "beacons.h"
}
c_track "&pair" "sizeof(struct pair)"
c_code {
  static int cycle_number = 0;
  static void print_cycle(void)
  {
    Printf("%4d  left  %-17s  right  %-17s\n", cycle_number++, robot_doing(LEFT), robot_doing(RIGHT));
  }
}

#define LEFT 0
#define RIGHT 1

/* What is asserted. */
#define FRESH 1 /* the lease is at least the age of a message plus that of what its beacon echoes */
#define LIFE 2  /* no robot acts on a message from before its boot */
#define LONE 4  /* nobody hears a partner that does not hear it for longer than LONELY cycles */
#define claim(kind, condition) assert(!(ARMED & kind) || (condition))

byte ARMED;  /* sum of the above */
byte LEASE;  /* cycles for which a message counts */
byte LONELY; /* see LONE */

byte reboots; /* that may still happen */
byte who;
int options;
byte choice;
bool bad;

/* One step of robot `who`: the adversary picks a beacon, or none. */
inline step()
{
  c_code { now.options = choices(now.who); };
  do
  :: options & (1 << choice) -> break
  :: options >> (choice + 1) -> choice++
  od;
  skip;
  c_code { robot_step(now.who, now.choice - 1); };
  options = 0; choice = 0
}

active proctype cycle()
{
  atomic {
    c_code {
      now.ARMED = parameter("ARMED");
      now.LEASE = parameter("LEASE");
      now.LONELY = parameter("LONELY");
      now.reboots = parameter("REBOOTS");
      set_lease(now.LEASE);
      robot_boot(LEFT);
      robot_boot(RIGHT);
    }
  };
  do
  :: atomic {
       if
       :: reboots > 0 ->
            reboots--;
            if
            :: who = LEFT
            :: who = RIGHT
            fi;
            c_code { robot_boot(now.who); Printf("      %s reboots\n", side_name(now.who)); }
       :: skip
       fi;
       c_code { pass_time(); };
       if
       :: who = LEFT
       :: who = RIGHT
       fi;
       step();
       who = 1 - who;
       step();
       who = 0;
       d_step {
         c_code { note_links(); print_cycle(); };
         c_code { now.bad = (!is_silent(LEFT) && pair.robot[LEFT].true_bound > now.LEASE) ||
                            (!is_silent(RIGHT) && pair.robot[RIGHT].true_bound > now.LEASE); };
         claim(FRESH, !bad);
         c_code { now.bad = (!is_silent(LEFT) && pair.robot[LEFT].true_age > pair.robot[LEFT].since_boot) ||
                            (!is_silent(RIGHT) && pair.robot[RIGHT].true_age > pair.robot[RIGHT].since_boot); };
         claim(LIFE, !bad);
         c_code { now.bad = pair.robot[LEFT].lone > now.LONELY || pair.robot[RIGHT].lone > now.LONELY; };
         claim(LONE, !bad);
         bad = false
       }
     }
  od
}
