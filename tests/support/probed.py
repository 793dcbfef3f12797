# SPDX-License-Identifier: Apache-2.0
"""Random objects for probes."""

import random
from typing import Any


def hidden(seed: int) -> dict[str, Any]:
    """A random object of the default prior, and where it lies."""
    draw = random.Random(seed)
    return {
        "object.com_m": [draw.uniform(0.095, 0.155), 0.04],
        "palm.left.friction": draw.uniform(0.15, 0.6),
        "palm.right.friction": draw.uniform(0.15, 0.6),
        "start.left_m": draw.uniform(-0.004, 0.004),
        "start.right_m": draw.uniform(-0.004, 0.004),
        "palm.pivot_offset_m": draw.choice([0.0, 0.02]),
    }
