# SPDX-License-Identifier: Apache-2.0
"""The quasistatic world: the compiled core runs the whole carry."""

from collections.abc import Callable, Sequence
from typing import Any

import palmbots._core as _core
from palmbots.errors import PalmbotsError
from palmbots.simulation.driven_world import QuasistaticWorld
from palmbots.simulation.episode import Episode
from palmbots.simulation.prepare import Prepared
from palmbots.simulation.trace import HEIGHTS, heights_of
from palmbots.simulation.worlds import PRECISIONS, WorldEntry, WorldRun


def run(
    prepared: Prepared,
    seed: int,
    *,
    precision: str = "double",
    record: bool = False,
    on_tick: Callable[[Any], None] | None = None,
    on_progress: Callable[[float], None] | None = None,
    forks: Sequence[tuple[float, int]] = (),
) -> WorldRun:
    """Run one carry; it takes milliseconds, so the callbacks are not called."""
    core = prepared.controller.for_core(prepared.spec)
    uses_floor = prepared.spec.uses_floor
    if uses_floor:
        _refuse_on_floor(precision, forks)
    measured = _core.run(prepared.spec, core, seed, precision, record, list(forks))
    return WorldRun(measured, trace=heights_of(measured) if uses_floor and record else {})


def _refuse_on_floor(precision: str, forks: Sequence[tuple[float, int]]) -> None:
    where = "a job that begins or ends on the floor (task.from, task.to)"
    if precision != "double":
        raise PalmbotsError(f"precision: value is {precision}; allowed: double, for {where}")
    if forks:
        raise PalmbotsError(f"forks: {where} cannot change its seed; allowed: none")


WORLD = WorldEntry(
    "quasistatic",
    "planar, without inertia and impacts; fast",
    run=run,
    episode=Episode,
    driven=QuasistaticWorld,
    precisions=PRECISIONS,
    supports_bumps=True,
    supports_floor=True,
    trace_variables=HEIGHTS,
    supports_forks=True,
    supports_references=True,
)
