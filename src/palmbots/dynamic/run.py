"""One carry in the dynamic world: the compiled robots (`_core.Crew`) in MuJoCo, tick by tick."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots import _core
from palmbots.dynamic.curved import world_of
from palmbots.dynamic.settings import DEFAULT, Engine
from palmbots.dynamic.world import SLACK, Measured, MujocoWorld
from palmbots.lowering import lower
from palmbots.scene import Scene

__all__ = ["Physics", "Watch", "run"]

Watch = Callable[[MujocoWorld], None]

# Unit and meaning of the fields of Measured, which the trace holds too.
_COLUMNS = {
    "force": ("N", "force of the object on each palm, along its normal"),
    "drag": ("N", "force of the object on each palm, along it, outward"),
    "speed": ("m/s", "speed of the pivot over the following tick"),
    "slip": ("m/s", "by how much the wheels run ahead of the robot"),
    "pitch": ("rad", "pitch of the robot's body, its outward end up"),
    "yaw": ("rad", "heading of the robot's body, anticlockwise seen from above"),
    "across": (
        "m",
        "contact coordinate across the palm, to the left seen from left robot to right",
    ),
    "pivot_x": ("m", "place of the pivot on the floor, x"),
    "pivot_y": ("m", "place of the pivot on the floor, y, to the left of x"),
    "vertex_x": ("m", "place of the middle of the contact edge, x"),
    "vertex_y": ("m", "place of the middle of the contact edge, y"),
}


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
) -> tuple[Any, Physics | None, tuple[float, float]]:
    """Carry once; returns what the core kept of it, with `record` what else there is to keep, and
    how far contacts came across their palms [m].

    `controller` is what the core takes: a name, or a pair of step functions. `watch` is called with
    the world at the start and after every tick, `progress` now and then with the fraction of the
    way.
    """
    world = world_of(scene, engine, measures=record or watch is not None)
    crew = _core.Crew(lower(scene, unrolled=True), controller, seed, world.sight(first=True), SLACK)
    kept: list[Measured] = []
    states = [world.state()] if record else []
    if watch is not None:
        watch(world)
    way = scene.task.distance_m
    while not crew.done:
        speeds, angles, *_ = crew.command()
        world.move(speeds, angles)
        crew.observe(world.sight())
        if record:
            kept.append(world.measured)
            states.append(world.state())
        if watch is not None:
            watch(world)
        if progress is not None and round(world.time_s / scene.control.period_s) % 20 == 0:
            progress(min(1.0, abs(world.advance) / way))
    if not record:
        return crew.run(), None, world.across_peak
    kept.append(
        kept[-1] if kept else world.measured
    )  # a tick's row is its start; the last has none
    columns = {
        name: (np.array([getattr(row, name) for row in kept]), unit, meaning)
        for name, (unit, meaning) in _COLUMNS.items()
    }
    return crew.run(), Physics(columns, np.array(states), engine), world.across_peak
