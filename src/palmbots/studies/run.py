"""Begin or take up a study, carry what is due, and say what came out."""

import contextlib
import functools
import os
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots.batch import cores
from palmbots.compare import wilson
from palmbots.errors import PalmbotsError, show
from palmbots.studies.campaign import Campaign
from palmbots.studies.design import Points, design
from palmbots.studies.layout import Layout, layout
from palmbots.studies.local import carry_locally
from palmbots.studies.needs import needed
from palmbots.studies.plan import Plan, load_plan
from palmbots.studies.sensitivity import sensitivities
from palmbots.studies.statistics import Values, pooled_rate
from palmbots.studies.store import opened

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Done", "checked_threads", "cut_of", "open_results", "run_study", "study"]

_MOST_REPAIRS = 3
Report = Callable[[str, float], None]


@dataclass(frozen=True)
class Done:
    """A study that is finished."""

    points: Points
    output: Path
    """Its folder."""
    results: Path
    """The zarr store in it."""
    values: Values
    """The statistics of the cells [points, controllers], and the ends of their intervals."""
    carries: int
    resumed: int
    """Of the carries, those that had been kept before."""
    drops: int
    stalls: int
    hash: str
    """Equal hashes: equal results, to the last bit."""
    seconds: float

    def dataset(self) -> "xr.Dataset":
        """The results, opened lazily."""
        return open_results(self.results)

    def summary(self) -> dict[str, Any]:
        """What ``palmbots study --json`` prints."""
        n = self.carries
        return {
            "carries": n,
            "drop_rate": self.drops / n if n else None,
            "interval": list(wilson(self.drops, n)) if n else None,
            "stall_rate": self.stalls / n if n else None,
            "output": str(self.output),
            "hash": self.hash,
            "identity": self.points.identity,
            "resumed": self.resumed,
            "seconds": round(self.seconds, 3),
            "cells": _cells(self.points, self.values),
            "sensitivity": [asdict(i) for i in sensitivities(self.points, self.values)],
            "refused": [
                _point(self.points, i) | {"why": w} for i, w in self.points.refused.items()
            ],
            "study": self.points.plan.name,
            "scene": self.points.plan.base.model_dump(),
        }


def _point(points: Points, i: int) -> dict[str, Any]:
    return {"at": dict(zip(points.plan.keys, points.values[i], strict=True))}


def _cells(points: Points, values: Values) -> list[dict[str, Any]]:
    """One row a cell, numbers that nothing is known of as null."""

    def plain(number: Any) -> float | None:
        return None if number != number else float(number)

    rows = []
    for i in range(len(points.values)):
        for c, controller in enumerate(points.plan.study.controllers):
            row: dict[str, Any] = _point(points, i) | {"controller": controller}
            for name, (numbers, ends) in values.items():
                row[name] = plain(numbers[i, c])
                if ends is not None:
                    row[f"{name}_interval"] = [plain(end) for end in ends[i, c]]
            row["carries"] = int(row["carries"])
            rows.append(row)
    return rows


def checked_threads(threads: int | None) -> int | None:
    """The number of threads, if it is one."""
    if threads is not None and not 1 <= threads <= 1024:
        raise PalmbotsError(f"--threads: {threads}; allowed: 1 to 1024")
    return threads


def cut_of(points: Points, chunk: int | None) -> Layout:
    """How the study is cut into chunks."""
    if chunk is not None and (isinstance(chunk, bool) or not 1 <= chunk <= 10_000_000):
        raise PalmbotsError(f"--chunk: {show(chunk)} carries; allowed: 1 to 10000000")
    study = points.plan.study
    stop = study.stop.block if study.stop else None
    return layout(points.shape, len(study.controllers), study.seeds.count, stop, chunk)


