# SPDX-License-Identifier: Apache-2.0
"""Whether random scripts (palm_scripts.py) end alike in the exact world and in a slow one.

A script in which no event is ambiguous has one course: the slow world (slow_world.py) must end it
at the same place for a reason of the same kind, or complete it with the object in the same pose.
After an ambiguous event both follow the same rule, but rounding may decide between equal margins.
`python tests/support/script_ends.py FIRST LAST` prints how many scripts of these seeds do.
"""

import math
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

import palmbots._core as _core
from motion_oracle import Moment, Oracle
from palm_scripts import PERIODS, Drive, world_of
from palmbots.errors import SceneError
from slow_world import SlowWorld

# Of the slow world [m]: a difference counts if the smallest ones show it.
STEPS = (3e-4, 3e-5, 1e-5)
# By so much both ends may differ [periods], and poses [m], the turn in sizes of the object: the
# slow world finds an end to a part of a step, and poses of most scripts agree to 1e-6 m.
WHEN, WHERE = 0.1, 1e-4
AFTER = 3  # periods for which the slow world may go on after the end of the exact one
# Which of these it is depends on rounding where the object is held only just.
STUCK = {"sliding", "tipping", "jammed", "fell", "toppled"}


Move = tuple[tuple[tuple[float, float], tuple[float, float]], tuple[float, float]]


@dataclass
class Ends:
    """How a number of scripts ended."""

    ambiguous: int = 0
    ambiguous_agreed: int = 0
    agreed: int = 0
    # Scripts that differ after an event that only the slow world calls ambiguous.
    missed: list[str] = field(default_factory=list)
    other_reasons: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    worst_apart: float = 0.0  # of poses at the end that agree [m]

    @property
    def clear_share(self) -> float:
        """The share of scripts without an ambiguous event."""
        compared = self.agreed + len(self.missed) + len(self.faults)
        return compared / (compared + self.ambiguous)


@dataclass(frozen=True)
class End:
    """Why and when a script ended [periods], where the object was then, and after how many events
    that were ambiguous."""

    reason: str
    at: float
    pose: tuple[float, float, float]
    ambiguous: int

    def is_like(self, other: "End", size: float) -> bool:
        if self.reason or other.reason:
            kinds = {"stuck" if end.reason in STUCK else end.reason for end in (self, other)}
            return len(kinds) == 1 and abs(self.at - other.at) < WHEN
        return self.apart(other, size) < WHERE

    def apart(self, other: "End", size: float) -> float:
        turn = size * abs(self.pose[2] - other.pose[2])
        return max(math.dist(self.pose[:2], other.pose[:2]), turn)


class Course:
    """A scene, and motions of its palms: the ways of both pivots [m] and the angles then [rad]."""

    def __init__(self, world: _core.World, oracle: Oracle, on_both: bool, moves: list[Move]):
        self.oracle = oracle
        self._world, self._on_both, self._moves = world, on_both, moves
        self._start = Moment.of(world)
        self.is_held = not (on_both and world.check())

    def exact(self) -> End:
        """The end of the exact world."""
        world = self._world.copy()
        for k, (by, palms) in enumerate(self._moves):
            reason, fraction, *_ = world.move(by, palms)
            if reason:
                return End(reason, k + fraction, world.pose, world.ambiguous_events)
        return End("", len(self._moves), world.pose, world.ambiguous_events)

    def slow(self, pace: float, until: float = math.inf) -> End:
        """The end of the slow world, if it is not later than this."""
        world = SlowWorld(self.oracle, self._start, self._on_both)
        for k, (by, palms) in enumerate(self._moves):
            reason, fraction = world.move(by, palms, pace)
            if reason or k > until:
                return End(reason, k + fraction, world.at.pose, world.ambiguous_events)
        return End("", len(self._moves), world.at.pose, world.ambiguous_events)

    def is_forced(self, end: End) -> bool:
        """Whether the slow world does not go on after this end of the exact one either."""
        return any(self.slow(pace, end.at + AFTER).at < end.at + WHEN for pace in STEPS)


def course_of(seed: int, judge: Callable[[Oracle], Oracle] | None = None) -> Course:
    """That of a script of palm_scripts.py; `judge` changes the oracle."""
    rng = np.random.default_rng(seed)
    world, oracle, on_floor = world_of(rng)
    drive, palms = Drive(rng, on_floor), world.palms
    moves = []
    for k in range(PERIODS):
        by, palms = drive.next(k, palms)
        moves.append((by, palms))
    return Course(world, oracle if judge is None else judge(oracle), not on_floor, moves)


def compare(name: object, course: Course, ends: Ends, steps: tuple[float, ...] = STEPS) -> None:
    """Runs a script in both worlds."""
    if not course.is_held:
        return
    exact = course.exact()
    size = course.oracle.size
    if exact.ambiguous:
        ends.ambiguous += 1
        until = exact.at + AFTER
        ends.ambiguous_agreed += any(exact.is_like(course.slow(p, until), size) for p in steps)
        return
    found = ""
    ambiguous = 0
    for pace in steps:
        slow = course.slow(pace, exact.at + AFTER)
        apart = exact.apart(slow, size)
        if exact.is_like(slow, size):
            ends.agreed += 1
            if exact.reason != slow.reason:
                ends.other_reasons.append(f"{name}: {exact.reason}, slow: {slow.reason}")
            elif not exact.reason:
                ends.worst_apart = max(ends.worst_apart, apart)
            return
        found = f"{name}: {exact}, slow: {slow}, apart {apart:.1e}"
        ambiguous = slow.ambiguous
    (ends.missed if ambiguous else ends.faults).append(found)


def compare_scripts(
    seeds: Iterable[int],
    judge: Callable[[Oracle], Oracle] | None = None,
    steps: tuple[float, ...] = STEPS,
) -> Ends:
    """Compares the scripts of these seeds that are not refused."""
    ends = Ends()
    for seed in seeds:
        try:
            course = course_of(seed, judge)
        except SceneError:
            continue
        compare(f"seed {seed}", course, ends, steps)
    return ends


def main(first: str, last: str) -> None:
    ends = compare_scripts(range(int(first), int(last)))
    differ = ends.missed + ends.faults
    print(*differ, sep="\n")
    count = ends.agreed + len(differ) + ends.ambiguous
    print(f"Without an ambiguous event: {ends.clear_share:.1%} of {count} scripts.")
    print(f"Of these, {ends.agreed} agree and {len(differ)} differ.")
    print(f"With ambiguous events, {ends.ambiguous_agreed} of {ends.ambiguous} agree.")
    print(f"Poses at the end that agree do so to {ends.worst_apart:.1e} m.")
    print(f"Ends at the same place with another reason: {len(ends.other_reasons)}.")


if __name__ == "__main__":
    main(*sys.argv[1:])
