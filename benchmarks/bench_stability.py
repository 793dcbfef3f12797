# SPDX-License-Identifier: Apache-2.0
"""A map of COM tolerance over a million pairs of palm angles, and an analysis, in one run.

    .venv/bin/python benchmarks/bench_stability.py

Prints a table with ratios and writes results/stability.csv. The peer asks scipy's HiGHS, as anyone
could: at one pair of angles, for every property, palm and extreme object angle, the least and the
greatest c_x for which the wanted contact mode balances, two linear programs each. Its tolerance is
compared with ours. One core; a time is the least of several repeats.
"""

import csv
import datetime
import math
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import scipy
from rich.console import Console
from rich.table import Table
from scipy.optimize import linprog

import palmbots as pb
from _machine import compiler, processor
from bench_contact_modes import least_s
from palmbots.stability.problem import stability_problem

RESULTS = Path(__file__).parent / "results" / "stability.csv"
N = 1000
WIDTH, COM_Y, FRICTION, HALF = 0.25, 0.04, 0.3, 0.075
PHI = math.atan(FRICTION)
STICK, UP, DOWN = (-PHI, PHI), (PHI,), (-PHI,)


def com_range(theta: tuple[float, float], rise: float, modes: tuple[tuple[float, ...], ...]):
    """The least and greatest c_x for which a contact mode balances at one object angle."""
    tilt = math.asin(rise / WIDTH)
    cos, sin = math.cos(tilt), math.sin(tilt)
    columns = []
    for side, at in ((0, (0.0, 0.0)), (1, (WIDTH * cos, WIDTH * sin))):
        for lean in modes[side]:
            angle = theta[side] + lean
            force = (math.sin(angle) * (1 - 2 * side), math.cos(angle))
            columns.append([*force, at[0] * force[1] - at[1] * force[0]])
    columns.append([0.0, 0.0, -cos])  # c_x, whose share of the moment is c_x cos ϑ
    matrix, wanted = np.array(columns).T, [0.0, 1.0, -COM_Y * sin]
    free = [(0, None)] * (len(columns) - 1) + [(None, None)]
    ends = []
    for sign in (1, -1):
        cost = np.zeros(len(columns))
        cost[-1] = sign
        found = linprog(cost, A_eq=matrix, b_eq=wanted, bounds=free, method="highs")
        ends.append(sign * found.fun if found.status == 0 else sign * math.inf)
    return ends


def by_linprog(shallow: float, steep: float) -> float:
    """The COM tolerance about the middle, properties 1 and 2 with either palm shallow."""
    low, high = 0.0, WIDTH
    sh, st = math.sin(shallow), math.sin(steep)
    first = {1: (UP, STICK), 2: (STICK, DOWN)}  # modes of the shallow and of the steep palm
    for number, (p, q) in first.items():
        # Extreme z with the left palm shallow; with the right one it is the mirror image.
        ends = (-HALF * st, HALF * (st + sh)) if number == 1 else (-HALF * sh, HALF * (st + sh))
        for z in ends:
            for theta, rise, modes in (
                ((shallow, steep), z, (p, q)),
                ((steep, shallow), -z, (q, p)),
            ):
                least, most = com_range(theta, rise, modes)
                low, high = max(low, least), min(high, most)
    return min(WIDTH / 2 - low, high - WIDTH / 2)


def main() -> None:
    """Time everything, print a table and write the CSV."""
    console = Console()
    at = stability_problem(pb.load_scene("paper"))
    envelope = at.envelope()
    shallow = np.radians(np.linspace(0, 20, N))
    steep = np.radians(np.linspace(20.02, 45, N))  # every pair has steep above shallow

    def whole():
        return envelope.map(shallow, steep, (at.com[0], at.com[0]), 0, 1.0, np.empty((0, 0)))

    one_map = least_s(whole, 5) / N**2
    places = [(250, 100), (400, 300), (500, 400), (300, 0)]
    ours, _ = whole()
    start = time.perf_counter()
    theirs = [by_linprog(float(shallow[i]), float(steep[j])) for i, j in places]
    peer = (time.perf_counter() - start) / len(places)
    for (i, j), value in zip(places, theirs, strict=True):
        assert abs(value - ours[i, j]) < 1e-8 or value <= 0 >= ours[i, j], (i, j, value, ours[i, j])

    analysis = least_s(lambda: pb.analyze("paper"), 9)
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "palmbots", "analyze", "--out", folder]
        drawn = least_s(lambda: subprocess.run(command, check=True, capture_output=True), 3)

    rows = [
        ("COM tolerance of one pair of angles", "palmbots", one_map, one_map, pb.__version__),
        ("COM tolerance of one pair of angles", "scipy HiGHS", peer, one_map, scipy.__version__),
        ("analyze, own time", "palmbots", analysis, analysis, pb.__version__),
        ("analyze --out, whole process", "palmbots", drawn, analysis, pb.__version__),
    ]
    table = Table("what", "by", "time", "ratio")
    for what, by, seconds, unit, _ in rows:
        shown = f"{1e6 * seconds:.2f} µs" if seconds < 1e-3 else f"{1e3 * seconds:.1f} ms"
        table.add_row(what, by, shown, f"{seconds / unit:,.0f}")
    console.print(table)
    console.print(f"{N} × {N} map: {one_map * N**2:.2f} s on {processor()}")
    with RESULTS.open("w", newline="") as file:
        write = csv.writer(file)
        write.writerow(
            ["what", "by", "seconds", "ratio", "version", "machine", "compiler", "python", "date"]
        )
        for what, by, seconds, unit, version in rows:
            write.writerow(
                [
                    what, by, f"{seconds:.3e}", f"{seconds / unit:.1f}", version, processor(),
                    compiler(), platform.python_version(), datetime.date.today().isoformat(),
                ]
            )  # fmt: skip


if __name__ == "__main__":
    main()
