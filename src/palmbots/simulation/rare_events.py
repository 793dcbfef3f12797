# SPDX-License-Identifier: Apache-2.0
"""The drop rate of a scene, however small: multilevel splitting in the compiled core.

A carry that drops first moves a contact far out on its palm. Levels divide that distance into
stages. Copies of the carries that reach a level continue from there, each with its own random
numbers, to the next level. The product of the fractions that reach the next level is an unbiased
estimate of the drop rate (`sim/multilevel_splitting.hpp` has the derivation). A pilot run finds the
levels, and pilot replicates estimate how many replicates are needed: at least a quarter of that
number, because fewer would estimate the scatter poorly. Neither counts in the result: an estimate
that also decides when to stop would be too low on average.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import Interval, Overrides
from palmbots._util.arguments import seed_of, whole_number
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import student_t95
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.control.registry import ControllerLike, refuse_reference, resolve
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.batch import available_cores
from palmbots.simulation.prepare import prepare

SHARE = 0.4
"""The fraction of the carries from one level that reaches the next one."""
EFFORT = 1000
"""Carries in each stage of a replicate. With fewer carries, or fewer levels, the scatter grows by
more than the time saved: at one drop in a million, 500 carries with a fraction of 0.2 took more
than twice the time."""
PILOT = 12
"""The smallest number of pilot replicates."""
FEWEST, MOST = 16, 10_000
"""Limits of the number of replicates that count."""
# More replicates than the scatter of the pilot requires, because that scatter is an estimate: at
# one drop in a million three of four intervals reach the wanted width of 20 %; with 1.3 it was
# three of five.
_RESERVE = 1.7


@dataclass(frozen=True, repr=False)
class DropRate(Result):
    """A drop rate, its interval, and how it was estimated."""

    drop_rate: float
    interval: Interval
    """95 %, by Student's t over the replicates; its low end is not below 0."""
    levels: tuple[float, ...]
    """|p| as fractions of the palm's half-length."""
    conditional_probabilities: tuple[float, ...]
    """For each level, the fraction of the carries from the level before that reach it; mean over
    the replicates."""
    replicates: int
    pilot_replicates: int
    """Replicates of the pilot run, which estimate how many are needed and do not count."""
    effort: int
    """Carries in each stage of a replicate."""
    equivalent_carries: float
    """How many whole carries would have taken the same time, without the pilot run."""
    controller: str
    seed: int
    scene: Scene

    def lines(self) -> Iterator[Item]:
        """The rate, and the levels of the splitting."""
        low, high = self.interval
        yield Line(bold(f"drop rate {self.drop_rate:.2g}"), f", 95 % {low:.2g} to {high:.2g}")
        yield quiet(f"{self.controller}, seed {self.seed}")
        if 0 < self.drop_rate < 0.1:
            yield f"one carry in {1 / self.drop_rate:,.0f} drops the object"
        if self.levels:
            heads = ("level (% of the palm's half-length)", "reached from the level before")
            reached = zip(self.levels, self.conditional_probabilities, strict=True)
            rows = [(f"{100 * level:.0f} %", f"{100 * part:.1f} %") for level, part in reached]
            yield Table(rows, heads, right=heads)
        yield quiet(
            f"{plural(self.replicates, 'replicate')} of {plural(self.effort, 'carry')} per stage; "
            f"cost: as {self.equivalent_carries:,.0f} whole carries"
        )


