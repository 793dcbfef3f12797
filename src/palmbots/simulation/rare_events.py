# SPDX-License-Identifier: Apache-2.0
"""The drop rate of a scene, however small: multilevel splitting in the compiled core.

A carry that drops first moves a contact far out on its palm. Levels divide that distance into
stages. Copies of the carries that reach a level continue from there, each with its own random
numbers, to the next level. The product of the fractions that reach the next level is an unbiased
estimate of the drop rate (`sim/multilevel_splitting.hpp` has the derivation). A pilot run finds the
levels, and pilot replicates estimate how many replicates are needed: at least a quarter of that
number, because fewer would estimate the scatter poorly. Neither counts in the result: an estimate
that also decides when to stop would be too low on average.

The work is limited by a budget, counted in whole carries. The pilot run also states what a
replicate costs, and so how many the budget allows. Where these are too few, or no pilot replicate
drops the object, plain carries use up the budget instead and give an exact bound.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import Interval, Overrides
from palmbots._util.arguments import seed_of, whole_number
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import clopper_pearson, student_t95
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots._util.text import duration, plural
from palmbots.control.registry import ControllerLike, refuse_reference, resolve
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import refuse_floor
from palmbots.simulation.batch import DROPPED, available_cores, run_singly
from palmbots.simulation.outcome_counts import carry_seeds
from palmbots.simulation.prepare import Prepared, prepare

SHARE = 0.4
"""The fraction of the carries from one level that reaches the next one."""
EFFORT = 1000
"""Carries in each stage of a replicate. With fewer carries, or fewer levels, the scatter grows by
more than the time saved: at one drop in a million, 500 carries with a fraction of 0.2 took more
than twice the time."""
PILOT = 12
"""The smallest number of pilot replicates."""
LEAST_PLAIN = 1000
"""Plain carries that are run at least where splitting gives no estimate."""
FEWEST, MOST = 16, 10_000
"""Limits of the number of replicates that count."""
MOST_BUDGET = 200_000
"""The budget if none is given, for carries as long and as simple as those of the default scene. For
other scenes it is smaller, so that the work takes about as long."""
SPLITTING = 20
"""With a budget of fewer stages than this, only plain carries are run, because splitting would not
end within it. The same holds if the choice of levels alone takes half of the budget."""
_AT_ONCE = 16  # replicates between two checks of the budget; not a matter of threads
_SEEDS_APART = 2**41  # plain carries share no seeds with those of other commands
# More replicates than the scatter of the pilot requires, as that is an estimate: at one drop in a
# million, three of four intervals reach the wanted width of 20 %; with 1.3 it was three of five.
_RESERVE = 1.7
_SINGLE_STEPS = 5  # times as long: a carry that checks every period
_SAMPLE_S, _MOMENT_S = 0.1, 2.0


@dataclass(frozen=True, repr=False)
class DropRate(Result):
    """A drop rate, its interval, and how it was estimated."""

    drop_rate: float
    interval: Interval
    """95 %: by Student's t over the replicates, with a low end not below 0; of plain carries,
    Clopper and Pearson's, which is one-sided where none was dropped."""
    carries: int
    """Plain carries that count; 0: the replicates of the splitting count."""
    dropped: int
    """Of the plain carries."""
    budget: int
    """What the work may cost, in carries, with the pilot run."""
    is_narrow: bool
    """Whether the budget was enough for an interval about as narrow as asked for."""
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
    """How many whole carries last as long as all the work, with the pilot run."""
    controller: str
    seed: int
    scene: Scene

    def lines(self) -> Iterator[Item]:
        """The rate or its bound, and the levels of the splitting."""
        low, high = self.interval
        if self.carries and not self.dropped:
            yield Line(bold(f"drop rate < {high:.2g}"), ", 95 %")
        else:
            yield Line(bold(f"drop rate {self.drop_rate:.2g}"), f", 95 % {low:.2g} to {high:.2g}")
        yield quiet(f"{self.controller}, seed {self.seed}")
        if 0 < self.drop_rate < 0.1:
            yield f"one carry in {1 / self.drop_rate:,.0f} drops the object"
        if self.carries:
            counts = f"{self.dropped:,} of {self.carries:,} plain carries dropped the object"
            yield f"{counts}; splitting gave no rate"
        elif self.levels:
            heads = ("level (% of the palm's half-length)", "reached from the level before")
            reached = zip(self.levels, self.conditional_probabilities, strict=True)
            rows = [(f"{100 * level:.0f} %", f"{100 * part:.1f} %") for level, part in reached]
            yield Table(rows, heads, right=heads)
        if not self.is_narrow:
            yield f"the budget of {self.budget:,} carries allows no narrower interval (--budget)"
        cost = f"cost: {self.equivalent_carries:,.0f} whole carries; budget: {self.budget:,}"
        if self.carries:
            yield quiet(cost)
        else:
            yield quiet(
                f"{plural(self.replicates, 'replicate')} of {plural(self.effort, 'carry')} per "
                f"stage; {cost}"
            )
            if self.effort < EFFORT:
                yield quiet(
                    f"with fewer than {EFFORT} carries per stage, about one interval in ten lies "
                    "below the true rate"
                )


