#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long the resilient algorithm needs after a fault until both robots travel again.

    .venv/bin/python benchmarks/bench_recovery.py [CARRIES]        50 each by default

Each carry of the default scene has three faults of a kind, at 3, 9 and 15 s, of one robot. Counted
is the time from the end of a fault until both are commanded to travel. By then they hear each other
again and have corrected, standing, what the stop has shifted. Seeds are 0, 1, …; the counts
depend on nothing but the version.
"""

import sys

import numpy as np

import palmbots as pb

FAULTS_S = (3.0, 9.0, 15.0)


def stood_s(kind: str, robot: str, for_s: float, seed: int) -> list[float]:
    """Of one carry, one number a fault."""
    script = [{"kind": kind, "robot": robot, "at_s": at, "duration_s": for_s} for at in FAULTS_S]
    done = pb.carry("paper", "resilient", seed=seed, overrides={"faults.script": script})
    assert done.trace is not None
    assert done.outcome == "delivered"
    times = done.trace["time"].to_numpy()[:-1]
    travel = np.all(np.abs(done.trace["commanded"].to_numpy()[:-1]) > 1e-9, axis=1)
    ends = [at + for_s for at in FAULTS_S]
    return [float(times[travel & (times > end - 1e-9)][0]) - end for end in ends]


def main() -> None:
    """A line for each kind and length of fault, over both robots."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    print("fault     for   faults  median     95 %  longest")
    for kind in ("reboot", "freeze"):
        for for_s in (0.05, 0.3, 2.0):
            durations = [stood_s(kind, r, for_s, s) for r in ("left", "right") for s in range(n)]
            stood = np.ravel(durations)
            median, most = np.quantile(stood, [0.5, 0.95])
            print(
                f"{kind:8}{for_s:4.2f} s{stood.size:9}{median:6.2f} s{most:7.2f} s"
                f"{stood.max():7.2f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
