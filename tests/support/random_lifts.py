# SPDX-License-Identifier: Apache-2.0
"""Random jobs from floor to floor: plates, objects and frictions, some of which cannot work."""

from typing import Any

import numpy as np


def random_lift(seed: int) -> dict[str, Any]:
    """Keys to set in the scene `lift`."""
    rng = np.random.default_rng(seed)

    def u(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    radius, width, height = u(0.001, 0.008), u(0.14, 0.45), u(0.06, 0.3)
    nose = u(0, radius * (1.2 if rng.random() < 0.3 else 0.5))
    steep = u(10, 35)
    return {
        "object.edge_radius_m": radius,
        "object.vertices_m": [[0, 0], [width, 0], [width, height], [0, height]],
        "object.com_m": [u(0.4, 0.6) * width, u(0.2, 0.5) * height],
        "object.mass_kg": u(0.1, 1.0),
        "palm.nose_m": nose,
        "palm.thickness_m": nose + u(0, 0.0015),
        "palm.bevel_m": u(0.004, 0.02),
        "palm.heel_m": 0.0 if rng.random() < 0.3 else u(0, 0.02),
        "palm.steep_deg": steep,
        "palm.shallow_deg": u(1, steep - 3),
        "palm.friction": u(0.1, 0.6),
        "palm.length_m": u(0.06, 0.18),
        "floor.friction": u(0.1, 0.8),
        "task.distance_m": 0.3,
    }