def run_study(
    plan: Plan,
    out: str | os.PathLike[str] | None = None,
    *,
    threads: int | None = None,
    chunk: int | None = None,
    scheduler: str | None = None,
    local_cluster: int | None = None,
    order: Callable[[Iterable[int]], Iterable[int]] = list,
    report: Report = lambda _what, _fraction: None,
) -> Done:
    """Carry a study, or what is left of it.

    Args:
        plan: what to study.
        out: its folder; default NAME.study here.
        threads: how many carry side by side; default all processors.
        chunk: carries that are kept at a time, about.
        scheduler: address of a Dask scheduler whose workers carry.
        local_cluster: or so many worker processes here.
        order: may shuffle chunks.
        report: called with what is done now and the fraction of it.

    Raises:
        PalmbotsError: see `palmbots.studies.store.opened`; or a worker's failure.
        KeyboardInterrupt: Ctrl-C. Finished chunks are kept.
    """
    needed("zarr", "study")
    if scheduler is not None or local_cluster is not None:
        needed("distributed", "cluster")
    threads = checked_threads(threads)
    began = time.monotonic()
    points = design(plan, lambda f: report("checking scenes", f))
    cut = cut_of(points, chunk)
    root = Path(out) if out is not None else Path(f"{plan.name}.study")
    with contextlib.ExitStack() as stack:
        carry: Callable[..., None] = functools.partial(carry_locally, threads=threads or cores())
        if scheduler is not None or local_cluster is not None:
            from palmbots.studies.cluster import reached

            carry = stack.enter_context(reached(scheduler, local_cluster)).carry
        # Last, so that nothing is begun that nobody can carry.
        store = stack.enter_context(opened(root, points, cut, chosen=chunk is not None))
        resumed = 0
        for repair in range(_MOST_REPAIRS):
            campaign = Campaign(store, order)
            carry(campaign, report=lambda f: report("carrying", f))
            resumed = campaign.resumed if repair == 0 else resumed
            told = campaign.verify(lambda f: report("reading back", f))
            if told is not None:
                break
        else:
            raise PalmbotsError(
                f"{root}: what is written there reads back differently; is the disk sound?"
            )
        values = campaign.statistics()
        store.conclude(values, {"hash": told, "identity": points.identity})
    carries, drops, stalls = pooled_rate(campaign.tally)
    return Done(
        points=points,
        output=root,
        results=store.results,
        values=values,
        carries=carries,
        resumed=resumed,
        drops=drops,
        stalls=stalls,
        hash=told,
        seconds=time.monotonic() - began,
    )


def open_results(path: str | os.PathLike[str]) -> "xr.Dataset":
    """The results of a study (its folder, or the store in it), read where they are looked at."""
    place = Path(path)
    if (place / "results.zarr").exists():
        place = place / "results.zarr"
    needed("zarr", "study")
    import xarray as xr  # here: slow to import

    try:
        return xr.open_zarr(place, chunks=None, zarr_format=2)
    except (OSError, KeyError, ValueError) as error:
        raise PalmbotsError(f"{place}: is no study's results: {error}") from None


def study(
    source: str | os.PathLike[str] | Mapping[str, Any],
    out: str | os.PathLike[str] | None = None,
    *,
    carries: int | None = None,
    threads: int | None = None,
    chunk: int | None = None,
    scheduler: str | None = None,
    local_cluster: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> "xr.Dataset":
    """Carry a study, or what is left of it, and open its results.

    Args:
        source: the name of a study that comes with the package, a TOML file, or a table.
        out: its folder; default NAME.study in the working directory. An unfinished one goes on.
        carries: for each cell, in place of ``seeds.count``.
        threads: how many carry side by side; default all processors. Results do not depend on it.
        chunk: carries that are kept at a time, about; likewise.
        scheduler: address of a Dask scheduler whose workers carry.
        local_cluster: or so many worker processes on this machine.
        progress: called with the fraction that is done.

    Returns:
        A dataset, lazily opened: every carry over the design's dimensions, ``controller``, ``seed``
        (and ``side``), and statistics of the cells with intervals. A grid has a dimension for each
        key, any other design the dimension ``point``. ``attrs["hash"]`` is the hash of all results.

    Raises:
        SceneError: the study or one of its scenes cannot be read or makes no sense.
        PalmbotsError: the folder cannot be used, or a package is missing.
    """
    report: Report = lambda what, f: progress(f) if progress and what == "carrying" else None  # noqa: E731
    done = run_study(
        load_plan(source, carries),
        out,
        threads=threads,
        chunk=chunk,
        scheduler=scheduler,
        local_cluster=local_cluster,
        report=report,
    )
    return done.dataset()
