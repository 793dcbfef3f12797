# SPDX-License-Identifier: Apache-2.0
"""Runs carries in MuJoCo: the compiled controllers step by step with the simulation.

`WORLD` is the entry of this world in the registry (`palmbots.simulation.worlds`).
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.errors import SceneError
from palmbots.mujoco.curved_world import world_of
from palmbots.mujoco.engine_settings import DEFAULT, Engine
from palmbots.mujoco.lift_world import LiftWorld
from palmbots.mujoco.route_geometry import Wall
from palmbots.mujoco.trace_columns import COLUMNS, Measured
from palmbots.mujoco.world import SLACK, MujocoWorld
from palmbots.scene.scene import Scene
from palmbots.scene.spec import refuse_floor
from palmbots.simulation.driven_world import Pair
from palmbots.simulation.episode import Episode
from palmbots.simulation.prepare import Prepared
from palmbots.simulation.trace import HEIGHTS, heights_of
from palmbots.simulation.worlds import WorldEntry, WorldRun

_PROGRESS_TICKS = 20  # between two calls of `on_progress`
_SLIPS = 0.05  # of the distance; 0.002 if nothing pulls at the robots
_TOO_FAST = 1.1  # times the nominal speed, as a mean of the carry


@dataclass(frozen=True)
class MujocoRecord:
    """What videos need of a carry in MuJoCo."""

    states: np.ndarray
    """MuJoCo's state (``mjSTATE_INTEGRATION``) at every row of the trace."""
    engine: Engine
    walls_m: tuple[Wall, ...] = ()
    """Walls for pictures only: the ends (x1, y1, x2, y2) of each, in the frame of the world."""


def run(
    prepared: Prepared,
    seed: int,
    *,
    precision: str = "double",
    record: bool = False,
    on_tick: Callable[[MujocoWorld], None] | None = None,
    on_progress: Callable[[float], None] | None = None,
    engine: Engine = DEFAULT,
    start: MujocoWorld | None = None,
) -> WorldRun:
    """Run one carry.

    Args:
        prepared: scene and controller.
        seed: random seed.
        precision: only ``double``.
        record: keep the trace, and the states for videos.
        on_tick: is called with the world at the start and after every tick.
        on_progress: is called now and then with the completed fraction of the distance.
        engine: solver options.
        start: the world at its start; None: that of the scene.
    """
    scene = prepared.scene
    world = start or world_of(scene, engine, measures=record or on_tick is not None)
    core = prepared.controller.for_core(prepared.spec)
    carried = CarriedWorld(world, engine, record)
    crew = _core.CoSimulation(prepared.spec, core, seed, carried.sight(first=True), SLACK)
    if on_tick is not None:
        on_tick(world)
    distance = scene.task.distance_m
    while not crew.done:
        speeds, angles, *_ = crew.step_controllers()
        if isinstance(world, LiftWorld):
            world.arms = crew.arms
        world.move(speeds, angles)
        crew.observe(carried.sight())
        if on_tick is not None:
            on_tick(world)
        tick = round(world.time_s / scene.control.period_s)
        if on_progress is not None and tick % _PROGRESS_TICKS == 0:
            on_progress(min(1.0, abs(world.advance) / distance))
    return carried.run_of(crew.run())


class CarriedWorld:
    """A world in MuJoCo during a carry: a `palmbots.simulation.episode.MovedWorld` that records,
    tick by tick, what only it measures."""

    slack: float = SLACK

    def __init__(self, world: MujocoWorld, engine: Engine, record: bool) -> None:
        """`world` is at its start."""
        self.world = world
        self.move: Callable[[Pair, Pair], None] = world.move
        self._engine, self._record = engine, record
        self._carries = not isinstance(world, LiftWorld)  # from palms to palms
        self._measured: list[Measured] = []
        self._states = [world.state()] if record else []

    def sight(self, first: bool = False) -> _core.WorldObservation:
        """Observe the present instant, and record it."""
        sight = self.world.sight(first)
        if self._record and not first:
            self._measured.append(self.world.measured)
            self._states.append(self.world.state())
        return sight

    def run_of(self, measured: Any) -> WorldRun:
        """The result of a carry that has ended."""
        world = self.world
        return WorldRun(
            measured,
            contact_events=world.contact_events(measured.time_s) if self._carries else (),
            warnings=(*world.warnings, *traction_warnings(world.scene, measured, world.wheel_slip)),
            lateral_peak_m=world.lateral_peak,
            wheel_slip_m=world.wheel_slip,
            trace=self._columns(measured) if self._record else {},
            recording=MujocoRecord(np.array(self._states), self._engine) if self._record else None,
        )

    def _columns(self, measured: Any) -> dict[str, tuple[np.ndarray, Mapping[str, str]]]:
        """The variables of the trace. A row is the start of its tick; the last one is repeated."""
        rows = [*self._measured, self._measured[-1] if self._measured else self.world.measured]
        floor = {} if self._carries else heights_of(measured)
        return floor | {
            name: (np.array([getattr(row, name) for row in rows]), attrs)
            for name, attrs in COLUMNS.items()
        }


def traction_warnings(scene: Scene, measured: Any, slip_m: tuple[float, float]) -> Iterator[str]:
    """Sentences on wheels that slipped or robots that were too fast during a carry."""
    for side, slip in zip(SIDES, slip_m, strict=True):
        extent = "less" if slip > 0 else "farther"
        if abs(slip) > _SLIPS * measured.distance_m:
            yield (
                f"the wheels of the {side} robot slip: it moved {abs(slip):.2f} m {extent} than "
                f"they rolled, on a path of {measured.distance_m:.2f} m"
            )
    nominal = max(scene.robot_of(side).speed_m_s for side in SIDES)
    if measured.time_s > 0 and measured.distance_m > _TOO_FAST * nominal * measured.time_s:
        yield (
            f"the robots drove at {100 * measured.distance_m / measured.time_s:.1f} cm/s, but "
            f"robot.speed_m_s is {100 * nominal:g} cm/s: wheels and motors could not hold them back"
        )


def episode(scene: Scene, seed: int, record: bool) -> Episode:
    """A carry that is stepped from outside."""
    world = world_of(scene, DEFAULT, measures=record)
    return Episode(scene, seed, record, WORLD, CarriedWorld(world, DEFAULT, record))


def driven(scene: Scene, pivot_heights_m: Pair = (0.0, 0.0)) -> MujocoWorld:
    """A world whose wheels are moved from outside. Nobody steers the robots: one whose wheels
    differ drives a curve.

    Raises:
        SceneError: the path is curved, or the job begins or ends on the floor.
    """
    refuse_floor(scene, "robots that are driven from outside do")
    if scene.task.path.is_curved:
        raise SceneError(
            "task.path.kind: robots that nobody steers cannot follow a curved path; "
            "allowed: straight"
        )
    world = MujocoWorld(scene, measures=False, pivot_heights_m=pivot_heights_m)
    world.sight(first=True)
    return world


WORLD = WorldEntry(
    "mujoco",
    "three-dimensional, with mass, wheels and soft contacts",
    run=run,
    episode=episode,
    driven=driven,
    supports_curved=True,
    supports_floor=True,
    is_stepped=True,
    trace_variables=HEIGHTS | COLUMNS,
    extra="mujoco",
)
