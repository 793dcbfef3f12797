# SPDX-License-Identifier: Apache-2.0
"""What the odometry of two robots without slip reads during a carry."""

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots.simulation.result import Carry


def distances(carry: Carry) -> NDArray[np.float64]:
    """The distances [m] that the robots covered in the direction of travel, (time, side).

    Each is the advance of the midpoint of the pivots, and half of what the separation has grown,
    with the sign of the robot that leads or follows.
    """
    trace = carry.trace
    assert trace is not None
    separation = trace["separation"].to_numpy()
    grown = 0.5 * (separation - separation[0])
    right = 1 if carry.scene.task.direction == "forward" else -1
    signs = [right if side == "right" else -right for side in SIDES]
    return trace["midpoint"].to_numpy()[:, None] + grown[:, None] * signs
