# SPDX-License-Identifier: Apache-2.0
"""Run a study: begin or continue it, carry what is due, and return the result."""

from __future__ import annotations

import contextlib
import functools
import os
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._types import Interval, MaybeNaN
from palmbots._util.arguments import whole_number
from palmbots._util.confidence_intervals import wilson
from palmbots._util.optional_imports import require
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.results import FIGURES, Result
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.simulation.batch import available_cores
from palmbots.studies.chunking import ChunkGrid, make_layout
from palmbots.studies.local_runner import run_locally
from palmbots.studies.points import Points, design_points
from palmbots.studies.schedule import StudySchedule
from palmbots.studies.sobol import SobolIndex, sobol_indices
from palmbots.studies.statistics import Values, pooled_counts
from palmbots.studies.store import open_store
from palmbots.studies.study_file import Plan, StudyLike, load_plan
from palmbots.studies.study_reader import open_study

if TYPE_CHECKING:
    import xarray as xr

FIGURES.register("study", "palmbots.studies.study_figures:draw")

_MAX_REPAIRS = 3
Report = Callable[[str, float], None]
"""Called with the present step of a study and the completed fraction of it."""
PathLike = str | os.PathLike[str]
OnProgress = Callable[[float], None] | None


@dataclass(frozen=True)
class Estimate:
    """A statistic of a cell."""

    value: MaybeNaN
    interval: tuple[MaybeNaN, MaybeNaN] | None
    """Its 95 % interval; None: it has none."""


@dataclass(frozen=True)
class Cell:
    """One point and one controller."""

    at: dict[str, Any]
    """The values of the varied keys."""
    controller: str
    carries: int
    statistics: dict[str, Estimate]
    """By name, as in the store of the study."""


@dataclass(frozen=True)
class RefusedCell:
    """A cell that a controller refuses."""

    at: dict[str, Any]
    controller: str
    why: str


@dataclass(frozen=True, repr=False)
class StudyResult(Result):
    """A finished study."""

    figure = "study"
    lines_of = "palmbots.studies.study_lines:study_lines"

    points: Points = field(metadata=NOT_IN_JSON)
    output: Path
    """The folder of the study."""
    results: Path = field(metadata=NOT_IN_JSON)
    """The Zarr store in it."""
    values: Values = field(metadata=NOT_IN_JSON)
    """The statistics of the cells [points, controllers], and the ends of their intervals."""
    carries: int
    resumed: int
    """Carries that an earlier run had completed."""
    drops: int
    stalls: int
    hash: str
    """Two studies with equal hashes have equal results, bit for bit."""
    seconds: float
    lost_workers: tuple[str, ...] = ()
    """Addresses of the workers that died during the study; others carried their chunks."""

    def dataset(self) -> xr.Dataset:
        """The results; arrays are read from the disk when they are used."""
        return open_study(self.results, verify=False)

    @derived
    def drop_rate(self) -> float | None:
        """The fraction of all carries that dropped the object; None: nothing was carried."""
        return self.drops / self.carries if self.carries else None

    @derived
    def interval(self) -> Interval | None:
        """Wilson's 95 % interval of the drop rate."""
        return wilson(self.drops, self.carries) if self.carries else None

    @derived
    def stall_rate(self) -> float | None:
        """The fraction of all carries that neither delivered nor dropped the object in time."""
        return self.stalls / self.carries if self.carries else None

    @derived
    def identity(self) -> str:
        """The hash of what was asked."""
        return self.points.identity

    @derived
    def cells(self) -> tuple[Cell, ...]:
        """The statistics of each point and controller."""
        names = self.points.plan.controller_names
        places = product(range(len(self.points.values)), range(len(names)))
        return tuple(
            Cell(self.place(i), names[c], int(self.values["carries"][0][i, c]), self._of(i, c))
            for i, c in places
        )

    @derived
    def sensitivity(self) -> tuple[SobolIndex, ...]:
        """The Sobol indices, if the design has any."""
        return tuple(sobol_indices(self.points, self.values))

    @derived
    def refused(self) -> tuple[RefusedCell, ...]:
        """The cells that a controller refuses."""
        names = self.points.plan.controller_names
        return tuple(
            RefusedCell(self.place(i), names[c], reason)
            for (i, c), reason in self.points.rejected_cells.items()
        )

    @derived
    def study(self) -> str:
        """The name of the study."""
        return self.points.plan.name

    @derived
    def scene(self) -> Scene:
        """The scene that is varied."""
        return self.points.plan.base

    def place(self, point: int) -> dict[str, Any]:
        """The values of the keys at a point."""
        return dict(zip(self.points.plan.keys, self.points.values[point], strict=True))

    def _of(self, i: int, c: int) -> dict[str, Estimate]:
        return {
            name: Estimate(
                float(numbers[i, c]),
                None if ends is None else (float(ends[i, c, 0]), float(ends[i, c, 1])),
            )
            for name, (numbers, ends) in self.values.items()
            if name != "carries"
        }


def thread_count(threads: int | None) -> int:
    """The number of threads; by default one for each processor."""
    return available_cores() if threads is None else whole_number("threads", threads, 1, 1024)


