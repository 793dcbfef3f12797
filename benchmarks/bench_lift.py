#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Jobs from the floor or a stand: how many succeed, and how far from the wanted place the object
ends.

    .venv/bin/python benchmarks/bench_lift.py [JOBS] [WORLD] [SCENE] [KEY=VALUE …]    200 jobs

The scene is `lift`, `stand`, `lone` or `handover`, with its noise of 1 cm/s, in the quasistatic
world or in MuJoCo. Seeds are 0, 1, …; the counts depend on nothing but the version. The miss is
positive where the object went too far. The time is that of the processor, without the checks before
the first job.
"""

import sys
import time
from collections import Counter

import numpy as np

import palmbots as pb
from palmbots.control.registry import resolve
from palmbots.scene.overrides import parse_overrides
from palmbots.simulation.floor_job import floor_job
from palmbots.simulation.prepare import prepare

CONTROLLERS = ("shared-sign", "resilient")


def jobs(
    controller: str, count: int, world: str, scene: pb.Scene
) -> tuple[Counter[str], list[float], float]:
    """What failed, the misses of the jobs that succeeded [m], and the time of a job [s]."""
    prepared = prepare(scene, resolve(controller), world)
    failed: Counter[str] = Counter()
    missed = []
    start = time.process_time()
    for seed in range(count):
        done = prepared.world.run(prepared, seed, record=False)
        job = floor_job(prepared.scene, done.measured)
        if job.failure is None:
            missed.append(job.missed_m)
        else:
            failed[job.failure] += 1
            print(f"seed {seed}: {job.failure}", file=sys.stderr)
    return failed, missed, (time.process_time() - start) / count


def main() -> None:
    """A line for each controller, and one for each kind of failure."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    world = sys.argv[2] if len(sys.argv) > 2 else "quasistatic"
    name = sys.argv[3] if len(sys.argv) > 3 else "lift"
    scene = pb.load_scene(name, parse_overrides(sys.argv[4:]))
    print(
        "controller     jobs  failed  median miss  95 % of the misses  95 % of |miss| below  time"
    )
    for controller in CONTROLLERS[:1] if name in ("lone", "handover") else CONTROLLERS:
        failed, missed, job_s = jobs(controller, count, world, scene)
        low, median, high = 1e3 * np.quantile(missed, [0.025, 0.5, 0.975])
        within = 1e3 * np.quantile(np.abs(missed), 0.95)
        print(
            f"{controller:12}{count:7}{failed.total():8}{median:10.0f} mm"
            f"{low:10.0f} to {high:.0f} mm{within:17.0f} mm{1e3 * job_s:11.1f} ms",
            flush=True,
        )
        for why, times in failed.most_common():
            print(f"{times:27}  {why}")
        if world == "quasistatic":
            first, last = pb.final_place(scene, controller).interval_m
            share = np.mean([first <= miss <= last for miss in missed])
            print(f"{'':27}  {100 * share:.1f} % within what final-place states", flush=True)


if __name__ == "__main__":
    main()
