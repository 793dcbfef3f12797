"""Curved paths in the dynamic world: what arrives, and whether the sideways drift is as predicted.

    .venv/bin/python benchmarks/curves.py [--seeds 12]

The default scene (friction 0.3, noise 1 cm/s, distributed algorithm) on circles, a turn and an S,
without and with lips. For each seed the drift across the palms is predicted before
(`palmbots.dynamic.sideways`) and measured after. Prints a table, writes
benchmarks/results/curves.csv.
"""

import argparse
import csv
import datetime
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from machine import processor
from rich.console import Console
from rich.progress import Progress

from palmbots.dynamic.engine import mujoco
from palmbots.dynamic.run import run
from palmbots.dynamic.sideways import Forecast
from palmbots.errors import SceneError
from palmbots.scene import load_scene
from palmbots.version import __version__

RESULTS = Path(__file__).parent / "results" / "curves.csv"
LEAD = 0.25  # m, from the start until the middle of the pair is on the curve
LIPS = {"palm.lip_height_m": 0.03}


def path(kind: str, radius: float, distance: float, **more: Any) -> dict[str, Any]:
    """The keys of a path and of the way on it."""
    keys = {"kind": kind, "radius_m": radius} | more
    return {"task.distance_m": distance} | {f"task.path.{k}": v for k, v in keys.items()}


CASES: dict[str, dict[str, Any]] = {
    "25 s on R = 4 m": path("arc", 4.0, LEAD + 1.5),
    "25 s on R = 2 m": path("arc", 2.0, LEAD + 1.5),
    "25 s on R = 1 m": path("arc", 1.0, LEAD + 1.5),
    "25 s on R = 0.7 m": path("arc", 0.7, LEAD + 1.5),
    "25 s on R = 0.5 m": path("arc", 0.5, LEAD + 1.5),
    "turn of 90 degrees, R = 1 m": path("arc", 1.0, 2 * LEAD + 1.67, angle_deg=90.0),
    "S, twice 45 degrees, R = 1 m": path("s", 1.0, 2 * LEAD + 1.77, angle_deg=45.0),
    "50 s on R = 1 m": path("arc", 1.0, LEAD + 3.0),
    "50 s on R = 1 m, lips 10 mm": path("arc", 1.0, LEAD + 3.0)
    | LIPS
    | {"palm.lip_clearance_m": 0.010},
    "25 s on R = 1 m, lips 3 mm": path("arc", 1.0, LEAD + 1.5)
    | LIPS
    | {"palm.lip_clearance_m": 0.003},
    "25 s on R = 2 m, axles 0.2 m out": path("arc", 2.0, LEAD + 1.7) | {"dynamic.axle_m": 0.2},
}


def main() -> None:
    """Predict, carry, print, write."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=12)
    seeds = parser.parse_args().seeds
    console = Console(width=120)
    rows: list[tuple[str, int, str, str, float, float, float]] = []
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("carrying", total=seeds * len(CASES))
        for name, keys in CASES.items():
            scene = load_scene("paper", keys)
            try:
                known = Forecast(scene)
            except SceneError:
                known = None  # lips that jam
            ends: Counter[str] = Counter()
            ratios = []
            told: list[float] = []
            for seed in range(seeds):
                done, _, across = run(scene, "distributed", seed)
                seen = max(map(abs, across))
                drift = np.nan if known is None else float(np.abs(known.seed(seed)).max())
                ends[done.reason or done.outcome] += 1
                told.append(drift)
                if done.outcome == "delivered":
                    ratios.append(seen / drift)
                rows.append((name, seed, done.outcome, done.reason or "", round(done.time_s, 2),
                             round(1e3 * drift, 2), round(1e3 * seen, 2)))  # fmt: skip
                bar.advance(task)
            measured = [row[6] for row in rows[-seeds:] if row[2] == "delivered"]
            shown = f"{np.mean(measured):5.1f} ({max(measured):.1f})" if measured else "–"
            spread = f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else "–"
            console.print(
                f"{name:34} {dict(ends)!s:40} predicted {1e3 * np.mean(told):5.1f} "
                f"({1e3 * max(told):.1f}) mm, seen {shown} mm, ratio {spread}"
            )
    with RESULTS.open("w", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(("case", "seed", "outcome", "reason", "time_s", "predicted_mm", "seen_mm",
                        "machine", "palmbots", "mujoco", "date"))  # fmt: skip
        told_once = (processor(), __version__, mujoco().__version__,
                     datetime.date.today().isoformat())  # fmt: skip
        for row in rows:
            table.writerow((*row, *told_once))


if __name__ == "__main__":
    main()
