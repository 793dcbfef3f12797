# SPDX-License-Identifier: Apache-2.0
"""Scenes with random objects, palms and motors, of which every shipped controller accepts most."""

import numpy as np

import palmbots as pb


def random_scene(seed: int, distance_m: float) -> pb.Scene:
    """A box or trapezoid of random size, with its COM off centre, on random palms and motors.

    The palm angles are the paper's, 5° and 15°.
    """
    rng = np.random.default_rng([seed, 23])
    width, height = rng.uniform(0.15, 0.5), rng.uniform(0.06, 0.3)
    inset = rng.uniform(0.0, 0.25) * width * rng.integers(0, 2)
    com = (width * rng.uniform(0.45, 0.55), height * rng.uniform(0.1, 0.4))
    outline = [(0, 0), (width, 0), (width - inset, height), (inset, height)]
    return pb.load_scene(
        {
            "object": {"vertices_m": outline, "contacts": [0, 1], "com_m": com, "mass_kg": 0.5},
            "palm": {
                "length_m": min(float(rng.uniform(0.08, 0.18)), 0.6 * width),
                "friction": float(rng.uniform(0.2, 0.5)),
                "rate_deg_s": float(rng.uniform(25, 100)),
            },
            "robot": {"correction_m_s": float(rng.uniform(0.02, 0.05))},
            "task": {"distance_m": distance_m},
        }
    )
