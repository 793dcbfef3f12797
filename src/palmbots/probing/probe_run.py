# SPDX-License-Identifier: Apache-2.0
"""Probes with a pair of robots, one after the other (`run_probes`).

A probe turns the palms, with the robots driven so that the contacts stay about where they are, and
then closes or opens until a switch changes. The contact at that switch slides at that instant; this
is the observation. If both switches change in one reading, it is a tie, which gives none.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

from palmbots._types import Interval
from palmbots.probing.contact_tracking import ContactBounds, Impossible, Pair, PairGeometry
from palmbots.probing.next_probe import (
    SPARE_M,
    Limits,
    Probe,
    next_probe,
    stroke_pose,
    turned_towards,
)
from palmbots.probing.object_set import ObjectSet, Observation
from palmbots.probing.slip_comparison import Pose

_LAST_S = 5.0
_ANYWHERE = (-math.inf, math.inf)
_WASTED = 60
"""Probes in a row that do not cut the set, after which nothing more is to be learned."""

Switches = tuple[tuple[bool, ...], tuple[bool, ...]]


class Hands(Protocol):
    """Two robots under an object, one control period at a time."""

    period_s: float

    @property
    def end(self) -> str:
        """Why the object is no longer held; empty if it is."""
        ...

    def switches(self) -> Switches:
        """Which switches of each palm are closed."""
        ...

    def step(self, change: float, angles: Pair) -> None:
        """Change the separation [m], and turn the palms to these angles [rad]."""
        ...


@dataclass(frozen=True)
class Stroke:
    """One probe as it went."""

    angles: Pair
    way: int
    side: int | None
    """Whose switch changed; None: both in the same reading, or none within the stroke."""
    time_s: float
    """Since the start, at its end."""
    volume: float
    """Of the set afterwards, over the prior's."""


@dataclass(frozen=True)
class Pace:
    """How the robots move, and when they stop."""

    rate: float
    """Of the palms [rad/s]."""
    speed: float
    """Of the separation [m/s]."""
    most_probes: int
    most_s: float


