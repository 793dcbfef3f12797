# SPDX-License-Identifier: Apache-2.0
"""The least drop rate and the greatest noise of a model with one coordinate: a bound of controllers
whose robots keep driving (docs/theory/optimum.md states the assumptions)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from statistics import NormalDist
from typing import Any

from palmbots._types import Overrides
from palmbots._util.arguments import one_of
from palmbots._util.command import Option, command
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots.errors import PalmbotsError
from palmbots.optimum.bound_cache import cached, keep, key_of
from palmbots.optimum.opening import (
    COARSE,
    FINE,
    SPEEDS,
    Grid,
    OpeningProblem,
    OpeningSolution,
    best_price,
    law_m_s,
    opening_problem,
    refuse_unfit,
    solve,
)
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import to_spec

NOISE_KEY = "robot.noise_m_s"
LEAST_M_S, MOST_M_S = 1e-4, 1.0
"""The noises between which σ* is sought."""

_PRICES = (1, 4, 16, 64, 256, 1024)  # of progress on the front, times that of the fewest drops
_ACCURACY = 1e-3  # of σ* on the coarse grid, relative
_MOST_STEPS = 40
_STEP = 0.01  # of ln(noise), for the slope
_STRIDE = 0.2  # of ln(noise), first, while σ* is bracketed
_ORDER = 2  # of convergence, at least: the remainder is a third of the last difference
_NORMAL = NormalDist()


def _quantile(drop: float) -> float:
    """The normal quantile of a drop rate: nearly linear in ln(noise)."""
    return _NORMAL.inv_cdf(min(max(drop, 1e-12), 1 - 1e-12))


@dataclass(frozen=True, slots=True)
class FrontPoint:
    """One compromise: no carry of this mean duration can drop the object less often."""

    time_s: float
    drop_rate: float


@dataclass(frozen=True, repr=False)
class Bound(Result):
    """Bounds of the noise and the drop rate of controllers whose robots keep driving."""

    sigma_star_m_s: float
    """The greatest ``robot.noise_m_s`` at which a controller can drop only the fraction `rate`.

    It contains `grid_error`."""
    grid_error: float
    """Error that the grids may cause, estimated from coarser ones, as a fraction of σ*."""
    drop_rate: float
    """The least fraction of carries that drop at the scene's own noise, less the `grid_error`."""
    noise_m_s: float
    """The scene's own noise."""
    rate: float
    speeds: str
    """The admissible speeds: ``corrections`` or ``stopping``."""
    time_s: float
    """The mean duration of the optimal carries at σ*."""
    law_m_s: float
    """√(u L / 11 τ), the design law for σ*."""
    opening_speed_m_s: float
    """u: the greatest speed at which the robots separate or approach on command."""
    usable_m: float
    """L: half of the interval in which the separation must stay."""
    front: tuple[FrontPoint, ...]
    """With ``stopping``: least drop rate over mean duration, at the noise σ*. Else empty."""
    scene: Scene

    figure = "bound"

    def lines(self) -> Iterator[Item]:
        """The noise, what it means, and the least drop rate over the duration."""
        star = f"{100 * self.sigma_star_m_s:.3g} cm/s"
        yield Line(
            bold(f"σ* at most {star} for robots that keep driving"),
            f", with {100 * self.grid_error:.2f} % for the error of the grids",
        )
        yield quiet(_MEANING[self.speeds])
        yield (
            f"at more noise, more than {100 * self.rate:g} % of carries drop, whatever a "
            "controller knows"
        )
        yield (
            "controllers that let a robot stand are not bounded, because it then has less noise or "
            "none (palmbots carry -c creeping)"
        )
        rate = f"{self.drop_rate:.2g}" if self.drop_rate >= 1e-9 else "below 1e-9"
        yield f"least drop rate at the scene's noise of {100 * self.noise_m_s:g} cm/s: {rate}"
        yield quiet(
            f"greatest opening speed u = {100 * self.opening_speed_m_s:.3g} cm/s, half of the "
            f"usable interval L = {100 * self.usable_m:.3g} cm: the law √(uL/11τ) gives "
            f"{100 * self.law_m_s:.3g} cm/s"
        )
        if self.front:
            heads = ("mean duration (s)", "least drop rate (%)")
            rows = [(f"{at.time_s:.1f}", f"{100 * at.drop_rate:.3g}") for at in self.front]
            yield Table(rows, heads, right=heads)
            yield quiet(f"at the noise of {star}")
        elif self.speeds == "corrections":
            yield quiet(f"for carries that take at least their nominal time, {self.time_s:.1f} s")


