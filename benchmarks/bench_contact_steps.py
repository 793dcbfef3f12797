#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Processor time of single steps of the quasistatic world with any contacts.

    .venv/bin/python benchmarks/bench_contact_steps.py [SCRIPTS]          1000 by default

The steps are control periods of the random scripts of tests/support/palm_scripts.py: rounded and
sharp objects on palms with noses and heels, with and without surroundings. Each step is timed as
Python calls it, which adds about a microsecond. The first step of a script has its own row,
because it also makes the shapes, with cold caches. Writes benchmarks/results/contact_steps.csv.
"""

import csv
import sys
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from _machine import load, processor
from palmbots.errors import SceneError

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "support"))
from palm_scripts import PERIODS, Drive, world_of

RESULTS = Path(__file__).parent / "results" / "contact_steps.csv"
FIRST = "first of a script"
PERSIST, CHANGE = "contacts persist", "contacts or their modes change"
HEAD = ("step", "most contacts", "steps", "median [us]", "p99 [us]", "longest [us]")


def times(scripts: int) -> dict[tuple[str, int], list[float]]:
    """Times of steps [us], by what happens in them and by the most contacts before or after."""
    found: dict[tuple[str, int], list[float]] = defaultdict(list)
    for seed in range(scripts):
        rng = np.random.default_rng(seed)
        try:
            world, _, on_floor = world_of(rng)
        except SceneError:
            continue
        drive = Drive(rng, on_floor)
        before, moved = world.constraints, None
        for k in range(PERIODS):
            motion = drive.next(k, world.palms)
            begun = time.thread_time_ns()
            reason, _, *modes, pieces = world.move(*motion)
            took = (time.thread_time_ns() - begun) / 1000
            after = world.constraints
            persists = pieces == 1 and before == after and modes == moved
            kind = FIRST if k == 0 else PERSIST if persists else CHANGE
            found[kind, max(2, len(before), len(after))].append(took)
            before, moved = after, modes
            if reason:
                break
    return found


def main() -> None:
    """Run the scripts, print, write."""
    found = times(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
    table = Table(*HEAD, title=f"{processor()}; load {load():.1f}")
    rows = []
    for kind in (FIRST, PERSIST, CHANGE):
        for contacts in sorted({n for k, n in found if k == kind}):
            took = np.array(found[kind, contacts])
            numbers = (np.median(took), np.quantile(took, 0.99), took.max())
            rows.append((kind, str(contacts), str(len(took)), *(f"{x:.1f}" for x in numbers)))
            table.add_row(*rows[-1])
    Console(width=100).print(table)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([("machine", processor()), HEAD, *rows])


if __name__ == "__main__":
    main()
