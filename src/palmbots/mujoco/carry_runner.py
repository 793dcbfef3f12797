# SPDX-License-Identifier: Apache-2.0
"""Runs carries in MuJoCo: the compiled controllers step by step with the simulation.

`WORLD` is the entry of this world in the registry (`palmbots.simulation.worlds`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import palmbots._core as _core
from palmbots.mujoco.curved_world import world_of
from palmbots.mujoco.driven_mujoco import DrivenMujoco
from palmbots.mujoco.settings import DEFAULT, Engine
from palmbots.mujoco.trace_columns import COLUMNS, Measured
from palmbots.mujoco.world import SLACK, MujocoWorld
from palmbots.scene.scene import Scene
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.simulation.result import Carry, make_carry
from palmbots.simulation.worlds import WorldEntry, WorldRun

_PROGRESS_TICKS = 20  # between two calls of `on_progress`


@dataclass(frozen=True)
class MujocoRecord:
    """What videos need of a carry in MuJoCo."""

    states: np.ndarray
    """MuJoCo's state (``mjSTATE_INTEGRATION``) at every row of the trace."""
    engine: Engine


def run(
    prepared: Prepared,
    seed: int,
    *,
    precision: str = "double",
    record: bool = False,
    on_tick: Callable[[MujocoWorld], None] | None = None,
    on_progress: Callable[[float], None] | None = None,
    engine: Engine = DEFAULT,
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
    """
    scene = prepared.scene
    world = world_of(scene, engine, measures=record or on_tick is not None)
    core = prepared.controller.for_core(prepared.spec)
    crew = _core.CoSimulation(prepared.spec, core, seed, world.sight(first=True), SLACK)
    recorder = MujocoRecorder(world, engine) if record else None
    if on_tick is not None:
        on_tick(world)
    distance = scene.task.distance_m
    while not crew.done:
        speeds, angles, *_ = crew.step_controllers()
        world.move(speeds, angles)
        crew.observe(world.sight())
        if recorder is not None:
            recorder.record(world)
        if on_tick is not None:
            on_tick(world)
        tick = round(world.time_s / scene.control.period_s)
        if on_progress is not None and tick % _PROGRESS_TICKS == 0:
            on_progress(min(1.0, abs(world.advance) / distance))
    return _world_run(crew.run(), world, recorder)


def _world_run(measured: Any, world: MujocoWorld, recorder: "MujocoRecorder | None") -> WorldRun:
    """The result of a carry that has ended."""
    return WorldRun(
        measured,
        contact_events=world.contact_events(measured.time_s),
        warnings=tuple(world.warnings),
        lateral_peak_m=world.lateral_peak,
        trace={} if recorder is None else recorder.columns(world),
        recording=None if recorder is None else recorder.states(),
    )


class MujocoRecorder:
    """Records, tick by tick, what only this world measures."""

    def __init__(self, world: MujocoWorld, engine: Engine = DEFAULT) -> None:
        """`world` is at its start."""
        self._engine = engine
        self._measured: list[Measured] = []
        self._states = [world.state()]

    def record(self, world: MujocoWorld) -> None:
        """Record the last tick."""
        self._measured.append(world.measured)
        self._states.append(world.state())

    def columns(self, world: MujocoWorld) -> dict[str, tuple[np.ndarray, dict[str, str]]]:
        """The variables of the trace. A row is the start of its tick; the last one is repeated."""
        rows = [*self._measured, self._measured[-1] if self._measured else world.measured]
        return {
            name: (np.array([getattr(row, name) for row in rows]), attrs)
            for name, attrs in COLUMNS.items()
        }

    def states(self) -> MujocoRecord:
        """The states for videos."""
        return MujocoRecord(np.array(self._states), self._engine)


class MujocoEpisode:
    """A carry that is stepped from outside, as in `palmbots.learn`."""

    def __init__(self, scene: Scene, seed: int, record: bool) -> None:
        self._prepared = prepare(scene, "none", WORLD)
        self.scene, self.spec, self.seed = scene, self._prepared.spec, seed
        self.world = world_of(scene, DEFAULT, measures=record)
        self._sight = self.world.sight(first=True)
        self._crew: Any = _core.ExternalCoSimulation(self.spec, seed, self._sight, SLACK)
        self._recorder = MujocoRecorder(self.world) if record else None
        self.seen = self._crew.observations

    def stop(self, left: bool, right: bool) -> None:
        """Let each robot rest, or travel, from now on."""
        self._crew.stop(left, right)

    def step(self, left: Any, right: Any, ticks: int) -> tuple[Any, ...]:
        """Apply the actions for some ticks.

        Returns outcome, number of ticks and messages so far, midpoint, contacts.
        """
        crew, world = self._crew, self.world
        crew.set_commands(left, right)
        for _ in range(ticks):
            world.move(*crew.step_controllers())
            self._sight = world.sight()
            crew.observe(self._sight)
            if self._recorder is not None:
                self._recorder.record(world)
            if crew.done:
                break
        sight = self._sight
        return crew.outcome, crew.ticks, crew.sent, sight.midpoint, sight.contacts

    @property
    def outcome(self) -> str:
        """``running``, ``delivered``, ``dropped`` or ``stalled``."""
        return self._crew.outcome

    @property
    def ticks(self) -> int:
        """Number of control periods so far."""
        return self._crew.ticks

    @property
    def sent(self) -> int:
        """Number of messages so far."""
        return self._crew.sent

    def __getattr__(self, name: str) -> Any:
        """Everything else, such as ``contacts`` and ``palms``, is the last observation."""
        return getattr(self.__dict__["_sight"], name)

    def make_carry(self, controller: str) -> Carry:
        """The carry, once it is over."""
        result = _world_run(self._crew.run(), self.world, self._recorder)
        is_recorded = self._recorder is not None
        return make_carry(self._prepared.renamed(controller), self.seed, result, record=is_recorded)


WORLD = WorldEntry(
    "mujoco",
    "three-dimensional, with mass, wheels and soft contacts",
    run=run,
    episode=MujocoEpisode,
    driven=DrivenMujoco,
    supports_curved=True,
    is_stepped=True,
    trace_variables=COLUMNS,
    extra="mujoco",
)
