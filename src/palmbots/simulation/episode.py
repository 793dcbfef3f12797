# SPDX-License-Identifier: Apache-2.0
"""One carry whose robots are commanded from outside, tick by tick, in any stepped world.

Observations and actions are those of `palmbots.learn.spaces`, as the numbers of the core.
"""

from collections.abc import Callable
from typing import Any, Protocol

import palmbots._core as _core
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.scene.spec import refuse_floor
from palmbots.simulation.prepare import prepare
from palmbots.simulation.result import Carry, make_carry
from palmbots.simulation.worlds import WorldEntry, WorldRun, world_entry

Pair = tuple[float, float]


class MovedWorld(Protocol):
    """A world outside the core, of which an `Episode` moves the robots."""

    slack: float
    """How far from the angle commanded a palm counts as turned [rad]."""

    move: Callable[[Pair, Pair], None]
    """One control period: robots that keep their heading at these speeds [m/s, towards +x], palms
    that turn at a constant rate to these angles [rad]."""

    def sight(self, first: bool = False) -> _core.WorldObservation:
        """The world after a control period, or at its start."""
        ...

    def run_of(self, measured: Any) -> WorldRun:
        """What the world returns of the carry that the core has measured."""
        ...


class Episode:
    """A carry that runs step by step. If its object is not held, it has ended already.

    Args:
        scene: the scene.
        seed: random seed.
        record: store every tick.
        entry: the world.
        moved: the world outside the core; None: the core's own, which is the quasistatic one.

    Raises:
        SceneError: the world refuses the scene.
    """

    def __init__(
        self,
        scene: Scene,
        seed: int,
        record: bool,
        entry: str | WorldEntry = "quasistatic",
        moved: MovedWorld | None = None,
    ) -> None:
        refuse_floor(scene, "robots that are commanded from outside do")
        self._prepared = prepare(scene, "none", entry)
        self.scene, self.spec, self.seed = scene, self._prepared.spec, seed
        self._record, self._moved = record, moved
        slack = 0.0 if moved is None else moved.slack
        self._core: Any = _core.Episode(self.spec, seed, record, moved, slack)
        self.seen, self.step, self.stop = self._core.seen, self._core.step, self._core.stop

    @property
    def outcome(self) -> str:
        """``running``, ``delivered``, ``dropped`` or ``stalled``."""
        return self._core.outcome

    @property
    def time_s(self) -> float:
        """Time since the start."""
        return self._core.ticks * self.scene.control.period_s

    def sight(self) -> _core.WorldObservation:
        """The present state of the world."""
        return self._core.sight()

    def make_carry(self, controller: str) -> Carry:
        """The finished carry; with its trace if the episode records."""
        measured = self._core.run()
        run = WorldRun(measured) if self._moved is None else self._moved.run_of(measured)
        return make_carry(self._prepared.renamed(controller), self.seed, run, record=self._record)


def begin_episode(scene: Scene, world: str, seed: int, record: bool = False) -> Episode:
    """An episode at its start.

    Raises:
        SceneError: the world refuses the scene.
        PalmbotsError: the world has no episodes.
    """
    begin = world_entry(world).episode
    if begin is None:
        raise PalmbotsError(f"world: {world} cannot be stepped from outside")
    return begin(scene, seed, record)
