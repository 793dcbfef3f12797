# SPDX-License-Identifier: Apache-2.0
"""How long a robot may take to stop."""

from palmbots._types import SIDES
from palmbots.scene.scene import Scene


def stopping_limit_s(scene: Scene) -> float:
    """The time in which a robot of the scene brakes from its nominal speed [s]. The time bounds of
    the controllers assume that no robot takes longer."""
    robots = [scene.robot_of(side) for side in SIDES]
    return max(robot.speed_m_s / robot.acceleration_m_s2 for robot in robots)
