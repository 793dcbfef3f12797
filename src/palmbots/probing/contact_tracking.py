# SPDX-License-Identifier: Apache-2.0
"""Where the contacts can be: intervals from the switches, the wheels and the closed loop.

Let d be the separation of the pivots, o the pivot offset, and z the difference of height of the
contacts. The contacts stay w apart:

    p_L cos θ_L + p_R cos θ_R + d − o_L sin θ_L − o_R sin θ_R = √(w² − z²)
    z = p_R sin θ_R + o_R cos θ_R − p_L sin θ_L − o_L cos θ_L

So the separation and one contact give the other one. The separation is not known at first; each
switch that changes narrows it. If the separation changes by less than δ, or the palms turn as if it
did, no contact slides farther than δ / (cos θ − |T| sin θ) (the derivative of the equation with the
other contact at rest). Left is index 0, right index 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

from palmbots._types import Interval
from palmbots.probing.slip_comparison import Pose
from palmbots.scene.robot_section import Zone

Pair = tuple[float, float]

_NARROWINGS = 3
_LATE_M, _UNSEEN_M, _RESTS = 0.001, 0.0001, 5  # in real time: docs/theory/probing.md


class Impossible(Exception):
    """The switches contradict the wheels."""


@dataclass(frozen=True)
class Give:
    """By how much a world departs from the quasistatic one; zero in that world."""

    angle: float = 0.0
    """A palm from the angle that its encoder reads, once the arms yield [rad]."""
    loop: float = 0.0
    """The separation from what the wheels have rolled [m]."""
    turn: float = 0.0
    """How far a contact slides while the palms turn, beyond what the encoders explain [m]."""
    squeeze: float = math.inf
    """The largest squeeze in a probe, in weights of the object: the arms yield to it."""
    creep: float = 0.0
    """Speed of a contact that sticks [m/s]."""
    edge: float = 0.0
    """A contact from the place at which its switch feels it [m]."""
    overshoot: float = 0.0
    """How far the robots go on after a switch has changed, away from that edge [m]."""
    clearance: float = 0.0
    """How far they have to go before a switch that changes shows that a contact has slid [m]."""
    settling_s: float = 0.0
    """How long the palms take to come to rest after a turn."""
    late: float = 0.0005
    """How far a contact slides before the robots have stopped [m]."""

    rests: int = 0
    """How many more readings a robot needs to show all commands of its wheels; 0: every reading is
    of the present instant."""

    def in_real_time(self) -> Give:
        """With robots whose readings are of different instants, and which obey late."""
        return replace(self, turn=self.turn + _UNSEEN_M, late=self.late + _LATE_M, rests=_RESTS)


@dataclass(frozen=True)
class PairGeometry:
    """What the robots know of themselves and of the object."""

    width: float
    offset: Pair
    zones: tuple[tuple[Zone, ...], tuple[Zone, ...]]
    angle_error: float
    """Of each palm, with what the arms yield [rad]."""
    odometry: float
    """Error of a change of the separation, as a fraction."""
    give: Give = Give()


def add(a: Interval, b: Interval) -> Interval:
    """The sums."""
    return a[0] + b[0], a[1] + b[1]


def times(a: Interval, b: Interval) -> Interval:
    """The products."""
    p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return min(p, q, r, s), max(p, q, r, s)


def both(a: Interval, b: Interval, slack: float = 1e-9) -> Interval:
    """The common part.

    Raises:
        Impossible: there is none.
    """
    low, high = max(a[0], b[0]), min(a[1], b[1])
    if low > high + slack:
        raise Impossible
    return (low, high) if low <= high else (high, low)


def exactly(value: float) -> Interval:
    """An interval without a width."""
    return value, value


def around(value: float, error: float) -> Interval:
    """An interval."""
    return value - error, value + error


@dataclass(frozen=True)
class ContactBounds:
    """Intervals of contact coordinates and separation [m], at nominal palm angles [rad]."""

    geometry: PairGeometry
    angles: Pair
    contacts: tuple[Interval, Interval]
    separation: Interval

    @classmethod
    def at_start(
        cls, geometry: PairGeometry, angles: Pair, contacts: tuple[Interval, Interval]
    ) -> ContactBounds:
        """Before anything has moved: the separation is any that the contacts allow."""
        return cls(geometry, angles, contacts, (-math.inf, math.inf)).narrowed()

    def _turned(self) -> tuple[tuple[Interval, Interval], tuple[Interval, Interval]]:
        """Sines and cosines of both palms."""
        return _sines_and_cosines(self.angles, self.geometry.angle_error)

    def rise(self) -> Interval:
        """z."""
        sines, cosines = self._turned()
        offset = self.geometry.offset
        up, down = (
            add(times(self.contacts[i], sines[i]), times(exactly(offset[i]), cosines[i]))
            for i in (1, 0)
        )
        return up[0] - down[1], up[1] - down[0]

    def tangent(self) -> Interval:
        """T = tan ϑ."""
        w = self.geometry.width
        low, high = (z / math.sqrt(max(w * w - z * z, 1e-12)) for z in self.rise())
        return low, high

    def pose(self) -> Pose:
        """Palms and object."""
        error = self.geometry.angle_error
        left, right = (around(angle, error) for angle in self.angles)
        return Pose((left, right), self.tangent())

    def narrowed(self) -> ContactBounds:
        """The same, where the loop is closed.

        Raises:
            Impossible: it cannot be.
        """
        w = self.geometry.width
        sines, cosines = self._turned()
        contacts, separation = list(self.contacts), self.separation
        for _ in range(_NARROWINGS):
            before = *contacts, separation
            z = replace(self, contacts=(contacts[0], contacts[1])).rise()
            highest = max(abs(z[0]), abs(z[1]))
            lowest = 0.0 if z[0] <= 0 <= z[1] else min(abs(z[0]), abs(z[1]))
            span = (
                math.sqrt(max(w * w - highest * highest, 0.0)),
                math.sqrt(max(w * w - lowest * lowest, 0.0)),
            )
            left, right = (
                times(exactly(o), s) for o, s in zip(self.geometry.offset, sines, strict=True)
            )
            yields = around(0.0, self.geometry.give.loop)
            whole = add(add(span, add(left, right)), yields)  # p_L cos + p_R cos + d
            runs = [times(p, c) for p, c in zip(contacts, cosines, strict=True)]
            others = add(runs[0], runs[1])
            separation = both(separation, (whole[0] - others[1], whole[1] - others[0]))
            for i in (0, 1):
                rest = add(runs[1 - i], separation)
                run = whole[0] - rest[1], whole[1] - rest[0]
                inverse = 1 / cosines[i][1], 1 / cosines[i][0]
                contacts[i] = both(contacts[i], times(run, inverse))
                runs[i] = times(contacts[i], cosines[i])
            if (*contacts, separation) == before:
                break
        return replace(self, contacts=(contacts[0], contacts[1]), separation=separation)

    def seen(self, closed: tuple[tuple[bool, ...], tuple[bool, ...]]) -> ContactBounds:
        """With these switches, True where one is closed.

        Raises:
            Impossible: they contradict the wheels.
        """
        edge = self.geometry.give.edge
        contacts = [
            both(p, add(_covered(zones, flags, p), (-edge, edge)))
            for p, zones, flags in zip(self.contacts, self.geometry.zones, closed, strict=True)
        ]
        return replace(self, contacts=(contacts[0], contacts[1])).narrowed()

    def loosened(self, most: float) -> ContactBounds:
        """After each contact has slid by at most this much, either way [m]."""
        left, right = (add(p, (-most, most)) for p in self.contacts)
        return replace(self, contacts=(left, right))

    def moved(
        self,
        change: float,
        angles: Pair,
        way: int = 0,
        may_slide: tuple[bool, bool] = (True, True),
    ) -> ContactBounds:
        """After the separation changed by this much and the palms turned to these angles.

        Args:
            change: of the separation.
            angles: nominal, of the palms.
            way: the only way in which contacts can slide: `UP`, `DOWN`; 0: both.
            may_slide: which contacts can.
        """
        error = abs(change) * self.geometry.odometry
        separation = add(self.separation, around(change, error))
        after = replace(self, angles=angles, separation=separation)
        steepest = max(abs(end) for bounds in (self, after) for end in bounds.tangent())
        loose = self._looseness(change, after, steepest) + error
        contacts = []
        for i, (low, high) in enumerate(self.contacts):
            worst = max(abs(self.angles[i]), abs(angles[i])) + self.geometry.angle_error
            slid = may_slide[i] * loose / (math.cos(worst) - steepest * math.sin(worst))
            contacts.append((low - slid * (way <= 0), high + slid * (way >= 0)))
        return replace(after, contacts=(contacts[0], contacts[1]))

    def _looseness(self, change: float, after: ContactBounds, steepest: float) -> float:
        """The change of the separation that would move the contacts as much as this step."""
        if after.angles == self.angles:
            return abs(change)
        (sines, cosines), (sines_after, cosines_after) = self._turned(), after._turned()
        loop, height = (change, change), (0.0, 0.0)
        for i in (0, 1):
            # Of one palm whose error stays as it is: the ends of the sine belong together.
            turn = _differences(sines[i], sines_after[i])
            shrink = _differences(cosines[i], cosines_after[i])
            offset = exactly(self.geometry.offset[i])
            loop = add(loop, times(self.contacts[i], shrink))
            loop = add(loop, times(exactly(-offset[0]), turn))
            lift = add(times(self.contacts[i], turn), times(offset, shrink))
            height = add(height, lift if i else (-lift[1], -lift[0]))
        return max(map(abs, loop)) + steepest * max(map(abs, height))


@lru_cache(maxsize=64)
def _sines_and_cosines(
    angles: Pair, error: float
) -> tuple[tuple[Interval, Interval], tuple[Interval, Interval]]:
    sines, cosines = [], []
    for angle in angles:
        low, high = around(angle, error)
        sines.append((math.sin(low), math.sin(high)))
        top = 1.0 if low <= 0 <= high else max(math.cos(low), math.cos(high))
        cosines.append((min(math.cos(low), math.cos(high)), top))
    return (sines[0], sines[1]), (cosines[0], cosines[1])


def _differences(before: Interval, after: Interval) -> Interval:
    ends = after[0] - before[0], after[1] - before[1]
    return min(ends), max(ends)


def _covered(zones: tuple[Zone, ...], closed: tuple[bool, ...], p: Interval) -> Interval:
    """The least interval of contacts with which exactly these switches are closed."""
    low, high = -math.inf, math.inf
    for zone, is_closed in zip(zones, closed, strict=True):
        if is_closed:
            low, high = max(low, zone.from_m), min(high, zone.to_m)
    for zone, is_closed in zip(zones, closed, strict=True):
        if is_closed:
            continue
        if zone.from_m <= max(low, p[0]) <= zone.to_m:
            low = zone.to_m
        if zone.from_m <= min(high, p[1]) <= zone.to_m:
            high = zone.from_m
    return low, high
