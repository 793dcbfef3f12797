# SPDX-License-Identifier: Apache-2.0
"""What each command of a controller means for the hardware: an angle and a speed."""

import math
from itertools import product

from palmbots._types import Side
from palmbots.drivers.driver import Drive
from palmbots.scene.scene import Scene


def drive_table(
    scene: Scene, side: Side, *, half_moves: bool = False
) -> dict[tuple[int, int, bool, bool], Drive]:
    """The drives of one robot, by palm, move, stop and wheels, as the core numbers them.

    Args:
        scene: the scene of the pair.
        side: which of its robots.
        half_moves: both robots correct at once, at half the correction speed each, as under the
            centralized algorithm.
    """
    robot, palm = scene.robot_of(side), scene.palm_of(side)
    leads = (side == "right") == (scene.task.direction == "forward")
    correction = robot.correction_m_s * (0.5 if half_moves else 1.0)
    away = correction if leads else -correction  # the follower moves away by falling behind
    added = (0.0, away, -away)
    angles = tuple(math.radians(angle) for angle in (palm.steep_deg, palm.shallow_deg))
    table = {}
    for shape in product((0, 1), (0, 1, 2), (False, True), (False, True)):
        which, move, stop, wheels = shape
        wanted = (0.0 if stop else robot.speed_m_s) + added[move]
        speed = max(-robot.max_speed_m_s, min(wanted, robot.max_speed_m_s)) if wheels else 0.0
        table[shape] = Drive(which, move, stop, wheels, angles[which], speed)
    return table
