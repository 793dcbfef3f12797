#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Jobs from the floor or a stand: how many succeed, and how far from the wanted place the object
ends.

    .venv/bin/python benchmarks/bench_lift.py [JOBS] [WORLD] [SCENE]        200 each by default

The scene is `lift`, `stand` or `lone`, with its noise of 1 cm/s, in the quasistatic world or in
MuJoCo. Seeds are 0, 1, …; the counts depend on nothing but the version. The miss is positive where
the object went too far.
"""

import sys
from collections import Counter

import numpy as np

import palmbots as pb
from palmbots.simulation.floor_job import FloorJob

CONTROLLERS = ("shared-sign", "resilient")


def jobs(controller: str, count: int, world: str, scene: str) -> tuple[Counter[str], list[float]]:
    """What failed, and the misses of the jobs that succeeded [m]."""
    failed: Counter[str] = Counter()
    missed = []
    for seed in range(count):
        job = pb.carry(scene, controller, seed=seed, world=world, record=False).floor_job
        assert isinstance(job, FloorJob)
        if job.failure is None:
            missed.append(job.missed_m)
        else:
            failed[job.failure] += 1
    return failed, missed


def main() -> None:
    """A line for each controller, and one for each kind of failure."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    world = sys.argv[2] if len(sys.argv) > 2 else "quasistatic"
    scene = sys.argv[3] if len(sys.argv) > 3 else "lift"
    print("controller     jobs  failed  median miss   95 % of the misses   95 % of |miss| within")
    for controller in CONTROLLERS[:1] if scene == "lone" else CONTROLLERS:
        failed, missed = jobs(controller, count, world, scene)
        low, median, high = 1e3 * np.quantile(missed, [0.025, 0.5, 0.975])
        within = 1e3 * np.quantile(np.abs(missed), 0.95)
        print(
            f"{controller:12}{count:7}{failed.total():8}{median:10.0f} mm"
            f"{low:11.0f} to {high:.0f} mm{within:18.0f} mm",
            flush=True,
        )
        for why, times in failed.most_common():
            print(f"{times:27}  {why}")


if __name__ == "__main__":
    main()