_NUMBERS = (
    "sigma_star_m_s", "grid_error", "drop_rate", "rate", "speeds", "time_s", "law_m_s",
    "opening_speed_m_s", "usable_m",
)  # fmt: skip
_MEANING = {
    "corrections": "nominal speed with corrections",
    "stopping": "any speed from the correction backwards to nominal speed plus correction",
}


@command(
    order=97,
    example="palmbots bound --speeds corrections",
    progress="solving",
    figure="bound.png",
    speeds=Option(metavar="NAME"),
    drop_rate=Option(percent=True, least=0.001, most=0.5),
)
def bound(
    scene: SceneLike = "paper",
    speeds: str = "stopping",
    *,
    drop_rate: float = 0.01,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
) -> Bound:
    """Bound all controllers whose robots keep driving.

    The result is the greatest noise at which such a controller can drop as few as 1 % of carries,
    and the least drop rate at the scene's own noise. A robot that stands with its brakes on has
    less noise or none, so controllers that let robots stand are not bounded.

    With `speeds` stopping the robots may stop travelling and still correct. With `speeds`
    corrections they keep their nominal speed and add opposite corrections.

    Args:
        scene: as in `palmbots.carry`.
        speeds: ``stopping`` or ``corrections``. Stopping: each robot from its correction backwards
            to nominal speed plus correction. Corrections: nominal speed with equal and opposite
            corrections.
        drop_rate: share of carries that drop at the limit.
        overrides: scene keys to set.
        on_progress: called with the completed fraction.

    Note:
        With ``corrections`` the bound holds for controllers whose carries take at least their
        nominal time; with ``stopping``, for carries of any duration. Results are kept in the user's
        cache folder, by a hash of the scene.

    Raises:
        SceneError: the scene is invalid, or has a curved path, bumps, pushes, reboots, a pair that
            its biases stop, an outline that reaches below or beyond its contacts, or different
            correlation times of the noise.
        PalmbotsError: another argument is not allowed, or the least drop rate does not pass the
            given one between 0.0001 and 1 m/s of noise.
    """
    one_of("speeds", speeds, SPEEDS)
    base = load_scene(scene, overrides)
    refuse_unfit(base)
    report = on_progress or (lambda fraction: None)
    key = key_of({"scene": base.model_dump(), "speeds": speeds, "rate": drop_rate})
    numbers = cached(key)
    if numbers is None or set(numbers) != {*_NUMBERS, "front"}:
        search = _Search(base, speeds, float(drop_rate), report)
        numbers = search.numbers()
        keep(key, numbers)
    report(1.0)
    front = tuple(FrontPoint(**point) for point in numbers.pop("front"))
    return Bound(scene=base, noise_m_s=base.robot.noise_m_s, front=front, **numbers)


