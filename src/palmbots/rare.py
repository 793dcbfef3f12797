"""The chance that a carry is dropped, however small: multilevel splitting in the compiled core.

A carry that is dropped first has to get a contact far out on its palm. Of the carries that come to
a level, a part of the palm's half-length, copies go on from there, each with random numbers of its
own, to the next level; the product of the parts that get on is an unbiased estimate of the drop
rate (`splitting.hpp` says how). The levels are found by a pilot, how many replicates are needed by
some that come before (at least a quarter of those, or they would tell too little of the scatter).
Neither of the two counts: an estimate that had a say in when to stop would be too low on average.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots import _core
from palmbots.batch import cores
from palmbots.bounds import bounds_of
from palmbots.carry import CONTROLLERS
from palmbots.errors import PalmbotsError, one_of, seed_of, show, whole_number
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene

__all__ = ["DropRate", "rare"]

SHARE = 0.4
"""Of the carries from one level, this part gets to the next one."""
EFFORT = 1000
"""Carries in each stage of a replicate. Replicates of fewer, or of fewer levels, scatter more than
they save: at one drop in a million, 500 with a share of 0.2 took more than twice the time."""
PLANNING = 12
"""The fewest replicates from which is told how many are needed."""
FEWEST, MOST = 16, 10_000
"""Replicates that count."""
# More than the scatter of a few replicates asks for, which is an estimate itself: at one drop in
# a million three of four intervals come out as narrow as 20 %; with 1.3 it was three of five.
_TO_SPARE = 1.7

# 97.5 % quantiles of Student's t for 15, 20, 30, 60, 120 and ever more degrees of freedom.
_T95 = ((15, 2.131), (20, 2.086), (30, 2.042), (60, 2.000), (120, 1.980), (MOST, 1.960))


@dataclass(frozen=True)
class DropRate:
    """A drop rate with what it was told from."""

    drop_rate: float
    interval: tuple[float, float]
    """95 %, by Student's t over the replicates; its low end is not below 0."""
    levels: tuple[float, ...]
    """|p| as parts of the palm's half-length."""
    reached: tuple[float, ...]
    """Of the carries from one level, which part came to the next; mean over the replicates."""
    replicates: int
    planning: int
    """Replicates before those, which told how many were needed and do not count."""
    effort: int
    """Carries in each stage of a replicate."""
    carries: float
    """As many whole carries would have taken the same time, pilot and planning left out."""
    controller: str
    seed: int
    scene: Scene

    def summary(self) -> dict[str, Any]:
        """What ``palmbots rare --json`` prints."""
        return {
            "drop_rate": self.drop_rate,
            "interval": list(self.interval),
            "levels": list(self.levels),
            "reached": list(self.reached),
            "replicates": self.replicates,
            "planning": self.planning,
            "effort": self.effort,
            "carries": self.carries,
            "controller": self.controller,
            "seed": self.seed,
            "scene": self.scene.model_dump(),
        }


def rare(
    scene: Any = "paper",
    controller: str = "distributed",
    *,
    seed: int = 0,
    within: float = 0.2,
    effort: int = EFFORT,
    overrides: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> DropRate:
    """Tell the drop rate of a scene, also where a million carries would see none dropped.

    In double precision. The result depends on the arguments alone, not on the number of threads.

    Args:
        scene: as in `palmbots.carry`.
        controller: ``none``, ``centralized``, ``distributed`` or ``resilient``.
        seed: of all that is random.
        within: wanted half-width of the 95 % interval, as a part of the rate. The interval that
            comes out may be wider: how many replicates it takes is an estimate too, and at most
            10000 count.
        effort: carries in each stage of a replicate.
        overrides: scene keys to set.
        threads: how many replicates at once; None: as many as there are processors.
        progress: called with the fraction that is done.

    Raises:
        SceneError: the scene cannot be read, makes no sense, or is refused by the controller.
        PalmbotsError: another argument is not allowed, or nothing random drives a contact outward.
    """
    one_of("controller", controller, CONTROLLERS)
    if not 0.01 <= within <= 1:
        raise PalmbotsError(f"within: value is {show(within)}; allowed: 0.01 to 1")
    effort = whole_number("effort", effort, 10, 100_000)
    seed = seed_of(seed)
    workers = cores() if threads is None else whole_number("threads", threads, 1, 1024)
    chosen = load_scene(scene, overrides)
    if controller == "resilient":
        bounds_of(chosen)
    spec = lower(chosen)
    told = progress or (lambda fraction: None)
    levels = _core.choose_levels(spec, controller, seed, max(effort, 1000), SHARE)

    def run(first: int, count: int, share: tuple[float, float]) -> tuple[NDArray[Any], int]:
        """Stages (reached, drops) of replicates; a few at a time, so that Ctrl-C is heard."""
        rows, ticks = [], 0
        step = 2 * workers
        for at in range(first, first + count, step):
            more = min(step, first + count - at)
            part, spent = _core.replicates(
                spec, controller, seed, effort, levels, at, more, workers
            )
            rows += part
            ticks += spent
            told(share[0] + (share[1] - share[0]) * (at + more - first) / count)
        return np.array(rows, float), ticks

    planning, _ = run(0, PLANNING, (0.0, 0.2))
    spent = 0.2
    while True:
        before = _estimates(planning, effort)
        if not before.any():
            raise PalmbotsError(
                f"rare: of {PLANNING} times {effort} carries none came to a drop, by "
                f"{len(levels)} level{'s' * (len(levels) != 1)} up to "
                f"{max(levels, default=0.0):.2f} of the palm's half-length; allowed: scenes "
                "that may drop by chance, or a greater effort"
            )
        count = _needed(before, within)
        first = len(planning)
        more = math.ceil(count / 4) - first
        if more <= 0:
            break
        further, _ = run(first, more, (spent, 0.5 * (spent + 0.4)))
        planning = np.concatenate([planning, further])
        spent = 0.5 * (spent + 0.4)
    stages, ticks = run(first, count, (spent, 1.0))
    estimates = _estimates(stages, effort)
    rate = float(estimates.mean())
    half = _t95(count - 1) * float(estimates.std(ddof=1)) / math.sqrt(count)
    return DropRate(
        drop_rate=rate,
        interval=(max(rate - half, 0.0), min(rate + half, 1.0)),
        levels=tuple(levels),
        reached=tuple(_parts(stages, effort)),
        replicates=count,
        planning=first,
        effort=effort,
        carries=ticks * spec.period / (chosen.task.distance_m / chosen.robot_of("left").speed_m_s),
        controller=controller,
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


def _needed(estimates: NDArray[Any], within: float) -> int:
    """How many replicates that scatter like these take for such an interval."""
    scatter = float(estimates.std(ddof=1) / estimates.mean())
    count = MOST
    for _ in range(2):  # Student's quantile is that of the number sought: a little more for a few
        wanted = math.ceil(_TO_SPARE * (_t95(count - 1) * scatter / within) ** 2)
        count = min(max(wanted, FEWEST), MOST)
    return count


def _parts(stages: NDArray[Any], effort: int) -> list[float]:
    return [float(part) for part in np.mean(stages[:, :-1, 0] / effort, axis=0)]


def _t95(freedom: int) -> float:
    """Student's quantile at the next smaller tabled number of degrees of freedom."""
    return min(t for n, t in _T95 if n <= freedom)
