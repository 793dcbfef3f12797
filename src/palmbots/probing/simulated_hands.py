# SPDX-License-Identifier: Apache-2.0
"""Simulated robots that probe in this program, in any world that is moved from outside."""

from __future__ import annotations

import math

from palmbots.drivers.hardware import HardwareParameters
from palmbots.errors import PalmbotsError
from palmbots.probing.contact_tracking import Give, Pair
from palmbots.probing.robot_hands import Commands, Readings, RobotHands
from palmbots.scene.scene import Scene
from palmbots.simulation.probe_stage import ProbeStage
from palmbots.simulation.worlds import world_entry

# Measured by tests/probing/test_probe_in_mujoco.py, with margins (docs/theory/probing.md).
_GIVES = {
    "quasistatic": Give(),
    "mujoco": Give(
        angle=math.radians(0.2), loop=0.0007, turn=0.0004, squeeze=1.2, creep=0.0001, edge=0.0001,
        overshoot=0.0008, clearance=0.0003, settling_s=0.1,
    ),
}  # fmt: skip


def give_of(world: str) -> Give:
    """By how much a world departs from the quasistatic one.

    Raises:
        PalmbotsError: there is no such world, or it is not known for this one.
    """
    world_entry(world)
    if world not in _GIVES:
        raise PalmbotsError(f"world: value is {world!r}; allowed: {' or '.join(_GIVES)}")
    return _GIVES[world]


class SimulatedHands(RobotHands):
    """A pair in this program.

    Args:
        scene: the robots, and the object as it really is.
        errors: by how much each palm really is steeper than its encoder shows [rad].
        world: the name of the world.

    Raises:
        SceneError: the world refuses the scene.
        PalmbotsError: the world needs a dependency that is not installed.
    """

    def __init__(self, scene: Scene, errors: Pair, world: str) -> None:
        self.stage = ProbeStage(scene, world, errors)
        hardware = HardwareParameters()
        period_s = scene.control.period_s
        super().__init__((hardware, hardware), period_s, self._act, self.stage.readings())
        self.end = self.stage.world.end

    def _act(self, commands: Commands) -> Readings:
        self.stage.step(*commands)
        self.end = self.stage.world.end
        return self.stage.readings()