def layout_of(points: Points, chunk_size: int | None) -> ChunkGrid:
    """How a study is divided into chunks."""
    if chunk_size is not None:
        chunk_size = whole_number("chunk_size", chunk_size, 1, 10_000_000)
    study = points.plan.study
    stop = study.stop.block if study.stop else None
    return make_layout(
        points.shape, len(points.plan.controllers), study.seeds.count, stop, chunk_size
    )


def run_study(
    plan: Plan,
    out: PathLike | None = None,
    *,
    threads: int | None = None,
    chunk_size: int | None = None,
    scheduler: str | None = None,
    local_cluster: int | None = None,
    order: Callable[[Iterable[int]], Iterable[int]] = list,
    report: Report = lambda _step, _fraction: None,
    notify: Callable[[str], None] = lambda _line: None,
) -> StudyResult:
    """Run a study, or the rest of it.

    Args:
        plan: what to study.
        out: the folder of the study; default NAME.study in the working directory.
        threads: number of threads; by default one for each processor.
        chunk_size: carries per chunk (approximate).
        scheduler: address of a Dask scheduler whose workers carry.
        local_cluster: number of local worker processes to start instead.
        order: may permute the chunks.
        report: called with the present step and the completed fraction of it.
        notify: called with a line about each Dask worker that was lost.

    Raises:
        PalmbotsError: the folder cannot be used (see `palmbots.studies.store.open_store`), or a
            worker failed.
        KeyboardInterrupt: Ctrl-C. Completed chunks are kept.
    """
    require("zarr", "study")
    is_distributed = scheduler is not None or local_cluster is not None
    if scheduler is not None and local_cluster is not None:
        raise PalmbotsError("study: pass either scheduler or local_cluster, not both")
    if is_distributed:
        require("distributed", "cluster")
    count = thread_count(threads)
    began = time.monotonic()
    points = design_points(plan, lambda fraction: report("checking scenes", fraction))
    layout = layout_of(points, chunk_size)
    root = user_path(out) if out is not None else Path(f"{plan.name}.study")

    def on_progress(completed: int, expected: int) -> None:
        report("carrying", completed / expected if expected else 1.0)

    with contextlib.ExitStack() as stack:
        run: Callable[..., None] = functools.partial(run_locally, threads=count)
        cluster = None
        if is_distributed:
            from palmbots.studies.dask_runner import connect

            makers = {c.name: c.maker for c in plan.controllers if c.maker is not None}
            cluster = stack.enter_context(connect(scheduler, local_cluster, makers, notify))
            run = cluster.run
        # Last: nothing is written before it is known that the study can run.
        store = stack.enter_context(
            open_store(root, points, layout, is_chosen=chunk_size is not None)
        )
        resumed = 0
        for repair in range(_MAX_REPAIRS):
            schedule = StudySchedule(store, order)
            run(schedule, on_progress=on_progress)
            resumed = schedule.resumed if repair == 0 else resumed
            results_hash = schedule.verify(lambda fraction: report("reading back", fraction))
            if results_hash is not None:
                break
        else:
            raise PalmbotsError(
                f"{root}: the results read back differ from those written; check the disk"
            )
        values = schedule.finish(results_hash)
    carries, drops, stalls = pooled_counts(schedule.sums)
    return StudyResult(
        points=points,
        output=root,
        results=store.results,
        values=values,
        carries=carries,
        resumed=resumed,
        drops=drops,
        stalls=stalls,
        hash=results_hash,
        seconds=time.monotonic() - began,
        lost_workers=cluster.lost_workers if cluster is not None else (),
    )


def study(
    source: StudyLike,
    out: PathLike | None = None,
    *,
    carries: int | None = None,
    threads: int | None = None,
    chunk_size: int | None = None,
    scheduler: str | None = None,
    local_cluster: int | None = None,
    on_progress: OnProgress = None,
) -> xr.Dataset:
    """Run a study, or the rest of it, and open its results.

    Args:
        source: the name of a study that comes with the package, a TOML file, or a table.
        out: the folder of the study; default NAME.study in the working directory. An unfinished
            study there is continued.
        carries: carries per cell, in place of ``seeds.count``.
        threads: number of threads; by default one for each processor. Results do not depend on it.
        chunk_size: carries per chunk (approximate). Results do not depend on it.
        scheduler: address of a Dask scheduler whose workers carry.
        local_cluster: number of local worker processes to start instead.
        on_progress: called with the completed fraction of the carries.

    Returns:
        A dataset whose arrays are read when they are used: every carry over the dimensions of the
        design, ``controller``, ``seed`` (and ``side``), and statistics of the cells with intervals.
        A grid has one dimension for each key, any other design the dimension ``point``.
        ``attrs["hash"]`` is the hash of all results.

    Raises:
        SceneError: the study or one of its scenes is invalid.
        PalmbotsError: the folder cannot be used, or a package is missing.
    """

    def report(step: str, fraction: float) -> None:
        if on_progress is not None and step == "carrying":
            on_progress(fraction)

    result = run_study(
        load_plan(source, carries),
        out,
        threads=threads,
        chunk_size=chunk_size,
        scheduler=scheduler,
        local_cluster=local_cluster,
        report=report,
    )
    return result.dataset()
