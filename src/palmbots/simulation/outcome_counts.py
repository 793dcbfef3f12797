# SPDX-License-Identifier: Apache-2.0
"""How often a scene ends in which way: with its controller, and with those that do better.

One carry says little about a scene: its seed decides. Here many seeds of one scene and one
controller are counted: 0, 1, …, the same ones for each controller. Where nothing else is asked for,
their number follows from the scene alone, so that all controllers together take about a second and
the result does not depend on the machine's speed. Controllers in Python, and worlds that Python
steps, take longer; for them the number must be given.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import Interval, Overrides
from palmbots._util.arguments import whole_number
from palmbots._util.confidence_intervals import rate_interval, rate_text
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots.control.registry import ControllerLike, resolve, shipped_names
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.batch import (
    DELIVERED,
    DROPPED,
    REASONS,
    STALLED,
    Columns,
    available_cores,
    can_run_in_lanes,
    is_built,
    run_batch,
)
from palmbots.simulation.carry_worker import run_apart
from palmbots.simulation.prepare import Prepared, check_precision, prepare

IN_LANES, SINGLY, FEWEST = 1000, 200, 20
"""Carries that are counted by default: side by side, one after the other, and at least."""
SMALL = 0.01
"""Below this share of failures no other controller is tried: it is that at which σ* is defined."""
_SECONDS = 5  # the most that counting may take if the number of carries is not given
MOST = 10**8


@dataclass(frozen=True, repr=False)
class OutcomeCounts(Result):
    """How the carries of one scene with one controller ended, with the seeds 0, 1, …"""

    controller: str
    carries: int
    dropped: int
    stalled: int
    """Neither delivered nor dropped within ``task.timeout_s``."""
    farthest_m: float | None = None
    """How far a contact came from its pivot in the carries that delivered; None: none did."""
    reasons: dict[str, int] = field(default_factory=dict)
    """How many carries dropped the object for which reason, the most frequent first."""

    @derived
    def drop_rate(self) -> float:
        """The share of carries that dropped the object."""
        return self.dropped / self.carries

    @derived
    def drop_interval(self) -> Interval:
        """95 %, Wilson's; where none was dropped, the exact one-sided bound."""
        return rate_interval(self.dropped, self.carries)

    @derived
    def stall_rate(self) -> float:
        """The share of carries that stalled."""
        return self.stalled / self.carries

    @derived
    def stall_interval(self) -> Interval:
        """As `drop_interval`."""
        return rate_interval(self.stalled, self.carries)

    @property
    def failure_rate(self) -> float:
        """The share of carries that did not deliver the object."""
        return (self.dropped + self.stalled) / self.carries

    @property
    def failure_interval(self) -> Interval:
        """As `drop_interval`."""
        return rate_interval(self.dropped + self.stalled, self.carries)

    def lines(self) -> Iterator[Item]:
        """Drops and stalls, and of how many carries."""
        drops, stalls = (rate_text(events, self.carries) for events in (self.dropped, self.stalled))
        yield Line(bold(f"drops {drops}"), f", stalls {stalls}")
        shown = "1 carry" if self.carries == 1 else f"{self.carries:,} carries"
        yield quiet(f"{self.controller}: {shown} of this scene, seeds from 0; 95 %")


@dataclass(frozen=True, repr=False)
class SceneStatistics(Result):
    """How often a scene fails, and the shipped controllers that fail less often in it."""

    own: OutcomeCounts
    better: tuple[OutcomeCounts, ...] | None
    """With the same seeds, the best first: the interval of their failures (drops and stalls) lies
    below that of `own`. None: `own` fails so rarely that no other one was tried."""

    def lines(self) -> Iterator[Item]:
        """The counts, and the better controllers."""
        yield from self.own.lines()
        if self.better:
            yield "these controllers fail less in this scene, on the same seeds:"
            yield Table([
                (f"  --controller {one.controller}",
                 f"drops {rate_text(one.dropped, one.carries)}",
                 f"stalls {rate_text(one.stalled, one.carries)}")
                for one in self.better
            ])  # fmt: skip
        elif self.better is not None:
            yield "no other shipped controller fails measurably less on the same seeds"


def default_carries(prepared: Prepared) -> int | None:
    """How many carries are counted where nothing else is asked for; None: the number must be given.

    A carry that may last longer than one of the default scene, in control periods, counts as more
    than one.
    """
    if takes_long(prepared):
        return None
    most = IN_LANES if _in_lanes(prepared) else SINGLY
    return max(FEWEST, min(most, int(_carries_of_a_second(prepared))))


def takes_long(prepared: Prepared) -> bool:
    """Whether a hundred carries of a usual length take longer than a second or two."""
    entry = prepared.controller
    return entry.is_python or entry.is_reference or prepared.world.is_stepped


def _carries_of_a_second(prepared: Prepared) -> float:
    """How many carries take about a second with all controllers together, if each lasts until it
    times out."""
    usual, scene = Scene(), prepared.scene
    share = (usual.timeout_s / usual.control.period_s) / (scene.timeout_s / scene.control.period_s)
    return share * (IN_LANES if _in_lanes(prepared) else SINGLY)


def _in_lanes(prepared: Prepared) -> bool:
    spec = prepared.spec
    is_fast = is_built() and not _core.takes_single_steps(spec)
    return is_fast and can_run_in_lanes(prepared.controller, [spec])


