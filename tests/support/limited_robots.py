# SPDX-License-Identifier: Apache-2.0
"""Robots whose force is limited, judged by a linear program that shares nothing with the core.

A world without limits makes the motion in which both robots drive. Its contacts (motion_oracle.py)
either have forces within the limits or not: this decides whether robots with limits may stall.
"""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linprog

from motion_oracle import Moment, Oracle
from palm_scripts import Drive, world_of
from palmbots.errors import SceneError

PERIODS = 150
NEAR = 0.01  # [weights]: so near to a limit the ends of a motion do not decide
SLACK = 5e-4  # [weights] of the balance: the poses of a motion are those at its ends
LIMITS = (0.03, 0.1, 0.2, 0.35, 0.6, np.inf)
Pair = tuple[float, float]


def excess(
    oracle: Oracle, before: Moment, after: Moment, limits: Pair, most: bool = False
) -> float | None:
    """By how much the forces of a motion exceed the limits of the robots, at least or (`most`) at
    most [weights]; infinite: no forces balance the weight; None: nothing is touched."""
    rays = oracle.rays(before, after, least=0.0)
    if not rays:
        return None
    wrenches = np.array([ray for _, ray in rays]).T
    rows, bounds = [], []
    for row, want in zip(wrenches, (oracle.slope, 1.0, 0.0), strict=True):
        for sign in (1.0, -1.0):
            rows.append([*(sign * row), 0.0])
            bounds.append(sign * want + SLACK)
    pushes = []
    for side, limit in enumerate(limits):
        along = np.array([ray[0] if carrier == side else 0.0 for carrier, ray in rays])
        pushes += [(sign * along, limit) for sign in (1.0, -1.0) if np.isfinite(limit)]
    n = len(rays)
    size = [(0.0, None)] * n + [(-10.0, None)]
    if most:
        values = []
        for along, limit in pushes:
            done = linprog([*-along, 0.0], A_ub=rows, b_ub=bounds, bounds=size)
            values.append(-done.fun - limit if done.status == 0 else np.inf)
        return max(values, default=-np.inf)
    rows += [[*along, -1.0] for along, _ in pushes]
    bounds += [limit for _, limit in pushes]
    done = linprog([0.0] * n + [1.0], A_ub=rows, b_ub=bounds, bounds=size)
    return float(done.x[-1]) if done.status == 0 else np.inf


@dataclass
class Stalls:
    """What a number of scripts showed."""

    drives: int = 0
    stalls: Counter[int] = field(default_factory=Counter)
    """Periods, by the number of robots that stalled."""
    jams: int = 0
    ends: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


class Script:
    """Palms that move at random, under robots with random limits [weights]."""

    def __init__(self, seed: int, found: Stalls, limits_of_judge: float = 1.0) -> None:
        """`limits_of_judge`: the judge's limits, as a share of those of the robots."""
        drawn = np.random.default_rng(seed + 1000).choice(LIMITS, 2)
        self._seed, self._found = seed, found
        self._world, self._oracle, self._on_floor = world_of(
            np.random.default_rng(seed), (float(drawn[0]), float(drawn[1]))
        )
        self._twin, *_ = world_of(np.random.default_rng(seed))
        self._limits = float(drawn[0]) * limits_of_judge, float(drawn[1]) * limits_of_judge

    def run(self) -> None:
        world, found = self._world, self._found
        if world.check():
            found.ends["not held at first"] += 1
            return
        drive = Drive(np.random.default_rng(self._seed + 2000), self._on_floor)
        for k in range(PERIODS):
            (left, right), palms = drive.next(k, world.palms)
            self._before = Moment.of(world)
            reason, *_, pieces = world.move((left, right), palms)
            after = Moment.of(world)
            name = f"seed {self._seed}, period {k}"
            if reason:
                found.ends[reason] += 1
                if reason == "jammed" and pieces == 1 and after == self._before:
                    self._judge_jam(name, left, right, palms)
                return
            if pieces == 1:
                self._judge(name, left, right, after)
        found.ends["completed"] += 1

    def _excess(self, left: Pair, right: Pair, palms: Pair, most: bool = False) -> float:
        """What a motion from the same place exceeds the limits by, if no robot stalls."""
        at = self._before
        self._twin.put(at.pivots, at.palms, at.pose[:2], at.pose[2])
        if self._twin.move((left, right), palms)[0]:
            return np.inf
        found = excess(self._oracle, at, Moment.of(self._twin), self._limits, most)
        return np.inf if found is None else found

    def _judge(self, name: str, left: Pair, right: Pair, after: Moment) -> None:
        """One period, in which the pivots should have moved by `left` and `right`."""
        before, found, by = self._before, self._found, (left, right)
        ways = [b[0] - a[0] for a, b in zip(before.pivots, after.pivots, strict=True)]
        shares = [way / one[0] if one[0] else 1.0 for way, one in zip(ways, by, strict=True)]
        if not all(-1e-9 <= share <= 1 + 1e-9 for share in shares):
            found.faults.append(f"{name}: backwards or too fast, {shares}")
        own = excess(self._oracle, before, after, self._limits)
        if own is not None and own > NEAR:
            found.faults.append(f"{name}: its own motion takes {own:.3g} too much")
        stalled = [share < 1 - 1e-6 for share in shares]
        if not any(stalled):
            found.drives += 1
            return
        found.stalls[sum(stalled)] += 1
        if self._excess(left, right, after.palms) < -NEAR:
            found.faults.append(f"{name}: stalls, but both can drive")
        weaker = 0 if self._limits[0] <= self._limits[1] else 1
        if self._limits[0] == self._limits[1] or not stalled[1 - weaker]:
            return
        for x in (0.0, by[1 - weaker][0]):
            if 0 <= x * by[weaker][0] <= by[weaker][0] ** 2:
                tried = [left, right]
                tried[weaker] = x, by[weaker][1]
                if self._excess(tried[0], tried[1], after.palms) < -NEAR:
                    found.faults.append(f"{name}: the stronger robot stalls, but need not")

    def _judge_jam(self, name: str, left: Pair, right: Pair, palms: Pair) -> None:
        """Nothing moved: so there are no speeds at which a robot that stalls is at its limit."""
        for x in (0.0, 0.5 * left[0], left[0], right[0]):
            for y in (0.0, 0.5 * right[0], right[0], left[0]):
                is_allowed = 0 <= x * left[0] <= left[0] ** 2 and 0 <= y * right[0] <= right[0] ** 2
                tried = (x, left[1]), (y, right[1]), palms
                if not is_allowed or self._excess(*tried) > -NEAR:
                    continue
                if self._excess(*tried, most=True) > NEAR:
                    self._found.faults.append(f"{name}: jammed, but {x:.3g} and {y:.3g} do")
        self._found.jams += 1


def run(seed: int, found: Stalls, limits_of_judge: float = 1.0) -> None:
    """One script, to its end."""
    try:
        script = Script(seed, found, limits_of_judge)
    except SceneError:
        found.ends["refused"] += 1
        return
    script.run()