class ProbeRun:
    """Probes with a pair.

    Args:
        hands: the pair.
        geometry: what the robots know.
        found: the prior; the observations cut it.
        limits: what probes may do.
        pace: of the robots.
        angles: of the palms at the start [rad].
        flipped: numbers of the observations whose switch reports the wrong palm, for tests.
    """

    def __init__(
        self,
        hands: Hands,
        geometry: PairGeometry,
        found: ObjectSet,
        limits: Limits,
        pace: Pace,
        angles: Pair,
        flipped: frozenset[int] = frozenset(),
    ) -> None:
        self.hands, self.found, self.limits, self.pace = hands, found, limits, pace
        self.time_s = 0.0
        self.strokes: list[Stroke] = []
        self.stop = ""
        self.is_possible = True
        """Whether the switches agree with the wheels."""
        self._flipped = flipped
        self._geometry = geometry
        self._switches = hands.switches()
        anywhere = (-limits.reach, limits.reach)
        self.bounds = ContactBounds.at_start(geometry, angles, (anywhere, anywhere)).seen(
            self._switches
        )
        """Where the contacts are if the object is in the set."""
        self._sure = self.bounds
        """Where they are whatever the object is."""

    def run(self, on_progress: Callable[[float], None] = lambda part: None) -> None:
        """Probe until nothing more is to be learned, or the limits are reached."""
        idle: list[Probe] = []
        while (
            not self.stop
            and len(idle) < _WASTED
            and len(self.found.observations) < self.pace.most_probes
            and self.time_s < self.pace.most_s
        ):
            done = len(self.found.observations) / self.pace.most_probes
            on_progress(max(done, self.time_s / self.pace.most_s))
            probe = next_probe(self.found, self.bounds, self._signs(), self.limits, idle)
            if probe is None:
                self.stop = "no further probe is safe for every object of the set"
                break
            self._turn(probe.angles)
            before = self.bounds.contacts
            side, has_changed = self._slide(probe.way) if not self.stop else (None, False)
            is_new = False
            if side is not None:
                reported = 1 - side if len(self.found.observations) in self._flipped else side
                pose = self.bounds.pose() if has_changed else self._pose_since(before)
                is_new = self.found.add(Observation(reported, probe.way, pose))
                if self.found.misfits:
                    self.bounds = self._sure
            idle = [] if is_new else [*idle, probe]
            self.strokes.append(
                Stroke(probe.angles, probe.way, side, self.time_s, self.found.volume())
            )

    def _pose_since(self, before: tuple[Interval, Interval]) -> Pose:
        """All poses of a stroke that began with these contacts."""
        left, right = (
            (min(a[0], b[0]), max(a[1], b[1]))
            for a, b in zip(before, self.bounds.contacts, strict=True)
        )
        return replace(self.bounds, contacts=(left, right)).pose()

    def _signs(self) -> tuple[int, int]:
        """Of the middles of the intervals' zones."""
        signs = []
        for zones, closed in zip(self._geometry.zones, self._switches, strict=True):
            names = [zone.sign for zone, is_on in zip(zones, closed, strict=True) if is_on]
            signs.append(0 if not names or "0" in names else (1 if "+" in names else -1))
        return signs[0], signs[1]

    def _turn(self, target: Pair) -> None:
        most = self.pace.rate * self.hands.period_s
        while self.bounds.angles != target and not self.stop:
            angles = turned_towards(self.bounds.angles, target, most)
            self._step(_compensation(self.bounds, angles), angles, 0)
        self.bounds = self.bounds.narrowed()

    def _slide(self, way: int) -> tuple[int | None, bool]:
        """Close or open until it is known which contact slides; returns which, and whether a switch
        has changed.

        A contact that is beyond the last edge that way changes no switch. It has slid if the other
        one would have reached its edge.
        """
        change = -way * self.pace.speed * self.hands.period_s
        before = self.bounds.contacts
        is_seen = all(way * sign <= 0 for sign in self._signs())
        reach = self.limits.reach - SPARE_M
        free = self._may_slide(way)
        while not self.stop and self.time_s < self.pace.most_s + _LAST_S:
            changed = self._step(change, self.bounds.angles, way, free)
            if changed:
                return (changed[0] if len(changed) == 1 else None), True
            if self.bounds is self._sure:  # where they were is not known either
                free, before = (True, True), (_ANYWHERE, _ANYWHERE)
            narrow = self.bounds.narrowed()
            slid = [
                max(way * start[0], way * start[1]) < min(way * end[0], way * end[1])
                for start, end in zip(before, narrow.contacts, strict=True)
            ]
            if not is_seen and any(slid):
                self.bounds = narrow
                return (None if all(slid) else slid.index(True)), False
            far = (max(way * low, way * high) > reach for low, high in narrow.contacts)
            if not is_seen and any(one and slides for one, slides in zip(far, free, strict=True)):
                return None, False
        return None, False

    def _may_slide(self, way: int) -> tuple[bool, bool]:
        """Which contact may slide in a stroke, for any object of the set. If no object explains all
        observations, the set does not say."""
        found = self.found
        if found.misfits:
            return True, True
        pose = stroke_pose(self.bounds, way, self.limits)
        left, right = found.may_slide(found.boxes, pose, way)
        return bool(left.any()), bool(right.any())

    def _step(
        self, change: float, angles: Pair, way: int, free: tuple[bool, bool] = (True, True)
    ) -> list[int]:
        """One control period; returns the palms whose switches have changed."""
        self.hands.step(change, angles)
        self.time_s += self.hands.period_s
        if self.hands.end:
            self.stop = f"the object was lost: {self.hands.end}"
            return []
        before, self._switches = self._switches, self.hands.switches()
        try:
            self._sure = self._sure.moved(change, angles, way).seen(self._switches)
        except Impossible:
            self.stop, self.is_possible = "the switches contradict the wheels", False
            return []
        try:
            self.bounds = self.bounds.moved(change, angles, way, free).seen(self._switches)
        except Impossible:  # the object is not in the set: an earlier observation is false
            self.bounds = self._sure
        return [i for i in (0, 1) if before[i] != self._switches[i]]


def _compensation(bounds: ContactBounds, angles: Pair) -> float:
    """The change of the separation that leaves the contacts where they probably are."""
    middles = [0.5 * (low + high) for low, high in bounds.contacts]
    offset, w = bounds.geometry.offset, bounds.geometry.width

    def separation(turned: Pair) -> float:
        z = sum(
            sense * (p * math.sin(t) + o * math.cos(t))
            for sense, p, t, o in zip((-1, 1), middles, turned, offset, strict=True)
        )
        return math.sqrt(w * w - z * z) + sum(
            o * math.sin(t) - p * math.cos(t)
            for p, t, o in zip(middles, turned, offset, strict=True)
        )

    return separation(angles) - separation(bounds.angles)
