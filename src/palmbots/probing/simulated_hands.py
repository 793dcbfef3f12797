# SPDX-License-Identifier: Apache-2.0
"""Simulated robots that probe, in any world whose wheels and palms are moved from outside."""

from __future__ import annotations

import math

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.probing.contact_tracking import Give, Pair
from palmbots.probing.probe_run import Switches
from palmbots.scene.scene import Scene
from palmbots.simulation.imperfect_robot import zones_of
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


class SimulatedHands:
    """A pair.

    Args:
        scene: the robots, and the object as it really is.
        errors: by how much each palm really is steeper than its encoder shows [rad].
        world: the name of the world.

    Raises:
        SceneError: the world refuses the scene.
        PalmbotsError: the world needs a dependency that is not installed.
    """

    def __init__(self, scene: Scene, errors: Pair, world: str) -> None:
        driven = world_entry(world).driven
        assert driven is not None
        self._world = driven(scene)
        self._errors = errors
        self.period_s = scene.control.period_s
        self._zones = [zones_of(scene, side) for side in SIDES]
        self._contacts = [0.0, 0.0]
        self.farthest_m = 0.0
        """The largest |p| so far, which the robots do not know."""
        self._look()

    @property
    def end(self) -> str:
        """Why the object is no longer held; empty if it is."""
        return self._world.end

    def _look(self) -> None:
        for i, p in enumerate(self._world.pressed):
            if p is not None:
                self._contacts[i] = p
        self.farthest_m = max(self.farthest_m, *map(abs, self._contacts))

    def switches(self) -> Switches:
        """Which switches of each palm are closed."""
        left, right = (
            tuple(zone.from_m <= p <= zone.to_m for zone in zones)
            for p, zones in zip(self._contacts, self._zones, strict=True)
        )
        return left, right

    def step(self, change: float, angles: Pair) -> None:
        """One control period."""
        half = 0.5 * change / self.period_s
        left, right = (angle + error for angle, error in zip(angles, self._errors, strict=True))
        self._world.step(((-half, -half), (half, half)), (left, right))
        self._look()

    def read(self) -> tuple[float, Pair]:
        """What the encoders show: the separation from any start [m], and the palm angles [rad]."""
        (a, b), (c, d) = self._world.rolled()
        left, right = (
            angle - error for angle, error in zip(self._world.wrists(), self._errors, strict=True)
        )
        return 0.5 * (c + d - a - b), (left, right)
