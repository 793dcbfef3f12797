"""One carry in the dynamic world: the compiled robots (`_core.Crew`) in MuJoCo, tick by tick."""

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np

from palmbots import _core
from palmbots.dynamic.settings import DEFAULT, Engine
from palmbots.dynamic.world import SLACK, Measured, MujocoWorld
from palmbots.lowering import lower
from palmbots.scene import Scene

__all__ = ["Watch", "run"]

Watch = Callable[[MujocoWorld], None]


def run(
    scene: Scene,
    controller: Any,
    seed: int,
    *,
    engine: Engine = DEFAULT,
    watch: Watch | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Any, dict[str, np.ndarray]]:
    """Carry once; returns what the core kept of it, and the columns of `Measured`.

    `controller` is what the core takes: a name, or a pair of step functions. `watch` is called with
    the world at the start and after every tick, `progress` with the fraction of the way now and then.
    """
    world = MujocoWorld(scene, engine)
    crew = _core.Crew(lower(scene), controller, seed, world.sight(first=True), SLACK)
    kept: list[Measured] = []
    if watch is not None:
        watch(world)
    way = scene.task.distance_m
    while not crew.done:
        speeds, angles, *_ = crew.command()
        world.move(speeds, angles)
        crew.observe(world.sight())
        kept.append(world.measured)
        if watch is not None:
            watch(world)
        if progress is not None and len(kept) % 50 == 0:
            progress(min(1.0, abs(world.advance) / way))
    # A row of the trace is the start of a tick: the last one repeats the end of the one before it.
    kept.append(kept[-1] if kept else world.measured)
    columns = {f.name: np.array([getattr(row, f.name) for row in kept]) for f in fields(Measured)}
    return crew.run(), columns
