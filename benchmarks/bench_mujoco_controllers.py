# SPDX-License-Identifier: Apache-2.0
"""How often each controller drops the object in the MuJoCo world, beside the quasistatic one.

    .venv/bin/python benchmarks/bench_mujoco_controllers.py [CONDITION ...]

The default scene at 3 and at 5 cm/s of noise, the scene `pipe`, and objects with rounded corners or
from a household (those of bench_robustness.py), in both worlds over the same seeds. All cores are
used. Writes benchmarks/results/mujoco_controllers.csv; rows of other conditions stay.
"""

import csv
import multiprocessing
import sys
from collections.abc import Iterator
from multiprocessing.pool import Pool
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

import palmbots as pb
from _household import HOUSEHOLD
from bench_robustness import CONDITIONS, Condition, household, scene_of
from palmbots._util.confidence_intervals import wilson
from palmbots.control.registry import shipped_names
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DROPPED, run_seeds
from palmbots.simulation.prepare import prepare
from palmbots.simulation.single import carry

RESULTS = Path(__file__).parent / "results" / "mujoco_controllers.csv"
CONTROLLERS = shipped_names("station", "robots")
STOPPING = ("silent", "shared-sign")
OBJECTS = ("object `bottle`", "object `carton`", *(f"object {one.name}" for one in HOUSEHOLD))
# A case: a condition, the noise [m/s], the controllers and how many carries each of them makes.
CASES = (
    ("default scene", 0.03, CONTROLLERS, 200),
    ("default scene", 0.05, STOPPING, 200),
    ("scene `pipe`", 0.03, CONTROLLERS, 200),
    *((name, 0.02, CONTROLLERS, 24) for name in OBJECTS),
)
HEAD = (
    "condition", "controller", "noise [cm/s]", "carries", "dropped in MuJoCo [%]", "95 %",
    "dropped, quasistatic [%]",
)  # fmt: skip


def drops(job: tuple[pb.Scene, str, int]) -> bool:
    """Whether one carry drops the object."""
    scene, controller, seed = job
    return carry(scene, controller, world="mujoco", seed=seed, record=False).outcome == "dropped"


def cells(
    pool: Pool, condition: Condition, noise: float, names: tuple[str, ...],
    seeds: int,
) -> Iterator[tuple[str, ...]]:  # fmt: skip
    """The rows of a case."""
    scene = scene_of(condition, noise)
    for controller in names:
        first = (condition[0], controller, f"{100 * noise:g}")
        try:
            spec = to_spec(prepare(scene, controller).scene)
        except pb.SceneError:
            yield (*first, "0", "refused", "", "refused")
            continue
        dropped = sum(pool.imap_unordered(drops, [(scene, controller, n) for n in range(seeds)]))
        low, high = wilson(dropped, seeds)
        known = run_seeds(spec, controller, 0, seeds, "double")["outcome"]
        percent = (100 * x for x in (dropped / seeds, low, high, (known == DROPPED).mean()))
        rate, low, high, quasistatic = (f"{x:.1f}" for x in percent)
        yield (*first, str(seeds), rate, f"{low}–{high}", quasistatic)


def main() -> None:
    """Carry, print, write."""
    only = sys.argv[1:]
    with RESULTS.open(newline="", encoding="utf-8") as file:
        known = [tuple(row) for row in csv.reader(file)][1:]
    conditions = {one[0]: one for one in (*CONDITIONS, *household())}
    rows: list[tuple[str, ...]] = []
    with multiprocessing.Pool() as pool:
        for name, noise, controllers, seeds in track(CASES, console=Console(stderr=True)):
            if name not in conditions or (only and name not in only):
                kept = (name, f"{100 * noise:g}")
                rows += [row for row in known if (row[0], row[2]) == kept]
            else:
                rows += cells(pool, conditions[name], noise, controllers, seeds)
    table = Table(*HEAD)
    for row in rows:
        table.add_row(*row)
    Console(width=120).print(table)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *rows])


if __name__ == "__main__":
    main()
