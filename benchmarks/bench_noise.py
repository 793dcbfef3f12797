#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Drop rate over the noise: every controller, the references, and the bound of all controllers.

    .venv/bin/python benchmarks/bench_noise.py [new]

4000 carries of the default scene for each point, with the same seeds. Controllers whose robots may
stop are compared with the bound for such speeds; without stopping (`control.brake = false`), with
the bound for corrections only. The points of a reference begin at the greatest noise and end with
the first one at which nothing drops, those of the bound where it is below one in a million. The
references do not run in lanes: all of it takes about ten minutes of one core. Writes
benchmarks/results/noise.csv after each point and continues where it was stopped; `new` starts from
the beginning. scripts/draw_images.py draws docs/images/noise.png.
"""

from pathlib import Path

import palmbots as pb
from _cells import Cells
from palmbots.control.registry import shipped_names
from palmbots.optimum.opening import COARSE, FINE, best_price, opening_problem, solve
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DROPPED, available_cores, run_seeds

RESULT = Path(__file__).parent / "results" / "noise.csv"
CARRIES = 4000
NOISES_M_S = tuple(round(0.005 * i, 3) for i in range(1, 13))
HEAD = ("speeds", "controller", "noise_m_s", "carries", "dropped", "rate")

NEGLIGIBLE = 1e-6

STOPPING = {"control.brake": True}
CORRECTIONS = {"control.brake": False}
SHIPPED = (
    ("corrections", shipped_names("station", "robots")),
    ("stopping", ("silent", "shared-sign")),
)
REFERENCES = (
    ("corrections", ("kalman", "exact-p", "optimal")),
    ("stopping", ("kalman-stopping", "exact-p-stopping", "optimal-stopping")),
)


def scene_of(speeds: str, noise: float) -> pb.Scene:
    """The default scene with a speed noise [m/s]."""
    keys = STOPPING if speeds == "stopping" else CORRECTIONS
    return pb.load_scene("paper", keys | {"robot.noise_m_s": noise})


def measure(cells: Cells, speeds: str, controller: str, noise: float) -> int:
    """How many carries drop."""
    row = cells.row(speeds, controller, noise)
    if row is None:
        spec = to_spec(scene_of(speeds, noise))
        run = run_seeds(spec, controller, 0, CARRIES, threads=available_cores())
        dropped = int((run["outcome"] == DROPPED).sum())
        row = cells.add(speeds, controller, noise, CARRIES, dropped, dropped / CARRIES)
    return int(row[4])


def least(speeds: str, noise: float) -> float:
    """The least drop rate that any controller can reach."""
    problem = opening_problem(to_spec(scene_of(speeds, noise)), speeds)
    if speeds == "corrections":
        return solve(problem, FINE).drop
    return best_price(problem, COARSE).drop


def main() -> None:
    """Measure the points that the file lacks."""
    cells = Cells(RESULT, HEAD, 3)
    for speeds, names in SHIPPED:
        for name in names:
            for noise in NOISES_M_S:
                measure(cells, speeds, name, noise)
    for speeds, names in REFERENCES:
        for noise in reversed(NOISES_M_S):
            row = cells.row(speeds, "bound", noise)
            if row is None:
                row = cells.add(speeds, "bound", noise, 0, 0, f"{least(speeds, noise):.3g}")
            if float(row[5]) < NEGLIGIBLE:
                break
        for name in names:
            for noise in reversed(NOISES_M_S):
                if measure(cells, speeds, name, noise) == 0:
                    break


if __name__ == "__main__":
    main()
