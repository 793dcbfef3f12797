# SPDX-License-Identifier: Apache-2.0
"""The noise that a controller tolerates: the speed noise at which it drops 1 % of carries.

The drop rate grows with ``robot.noise_m_s``. A pilot run brackets the noise at which it passes the
given rate: first on a geometric grid, then by bisection, with a few hundred carries at each noise
and the same seeds everywhere. It also finds how steep the rate is, and so how many carries the
result needs. These carries then run at five noises near the crossing, and a probit model in the
logarithm of the noise is fitted to them alone (`palmbots._util.probit`). The window is so narrow
that a curvature of the rate shifts the result by little compared with its interval. No carry of the
pilot run counts: they chose the window, and an estimate that also chooses its data would be biased.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from palmbots._types import Interval, Overrides
from palmbots._util.arguments import seed_of, whole_number
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import Z95, wilson
from palmbots._util.probit import Counts, Crossing, crossing, information
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots.control.registry import ControllerEntry, ControllerLike, resolve
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.simulation.batch import DROPPED, available_cores
from palmbots.simulation.outcome_counts import carry_many
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.simulation.worlds import DEFAULT_WORLD, WorldEntry, world_entry

NOISE_KEY = "robot.noise_m_s"
LEAST_M_S, MOST_M_S = 1e-4, 1.0
"""The noises that the bracket may reach; the largest is the scene's own limit."""
LEVELS = 5
"""Noises at which the carries that count run."""
NARROW, WIDE = 0.01, 0.05
"""Relative half-width of the interval by default: in the core, and if Python steps the carries."""
FEW, FEW_IN_PYTHON = 200, 50
"""Fewest carries of the pilot run at each noise: in the core, and if Python steps the carries."""
MOST_CARRIES_IN_PYTHON = 20_000
"""More carries that Python steps than this take longer than about a quarter of an hour."""

# Half of the window in ln(noise), for a relative half-width h of the interval. Where noise makes a
# contact reach the end of a palm, the rate's quantile is about −c/noise, whose second derivative in
# ln(noise) is minus its first. Five noises over ±w then shift the crossing by w²/4 = 0.15 h.
_WINDOW_SQUARED = 0.6
_WIDEST_PROBIT = 1.2  # in standard deviations of the rate's quantile
_TYPICAL_SLOPE = 4.0  # of the shipped controllers in the built-in scenes
_RESERVE = 1.4  # the slope is an estimate, and the crossing is not quite in the window's middle


@dataclass(frozen=True, slots=True)
class NoisePoint:
    """The carries at one noise."""

    noise_m_s: float
    carries: int
    drops: int
    counts: bool
    """Whether the result is fitted to them; False: a carry of the pilot run."""

    @property
    def drop_rate(self) -> float:
        """The fraction of carries that dropped the object."""
        return self.drops / self.carries

    @property
    def interval(self) -> Interval:
        """Wilson's 95 % interval of the drop rate."""
        return wilson(self.drops, self.carries)

    def row(self) -> tuple[str, str, str]:
        """The noise, the carries and their drop rate, for people."""
        ends = "–".join(f"{100 * end:.2f}" for end in self.interval)
        rate = f"{100 * self.drop_rate:.2f} ({ends})"
        return f"{100 * self.noise_m_s:.3f}", f"{self.carries:,}", rate


