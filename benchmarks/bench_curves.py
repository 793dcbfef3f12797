# SPDX-License-Identifier: Apache-2.0
"""Curved paths in MuJoCo: how many carries arrive, and whether the lateral drift is as forecast.

    .venv/bin/python benchmarks/bench_curves.py [--carries 12] [--predict]

The default scene (friction 0.3, noise 1 cm/s, distributed algorithm) on circles, a turn and an S,
without and with lips. For each seed the drift across the palms is forecast before the carry
(`palmbots.mujoco.drift_forecast`) and measured after it. Prints a table and writes
benchmarks/results/curves.csv. With --predict it carries nothing and only computes forecasts.
"""

import argparse
import csv
import datetime
import math
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from _machine import processor
from palmbots._version import __version__
from palmbots.errors import SceneError
from palmbots.mujoco.drift_forecast import Forecast
from palmbots.mujoco.engine import mujoco
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.single import carry

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
    "25 s on R = 2 m, axles 0.2 m out": path("arc", 2.0, LEAD + 1.7) | {"mujoco.axle_m": 0.2},
}


def main() -> None:
    """Predict, carry, print, write."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--carries", type=int, default=12)
    parser.add_argument("--predict", action="store_true", help="anew, beside what is in the CSV")
    options = parser.parse_args()
    known = list(csv.DictReader(RESULTS.open())) if options.predict else []
    rows: list[dict[str, Any]] = []
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("carrying", total=options.carries * len(CASES))
        for name, keys in CASES.items():
            scene = load_scene("paper", keys)
            try:
                foreseen = Forecast(scene)
            except SceneError:
                foreseen = None  # lips that jam
            for seed in range(options.carries):
                if options.predict:
                    row = next(r for r in known if (r["case"], r["seed"]) == (name, str(seed)))
                else:
                    row = carried(name, scene, seed)
                drift = math.nan if foreseen is None else np.abs(foreseen.seed(seed)).max()
                rows.append(row | {"predicted_mm": round(1e3 * float(drift), 2)})
                bar.advance(task)
    print_rows(rows)
    with RESULTS.open("w", newline="") as stream:
        table = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def carried(name: str, scene: Scene, seed: int) -> dict[str, Any]:
    """One carry, as a row of the CSV."""
    done = carry(scene, world="mujoco", seed=seed, record=False)
    assert done.lateral_peak_m is not None
    return {
        "case": name,
        "seed": seed,
        "outcome": done.outcome,
        "reason": done.reason or "",
        "time_s": round(done.time_s, 2),
        "predicted_mm": 0.0,
        "seen_mm": round(1e3 * max(map(abs, done.lateral_peak_m.values())), 2),
        "machine": processor(),
        "palmbots": __version__,
        "mujoco": mujoco().__version__,
        "date": datetime.date.today().isoformat(),
    }


def print_rows(rows: list[dict[str, Any]]) -> None:
    """The table of docs/reference/mujoco-agreement.md. What is seen, and its ratio to what was
    predicted, is of carries that arrived: the drift of an object that fell says where it fell."""
    table = Table(box=None, pad_edge=False, padding=(0, 3, 0, 0))
    for head in ("carries", "delivered", "predicted, mean (mm)", "most", "seen, mean (mm)",
                 "most", "seen / predicted"):  # fmt: skip
        table.add_column(head, justify="left" if head == "carries" else "right")
    for name in CASES:
        cases = [row for row in rows if row["case"] == name]
        whole = [row for row in cases if row["outcome"] == "delivered"]
        predicted = [row["predicted_mm"] for row in cases]
        seen = [float(row["seen_mm"]) for row in whole]
        ratio = [float(row["seen_mm"]) / row["predicted_mm"] for row in whole]
        lips = "palm.lip_height_m" in CASES[name]
        table.add_row(
            name,
            f"{len(whole)} of {len(cases)}",
            *(("lips", "") if lips else (f"{np.mean(predicted):.1f}", f"{max(predicted):.1f}")),
            *((f"{np.mean(seen):.1f}", f"{max(seen):.1f}") if seen else ("–", "")),
            f"{min(ratio):.2f} to {max(ratio):.2f}" if ratio and not lips else "–",
        )
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
