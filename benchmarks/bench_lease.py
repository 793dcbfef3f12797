#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether every lease that the resilient algorithm admits is safe.

    .venv/bin/python benchmarks/bench_lease.py [CARRIES]        20000 by default

For each speed noise: the default lease and the longest admitted one, and the drop rates of the
default scene without a fault and with one reboot of 2 s in every carry. Seeds are 0, 1, …; the
counts depend on nothing but the version.
"""

import sys
from typing import Any

import numpy as np

import palmbots as pb
from palmbots.control.resilient_timing import bounds_of
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds

NOISE_M_S = (0.005, 0.01, 0.015, 0.02, 0.025, 0.03)
REBOOT = {"faults.random_reboots": 1, "faults.reboot_s": 2.0}
DROPPED = 2


def drop_rate(overrides: dict[str, Any], carries: int) -> float:
    """The share of carries that drop the object."""
    scene = pb.load_scene("paper", {"task.timeout_s": 150.0, **overrides})
    bounds_of(scene)  # refuses a lease that is not admitted
    outcome = run_seeds(to_spec(scene), "resilient", 0, carries, "double")["outcome"]
    return float(np.mean(outcome == DROPPED))


def main() -> None:
    """A line for each noise and lease."""
    carries = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    print("    noise      lease             dropped   with a reboot")
    for noise in NOISE_M_S:
        bounds = bounds_of(pb.load_scene("paper", {"robot.noise_m_s": noise}))
        for name, lease in (("default", bounds.lease_s), ("longest", bounds.longest_lease_s)):
            keys = {"robot.noise_m_s": noise, "radio.lease_s": lease}
            without, with_reboot = (drop_rate(keys | more, carries) for more in ({}, REBOOT))
            row = f"{100 * noise:4.1f} cm/s   {lease:.2f} s ({name})"
            print(f"{row}   {without:9.3%} {with_reboot:15.3%}", flush=True)


if __name__ == "__main__":
    main()