@command(
    "drop-rate",
    order=90,
    example="palmbots drop-rate --set robot.noise_m_s=0.012 --relative-error-percent 20",
    progress="splitting",
    relative_half_width=Option("--relative-error-percent", percent=True, least=0.01, most=1.0),
    effort=Option(least=10, most=100_000),
    budget=Option(least=1000, most=10**9),
)
def estimate_drop_rate(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    relative_half_width: float = 0.2,
    effort: int = EFFORT,
    budget: int | None = None,
    seed: int = 0,
    threads: int | None = None,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
    on_line: Callable[[str], None] | None = None,
) -> DropRate:
    """Estimate a drop rate, down to one in a billion.

    The method is multilevel splitting; the estimate has a 95 % interval. Where the budget is too
    small for it, or nothing drops, plain carries give an upper bound.

    Args:
        scene: as in `palmbots.carry`.
        controller: the name of a shipped one, or a policy file. Splitting copies a carry that is
            under way, and a Python controller cannot be copied.
        relative_half_width: half-width of the 95 % interval, relative to the rate. The interval
            may be wider: the number of replicates is an estimate too, and at most 10000 count.
        effort: carries in each stage of the splitting. With fewer than the default, the interval
            lies below the true rate more often than its 2.5 %.
        budget: what the work may cost, in whole carries; None: as many as usually take up to two
            minutes on two processors, and at most 200,000. It depends on the scene, not on the
            machine.
        seed: random seed.
        threads: worker threads; None: one per processor.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.
        on_line: called before the work with a line about how long it takes at most.

    Note:
        Runs in double precision. The result depends on the arguments, not on the number of threads
        or their speed.

    Raises:
        SceneError: the scene cannot be read, is invalid, or is refused by the controller.
        PalmbotsError: another argument is not allowed.
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
    refuse_floor(prepared.scene, "copies of carries that are under way do")
    budget = default_budget(prepared) if budget is None else budget
    if on_line is not None:
        _announce(prepared, budget, effort, workers, on_line)
    run = _Splitting(
        prepared, seed, effort, budget, workers, on_progress or (lambda fraction: None)
    )
    rows = run.pilot(relative_half_width)
    pilot = len(rows)
    count = run.wanted(rows, relative_half_width)
    affordable = run.affordable(pilot)
    is_narrow = count <= affordable
    count = min(count, affordable)
    levels, fractions = tuple(run.levels), ()
    carries = dropped = 0
    if count >= FEWEST:
        stages = run.replicates(pilot, count, run.planned(pilot, count))
        estimates = _estimates(stages, effort)
        rate = float(estimates.mean())
        half = student_t95(count - 1) * float(estimates.std(ddof=1)) / math.sqrt(count)
        interval = max(rate - half, 0.0), min(rate + half, 1.0)
        fractions = tuple(_fractions(stages, effort))
    else:
        count, is_narrow = 0, False
        carries = max(LEAST_PLAIN, budget - math.ceil(run.spent))
        dropped = run.plain(carries)
        rate, interval = dropped / carries, clopper_pearson(dropped, carries)
    run.report(1.0)
    return DropRate(
        drop_rate=rate,
        interval=interval,
        carries=carries,
        dropped=dropped,
        budget=budget,
        is_narrow=is_narrow,
        levels=levels if fractions else (),
        conditional_probabilities=fractions,
        replicates=count,
        pilot_replicates=pilot,
        effort=effort,
        equivalent_carries=run.spent + carries,
        controller=entry.name,
        seed=seed,
        scene=prepared.scene,
    )


def default_budget(prepared: Prepared) -> int:
    """The budget if none is given. It is smaller for carries that may last longer than those of
    the default scene, or that check in every control period whether a robot stalls."""
    usual, scene = Scene(), prepared.scene
    share = (usual.timeout_s / usual.control.period_s) / (scene.timeout_s / scene.control.period_s)
    if _core.takes_single_steps(prepared.spec):
        share /= _SINGLE_STEPS
    return max(LEAST_PLAIN, min(MOST_BUDGET, int(float(f"{share * MOST_BUDGET:.2g}"))))


def _announce(
    prepared: Prepared, budget: int, effort: int, workers: int, on_line: Callable[[str], None]
) -> None:
    """State how long the budget lasts, if it is more than a moment."""
    each_s, count = 0.0, 4
    while each_s * count < _SAMPLE_S and count < LEAST_PLAIN:
        count *= 2
        begin = time.monotonic()
        index, seeds = np.zeros(count, np.uint32), np.arange(count, dtype=np.uint64)
        run_singly([prepared.spec], index, seeds, prepared.controller, "double", 1, None)
        each_s = (time.monotonic() - begin) / count
    total_s = budget * each_s / workers
    if budget >= SPLITTING * max(effort, EFFORT):  # half of it may choose levels, on one processor
        total_s *= 0.5 * (1 + workers)
    if total_s > _MOMENT_S:
        on_line(
            f"the drop rate takes up to about {duration(float(f'{total_s:.2g}'))}: "
            f"{budget:,} carries (--budget)"
        )


class _Splitting:
    """The replicates of one scene, what they cost, and what is left of the budget."""

    def __init__(
        self,
        prepared: Prepared,
        seed: int,
        effort: int,
        budget: int,
        workers: int,
        on_progress: Callable[[float], None],
    ) -> None:
        scene = prepared.scene
        self._prepared, self._seed, self._effort = prepared, seed, effort
        self._budget, self._workers, self._on_progress = budget, workers, on_progress
        self._core = prepared.controller.for_core(prepared.spec)
        self._duration_s = scene.task.distance_m / scene.robot_of("left").speed_m_s
        self.levels: list[float] = []
        self.ticks = self._before = 0
        tried = max(effort, EFFORT)
        if budget >= SPLITTING * tried:
            half = int(budget / 2 / self.carries(1))  # in ticks
            self.levels, self._before = _core.choose_levels(
                prepared.spec, self._core, seed, tried, SHARE, half
            )
        self._fraction = 0.0

    def report(self, fraction: float) -> None:
        """Report progress, which never falls."""
        self._fraction = max(self._fraction, fraction)
        self._on_progress(self._fraction)

    def carries(self, ticks: float) -> float:
        """How many whole carries last that many ticks."""
        return ticks * self._prepared.spec.period / self._duration_s

    @property
    def spent(self) -> float:
        """What the work has cost so far, in carries."""
        return self.carries(self._before + self.ticks)

    def affordable(self, pilot: int) -> int:
        """How many replicates the rest of the budget allows."""
        each = self.carries(self.ticks) / max(pilot, 1)
        return int((self._budget - self.spent) / each) if each > 0 else 0

    def planned(self, pilot: int, count: int) -> float:
        """The completed fraction after the pilot run, where `count` more replicates follow."""
        return pilot / (pilot + count)

    def pilot(self, half_width: float) -> NDArray[Any]:
        """At least `PILOT` replicates and a quarter of those wanted, or half of the budget."""
        rows = np.zeros((0, len(self.levels) + 1, 2))
        target = PILOT
        while self.levels and len(rows) < target and self.spent < self._budget / 2:
            at = len(rows)
            half = self._budget / 2 - self.spent
            # At first, the most that a replicate can cost.
            each = self.carries(self.ticks) / at if at else (len(self.levels) + 1) * self._effort
            more = max(1, min(target - at, _AT_ONCE, int(half / max(each, 1e-9))))
            rows = np.concatenate([rows, self._run(at, more)])
            # What is left, at least, if the pilot run turns out to be of no use.
            self.report(self.spent / max(self._budget, self.spent + LEAST_PLAIN))
            if len(rows) >= target:
                wanted = min(self.wanted(rows, half_width), self.affordable(len(rows)))
                target = max(target, math.ceil(wanted / 4)) if wanted else target
        return rows

    def wanted(self, rows: NDArray[Any], half_width: float) -> int:
        """How many replicates give the wanted interval; 0: the pilot run does not say."""
        before = _estimates(rows, self._effort)
        return _needed(before, half_width) if len(rows) >= PILOT and before.any() else 0

    def replicates(self, first: int, count: int, start: float) -> NDArray[Any]:
        """Stages (reached, drops) of replicates; a few at a time, so that Ctrl-C is noticed."""
        found = []
        start = max(start, self._fraction)
        for at in range(0, count, _AT_ONCE):
            more = min(_AT_ONCE, count - at)
            found.append(self._run(first + at, more))
            self.report(start + (1 - start) * (at + more) / count)
        return np.concatenate(found)

    def _run(self, first: int, count: int) -> NDArray[Any]:
        stages, ticks = _core.replicates(
            self._prepared.spec, self._core, self._seed, self._effort, self.levels, first, count,
            self._workers,
        )  # fmt: skip
        self.ticks += ticks
        return np.array(stages, float)

    def plain(self, carries: int) -> int:
        """How many of so many plain carries drop the object."""
        first = (self._seed + _SEEDS_APART) % 2**64
        start = self._fraction
        found = carry_seeds(
            self._prepared, first, carries,
            report=lambda fraction: self.report(start + (1 - start) * fraction),
        )  # fmt: skip
        return int(np.count_nonzero(found["outcome"] == DROPPED))


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
