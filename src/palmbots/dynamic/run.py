"""One carry in the dynamic world: the compiled robots (`_core.Crew`) in MuJoCo, tick by tick."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots import _core
from palmbots.dynamic.columns import COLUMNS, Measured
from palmbots.dynamic.curved import world_of
from palmbots.dynamic.settings import DEFAULT, Engine
from palmbots.dynamic.world import SLACK, MujocoWorld
from palmbots.lowering import lower
from palmbots.scene import Scene

__all__ = ["Keeper", "Physics", "Watch", "run"]

Watch = Callable[[MujocoWorld], None]


@dataclass(frozen=True)
class Physics:
    """What a carry in MuJoCo leaves besides what every carry leaves."""

    columns: dict[str, tuple[np.ndarray, str, str]]
    """Variables of the trace: values (rows, sides), unit, meaning."""
    states: np.ndarray
    """MuJoCo's state (``mjSTATE_INTEGRATION``) at every row of the trace."""
    engine: Engine


def run(
    scene: Scene,
    controller: Any,
    seed: int,
    *,
    engine: Engine = DEFAULT,
    record: bool = False,
    watch: Watch | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Any, Physics | None, MujocoWorld]:
    """Carry once; returns what the core kept of it, with `record` what else there is to keep, and
    the world at its end.

    `controller` is what the core takes: a name, or a pair of step functions. `watch` is called with
    the world at the start and after every tick, `progress` now and then with the fraction of the
    way.
    """
    world = world_of(scene, engine, measures=record or watch is not None)
    crew = _core.Crew(lower(scene, unrolled=True), controller, seed, world.sight(first=True), SLACK)
    keeper = Keeper(world) if record else None
    if watch is not None:
        watch(world)
    way = scene.task.distance_m
    while not crew.done:
        speeds, angles, *_ = crew.command()
        world.move(speeds, angles)
        crew.observe(world.sight())
        if keeper is not None:
            keeper.keep(world)
        if watch is not None:
            watch(world)
        if progress is not None and round(world.time_s / scene.control.period_s) % 20 == 0:
            progress(min(1.0, abs(world.advance) / way))
    physics = None if keeper is None else keeper.physics(world, engine)
    return crew.run(), physics, world


class Keeper:
    """Keeps what only this world knows, tick after tick."""

    def __init__(self, world: MujocoWorld) -> None:
        """`world` is at its start."""
        self._kept: list[Measured] = []
        self._states = [world.state()]

    def keep(self, world: MujocoWorld) -> None:
        """What the last tick came to."""
        self._kept.append(world.measured)
        self._states.append(world.state())

    def physics(self, world: MujocoWorld, engine: Engine) -> Physics:
        """All of it. A tick's row is its start, so the last row repeats the last tick."""
        rows = [*self._kept, self._kept[-1] if self._kept else world.measured]
        columns = {
            name: (np.array([getattr(row, name) for row in rows]), unit, meaning)
            for name, (unit, meaning) in COLUMNS.items()
        }
        return Physics(columns, np.array(self._states), engine)
