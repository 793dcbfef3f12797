#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Processor time of single steps of the quasistatic world with any contacts.

    .venv/bin/python benchmarks/bench_contact_steps.py [SCRIPTS]          1000 by default

The steps are control periods of the random scripts of tests/support/palm_scripts.py: rounded and
sharp objects on palms with noses and heels, with and without surroundings. As many further scripts
have up to six contacts: the object lies flush on level palms and touches their heels, or it stands
between their noses or a wall, flush with both. A third family has robots with limited forces, which
may stall. Each step is made three times, from copies of the world, and the least time counts. It is
timed as Python calls it: that adds about a microsecond. The first step of a script has its own row,
because it also makes the shapes. Writes benchmarks/results/contact_steps.csv.
"""

import csv
import math
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

import palmbots._core as _core
from _machine import load, processor
from palmbots.errors import SceneError
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "support"))
from palm_scripts import BOX, FAR, LEANING, NARROWER, PERIODS, PHASE, Drive, world_of

RESULTS = Path(__file__).parent / "results" / "contact_steps.csv"
REPEATS = 3  # of each step
FIRST = "first of a script"
PERSIST, CHANGE = "contacts persist", "contacts or their modes change"
LIMITED = ", robots with limits"
LIMITS = (0.3, 0.6, 1.0, 2.0)  # of their forces [weights]
HEAD = ("step", "most contacts", "steps", "median [us]", "p99 [us]", "longest [us]")


def flush_world(rng: np.random.Generator) -> _core.World:
    """An object flush on level palms with heels beside it, or on a floor between level palms."""
    lies = bool(rng.random() < 0.6)
    walled = not lies and rng.random() < 0.5
    keys: dict[str, Any] = {
        "palm.left.friction": float(rng.choice([0.1, 0.2, 0.3, 0.45])),
        "palm.right.friction": float(rng.choice([0.15, 0.3, 0.4])),
        "palm.thickness_m": float(rng.choice([0.003, 0.006])),
        "palm.heel_m": 0.012,
        "object.vertices_m": (BOX, LEANING, NARROWER)[rng.integers(3)] if lies else BOX,
        "object.edge_radius_m": float(rng.choice([0.0, 0.0005])),
        "floor.friction": float(rng.choice([0.15, 0.3, 0.6])),
    }
    half = BOX[1][0] / 2
    if walled:
        keys["floor.walls"] = [{"at_m": half + 0.001, "friction": 0.3, "height_m": 0.03}]
    spec = to_spec(load_scene("paper", keys))
    pivots = []
    for out, palm in zip((-1, 1), spec.palms, strict=True):
        end = palm.length / 2 * (-1 if lies else 1)
        away = FAR if walled and out > 0 else half + end + float(rng.uniform(0.0003, 0.002))
        pivots.append((out * away, palm.lowest_pivot(0.0)))
    low = min(y for _, y in spec.silhouette)
    level = pivots[0][1] + spec.palms[0].offset if lies else 0.0
    world = _core.World(spec, True)
    world.set_phase("by_hand")
    world.put((pivots[0], pivots[1]), (0.0, 0.0), (0.0, level + spec.com_height - low), 0.0)
    return world


class FlushDrive:
    """Random motions of level palms, constant for some periods; later they may turn."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._goal = (0.0, 0.0)
        self._ways = ((0.0, 0.0), (0.0, 0.0))

    def next(self, k: int, palms: tuple[float, float]) -> tuple[Any, tuple[float, float]]:
        """The way of each pivot in a period, and the palm angles after it."""
        rng = self._rng
        if k % PHASE == 0:
            x = [float(rng.normal(-out * 1e-4, 3e-4)) for out in (-1, 1)]
            if rng.random() < 0.25:
                x[1] = x[0]
            self._ways = ((x[0], 0.0), (x[1], 0.0))
            if k > 4 * PHASE and rng.random() < 0.3:
                turned = np.radians(rng.choice([0.0, 5.0], 2)).tolist()
                self._goal = (turned[0], turned[1])
        rate = math.radians(0.3)
        left, right = (
            angle + max(-rate, min(rate, goal - angle))
            for angle, goal in zip(palms, self._goal, strict=True)
        )
        return self._ways, (left, right)


def worlds(scripts: int) -> Iterator[tuple[_core.World, Drive | FlushDrive, str]]:
    """The worlds of the scripts, what moves their palms, and what to add to the names of rows."""
    for seed in range(scripts):
        rng = np.random.default_rng(seed)
        try:
            world, _, on_floor = world_of(rng)
        except SceneError:
            continue
        yield world, Drive(rng, on_floor), ""
        rng = np.random.default_rng([seed, 1])
        yield flush_world(rng), FlushDrive(rng), ""
        rng = np.random.default_rng([seed, 2])
        world, _, on_floor = world_of(rng, tuple(rng.choice(LIMITS, 2).tolist()))
        yield world, Drive(rng, on_floor), LIMITED


def timed(world: _core.World, motion: tuple[Any, tuple[float, float]]) -> float:
    """The time of a step of a copy of the world [us]."""
    copy = world.copy()
    begun = time.thread_time_ns()
    copy.move(*motion)
    return (time.thread_time_ns() - begun) / 1000


def times(scripts: int) -> dict[tuple[str, int], list[float]]:
    """Times of steps [us], by what happens in them and by the most contacts before or after."""
    found: dict[tuple[str, int], list[float]] = defaultdict(list)
    for world, drive, family in worlds(scripts):
        before, moved = world.constraints, None
        for k in range(PERIODS):
            motion = drive.next(k, world.palms)
            took = min(timed(world, motion) for _ in range(REPEATS))
            reason, _, *modes, pieces = world.move(*motion)
            after = world.constraints
            persists = pieces == 1 and before == after and modes == moved
            kind = FIRST if k == 0 else PERSIST if persists else CHANGE
            found[kind + family, max(2, len(before), len(after))].append(took)
            before, moved = after, modes
            if reason:
                break
    return found


def main() -> None:
    """Run the scripts, print, write."""
    found = times(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
    table = Table(*HEAD, title=f"{processor()}; load {load():.1f}")
    rows = []
    for kind in [k + family for family in ("", LIMITED) for k in (FIRST, PERSIST, CHANGE)]:
        by_contacts = {str(n): np.array(found[k, n]) for k, n in sorted(found) if k == kind}
        by_contacts["all"] = np.concatenate(list(by_contacts.values()))
        for contacts, took in by_contacts.items():
            numbers = (np.median(took), np.quantile(took, 0.99), took.max())
            rows.append((kind, contacts, str(len(took)), *(f"{x:.1f}" for x in numbers)))
            table.add_row(*rows[-1])
    Console(width=100).print(table)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([("machine", processor()), HEAD, *rows])


if __name__ == "__main__":
    main()
