#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often controllers drop the object on curved paths, with and without lips on the palms.

    .venv/bin/python benchmarks/bench_curved_controllers.py [new]

Carries in the MuJoCo world with 3 cm/s of noise, over the same seeds in each row. On a curve the
object drifts sideways while contacts slide; lips of 30 mm stop it. Drops over the side of a palm
and over its ends are counted separately. Writes benchmarks/results/curved_controllers.csv after
each row and continues where it was stopped; `new` starts from the beginning. Takes about ten
minutes of one core.
"""

from pathlib import Path
from typing import Any

import numpy as np

from _cells import Cells
from palmbots._util.confidence_intervals import wilson
from palmbots.simulation.result import Carry
from palmbots.simulation.single import carry

RESULT = Path(__file__).parent / "results" / "curved_controllers.csv"
SEEDS = 24
NOISE_M_S = 0.03
CONTROLLERS = ("distributed", "silent", "shared-sign")
ARC: dict[str, Any] = {"task.path.kind": "arc", "task.path.radius_m": 1.0}
S: dict[str, Any] = {"task.path.kind": "s", "task.path.radius_m": 1.0, "task.distance_m": 2.27}
LIPS = {"palm.lip_height_m": 0.03, "palm.lip_clearance_m": 0.01}
PATHS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("S of 1 m radius", S),
    ("arc of 1 m radius", ARC),
    ("arc of 1 m radius, lips", ARC | LIPS),
)
HEAD = (
    "path", "controller", "carries", "over an end", "over the side", "dropped 95 % [%]",
    "contact rms [mm]", "time [s]",
)  # fmt: skip


def fell_over_the_side(run: Carry) -> bool:
    """Whether a contact was nearer to the side of its palm than one to the end of its palm."""
    assert run.lateral_peak_m is not None
    aside = max(abs(offset) for offset in run.lateral_peak_m.values()) / run.scene.palm.width_m
    along = max(run.contact_peak_m.values()) / run.scene.palm.length_m
    return aside > along


def row(path: dict[str, Any], controller: str) -> tuple[Any, ...]:
    """One row without its key."""
    ends = sides = 0
    squares, times = [], []
    for seed in range(SEEDS):
        keys = path | {"robot.noise_m_s": NOISE_M_S}
        run = carry("paper", controller, world="mujoco", seed=seed, record=False, overrides=keys)
        if run.outcome == "dropped":
            is_side = fell_over_the_side(run)
            ends, sides = ends + (not is_side), sides + is_side
        else:
            times.append(run.time_s)
        squares += [value**2 for value in run.contact_rms_m.values()]
    low, high = wilson(ends + sides, SEEDS)
    rms = 1e3 * float(np.sqrt(np.mean(squares)))
    time = f"{np.mean(times):.1f}" if times else ""
    return SEEDS, ends, sides, f"{100 * low:.1f}–{100 * high:.1f}", f"{rms:.1f}", time


def main() -> None:
    """Carry what the file lacks."""
    cells = Cells(RESULT, HEAD, 2)
    for name, path in PATHS:
        for controller in CONTROLLERS:
            if cells.row(name, controller) is None:
                cells.add(name, controller, *row(path, controller))


if __name__ == "__main__":
    main()
