# SPDX-License-Identifier: Apache-2.0
"""One carry whose robots are commanded from outside, in either world.

Both kinds of episodes have the same interface: `seen` and `step` in the numbers of the core, and
the attributes that a reward or a view needs. SI units and radians; pairs are (left, right).
"""

from typing import Protocol

import palmbots._core as _core
from palmbots.errors import PalmbotsError
from palmbots.learn.spaces import RobotAction, RobotObservation
from palmbots.scene.scene import Scene
from palmbots.simulation.result import Carry
from palmbots.simulation.worlds import world_entry

Pair = tuple[float, float]
StepResult = tuple[str, int, int, float, Pair]
"""Outcome, ticks, messages sent, midpoint, contacts: as the attributes of the episode."""


class Episode(Protocol):
    """A carry that runs step by step."""

    scene: Scene
    spec: _core.Spec
    seed: int
    outcome: str
    """``running``, ``delivered``, ``dropped`` or ``stalled``."""
    ticks: int
    """Control periods since the start."""
    sent: int
    """Messages sent since the start."""
    contacts: Pair
    lift: Pair
    palms: Pair
    motion: tuple[int, int]
    separation: float
    midpoint: float
    """Displacement of the midpoint of the pivots towards +x [m]."""
    rise: float
    """Height of the right contact vertex above the left one [m]."""

    def seen(self) -> tuple[RobotObservation, RobotObservation]:
        """The observations of both robots."""
        ...

    def step(self, left: RobotAction, right: RobotAction, ticks: int) -> StepResult:
        """Run a number of ticks with these actions."""
        ...

    def make_carry(self, controller: str) -> Carry:
        """The finished carry; with its trace if the episode records."""
        ...


def begin_episode(scene: Scene, world: str, seed: int, record: bool) -> Episode:
    """An episode at its start. If its object is not held, it has ended already.

    Raises:
        PalmbotsError: the world has no episodes.
    """
    begin = world_entry(world).episode
    if begin is None:
        raise PalmbotsError(f"world: {world} cannot be stepped from outside")
    return begin(scene, seed, record)
