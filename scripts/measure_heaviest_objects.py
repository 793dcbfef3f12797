# SPDX-License-Identifier: Apache-2.0
"""Bisect the heaviest object that MuJoCo delivers, beside the static limit at the start.

Prints the table of docs/reference/mujoco-agreement.md. The carries run without the check of the
load, which would refuse them.
"""

import math
from dataclasses import replace
from typing import Any

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.mechanics.load_limits import mass_text
from palmbots.mujoco.carry_runner import run
from palmbots.simulation.prepare import prepare

CRATE = {
    "object.box_m": [0.40, 0.12], "object.com_m": [0.22, 0.10], "object.depth_m": 0.2,
    "palm.friction": 0.35, "palm.length_m": 0.08,
}  # fmt: skip
SCENES: dict[str, dict[str, Any]] = {
    "default": {},
    "0.40 × 0.12 m, COM (0.22, 0.10), friction 0.35, palms 0.08 m": CRATE,
    "0.60 × 0.16 m": {"object.box_m": [0.60, 0.16]},
    "default, `mujoco.body_kg` = 6": {"mujoco.body_kg": 6.0},
    "default, `mujoco.axle_m` = 0.25": {"mujoco.axle_m": 0.25},
}
STEPS = 6


def delivers(keys: dict[str, Any], mass_kg: float) -> bool:
    """Whether MuJoCo delivers the object of a scene with another mass."""
    keys = keys | {"task.distance_m": 0.5, "object.mass_kg": 0.5}
    light = pb.load_scene("paper", keys)
    heavy = pb.load_scene("paper", keys | {"object.mass_kg": mass_kg})
    try:
        found = run(replace(prepare(light, "shared-sign", "mujoco"), scene=heavy), 0)
    except PalmbotsError:  # unstable
        return False
    return found.measured.outcome == "delivered"


def main() -> None:
    """Print a row for every scene."""
    for name, keys in SCENES.items():
        low, high = 0.3, 30.0
        for _ in range(STEPS):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if delivers(keys, middle) else (low, middle)
        limit = pb.load_limits("paper", overrides=keys).at_start_kg or math.inf
        print(f"| {name} | {mass_text(limit)} kg | {low:.3g} kg | {high:.3g} kg |", flush=True)


if __name__ == "__main__":
    main()
