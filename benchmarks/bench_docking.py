#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far the object moves while two robots get their palms under it.

    .venv/bin/python benchmarks/bench_docking.py [JOBS]        200 by default

Jobs of the scene `lift` in the quasistatic world. Distances are medians, positive towards the robot
whose palm is the first one under the object.
"""

import sys

import numpy as np

from palmbots.control.registry import resolve
from palmbots.scene.scene import load_scene
from palmbots.simulation.floor_job import FloorJob, floor_job
from palmbots.simulation.prepare import prepare

CONTROLLERS = ("shared-sign", "resilient", "distributed")


def moves(job: FloorJob) -> tuple[float, float, float]:
    """How far the object moves until the first palm is under it, until the second one is, and while
    the contacts are centred [m]."""
    under = [one for one in job.phases if one.phase == "under"]
    second = next(one for one in under if one.robot != under[0].robot)
    places = [
        under[0].moved_m,
        second.moved_m,
        next(one.moved_m for one in job.phases if one.phase == "raise"),
    ]
    sense = 1 if under[0].robot == "right" else -1
    first, rest, centring = sense * np.diff([0.0, *places])
    return first, rest, centring


def main() -> None:
    """A line for each controller."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    print("controller    first under  second under     centring")
    for controller in CONTROLLERS:
        prepared = prepare(load_scene("lift"), resolve(controller), "quasistatic")
        jobs = (
            floor_job(prepared.scene, prepared.world.run(prepared, seed, record=False).measured)
            for seed in range(count)
        )
        found = 1e3 * np.array([moves(job) for job in jobs if job.failure is None])
        print(f"{controller:12}" + "".join(f"{one:+10.0f} mm" for one in np.median(found, axis=0)))


if __name__ == "__main__":
    main()
