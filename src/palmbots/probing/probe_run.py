# SPDX-License-Identifier: Apache-2.0
"""Probes with a pair of robots, one after the other (`run_probes`).

A probe turns the palms, with the robots driven so that the contacts stay about where they are, and
then closes or opens until a switch changes. The contact at that switch slides at that instant; this
is the observation. If both switches change in one reading, it is a tie, which gives none.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
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

_ROUNDING = 1e-9
_STANDS = (0.0, 0.0)
_ANYWHERE = (-math.inf, math.inf)
_LEAST_DRIFT = 0.001
"""How far contacts slide while the palms turn and the robots compensate for it [m]."""
_STRIDE = 5
"""Control periods after which robots in real time stand, if no switch may show how far they are."""
_OLDER = 6
"""In this many consecutive readings in real time, the last one of a robot is newer than the first
one of its partner (docs/theory/probing.md)."""
_PATIENCE, _WASTED = 20, 60
"""Probes in a row that do not cut the set, after which smaller cuts count, too, and after which
nothing more is to be learned."""

Switches = tuple[tuple[bool, ...], tuple[bool, ...]]


class Hands(Protocol):
    """Two robots under an object, one control period at a time."""

    period_s: float
    time_s: float
    """Since the start."""

    @property
    def end(self) -> str:
        """Why the object is no longer held; empty if it is."""
        ...

    def switches(self) -> Switches:
        """Which switches of each palm are closed."""
        ...

    def step(self, changes: Pair, angles: Pair) -> None:
        """Each robot changes the separation [m] and turns its palm to this angle [rad]."""
        ...

    def read(self) -> tuple[Pair, Pair]:
        """What the encoders show: by how much each robot has changed the separation [m], from any
        start, and the palm angles [rad]."""
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
        flipped: numbers of the observations whose switch reports the wrong palm, for tests.
    """

    def __init__(
        self,
        hands: Hands,
        geometry: PairGeometry,
        found: ObjectSet,
        limits: Limits,
        pace: Pace,
        flipped: frozenset[int] = frozenset(),
    ) -> None:
        self.hands, self.found, self.limits, self.pace = hands, found, limits, pace
        self.time_s = 0.0
        self.strokes: list[Stroke] = []
        self.stop = ""
        self.is_possible = True
        """Whether the switches agree with the wheels."""
        self._flipped = flipped
        self._geometry, self._give = geometry, geometry.give
        self._at_edge: set[int] = set()
        """The contacts that may lie at the edge that they passed last; they can creep over it."""
        self._switches = hands.switches()
        self._rolled, angles = hands.read()
        self._commanded = angles
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
            self._may_go_on()
            and len(idle) < _WASTED
            and len(self.found.observations) < self.pace.most_probes
        ):
            done = len(self.found.observations) / self.pace.most_probes
            on_progress(max(done, self.time_s / self.pace.most_s))
            probe = self._next(idle)
            if probe is None:
                self.stop = "no further probe is safe for every object of the set"
                break
            self._turn(probe.angles)
            side, pose = self._slide(probe.way) if not self.stop else (None, None)
            is_new = False
            if side is not None and pose is not None:
                reported = 1 - side if len(self.found.observations) in self._flipped else side
                is_new = self.found.add(Observation(reported, probe.way, pose))
                if self.found.misfits:
                    self.bounds = self._sure
            idle = [] if is_new else [*idle, probe]
            if len(idle) % _PATIENCE == _PATIENCE - 1:  # observations would be left over
                self.found.least_cut /= 2
            self.strokes.append(
                Stroke(probe.angles, probe.way, side, self.time_s, self.found.volume())
            )

    def _next(self, idle: list[Probe]) -> Probe | None:
        """The best probe. Large boxes overestimate the set: if no probe is safe for them, one may
        be for smaller ones. The palms could otherwise not leave angles that have become unsafe, so
        less is then assumed about how far contacts slide while they turn."""
        for limits in (self.limits, self.limits, replace(self.limits, drift=_LEAST_DRIFT)):
            probe = next_probe(self.found, self.bounds, self._signs(), limits, idle)
            if probe is not None:
                return probe
            self.found.sharpen()
        return None

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

    def _may_go_on(self) -> bool:
        return not self.stop and self.time_s < self.pace.most_s - 0.5 * self.hands.period_s

    def _turn(self, target: Pair) -> None:
        most = self.pace.rate * self.hands.period_s
        is_sure = self.bounds is self._sure
        self._sure = self._sure.loosened(self._give.turn)
        self.bounds = self._sure if is_sure else self.bounds.loosened(self._give.turn)
        while self._commanded != target and self._may_go_on():
            angles = turned_towards(self._commanded, target, most)
            changes = self._compensation(angles)
            self._at_edge.update(self._step(changes, angles, 0))
        for _ in range(round(self._give.settling_s / self.hands.period_s)):
            if self._may_go_on():
                self._at_edge.update(self._step(_STANDS, target, 0))
        self._at_edge.update(self._rest(0))
        self.bounds = self.bounds.narrowed()

    def _compensation(self, angles: Pair) -> Pair:
        """What the robots change of the separation while the palms turn to these angles: each a
        half, or in real time, where one may be late, what its own palm needs."""
        before = self._commanded
        if not self._give.rests:
            half = 0.5 * _compensation(self.bounds, before, angles)
            return half, half
        return (
            _compensation(self.bounds, before, (angles[0], before[1])),
            _compensation(self.bounds, before, (before[0], angles[1])),
        )

    def _slide(self, way: int) -> tuple[int | None, Pose | None]:
        """Close or open until it is known which contact slides; returns which, and the pose.

        A contact that is beyond the last edge that way changes no switch. It has slid if the other
        one would have reached its edge.
        """
        half = -0.5 * way * self.pace.speed * self.hands.period_s
        changes = half, half
        before, start, start_s = self.bounds.contacts, sum(self._rolled), self.time_s
        is_seen = all(way * sign <= 0 for sign in self._signs())
        reach = self.limits.reach - SPARE_M
        free = self._may_slide(way)
        steps, rolled = 0, deque[Pair](maxlen=_OLDER)
        while self._may_go_on():
            rolled.append(self._rolled)
            changed = self._step(changes, self._commanded, way, free)
            has_slid = abs(sum(self._rolled) - start) >= self._give.clearance
            if self._give.rests:
                steps += 1
                if not changed and (is_seen or steps % _STRIDE):
                    continue
                changed = sorted({*changed, *self._rest(way, free)})
            crept = self._give.creep * (self.time_s - start_s)
            if changed:
                side = changed[0] if has_slid and len(changed) == 1 else None
                if self._give.creep and side in self._at_edge:
                    side = None
                self._at_edge.difference_update(changed)
                pose = self._pose_since_change(changed[0], rolled, way, free)
                for _ in range(round(self._give.overshoot / abs(2 * half))):
                    if self._may_go_on():
                        self._at_edge.update(self._step(changes, self._commanded, way))
                if self._give.overshoot:
                    self._at_edge.update(self._rest(way))
                return side, pose
            if self.bounds is self._sure:  # where they were is not known either
                free, before = (True, True), (_ANYWHERE, _ANYWHERE)
            narrow = self.bounds.narrowed()
            slid = _slid(before, narrow.contacts, way, crept + _ROUNDING)
            if not is_seen and any(slid):
                self.bounds = narrow
                return (None if all(slid) else slid.index(True)), self._pose_since(before)
            far = (max(way * low, way * high) > reach for low, high in narrow.contacts)
            if not is_seen and any(one and slides for one, slides in zip(far, free, strict=True)):
                return None, None
        return None, None

    def _may_slide(self, way: int) -> tuple[bool, bool]:
        """Which contact may slide in a stroke, for any object of the set. If no object explains all
        observations, the set does not say."""
        found = self.found
        if found.misfits:
            return True, True
        pose = stroke_pose(self.bounds, way, self.limits)
        left, right = found.may_slide(found.boxes, pose, way)
        return bool(left.any()), bool(right.any())

    def _pose_since_change(
        self, side: int, before: Sequence[Pair], way: int, free: tuple[bool, bool]
    ) -> Pose:
        """All poses from the change of a switch to now; robots in real time have gone on.

        Args:
            side: of the switch.
            before: how far the robots had rolled before. The last reading of this robot is older
                than the change, and so is the first one of the other robot.
            way: in which contacts have slid.
            free: which contacts may slide.
        """
        if not self._give.rests:
            return self.bounds.pose()
        other = 1 - side
        own = abs(self._rolled[side] - before[-1][side])
        most = own + abs(self._rolled[other] - before[0][other])
        return self.bounds.moved(most, self.bounds.angles, -way, free).pose()

    def _rest(self, way: int, free: tuple[bool, bool] = (True, True)) -> list[int]:
        """Wait until both robots stand; only then do the readings of robots in real time describe
        one instant. Returns the palms whose switches have changed."""
        changed: list[int] = []
        for _ in range(self._give.rests):
            if not self.stop:
                changed += self._step(_STANDS, self._commanded, way, free)
        if self._give.rests and not self.stop:
            self._follow(lambda bounds, _: bounds.seen(self._switches), free)
        return changed

    def _step(
        self, changes: Pair, angles: Pair, way: int, free: tuple[bool, bool] = (True, True)
    ) -> list[int]:
        """One control period; returns the palms whose switches have changed."""
        self.hands.step(changes, angles)
        self._commanded = angles
        passed_s, self.time_s = self.hands.time_s - self.time_s, self.hands.time_s
        if self.hands.end:
            self.stop = f"the object was lost: {self.hands.end}"
            return []
        before, self._switches = self._switches, self.hands.switches()
        last, (self._rolled, angles) = self._rolled, self.hands.read()
        moves = [(sum(self._rolled) - sum(last), angles)]
        if self._give.rests:  # either robot may have moved first
            (left, right), (old_left, old_right) = self._rolled, last
            halfway = angles[0], self.bounds.angles[1]
            moves = [(left - old_left, halfway), (right - old_right, angles)]
        crept = self._give.creep * passed_s

        def moved(bounds: ContactBounds, free: tuple[bool, bool]) -> ContactBounds:
            for change, turned in moves:
                bounds = bounds.moved(change, turned, way if change * way <= 0 else 0, free)
            bounds = bounds.loosened(crept)
            return bounds if self._give.rests else bounds.seen(self._switches)

        self._follow(moved, free)
        return [i for i in (0, 1) if before[i] != self._switches[i]]

    def _follow(
        self,
        of: Callable[[ContactBounds, tuple[bool, bool]], ContactBounds],
        free: tuple[bool, bool],
    ) -> None:
        """Change the bounds."""
        try:
            self._sure = of(self._sure, (True, True))
        except Impossible:
            self.stop, self.is_possible = "the switches contradict the wheels", False
            return
        try:
            self.bounds = of(self.bounds, free)
        except Impossible:  # the object is not in the set: an earlier observation is false
            self.bounds = self._sure


def _slid(
    before: tuple[Interval, Interval], after: tuple[Interval, Interval], way: int, crept: float
) -> list[bool]:
    """Which contacts have certainly moved that way by at least as much as one that sticks."""
    return [
        max(way * start[0], way * start[1]) + crept <= min(way * end[0], way * end[1])
        for start, end in zip(before, after, strict=True)
    ]


def _compensation(bounds: ContactBounds, before: Pair, after: Pair) -> float:
    """The change of the separation that leaves the contacts where they probably are. Both angles
    are commanded ones: those that the encoders show lag behind."""
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

    return separation(after) - separation(before)
