# SPDX-License-Identifier: Apache-2.0
"""The MuJoCo world: the time of a carry, and whether its carries end as the quasistatic ones.

    .venv/bin/python benchmarks/bench_mujoco.py [SEEDS]        at higher noise; 360 seeds by default

Carries of the default scene at several frictions, and at higher noise, where carries begin to fail,
in both worlds over the same seeds. Prints tables and writes benchmarks/results/mujoco.csv.
"""

import csv
import datetime
import statistics
import sys
import time
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from _machine import compiler, processor
from palmbots._util.confidence_intervals import wilson
from palmbots._version import __version__
from palmbots.mujoco.engine import mujoco
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, run_seeds
from palmbots.simulation.single import carry

RESULTS = Path(__file__).parent / "results" / "mujoco.csv"
FRICTIONS, SEEDS = (0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8), 12
NOISES, MANY, KNOWN = (0.02, 0.025, 0.03, 0.04), 360, 4000


def main() -> None:
    """Carry, compare, print, write."""
    console = Console(width=120)
    rows: list[tuple[object, ...]] = []
    cells = [("palm.friction", f, SEEDS) for f in FRICTIONS]
    many = int(sys.argv[1]) if len(sys.argv) > 1 else MANY
    cells += [("robot.noise_m_s", n, many) for n in NOISES]
    times: list[float] = []
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("carrying", total=sum(n for *_, n in cells))
        for key, value, n in cells:
            scene = load_scene("paper", {key: value})
            delivered = 0
            for seed in range(n):
                began = time.process_time()
                done = carry(scene, world="mujoco", seed=seed, record=False)
                if value == 0.3:
                    times.append(time.process_time() - began)
                delivered += done.outcome == "delivered"
                bar.advance(task)
            known = run_seeds(to_spec(scene), "distributed", 0, KNOWN, "double")["outcome"]
            rate = float((known == DELIVERED).mean())
            same = int((known[:n] == DELIVERED).sum())
            low, high = wilson(same, n)
            inside = low <= delivered / n <= high
            rows.append((key, value, n, delivered, same, low, high, inside, KNOWN, rate))
            console.print(
                f"{key} = {value:<5g} mujoco delivers {delivered:3d} of {n:3d}, quasistatic "
                f"{same:3d} of the same ({100 * low:5.1f} to {100 * high:5.1f} %), "
                f"{100 * rate:6.2f} % of {KNOWN}"
            )
    best, median = min(times), statistics.median(times)
    console.print(f"a carry of 25 s takes {best:.2f} s at best, {median:.2f} s in the median")
    with RESULTS.open("w", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(("key", "value", "n", "mujoco_delivered", "quasistatic_delivered",
                        "quasistatic_low", "quasistatic_high", "inside", "more_n",
                        "quasistatic_rate_of_more", "best_s", "median_s", "machine",
                        "compiler", "palmbots", "mujoco", "date"))  # fmt: skip
        stamp = (f"{best:.3f}", f"{median:.3f}", processor(), compiler(), __version__,
                 mujoco().__version__, datetime.date.today().isoformat())  # fmt: skip
        for row in rows:
            shown = (f"{x:.4f}" if isinstance(x, float) and x != row[1] else x for x in row)
            table.writerow((*shown, *stamp))


if __name__ == "__main__":
    main()