@dataclass
class _Search:
    """Solves the problem of one scene at any noise."""

    base: Scene
    speeds: str
    rate: float
    report: Callable[[float], None]
    price: float = 0.0
    """Of the last solution with stopping: a good start for the next one."""
    solved: float = 0.0
    """Work so far, in solutions on the fine grid."""

    def numbers(self) -> dict[str, Any]:
        """The fields of `Bound`, as plain numbers."""
        target = _quantile(self.rate)
        x, slope = self._coarse_crossing(target)
        # From there the fine grid needs two steps.
        x -= (_quantile(self.solution(math.exp(x), FINE).drop) - target) / slope
        near = math.exp(x)
        fine = self.solution(near, FINE)
        sigma = math.exp(x - (_quantile(fine.drop) - target) / slope)
        error = self._grid_error(near, fine.drop, slope)
        problem = self._problem(sigma)
        noise = self.base.robot.noise_m_s
        own = self.solution(noise / (1 + error), FINE if noise > sigma / 2 else COARSE)
        return {
            "sigma_star_m_s": sigma * (1 + error),
            "grid_error": error,
            "drop_rate": max(own.drop, 0.0),
            "rate": self.rate,
            "speeds": self.speeds,
            "time_s": fine.duration,
            "law_m_s": law_m_s(problem, self.base.robot_of("left").noise_tau_s),
            "opening_speed_m_s": (problem.fastest - problem.slowest) / 2,
            "usable_m": (problem.highest - problem.lowest) / 2,
            "front": self._front(sigma) if self.speeds == "stopping" else [],
        }

    def solution(self, noise: float, grid: Grid) -> OpeningSolution:
        """The fewest drops at a noise [m/s]."""
        problem = self._problem(noise)
        if self.speeds == "corrections":
            solution = solve(problem, grid)
            self._count(grid)
            return solution
        problem.price = self.price
        solution = best_price(problem, grid, lambda _: self._count(grid))
        self.price = problem.price
        return solution

    def _problem(self, noise: float) -> OpeningProblem:
        scene = load_scene(self.base, {NOISE_KEY: noise}, called="bound:")
        return opening_problem(to_spec(scene), self.speeds)

    def _count(self, grid: Grid) -> None:
        share = grid.positions * grid.noises * grid.speeds
        self.solved += share / (FINE.positions * FINE.noises * FINE.speeds)
        expected = 7.0 if self.speeds == "corrections" else 14.0
        self.report(min(self.solved / expected, 0.99))

    def _coarse_crossing(self, target: float) -> tuple[float, float]:
        """Where the quantile of the drop rate passes the target on the coarse grid, in ln(noise),
        and its slope there."""
        start = law_m_s(self._problem(0.01), self.base.robot_of("left").noise_tau_s)
        low, high = self._bracket(math.log(min(max(start, 2 * LEAST_M_S), MOST_M_S / 2)), target)
        x = self._crossing(low, high, target)
        step = _STEP
        while True:  # rounding may hide a small step
            rise = self._error(x + step, target) - self._error(x - step, target)
            if rise > 0:
                return x, rise / (2 * step)
            if step > 1:
                raise self._unreached("about", x)
            step *= 2

    def _error(self, x: float, target: float) -> float:
        return _quantile(self.solution(math.exp(x), COARSE).drop) - target

    def _bracket(self, centre: float, target: float) -> tuple[float, float]:
        """Two noises, as logarithms, between which the least drop rate passes the target."""
        least, most = math.log(LEAST_M_S), math.log(MOST_M_S)
        low = high = centre
        stride = _STRIDE
        while self._error(high, target) < 0:
            if high >= most:
                raise self._unreached("at most", high)
            low, high = high, min(high + stride, most)
            stride *= 2
        while low == high or self._error(low, target) > 0:
            if low <= least:
                raise self._unreached("at least", low)
            low = max(low - stride, least)
            stride *= 2
        return low, high

    def _unreached(self, bound: str, x: float) -> PalmbotsError:
        drop = self.solution(math.exp(x), COARSE).drop
        return PalmbotsError(
            f"bound: the least drop rate is {bound} {drop:.3g} with {NOISE_KEY} = "
            f"{math.exp(x):g}; allowed: scenes in which it passes {self.rate:g} between "
            f"{LEAST_M_S:g} and {MOST_M_S:g} m/s"
        )

    def _crossing(self, a: float, b: float, target: float) -> float:
        """Where the quantile passes the target between a and b (Illinois variant)."""
        fa, fb = self._error(a, target), self._error(b, target)
        side = 0
        x = a
        for _ in range(_MOST_STEPS):
            before, x = x, (a * fb - b * fa) / (fb - fa)
            f = self._error(x, target)
            if abs(x - before) < _ACCURACY or f == 0:
                break
            if f > 0:
                b, fb = x, f
                fa = fa / 2 if side == 1 else fa
                side = 1
            else:
                a, fa = x, f
                fb = fb / 2 if side == -1 else fb
                side = -1
        return x

    def _grid_error(self, noise: float, drop: float, slope: float) -> float:
        """The remainder of σ*, from solutions with half as many intervals, one kind at a time."""
        differences = (
            _quantile(self.solution(noise, FINE.coarser(name)).drop) - _quantile(drop)
            for name in ("positions", "noises", "speeds")
        )
        return sum(map(abs, differences)) / slope / (2**_ORDER - 1)

    def _front(self, sigma: float) -> list[dict[str, float]]:
        """Least drop rate over mean duration at a noise: progress gets more and more expensive."""
        problem = self._problem(sigma)
        problem.price = self.price
        points = []
        best_price(problem, COARSE, lambda _: self._count(COARSE))
        fewest = problem.price
        for factor in _PRICES:
            problem.price = factor * fewest
            solution = solve(problem, COARSE)
            self._count(COARSE)
            points.append(asdict(FrontPoint(solution.duration, solution.drop)))
        return points