@dataclass(frozen=True, repr=False)
class NoiseLimit(Result):
    """The noise at which a controller drops a given fraction of carries, and how it was found."""

    sigma_star_m_s: float
    """``robot.noise_m_s`` at which the fraction `rate` of carries drops the object."""
    interval: Interval
    """95 %, from the likelihood ratio."""
    rate: float
    slope: float
    """Of the fitted rate: how many standard deviations its quantile grows while the noise grows by
    a factor of e."""
    carries: int
    """Those that count."""
    pilot_carries: int
    world: str
    points: tuple[NoisePoint, ...]
    controller: str
    seed: int
    scene: Scene

    figure = "noise_limit"

    def lines(self) -> Iterator[Item]:
        """The noise, its interval, and the drop rates it was fitted to."""
        low, high = (100 * end for end in self.interval)
        star = bold(f"σ* = {100 * self.sigma_star_m_s:.3g} cm/s")
        yield Line(star, f", 95 % {low:.3f} to {high:.3f}")
        place = "" if self.world == DEFAULT_WORLD else f", {self.world}"
        yield quiet(f"{self.controller}, seed {self.seed}{place}")
        yield f"at robot.noise_m_s = σ*, {100 * self.rate:g} % of carries drop the object"
        heads = ("noise (cm/s)", "carries", "dropped % (95 %)")
        yield Table([point.row() for point in self.points if point.counts], heads, right=heads)
        yield quiet(
            f"fitted to these {self.carries:,} carries; {self.pilot_carries:,} carries of a pilot "
            "run found where"
        )