def count_outcomes(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    seeds: int | None = None,
    world: str = "quasistatic",
    precision: str = "double",
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> OutcomeCounts:
    """Count how the carries of a scene with a controller end.

    Args:
        scene: as in `palmbots.carry`.
        controller: as in `palmbots.carry`.
        seeds: how many seeds, from 0; None: as many as take a fraction of a second.
        world: as in `palmbots.carry`. The carries of a world that Python steps run in one process
            per processor.
        precision: ``double`` or ``float``.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Note:
        The result depends on the arguments, not on the number of processors or their speed. Without
        `seeds`, fewer carries are counted where the batch modules are not built.

    Raises:
        SceneError: the scene cannot be read or is invalid, or the world or the controller refuses
            it.
        PalmbotsError: another argument is not allowed; a controller in Python, a reference or a
            world that Python steps needs `seeds`.
    """
    entry = resolve(controller)
    prepared = prepare(load_scene(scene, overrides), entry, world)
    check_precision(prepared.world, precision)
    count = default_carries(prepared) if seeds is None else whole_number("seeds", seeds, 1, MOST)
    if count is None:
        raise PalmbotsError(
            f"seeds: none given; allowed: 1 to {MOST}, as carries of {entry.name} in the world "
            f"{prepared.world.name} take long"
        )
    return _counted(prepared, count, precision, on_progress)


def better_controllers(
    own: OutcomeCounts,
    scene: SceneLike,
    *,
    world: str = "quasistatic",
    precision: str = "double",
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> tuple[OutcomeCounts, ...]:
    """The shipped controllers whose interval of failures lies below that of `own`, the best first.

    All run with the seeds of `own`. A controller that refuses the scene is left out.

    Raises:
        SceneError: the scene cannot be read or is invalid.
    """
    chosen = load_scene(scene, overrides)
    others = [name for name in shipped_names() if name != own.controller]
    found = []
    for k, name in enumerate(others):
        try:
            prepared = prepare(chosen, name, world)
        except SceneError:
            continue
        report = None if on_progress is None else _part(on_progress, k, len(others))
        found.append(_counted(prepared, own.carries, precision, report))
    least = own.failure_interval[0]
    better = [one for one in found if one.failure_interval[1] < least]
    return tuple(sorted(better, key=lambda one: one.failure_rate))


def scene_statistics(
    prepared: Prepared,
    *,
    seeds: int | None = None,
    precision: str = "double",
    on_progress: Callable[[float], None] | None = None,
) -> SceneStatistics | None:
    """Counts, and the better controllers unless `prepared` rarely fails.

    Where carries take long, others are not tried: `better` is None. None: `seeds` is not given, and
    even a few carries may take several seconds.
    """
    count = default_carries(prepared) if seeds is None else seeds
    if count is None:
        return None
    if seeds is None and _SECONDS * _carries_of_a_second(prepared) < FEWEST:
        return None
    tries_others = not takes_long(prepared)
    own_part = _part(on_progress, 0, 6) if on_progress and tries_others else on_progress
    own = _counted(prepared, count, precision, own_part)
    better = None
    if tries_others and own.failure_rate >= SMALL:
        world = prepared.world.name
        rest = _part(on_progress, 1, 6, 5) if on_progress else None
        better = better_controllers(
            own, prepared.scene, world=world, precision=precision, on_progress=rest
        )
    return SceneStatistics(own, better)


def _part(
    report: Callable[[float], None], k: int, of: int, parts: int = 1
) -> Callable[[float], None]:
    """For `parts` of `of` equal parts of the work, after the first k."""
    return lambda fraction: report((k + parts * fraction) / of)


def _counted(
    prepared: Prepared, count: int, precision: str, report: Callable[[float], None] | None
) -> OutcomeCounts:
    columns = carry_seeds(prepared, 0, count, precision, report)
    return OutcomeCounts(
        prepared.controller.name,
        count,
        int(np.count_nonzero(columns["outcome"] == DROPPED)),
        int(np.count_nonzero(columns["outcome"] == STALLED)),
        farthest_m(columns),
        reason_counts(REASONS[k] for k in columns["reason"].tolist()),
    )


def farthest_m(columns: Columns) -> float | None:
    """How far a contact came from its pivot in the carries that delivered; None: none did."""
    peaks = columns["contact_peak_m"][columns["outcome"] == DELIVERED]
    return float(peaks.max()) if peaks.size else None


def reason_counts(reasons: Iterable[str | None]) -> dict[str, int]:
    """How often each reason for a drop occurs; None means no drop."""
    return dict(Counter(reason for reason in reasons if reason is not None).most_common())


def carry_seeds(
    prepared: Prepared,
    first: int,
    count: int,
    precision: str = "double",
    report: Callable[[float], None] | None = None,
) -> Columns:
    """Columns of the carries with seeds first … first + count − 1, in the fastest way there is."""
    watch = None if report is None else lambda done: report(done / count)
    seeds = np.arange(count, dtype=np.uint64) + np.uint64(first)
    index = np.zeros(count, np.uint32)
    return carry_many([prepared], index, seeds, precision, threads=available_cores(), watch=watch)


def carry_many(
    prepared: Sequence[Prepared],
    index: NDArray[Any],
    seeds: NDArray[np.uint64],
    precision: str = "double",
    *,
    threads: int,
    watch: Callable[[int], None] | None = None,
) -> Columns:
    """Columns of the carries of ``prepared[index[i]]`` with ``seeds[i]``, which have the same
    controller and world: in processes of their own where Python steps them."""
    entry, world = prepared[0].controller, prepared[0].world
    if entry.is_python or world.is_stepped:
        return run_apart(
            prepared, index.tolist(), seeds.tolist(), precision, processes=threads, watch=watch
        )
    specs = [one.spec for one in prepared]
    return run_batch(specs, index, seeds, entry, precision, threads=threads, watch=watch)
