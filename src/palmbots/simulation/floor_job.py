# SPDX-License-Identifier: Apache-2.0
"""A job that begins or ends on the floor or on a stand: its phases, where the object ends, why it
failed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

MEANINGS: dict[str, str] = _core.lift_states
"""What a robot does in each phase, in words."""
TASK_PHASES: dict[str, str] = _core.phases_of_lift_states
"""The phase of the task of a robot in each of them (`palmbots.ends`): ``low`` or ``carried``."""

# What a job did not achieve that ends in one of these phases, in their order.
_GOALS = {
    "did not get under the object": (
        "stand_by", "dock", "touch", "meet", "under", "begin", "prop", "scoop", "seat", "ease",
        "stand_back", "back_off", "sink", "failed",
    ),
    "did not centre the contacts on the floor": ("centre", "ready", "recentre"),
    "did not raise the object": ("raise", "raise_hold", "poised", "up", "lift"),
    "did not arrive": ("carry", "arrived", "clear", "ahead", "there", "hold_up", "haul"),
    "did not lower the object": ("lower", "lower_hold", "down", "set_down"),
    "did not get away from the object": (
        "leave_steep", "leave_shallow", "tip_out", "empty", "brace", "retreat", "done",
    ),
    "a robot that had restarted did not hear its partner": ("held",),
    "a robot restarted while the object may have been on a palm, and stopped": ("land",),
}  # fmt: skip
MISSED = {phase: goal for goal, phases in _GOALS.items() for phase in phases}
"""What a job did not achieve that ends in a phase."""
STAGES = {
    phase: "dock" if "dock" in phases else phases[0].partition("_")[0]
    for phases in _GOALS.values()
    for phase in phases
}
"""The stage to which a phase belongs, dock, centre, raise, carry, lower, leave or held."""
RETRIES = ("back_off", "stand_back", "sink", "failed")
"""The phases after an attempt that failed."""
_TOUCHES_M = 1e-4  # a vertex no farther above its palm touches it; soft contacts are compressed


@dataclass(frozen=True, slots=True)
class JobPhase:
    """One phase of one robot."""

    robot: Literal["left", "right"]
    phase: str
    """Its name in the table of phases (`palmbots.simulation.floor_job.MEANINGS` explains them)."""
    start_s: float
    end_s: float
    moved_m: float
    """How far the centre of mass had moved in the direction of travel when the phase began."""


@dataclass(frozen=True, slots=True)
class Fall:
    """The object fell where its contacts no longer held it, for example off a nose. It takes no
    time."""

    height_m: float
    """How far a contact vertex fell at most. `world.fall_m` limits the part that friction does not
    slow."""
    energy_j: float
    """Weight times the height through which the centre of mass fell."""


@dataclass(frozen=True, slots=True)
class SmallFall(Fall):
    """A fall in a job. In MuJoCo falls are part of the motion, so none are listed."""

    time_s: float


@dataclass(frozen=True, slots=True)
class FloorJob:
    """The course and the result of a job that begins or ends on the floor or on a stand."""

    phases: tuple[JobPhase, ...]
    """The first 128 phases of both robots, in the order in which they began."""
    failure: str | None
    """What was not achieved; None: the job succeeded."""
    moved_m: float
    """How far the centre of mass moved in the direction of travel."""
    missed_m: float
    """How much farther that is than the distance of the task; < 0: it fell short."""
    falls: tuple[SmallFall, ...] = ()
    """The falls of the object."""


def covered_m(job: FloorJob | None, distance_m: float) -> float:
    """How far the object was moved in a job; without one, how far the robots have carried it."""
    return distance_m if job is None else job.moved_m


def stages(job: FloorJob, robot: str) -> list[tuple[str, float, float]]:
    """What a robot did: stage, start and end [s]."""
    found: list[tuple[str, float, float]] = []
    for phase in job.phases:
        if phase.robot != robot:
            continue
        stage, start = STAGES[phase.phase], phase.start_s
        if found and found[-1][0] == stage:
            start = found.pop()[1]
        found.append((stage, start, phase.end_s))
    return found


def phase_at(job: FloorJob, robot: str, time_s: float) -> str:
    """The phase of a robot at a time; empty: it takes no part in the job."""
    began = (p.phase for p in reversed(job.phases) if p.robot == robot and p.start_s <= time_s)
    return next(began, "")


def contacts_on_palms(scene: Scene, trace: xr.Dataset) -> NDArray[np.float64]:
    """The contact coordinates of a job's trace (n, 2) [m]; NaN: nothing is on this palm."""
    p, above = (
        trace[name].transpose("time", "side").to_numpy() for name in ("contact", "vertex_height")
    )
    half = [0.5 * scene.palm_of(side).length_m for side in SIDES]
    return np.where((np.abs(p) <= half) & (above < _TOUCHES_M), p, np.nan)


def floor_job(scene: Scene, measured: Any) -> FloorJob:
    """The job of a finished carry."""
    end = measured.time_s
    rows = [(SIDES[side], *row) for side, *row in measured.phases]
    phases = []
    sense = 1 if scene.task.direction == "forward" else -1
    for i, (side, name, start, place) in enumerate(rows):
        later = (begin for other, _, begin, _ in rows[i + 1 :] if other == side)
        phases.append(JobPhase(side, name, start, next(later, end), sense * place))
    moved = sense * measured.moved_m
    return FloorJob(
        phases=tuple(phases),
        falls=tuple(
            SmallFall(height, scene.object.mass_kg * _core.standard_gravity * com, time)
            for time, height, com in measured.falls
        ),
        failure=None if measured.outcome == "delivered" else _missed(phases),
        moved_m=moved,
        missed_m=moved - scene.task.distance_m,
    )


def _missed(phases: list[JobPhase]) -> str:
    """What the robot that got less far did not achieve, by its last phase of an attempt."""
    last = {phase.robot: phase.phase for phase in phases if phase.phase not in RETRIES}
    order = list(MISSED)
    return MISSED[min(last.values(), key=order.index)]