@command(
    order=95,
    example="palmbots noise-limit -c resilient --set radio.loss=0.2",
    progress="carrying",
    figure="noise_limit.png",
    drop_rate=Option(percent=True, least=0.001, most=0.5),
    relative_half_width=Option("--relative-error-percent", percent=True, least=0.001, most=0.1),
)
def noise_limit(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    drop_rate: float = 0.01,
    relative_half_width: float | None = None,
    seed: int = 0,
    world: str = "quasistatic",
    threads: int | None = None,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> NoiseLimit:
    """Find the noise at which 1 % of carries drop the object.

    The noise is the scene key ``robot.noise_m_s``; the estimate has a 95 % interval.

    Args:
        scene: as in `palmbots.carry`.
        controller: as in `palmbots.carry`.
        drop_rate: share of carries that drop at the limit.
        relative_half_width: half-width of the 95 % interval, relative to the noise; None: 1 %, or
            5 % where Python steps the carries. The interval may be a little wider, because the
            number of carries is an estimate.
        seed: random seed.
        world: as in `palmbots.carry`. MuJoCo runs in one process per processor.
        threads: worker threads; None: one per processor.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Note:
        A robot that overrides the noise keeps its own. Carry i has the seed seed + i at whatever
        noise it runs. The result depends on the arguments, not on the number of threads.

    Raises:
        SceneError: the scene cannot be read, is invalid, or is refused by the controller.
        PalmbotsError: another argument is not allowed, or the drop rate does not pass the given one
            between 0.0001 and 1 m/s of noise.
    """
    entry = resolve(controller)
    seed = seed_of(seed)
    workers = available_cores() if threads is None else whole_number("threads", threads, 1, 1024)
    base = load_scene(scene, overrides)
    place = world_entry(world)
    is_slow = entry.is_python or place.is_stepped
    if relative_half_width is None:
        relative_half_width = WIDE if is_slow else NARROW
    few = max(FEW_IN_PYTHON if is_slow else FEW, math.ceil(4 / drop_rate))
    if is_slow:
        _refuse_if_slow(entry, place, drop_rate, relative_half_width, few)
    expected = _expected(drop_rate, relative_half_width, few)
    report = on_progress or (lambda fraction: None)
    run = _Carries(base, entry, place, seed, workers, report, expected)
    pilot = _locate(run, base.robot.noise_m_s, drop_rate, few)
    pilot_carries = run.carries
    found: Crossing | None = None
    for _ in range(4):
        found, window = _measure(run, pilot, drop_rate, relative_half_width, few)
        if found is not None and abs(found.x - pilot.x) <= window:
            break
        pilot = found or pilot  # the window missed the crossing: it moves, with carries of its own
        pilot_carries = run.carries
        run.discard()
    if found is None or not math.isfinite(found.high - found.low):
        raise PalmbotsError(
            f"noise-limit: the drop rate of {entry.name} does not grow with the noise near "
            f"{math.exp(pilot.x):.3g} m/s; allowed: scenes in which noise causes the drops"
        )
    run.report(1.0)
    return NoiseLimit(
        sigma_star_m_s=math.exp(found.x),
        interval=(math.exp(found.low), math.exp(found.high)),
        rate=float(drop_rate),
        slope=found.slope,
        carries=run.carries - pilot_carries,
        pilot_carries=pilot_carries,
        world=place.name,
        points=tuple(run.points),
        controller=entry.name,
        seed=seed,
        scene=base,
    )


def _refuse_if_slow(
    entry: ControllerEntry, place: WorldEntry, rate: float, half_width: float, few: int
) -> None:
    expected = _expected(rate, half_width, few)
    if expected > MOST_CARRIES_IN_PYTHON:
        left = max(MOST_CARRIES_IN_PYTHON - 12 * few, 1)
        least = half_width * math.sqrt(_needed(rate, half_width, _TYPICAL_SLOPE) / left)
        what, other = f"controller: {entry.name}", "a shipped controller"
        if place.is_stepped:
            what, other = f"world: {place.name}", DEFAULT_WORLD
        raise PalmbotsError(
            f"{what} is stepped in Python, and this interval needs about {expected:,} carries; "
            f"allowed: {other}, or a relative error of {math.ceil(100 * least)} % or more "
            "(--relative-error-percent, relative_half_width)"
        )


def expected_carries(drop_rate: float, relative_half_width: float) -> int:
    """About how many carries `noise_limit` takes with a shipped controller."""
    return _expected(drop_rate, relative_half_width, max(FEW, math.ceil(4 / drop_rate)))


def _expected(rate: float, half_width: float, few: int) -> int:
    """About how many carries the pilot run and the result take."""
    return 12 * few + max(_needed(rate, half_width, _TYPICAL_SLOPE), few * LEVELS)


def _needed(rate: float, half_width: float, slope: float) -> int:
    """How many carries near the crossing an interval of this relative half-width takes."""
    per_carry = information(rate) * slope * slope
    return math.ceil(_RESERVE * (Z95 / half_width) ** 2 / per_carry)


@dataclass
class _Carries:
    """Runs carries of one scene at any noise, and keeps what came out."""

    base: Scene
    entry: ControllerEntry
    place: WorldEntry
    seed: int
    threads: int
    report: Callable[[float], None]
    expected: int
    """How many there will be in all, as far as it is known."""
    carries: int = 0
    """All so far."""
    next_seed: int = 0
    """Carries with a smaller index have been run at some noise."""
    points: list[NoisePoint] = field(default_factory=list)
    prepared: dict[float, Prepared] = field(default_factory=dict)
    fraction: float = 0.0

    def run(
        self, noises: list[float], first: int, count: int, *, counts: bool = False
    ) -> list[NoisePoint]:
        """Run carries first … first + count − 1, each at the next of the noises in turn."""
        index = np.arange(count) % len(noises)
        seeds = np.arange(first, first + count, dtype=np.uint64) + np.uint64(self.seed)
        outcome = carry_many(
            [self._prepared(noise) for noise in noises],
            index,
            seeds,
            threads=self.threads,
            watch=self._report,
        )["outcome"]
        self.carries += count
        self._report(0)
        self.next_seed = max(self.next_seed, first + count)
        made = [
            NoisePoint(
                noise,
                int(np.count_nonzero(index == i)),
                int(np.count_nonzero(outcome[index == i] == DROPPED)),
                counts,
            )
            for i, noise in enumerate(noises)
        ]
        self.points += made
        return made

    def discard(self) -> None:
        """Let none of the carries so far count."""
        self.points = [NoisePoint(p.noise_m_s, p.carries, p.drops, False) for p in self.points]

    def _report(self, done: int) -> None:
        """Report the fraction after this many carries of the present run; it never decreases."""
        now = min((self.carries + done) / self.expected, 1.0)
        self.fraction = max(self.fraction, now)
        self.report(self.fraction)

    def _prepared(self, noise: float) -> Prepared:
        if noise not in self.prepared:
            scene = load_scene(self.base, {NOISE_KEY: noise}, called="noise-limit:")
            self.prepared[noise] = prepare(scene, self.entry, self.place)
        return self.prepared[noise]


def _fit(points: list[NoisePoint], rate: float) -> Crossing | None:
    return crossing(
        Counts(
            [math.log(point.noise_m_s) for point in points],
            [point.carries for point in points],
            [point.drops for point in points],
        ),
        rate,
    )


def _locate(run: _Carries, start: float, rate: float, few: int) -> Crossing:
    """About where the drop rate passes `rate`, and how steeply, from a pilot run."""
    tried: dict[float, NoisePoint] = {}

    def at(noise: float) -> NoisePoint:
        if noise not in tried:
            (tried[noise],) = run.run([noise], 0, few)
        return tried[noise]

    noise = min(max(start or 0.01, LEAST_M_S), MOST_M_S)
    low = high = noise
    while at(high).interval[0] <= rate:
        if high == MOST_M_S:
            raise _unreached(run.entry, at(high), rate, "at most")
        high = min(2 * high, MOST_M_S)
    while at(low).interval[1] >= rate:
        if low == LEAST_M_S:
            raise _unreached(run.entry, at(low), rate, "at least")
        low = max(low / 2, LEAST_M_S)
    low = max(n for n in tried if n < high and tried[n].interval[1] < rate)
    while high > 1.5 * low:
        middle = math.sqrt(low * high)
        if at(middle).interval[1] < rate:
            low = middle
        elif at(middle).interval[0] > rate:
            high = middle
        else:
            break
    found = _fit([point for n, point in tried.items() if low <= n <= high], rate)
    centre = math.log(math.sqrt(low * high)) if found is None else found.x
    centre = min(max(centre, math.log(low)), math.log(high))
    step = 0.4 / (_TYPICAL_SLOPE if found is None else min(max(found.slope, 2.5), 12.0))
    levels = [math.exp(centre + step * i) for i in (-2, -1, 0, 1, 2)]
    run.run([min(n, MOST_M_S) for n in levels], run.next_seed, 5 * few)
    near = [p for p in run.points if abs(math.log(p.noise_m_s) - centre) < 5 * step]
    return _fit(near, rate) or Crossing(centre, _TYPICAL_SLOPE, -math.inf, math.inf)


def _unreached(entry: ControllerEntry, point: NoisePoint, rate: float, bound: str) -> PalmbotsError:
    """The refusal where the drop rate does not pass `rate` in the whole range of the noise."""
    share = f"{100 * point.drop_rate:.3g} % of {point.carries} carries"
    return PalmbotsError(
        f"noise-limit: {entry.name} drops {bound} about {share}, here with {NOISE_KEY} = "
        f"{point.noise_m_s:g}; allowed: scenes in which the drop rate passes {100 * rate:g} % "
        f"between {LEAST_M_S:g} and {MOST_M_S:g} m/s"
    )


def _measure(
    run: _Carries, pilot: Crossing, rate: float, half_width: float, few: int
) -> tuple[Crossing | None, float]:
    """The crossing from carries of its own, and half the window of ln(noise) in which they ran."""
    window = min(math.sqrt(_WINDOW_SQUARED * half_width), _WIDEST_PROBIT / pilot.slope)
    count = max(_needed(rate, half_width, pilot.slope), min(few, FEW) * LEVELS)
    if run.entry.is_python or run.place.is_stepped:
        count = min(count, MOST_CARRIES_IN_PYTHON)
    steps = np.linspace(-window, window, LEVELS)
    noises = [min(math.exp(pilot.x + float(step)), MOST_M_S) for step in steps]
    run.expected = run.carries + count
    made = run.run(noises, run.next_seed, count, counts=True)
    return _fit(made, rate), window
