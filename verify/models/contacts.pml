/* SPDX-License-Identifier: Apache-2.0 */
/* The object on two palms, as far as both algorithms may rely on it.
 *
 * Contact coordinates are whole units, outward positive; the sensor reads 0 in the WIDTH units from 0
 * on, − below, + above. Moving the robots together or apart by one unit moves one contact by one
 * unit. Which one, the two properties of the palm angles say (paper, section 2):
 *   1  closing: the contact on the only shallow palm slides up;
 *   2  opening: the contact on the only steep palm slides down.
 * The paper asks for 1 only where that contact is not outward already, and for 2 only where it is not
 * inward already; EVERYWHERE says that they hold all over the palms. Where no property speaks (palms
 * alike, a palm still turning) an adversary chooses. No friction, no geometry: what holds here holds
 * for every object with the two properties.
 */

#define settled (turning[LEFT] == 0 && turning[RIGHT] == 0)
#define only_shallow(s) (settled && palm[s] == SHALLOW && palm[1 - (s)] == STEEP)

#define slides_up(s) (only_shallow(s) && (EVERYWHERE || p[s] < WIDTH))
#define slides_down(s) (only_shallow(1 - (s)) && (EVERYWHERE || p[s] >= 0))

short p[2];       /* contact coordinates, in units */
byte palm[2];     /* the angle last commanded */
byte turning[2];  /* cycles until a palm has got there */

byte WIDTH;  /* of the zero zone, in units */
byte SPAN;   /* of the palm, outward and inward of that zone, in units */
byte EVERYWHERE;
byte TURN;   /* cycles that a palm takes to turn */

inline together()
{
  if
  :: !slides_up(RIGHT) -> p[LEFT]++
  :: !slides_up(LEFT) -> p[RIGHT]++
  fi
}

inline apart()
{
  if
  :: !slides_down(RIGHT) -> p[LEFT]--
  :: !slides_down(LEFT) -> p[RIGHT]--
  fi
}

#define fallen(s) (p[s] < 0 - SPAN || p[s] >= WIDTH + SPAN)

/* A command to the palm of robot s. */
inline turn(s, command)
{
  if
  :: command != palm[s] -> palm[s] = command; turning[s] = TURN
  :: else -> if :: turning[s] > 0 -> turning[s]-- :: else fi
  fi
}
