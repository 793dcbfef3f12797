# SPDX-License-Identifier: Apache-2.0
"""Random jobs from a stand or the floor to a stand or the floor: sizes, frictions, contacts at the
start, some of which cannot work."""

from typing import Any

import numpy as np

_GAP_M = 0.26


def stands(from_m: float | None, to_m: float | None, distance_m: float) -> list[dict[str, float]]:
    """Stands of these heights below the object where the job begins and ends; None: there is
    none."""
    at = {0.0: from_m, distance_m: to_m}
    return [
        {"from_m": x - 0.25, "to_m": x + 0.25, "height_m": height, "gap_m": _GAP_M}
        for x, height in at.items()
        if height is not None
    ]


def random_stand(seed: int) -> dict[str, Any]:
    """Keys to set in the scene `stand`."""
    rng = np.random.default_rng(seed)

    def u(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    radius, width, height = u(0.001, 0.008), u(0.18, 0.45), u(0.06, 0.3)
    steep = u(8, 25)
    at_stand = rng.integers(1, 4)  # 1: the first, 2: the last, 3: both
    ends = tuple(u(0.08, 0.2) if at_stand & bit else None for bit in (1, 2))
    return {
        "object.edge_radius_m": radius,
        "object.vertices_m": [[0, 0], [width, 0], [width, height], [0, height]],
        "object.com_m": [u(0.4, 0.6) * width, u(0.2, 0.5) * height],
        "object.mass_kg": u(0.1, 0.8),
        "palm.steep_deg": steep,
        "palm.shallow_deg": u(1, steep - 3),
        "palm.friction": u(0.15, 0.6),
        "palm.length_m": u(0.06, 0.16),
        "floor.friction": u(0.1, 0.8),
        "floor.stands": stands(ends[0], ends[1], 0.6),
        "arm.carry_height_m": 0.28,
        "start.left_m": u(-0.02, 0.02),
        "start.right_m": u(-0.02, 0.02),
        "task.from": "floor" if ends[0] is None else "stand",
        "task.to": "floor" if ends[1] is None else "stand",
        "task.distance_m": 0.6,
    }
