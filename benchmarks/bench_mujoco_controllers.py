# SPDX-License-Identifier: Apache-2.0
"""How often each controller drops the object in the MuJoCo world, beside the quasistatic one.

    .venv/bin/python benchmarks/bench_mujoco_controllers.py [SEEDS]           200 by default

Carries of the default scene at 3 cm/s of noise, and at 5 cm/s for the controllers whose robots may
stop, and of the scene `pipe` at 3 cm/s, in both worlds over the same seeds. All cores are used.
Writes benchmarks/results/mujoco_controllers.csv.
"""

import csv
import multiprocessing
import sys
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

from palmbots._util.confidence_intervals import wilson
from palmbots.control.registry import shipped_names
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DROPPED, run_seeds
from palmbots.simulation.single import carry

RESULTS = Path(__file__).parent / "results" / "mujoco_controllers.csv"
SEEDS = 200
CASES = [
    *(("paper", name, 0.03) for name in shipped_names("station", "robots")),
    ("paper", "silent", 0.05),
    ("paper", "shared-sign", 0.05),
    # `resilient` refuses the short palms of this scene.
    *(("pipe", name, 0.03) for name in shipped_names("station", "robots") if name != "resilient"),
]
HEAD = (
    "scene", "controller", "noise [cm/s]", "dropped in MuJoCo [%]", "95 %",
    "dropped, quasistatic [%]",
)  # fmt: skip


def drops(job: tuple[str, str, float, int]) -> bool:
    """Whether one carry drops the object."""
    name, controller, noise, seed = job
    scene = load_scene(name, {"robot.noise_m_s": noise})
    return carry(scene, controller, world="mujoco", seed=seed, record=False).outcome == "dropped"


def main() -> None:
    """Carry, print, write."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else SEEDS
    console = Console(width=120)
    table = Table(*HEAD, title=f"{seeds} carries each")
    rows = []
    with multiprocessing.Pool() as pool:
        for scene, controller, noise in track(CASES, console=Console(stderr=True)):
            jobs = [(scene, controller, noise, seed) for seed in range(seeds)]
            dropped = sum(pool.imap_unordered(drops, jobs))
            low, high = wilson(dropped, seeds)
            spec = to_spec(load_scene(scene, {"robot.noise_m_s": noise}))
            known = run_seeds(spec, controller, 0, seeds, "double")["outcome"]
            percent = (100 * x for x in (dropped / seeds, low, high, (known == DROPPED).mean()))
            rate, low, high, quasistatic = (f"{x:.1f}" for x in percent)
            rows.append((scene, controller, f"{100 * noise:g}", rate, f"{low}–{high}", quasistatic))
            table.add_row(*rows[-1])
    console.print(table)
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *rows])


if __name__ == "__main__":
    main()