@command(
    "drop-rate",
    order=90,
    example="palmbots drop-rate --set robot.noise_m_s=0.012 --relative-error-percent 20",
    progress="splitting",
    relative_half_width=Option("--relative-error-percent", percent=True, least=0.01, most=1.0),
    effort=Option(least=10, most=100_000),
)
def estimate_drop_rate(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    relative_half_width: float = 0.2,
    effort: int = EFFORT,
    seed: int = 0,
    threads: int | None = None,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> DropRate:
    """Estimate a drop rate, down to one in a billion.

    The method is multilevel splitting; the estimate has a 95 % interval.

    Args:
        scene: as in `palmbots.carry`.
        controller: the name of a shipped one, or a policy file. Splitting copies a carry that is
            under way, and a Python controller cannot be copied.
        relative_half_width: half-width of the 95 % interval, relative to the rate. The interval
            may be wider: the number of replicates is an estimate too, and at most 10000 count.
        effort: carries in each stage of the splitting.
        seed: random seed.
        threads: worker threads; None: one per processor.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Note:
        Runs in double precision. The result depends on the arguments, not on the number of threads.

    Raises:
        SceneError: the scene cannot be read, is invalid, or is refused by the controller.
        PalmbotsError: another argument is not allowed, or no random input moves a contact outward.
    """
    entry = resolve(controller)
    refuse_reference(entry, "a drop rate")
    if entry.is_python:
        raise PalmbotsError(
            f"controller: {entry.name} is in Python, and a drop rate needs copies of carries that "
            "are under way; use compare or study, or a shipped controller"
        )
    seed = seed_of(seed)
    workers = available_cores() if threads is None else whole_number("threads", threads, 1, 1024)
    prepared = prepare(load_scene(scene, overrides), entry)
    chosen, spec = prepared.scene, prepared.spec
    report = on_progress or (lambda fraction: None)
    core = entry.for_core(spec)
    levels = _core.choose_levels(spec, core, seed, max(effort, 1000), SHARE)

    def run(first: int, count: int, part: Interval) -> tuple[NDArray[Any], int]:
        """Stages (reached, drops) of replicates; a few at a time, so that Ctrl-C is noticed."""
        rows, ticks = [], 0
        step = 2 * workers
        for at in range(first, first + count, step):
            more = min(step, first + count - at)
            stages, spent = _core.replicates(spec, core, seed, effort, levels, at, more, workers)
            rows += stages
            ticks += spent
            report(part[0] + (part[1] - part[0]) * (at + more - first) / count)
        return np.array(rows, float), ticks

    pilot, _ = run(0, PILOT, (0.0, 0.2))
    spent = 0.2
    while True:
        before = _estimates(pilot, effort)
        if not before.any():
            raise PalmbotsError(
                f"drop-rate: none of {PILOT} times {effort} carries dropped, with "
                f"{plural(len(levels), 'level')} up to {max(levels, default=0.0):.2f} of the "
                "palm's half-length; allowed: scenes that may drop by chance, or a greater effort"
            )
        count = _needed(before, relative_half_width)
        first = len(pilot)
        more = math.ceil(count / 4) - first
        if more <= 0:
            break
        further, _ = run(first, more, (spent, 0.5 * (spent + 0.4)))
        pilot = np.concatenate([pilot, further])
        spent = 0.5 * (spent + 0.4)
    stages, ticks = run(first, count, (spent, 1.0))
    estimates = _estimates(stages, effort)
    rate = float(estimates.mean())
    half = student_t95(count - 1) * float(estimates.std(ddof=1)) / math.sqrt(count)
    duration_s = chosen.task.distance_m / chosen.robot_of("left").speed_m_s
    return DropRate(
        drop_rate=rate,
        interval=(max(rate - half, 0.0), min(rate + half, 1.0)),
        levels=tuple(levels),
        conditional_probabilities=tuple(_fractions(stages, effort)),
        replicates=count,
        pilot_replicates=first,
        effort=effort,
        equivalent_carries=ticks * spec.period / duration_s,
        controller=entry.name,
        seed=seed,
        scene=chosen,
    )


def _estimates(stages: NDArray[Any], effort: int) -> NDArray[Any]:
    """Σ_k (r_0 / N) ⋯ (r_{k−1} / N) · d_k / N of each replicate."""
    reached, drops = stages[:, :, 0] / effort, stages[:, :, 1] / effort
    before = np.concatenate(
        [np.ones((len(stages), 1)), np.cumprod(reached, axis=1)[:, :-1]], axis=1
    )
    return np.sum(before * drops, axis=1)


def _needed(estimates: NDArray[Any], relative_half_width: float) -> int:
    """How many replicates with this scatter give the wanted interval."""
    scatter = float(estimates.std(ddof=1) / estimates.mean())
    count = MOST
    for _ in range(2):  # the quantile depends on the number sought
        wanted = math.ceil(_RESERVE * (student_t95(count - 1) * scatter / relative_half_width) ** 2)
        count = min(max(wanted, FEWEST), MOST)
    return count


def _fractions(stages: NDArray[Any], effort: int) -> list[float]:
    return [float(part) for part in np.mean(stages[:, :-1, 0] / effort, axis=0)]
