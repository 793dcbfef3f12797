# SPDX-License-Identifier: Apache-2.0
"""Simulated robots that probe, in the quasistatic world. In MuJoCo contacts creep and masses have
inertia, for which the set of a probe does not allow."""

from __future__ import annotations

from palmbots._types import SIDES
from palmbots.probing.contact_tracking import Pair
from palmbots.probing.probe_run import Switches
from palmbots.scene.scene import Scene
from palmbots.simulation.driven_world import QuasistaticWorld
from palmbots.simulation.imperfect_robot import zones_of


class SimulatedHands:
    """A pair.

    Args:
        scene: the robots, and the object as it really is.
        errors: by how much each palm really is steeper than its angle [rad].

    Raises:
        SceneError: the world refuses the scene.
    """

    def __init__(self, scene: Scene, errors: Pair) -> None:
        self._world = QuasistaticWorld(scene)
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
