# SPDX-License-Identifier: Apache-2.0
"""Where a job on the floor will put its object down: an interval that is stated before the start.

The *miss* is the distance from the wanted place to the place of the object; it is positive if the
object went too far. The interval lies between two order statistics of the misses of simulated jobs,
whose seeds are not those of users. The expected share of further jobs in it is 95 % for any
distribution. This matters, because the misses have two clusters if either robot may be the first
one under the object. Source: order statistics of a sample, Wilks (1941).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import Interval, Overrides
from palmbots._util.arguments import whole_number
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import rate_interval, rate_text
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots.control.registry import ControllerLike, refuse_reference, resolve
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.batch import available_cores
from palmbots.simulation.floor_job import FloorJob, floor_job
from palmbots.simulation.prepare import prepare

COVERED = 0.95
FEWEST, MOST = 100, 10**6
_SEEDS_APART = 2**41
"""These jobs do not share seeds with those of users."""

_PARTS = ("docking", "travel", "leaving")


@dataclass(frozen=True)
class PlacePart:
    """What one part of the job contributes to the miss."""

    name: str
    """docking: until both robots carry; travel: until both noses are on the floor again; leaving:
    the rest."""
    mean_m: float
    interval_m: Interval
    """Contains the contributions of 95 % of the jobs that succeed and whose phases were all
    recorded."""
    share: float
    """Share of the variance of the miss: cov(part, miss) / var(miss). The shares add up to 1."""


@dataclass(frozen=True, repr=False)
class FinalPlace(Result):
    """Where jobs of a scene with a controller put the object down."""

    controller: str
    jobs: int
    failed: int
    """How many jobs failed; these have no miss."""
    interval_m: Interval
    """Contains the misses of 95 % of the jobs that succeed; > 0: too far."""
    median_m: float
    parts: tuple[PlacePart, ...]
    scene: Scene

    @derived
    def half_width_m(self) -> float:
        """Half of the width of the interval."""
        return 0.5 * (self.interval_m[1] - self.interval_m[0])

    @derived
    def failure_interval(self) -> Interval:
        """The 95 % interval of the share of jobs that fail."""
        return rate_interval(self.failed, self.jobs)

    def lines(self) -> Iterator[Item]:
        """The interval, and what docking, travel and leaving contribute."""
        yield Line(
            bold(f"{_mm(self.interval_m)} from the wanted place"),
            f"  95 % of the jobs, half width {1e3 * self.half_width_m:.0f} mm",
        )
        rows = [("", "mean", "95 %", "share of variance")]
        for part in self.parts:
            share = f"{100 * part.share:.0f} %"
            rows.append((
                f"  {part.name}", f"{_rounded(part.mean_m)} mm", _mm(part.interval_m), share
            ))  # fmt: skip
        yield Table(rows)
        yield f"failed jobs: {rate_text(self.failed, self.jobs)}"
        yield quiet(f"{self.controller}: {self.jobs:,} jobs with other seeds than those of carries")


def _rounded(value_m: float) -> str:
    return f"{round(1e3 * value_m)}".replace("-", "−")


def _mm(ends: Interval) -> str:
    return f"{_rounded(ends[0])} to {_rounded(ends[1])} mm"


@command(
    order=66,
    example="palmbots final-place lift -c shared-sign",
    progress="simulating",
    jobs=Option(least=100, most=1000000),
)
def final_place(
    scene: SceneLike = "lift",
    controller: ControllerLike = "distributed",
    *,
    jobs: int = 1000,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> FinalPlace:
    """Predict where jobs on the floor put the object down.

    Args:
        scene: a built-in name, a file, a table or a `Scene`; its job begins and ends on the floor.
        controller: the controller.
        jobs: how many jobs to simulate; with 1000, between 93 and 97 % of further jobs end in the
            interval.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Raises:
        SceneError: the scene cannot be read or is not valid, or its controller refuses it.
        PalmbotsError: the job does not begin and end on the floor, or no job succeeds.
    """
    count = whole_number("jobs", jobs, FEWEST, MOST)
    chosen, entry = load_scene(scene, overrides), resolve(controller)
    refuse_reference(entry, "the final place")
    if "palms" in chosen.task.ends:
        raise PalmbotsError(
            "scene: the job does not begin and end on the floor or on a stand; allowed: a scene "
            'with task.from and task.to = "floor" or "stand"'
        )
    prepared = prepare(chosen, entry)
    shared = None if entry.is_python else entry.for_core(prepared.spec)
    done = 0

    def run(seed: int) -> FloorJob:
        nonlocal done
        core: Any = entry.for_core(prepared.spec) if shared is None else shared
        found = floor_job(chosen, _core.run(prepared.spec, core, seed, "double", False))
        done += 1
        if on_progress is not None and done % 20 == 0:
            on_progress(done / count)
        return found

    with ThreadPoolExecutor(1 if entry.is_python else available_cores()) as pool:
        found = list(pool.map(run, range(_SEEDS_APART, _SEEDS_APART + count)))
    succeeded = [one for one in found if one.failure is None]
    if len(succeeded) < 2:
        raise PalmbotsError(f"final-place: {count - len(succeeded)} of {count} jobs failed")
    miss = np.array([one.moved_m for one in succeeded]) - chosen.task.distance_m
    recorded = [contributions(one, chosen.task.distance_m) for one in succeeded]
    parts = np.array([one for one in recorded if one is not None]).reshape(-1, len(_PARTS))
    together = parts.sum(axis=1)
    spread = float(together.var()) if len(parts) > 1 else 0.0
    return FinalPlace(
        controller=entry.name,
        jobs=count,
        failed=count - len(succeeded),
        interval_m=_covered(miss),
        median_m=float(np.median(miss)),
        parts=tuple(
            PlacePart(
                name,
                float(column.mean()),
                _covered(column),
                float(np.mean((column - column.mean()) * (together - together.mean()))) / spread
                if spread > 0
                else 0.0,
            )
            for name, column in zip(_PARTS, parts.T, strict=True)
            if len(parts) > 1
        ),
        scene=chosen,
    )


def contributions(job: FloorJob, distance_m: float) -> tuple[float, float, float] | None:
    """What docking, travel and leaving contribute to the miss of a job that succeeded [m]; None: it
    had so many phases that not all were recorded."""

    def begun(by_one: str, by_both: str) -> list[float]:
        """Where the object was when a phase began; on one palm, for each robot that carries it."""
        places = [one.moved_m for one in job.phases if one.phase == by_one]
        both = [(one.start_s, one.moved_m) for one in job.phases if one.phase == by_both]
        return places or [place for _, place in sorted(both)[-1:]]

    held, down = begun("haul", "carry"), begun("tip_out", "down")
    if not held or not down:
        return None
    travel, leaving = sum(down) - sum(held) - distance_m, job.moved_m - down[-1]
    return job.moved_m - distance_m - travel - leaving, travel, leaving


def _covered(values: NDArray[np.float64]) -> Interval:
    """Between the order statistics with the numbers (n + 1) (1 ∓ `COVERED`) / 2."""
    ends = np.quantile(values, [(1 - COVERED) / 2, (1 + COVERED) / 2], method="weibull")
    return float(ends[0]), float(ends[1])
